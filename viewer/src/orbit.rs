//! A viewpoint that circles a target.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::{Error, Result};

/// The largest elevation, in radians: straight from above, up has no direction in the image.
const MAX_ELEVATION: f64 = 1.55;

/// Elevation of a viewpoint that shows a whole subject, its distance in lengths of the subject's longest side, and its
/// horizontal angle of view.
const ELEVATION: f64 = 0.30;
const DISTANCE: f64 = 1.9;
const FIELD_OF_VIEW: f64 = 50.0 * std::f64::consts::PI / 180.0;

/// Bounds of the distance that zooming leads to, in metres.
const MIN_DISTANCE: f64 = 0.05;
const MAX_DISTANCE: f64 = 100.0;

/// A viewpoint given by the place it looks at. World z is up; metres and radians.
///
/// ```text
///            eye
///          /  |  elevation above the horizontal plane
///   target ---+  azimuth counter-clockwise from +x
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// The place in the middle of the picture.
    pub target: Point3<f64>,
    /// Counter-clockwise from +x, seen from above.
    pub azimuth: f64,
    /// Above the horizontal plane.
    pub elevation: f64,
    /// Of the eye from the target.
    pub distance: f64,
    /// Horizontal angle of view.
    pub field_of_view: f64,
}

impl Orbit {
    /// The viewpoint at `eye` that looks at `target`.
    pub fn from_eye(eye: &Point3<f64>, target: &Point3<f64>, field_of_view: f64) -> Self {
        let offset = eye - target;
        Self {
            target: *target,
            azimuth: offset.y.atan2(offset.x),
            elevation: offset.z.atan2(offset.xy().norm()),
            distance: offset.norm(),
            field_of_view,
        }
    }

    /// A viewpoint that shows all of `subject`, from this azimuth.
    pub fn around(subject: &Aabb, azimuth: f64) -> Self {
        Self {
            target: subject.centre(),
            azimuth,
            elevation: ELEVATION,
            distance: DISTANCE * (subject.max - subject.min).amax(),
            field_of_view: FIELD_OF_VIEW,
        }
    }

    /// Where the eye is.
    pub fn eye(&self) -> Point3<f64> {
        let (sin, cos) = self.azimuth.sin_cos();
        let (up, out) = self.elevation.clamp(-MAX_ELEVATION, MAX_ELEVATION).sin_cos();
        self.target + self.distance * Vector3::new(out * cos, out * sin, up)
    }

    /// The viewpoint as a camera whose pictures have `size` (width, height) pixels.
    ///
    /// # Errors
    /// A distance or an angle of view that is not positive, an angle of view of 180 degrees or more, a size of zero, numbers
    /// that are not finite.
    pub fn camera(&self, size: (u32, u32)) -> Result<Camera> {
        if !(self.distance > 0.0 && self.distance.is_finite()) {
            return Err(Error::argument(format!(
                "viewpoint: expected an eye away from its target, found a distance of {} m",
                self.distance
            )));
        }
        Camera::look_at("viewpoint", size, self.field_of_view, self.eye(), self.target, Vector3::z())
    }

    /// This viewpoint turned around its target, by angles in radians counter-clockwise seen from above, and upwards.
    pub fn turned(self, azimuth: f64, elevation: f64) -> Self {
        let elevation = (self.elevation + elevation).clamp(-MAX_ELEVATION, MAX_ELEVATION);
        Self { azimuth: self.azimuth + azimuth, elevation, ..self }
    }

    /// This viewpoint with its eye `factor` times as far from the target, at least 5 cm.
    pub fn zoomed(self, factor: f64) -> Self {
        Self { distance: (self.distance * factor).clamp(MIN_DISTANCE, MAX_DISTANCE), ..self }
    }

    /// This viewpoint moved to the right, upwards in the picture and forwards, in metres.
    pub fn moved(self, right: f64, up: f64, forward: f64) -> Self {
        let ahead = (self.target - self.eye()).normalize();
        let to_the_right = ahead.cross(&Vector3::z()).normalize();
        let upwards = to_the_right.cross(&ahead);
        Self { target: self.target + to_the_right * right + upwards * up + ahead * forward, ..self }
    }

    /// This viewpoint turned around its target to the azimuth that is nearest to that of `other`, by full turns.
    pub fn unwound_towards(self, other: &Self) -> Self {
        let turns = ((other.azimuth - self.azimuth) / std::f64::consts::TAU).round();
        Self { azimuth: self.azimuth + turns * std::f64::consts::TAU, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orbit() -> Orbit {
        Orbit {
            target: Point3::new(0.1, 0.2, 0.9),
            azimuth: 0.7,
            elevation: 0.3,
            distance: 3.0,
            field_of_view: 0.9,
        }
    }

    #[test]
    fn turning_and_zooming_keep_the_target_and_moving_keeps_the_direction() {
        let turned = orbit().turned(0.5, -0.1).zoomed(0.5);
        assert!(((turned.eye() - turned.target).norm() - 1.5).abs() < 1e-9);
        assert_eq!(turned.target, orbit().target);
        let moved = orbit().moved(0.3, -0.2, 0.4);
        let shift = moved.eye() - orbit().eye();
        assert!((shift.norm() - 0.29_f64.sqrt()).abs() < 1e-9);
        assert!((shift - (moved.target - orbit().target)).norm() < 1e-9);
    }

    #[test]
    fn the_eye_never_passes_over_the_top() {
        assert!(orbit().turned(0.0, 9.0).elevation < std::f64::consts::FRAC_PI_2);
        assert!(orbit().turned(0.0, 9.0).camera((64, 48)).is_ok());
    }
}
