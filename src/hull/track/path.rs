//! The last poses of a part of the real subject, and how fast it moves, by least squares.

use nalgebra::{Isometry3, Matrix3, Matrix3x6, Point3, UnitQuaternion, Vector3};
use std::collections::VecDeque;

/// The time over which poses are kept, in seconds. Over less, the noise of masks is not averaged out; over more, a hand does
/// not accelerate evenly.
const SECONDS: f64 = 0.1;

/// The time from which on a change of the velocity is fitted, in seconds.
const SECONDS_OF_CHANGE: f64 = 0.06;

/// The most poses that are kept: as many as steps of a simulation at 1 kHz.
const MAX_POSES: usize = 128;

/// A rigid motion: how fast a point of a body moves, and how the body turns about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RigidMotion {
    /// In m/s.
    pub(crate) linear: Vector3<f64>,
    /// In rad/s.
    pub(crate) angular: Vector3<f64>,
}

impl RigidMotion {
    pub(crate) const REST: Self =
        Self { linear: Vector3::new(0.0, 0.0, 0.0), angular: Vector3::new(0.0, 0.0, 0.0) };

    /// The motion of the point that lies `arm` metres from this one.
    pub(crate) fn at(&self, arm: &Vector3<f64>) -> Self {
        Self { linear: self.linear + self.angular.cross(arm), ..*self }
    }

    /// This motion times a number.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }

    /// This motion in another frame, which is turned by `rotation`.
    pub(crate) fn turned(&self, rotation: &UnitQuaternion<f64>) -> Self {
        Self { linear: rotation * self.linear, angular: rotation * self.angular }
    }

    /// The pose `seconds` later of a part whose pose is `pose`, and whose point at `centre` moves so.
    pub(crate) fn advance(
        &self,
        pose: &Isometry3<f64>,
        centre: &Point3<f64>,
        seconds: f64,
    ) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(self.angular * seconds);
        let centre_later = centre + self.linear * seconds;
        let arm = pose.translation.vector - centre.coords;
        Isometry3::from_parts((centre_later.coords + turn * arm).into(), turn * pose.rotation)
    }
}

/// Where a part of the subject was, over the last tenth of a second.
#[derive(Debug, Clone, Default)]
pub(super) struct Path {
    /// The latest last.
    places: VecDeque<Place>,
}

#[derive(Debug, Clone, Copy)]
struct Place {
    seconds: f64,
    centre: Point3<f64>,
    rotation: UnitQuaternion<f64>,
}

impl Path {
    pub(super) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Adds a place at a time after all others.
    pub(super) fn push(&mut self, seconds: f64, centre: Point3<f64>, rotation: UnitQuaternion<f64>) {
        while self.places.front().is_some_and(|first| seconds - first.seconds > SECONDS)
            || self.places.len() >= MAX_POSES
        {
            // Two places tell a velocity, however far apart.
            if self.places.len() < 2 {
                break;
            }
            self.places.pop_front();
        }
        self.places.push_back(Place { seconds, centre, rotation });
    }

    /// The time between the last two places, in seconds; `None` before the second.
    pub(super) fn last_period(&self) -> Option<f64> {
        let last = self.places.back()?;
        let before = self.places.iter().rev().nth(1)?;
        Some(last.seconds - before.seconds)
    }

    /// How the part moves at the last place: the derivative there of the parabola that fits all places best; of the straight
    /// line, where they cover too little time. `None` before the second place.
    pub(super) fn motion(&self) -> Option<RigidMotion> {
        let (last, first) = (self.places.back()?, self.places.front()?);
        let covered = last.seconds - first.seconds;
        if self.places.len() < 2 || covered <= 0.0 {
            return None;
        }
        let is_curved = self.places.len() >= 4 && covered >= SECONDS_OF_CHANGE;

        // The sums of a polynomial's least squares, in units of the time that is covered.
        let (mut matrix, mut right) = (Matrix3::zeros(), Matrix3x6::zeros());
        for place in &self.places {
            let time = (place.seconds - last.seconds) / covered;
            let powers = Vector3::new(1.0, time, if is_curved { time * time } else { 0.0 });
            let shift = place.centre - last.centre;
            let turn = (place.rotation * last.rotation.inverse()).scaled_axis();
            matrix += powers * powers.transpose();
            for k in 0..3 {
                right.set_column(k, &(right.column(k) + powers * shift[k]));
                right.set_column(3 + k, &(right.column(3 + k) + powers * turn[k]));
            }
        }
        if !is_curved {
            matrix[(2, 2)] = 1.0;
        }
        let fitted = matrix.cholesky()?.solve(&right);
        let slope = |k: usize| fitted[(1, k)] / covered;
        Some(RigidMotion {
            linear: Vector3::new(slope(0), slope(1), slope(2)),
            angular: Vector3::new(slope(3), slope(4), slope(5)),
        })
    }
}
