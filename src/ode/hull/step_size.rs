//! The length of the simulation's steps, on which depends how fast ODE corrects a depth.
//!
//! ODE does not tell its colliders. A program tells it with the hull's time and with the motion of contacts; of others it is
//! seen from how bodies move from one collide to the next, since ODE moves a body by its velocity times the step.

use crate::lock::lock;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use std::sync::Mutex;

/// The longest step in seconds that is believed: a clock may have jumped.
const LONGEST_STEP: f64 = 0.05;

/// A body has moved by its velocity if its way differs by at most this part of itself.
const SAME_WAY: f64 = 1e-6;

/// Number of bodies from which on they are forgotten: addresses accumulate.
const MAX_BODIES: usize = 1 << 12;

/// What is known of the length of the steps.
#[derive(Debug, Default)]
pub(super) struct StepSize(Mutex<Known>);

#[derive(Debug, Default)]
struct Known {
    /// In seconds, as the program has told it last.
    told: Option<f64>,
    /// In seconds, as bodies have moved last.
    seen: Option<f64>,
    /// Where bodies were when they were last collided, by their addresses, which are compared and never followed.
    positions: HashMap<usize, Point3<f64>>,
}

impl StepSize {
    /// The length of the steps, in seconds; `None` before one was told or seen, as in programs that only query contacts.
    pub(super) fn seconds(&self) -> Option<f64> {
        self.unbounded_seconds().map(|seconds| seconds.min(LONGEST_STEP))
    }

    /// [`Self::seconds`], also where they are more than is believed of a clock.
    pub(super) fn unbounded_seconds(&self) -> Option<f64> {
        let known = lock(&self.0);
        known.told.or(known.seen)
    }

    /// Records the length in seconds that the program has told.
    pub(super) fn tell(&self, seconds: f64) {
        if seconds > 0.0 && seconds.is_finite() {
            let mut known = lock(&self.0);
            known.told = Some(seconds);
            known.positions = HashMap::new();
        }
    }

    /// Records where the body at an address is, and its velocity.
    pub(super) fn see(&self, body: usize, position: Point3<f64>, velocity: &Vector3<f64>) {
        let mut known = lock(&self.0);
        if known.told.is_some() {
            return;
        }
        if known.positions.len() >= MAX_BODIES {
            known.positions.clear();
        }
        let Some(before) = known.positions.insert(body, position) else { return };

        let way = position - before;
        let seconds = way.dot(velocity) / velocity.norm_squared();
        if seconds > 0.0 && (way - velocity * seconds).norm() <= SAME_WAY * way.norm() {
            known.take(seconds);
        }
    }
}

impl Known {
    /// Takes a length that was seen. A body that was not collided in each step has moved by several at once.
    fn take(&mut self, seconds: f64) {
        let steps = self.seen.map_or(1.0, |seen| seconds / seen);
        let are_several = steps > 1.5 && (steps - steps.round()).abs() < 1e-3;
        if !are_several {
            self.seen = Some(seconds);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_is_seen_from_bodies_that_move_by_their_velocity() {
        let step = StepSize::default();
        assert_eq!(step.seconds(), None);

        let (mut position, velocity) = (Point3::new(1.0, 2.0, 3.0), Vector3::new(0.3, -0.2, 1.0));
        for _ in 0..2 {
            step.see(1, position, &velocity);
            position += velocity / 240.0;
        }
        assert!((step.seconds().unwrap() * 240.0 - 1.0).abs() < 1e-9);

        // Several steps at once, a body that the program has moved, one at rest, and an address that is another body's now.
        step.see(1, position + velocity / 60.0, &velocity);
        step.see(1, Point3::origin(), &velocity);
        step.see(1, Point3::origin(), &Vector3::zeros());
        step.see(1, Point3::new(0.0, 1.0, 0.0), &velocity);
        assert!((step.seconds().unwrap() * 240.0 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_step_that_is_told_is_taken_up_to_the_longest() {
        let step = StepSize::default();
        for nonsense in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            step.tell(nonsense);
            assert_eq!(step.seconds(), None);
        }
        step.tell(0.01);
        step.see(1, Point3::origin(), &Vector3::x());
        step.see(1, Point3::new(0.002, 0.0, 0.0), &Vector3::x());
        assert_eq!(step.seconds(), Some(0.01));
        step.tell(100.0);
        assert_eq!(step.seconds(), Some(LONGEST_STEP));
    }
}
