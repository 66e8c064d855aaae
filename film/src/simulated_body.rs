//! A virtual body of a simulation: its parts, and what has become of it so far.

use crate::compositor::Drawn;
use crate::part::Part;
use nalgebra::{Isometry3, Translation3, Vector3};
use ode_visual_hull::ode::BodyId;

/// Acceleration of falling bodies, in m/s2.
pub(crate) const GRAVITY: f64 = 9.81;

/// A body slower than this, in m/s, is at rest.
pub(crate) const AT_REST: f64 = 0.02;

/// A virtual body.
#[derive(Debug, Clone)]
pub struct SimulatedBody {
    /// What it consists of.
    pub parts: Vec<Part>,
    pub(crate) id: BodyId,
    /// Where the centre of mass, the origin of ODE's frame, is in the body's own frame.
    pub(crate) mass_centre: Translation3<f64>,
    pub(crate) touched: Touched,
    /// Largest depth in the hull so far, in metres.
    pub deepest: f64,
    /// Time of its first contact, in seconds.
    pub first_contact: Option<f64>,
    /// Largest speed since then, in m/s.
    pub fastest_after_contact: f64,
    /// Largest speed since then without what it gained by falling, in m/s: the speed that it would have at the greatest
    /// height since it was last at rest.
    pub fastest_without_fall: f64,
    /// That height, in metres.
    highest: f64,
}

/// What a body touched in the last step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Touched {
    pub(crate) hull: bool,
    /// The floor, or what is fixed.
    pub(crate) floor: bool,
    /// Other bodies, by index.
    pub(crate) bodies: Vec<usize>,
}

/// Pose and velocity of a body.
#[derive(Debug, Clone, Copy)]
pub struct State {
    /// World from body.
    pub pose: Isometry3<f64>,
    /// That of the centre of mass, in m/s.
    pub linear_velocity: Vector3<f64>,
    /// In rad/s, in the world.
    pub angular_velocity: Vector3<f64>,
}

/// What supports a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// The real subject, directly or through other bodies.
    Subject,
    /// The floor or what is fixed, directly or through other bodies.
    Floor,
    /// Nothing: the body falls, or hangs from a joint.
    Nothing,
}

impl SimulatedBody {
    /// A body that has touched nothing yet, with its centre of mass at this `height` in metres.
    pub(crate) fn new(parts: &[Part], id: BodyId, mass_centre: Translation3<f64>, height: f64) -> Self {
        Self {
            parts: parts.to_vec(),
            id,
            mass_centre,
            touched: Touched::default(),
            deepest: 0.0,
            first_contact: None,
            fastest_after_contact: 0.0,
            fastest_without_fall: 0.0,
            highest: height,
        }
    }

    /// Records the speed in m/s and the height in metres after a step.
    pub(crate) fn record_speed(&mut self, speed: f64, height: f64) {
        self.highest = if speed < AT_REST { height } else { self.highest.max(height) };
        if self.first_contact.is_some() {
            let by_falling = 2.0 * GRAVITY * (self.highest - height);
            let without_fall = (speed * speed - by_falling).max(0.0).sqrt();
            self.fastest_without_fall = self.fastest_without_fall.max(without_fall);
            self.fastest_after_contact = self.fastest_after_contact.max(speed);
        }
    }

    /// The colour in plots: that of the first part.
    pub(crate) fn colour(&self) -> [u8; 3] {
        self.parts.first().map_or([0; 3], |part| part.colour)
    }
}

impl Support {
    /// What supports a body that touched this.
    pub(crate) fn of(touched: &Touched) -> Self {
        match touched {
            Touched { hull: true, .. } => Self::Subject,
            Touched { floor: true, .. } => Self::Floor,
            _ => Self::Nothing,
        }
    }
}

/// The parts of a body at the pose `world_from_body`, as they are drawn.
pub(crate) fn drawn<'p>(
    parts: &'p [Part],
    world_from_body: Isometry3<f64>,
) -> impl Iterator<Item = Drawn> + 'p {
    parts.iter().map(move |part| Drawn {
        shape: part.shape.clone(),
        world_from_body: world_from_body * part.body_from_part,
        colour: part.colour,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Simulation;
    use ode_visual_hull::hull::{HullData, Motion};
    use ode_visual_hull::ode::Shape;
    use std::sync::Arc;

    /// The largest speed without falling of a body that has these speeds, in m/s, at these heights, in metres.
    fn without_fall(states: &[(f64, f64)]) -> f64 {
        let mut simulation = Simulation::new(&Arc::new(HullData::new()), 0.001, Motion::Held).unwrap();
        simulation.add(&Shape::cube(0.1), &Isometry3::translation(0.0, 0.0, 1.0), [0; 3]).unwrap();
        let mut one = simulation.bodies()[0].clone();
        one.first_contact = Some(0.0);
        states.iter().for_each(|&(speed, height)| one.record_speed(speed, height));
        one.fastest_without_fall
    }

    #[test]
    fn falling_adds_nothing_to_a_bodys_speed_without_falling() {
        let fallen = |height: f64| ((2.0 * GRAVITY * (1.0 - height)).sqrt(), height);
        assert!(without_fall(&[(0.0, 1.0), fallen(0.6), fallen(0.1)]) < 1e-6);

        // A body that was thrown at 2 m/s keeps that speed while it rises, falls and lies on the floor.
        let thrown = |height: f64| ((4.0 + 2.0 * GRAVITY * (1.0 - height)).sqrt(), height);
        let found = without_fall(&[(0.0, 1.0), thrown(1.0), thrown(1.1), thrown(0.1), (0.0, 0.05)]);
        assert!((found - 2.0).abs() < 1e-9, "{found}");
    }
}
