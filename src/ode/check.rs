//! Checks of arguments before they reach ODE, which aborts the process on many invalid ones.
//!
//! Each function takes the argument's name for the error message.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};

use crate::{Error, Result};

pub(super) use crate::shape::check_point as point;
pub use crate::shape::{MIN_SIZE, REACH};

/// Larger numbers are refused as if they were infinite, because their squares and products in ODE would overflow.
const LARGEST: f64 = 1e30;

/// Accepts a finite number.
pub(super) fn finite(name: &str, value: f64) -> Result<f64> {
    if value.abs() <= LARGEST {
        Ok(value)
    } else {
        Err(Error::argument(format!("{name}: expected a finite number, found {value}")))
    }
}

/// Accepts a number in `low..=high`.
pub(super) fn within(name: &str, value: f64, low: f64, high: f64) -> Result<f64> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(Error::argument(format!("{name}: expected a number from {low} to {high}, found {value}")))
    }
}

/// Accepts a finite number above zero.
pub(super) fn positive(name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value <= LARGEST {
        Ok(value)
    } else {
        Err(Error::argument(format!("{name}: expected a positive, finite number, found {value}")))
    }
}

/// Accepts a finite number, zero or above.
pub(super) fn not_negative(name: &str, value: f64) -> Result<f64> {
    if (0.0..=LARGEST).contains(&value) {
        Ok(value)
    } else {
        Err(Error::argument(format!("{name}: expected a finite number, 0 or more, found {value}")))
    }
}

/// Accepts a finite number, zero or above, or positive infinity.
pub(super) fn not_negative_or_infinite(name: &str, value: f64) -> Result<f64> {
    if value == f64::INFINITY { Ok(value) } else { not_negative(name, value) }
}

/// Accepts a length from [`MIN_SIZE`] to [`REACH`], in metres.
pub(super) fn length(name: &str, value: f64) -> Result<f64> {
    if (MIN_SIZE..=REACH).contains(&value) {
        Ok(value)
    } else {
        Err(Error::argument(format!(
            "{name}: expected a length from {MIN_SIZE:e} to {REACH:e} m, found {value}"
        )))
    }
}

/// Accepts a vector of three finite numbers.
pub(super) fn vector(name: &str, value: &Vector3<f64>) -> Result<()> {
    if value.iter().all(|x| x.abs() <= LARGEST) {
        Ok(())
    } else {
        let [x, y, z] = [value.x, value.y, value.z];
        Err(Error::argument(format!("{name}: expected three finite numbers, found ({x}, {y}, {z})")))
    }
}

/// Accepts a finite vector that is not zero, and returns it normalised.
pub(super) fn direction(name: &str, value: &Vector3<f64>) -> Result<Unit<Vector3<f64>>> {
    vector(name, value)?;
    Unit::try_new(*value, 1e-12)
        .ok_or_else(|| Error::argument(format!("{name}: expected a direction, found a vector of length 0")))
}

/// Accepts a pose with coordinates within [`REACH`] and a unit quaternion.
pub(super) fn pose(name: &str, value: &Isometry3<f64>) -> Result<()> {
    point(name, &value.translation.vector.into())?;
    rotation(name, &value.rotation)
}

/// Accepts a unit quaternion.
pub(super) fn rotation(name: &str, value: &UnitQuaternion<f64>) -> Result<()> {
    let norm = value.as_ref().norm();
    if (norm - 1.0).abs() <= 1e-6 {
        Ok(())
    } else {
        Err(Error::argument(format!("{name}: expected a unit quaternion as rotation, found length {norm}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        for bad in BAD {
            assert!(finite("x", bad).is_err());
            assert!(within("x", bad, 0.0, 1.0).is_err());
            assert!(positive("x", bad).is_err());
            assert!(not_negative("x", bad).is_err());
            assert!(length("x", bad).is_err());
            assert!(vector("x", &Vector3::new(0.0, bad, 0.0)).is_err());
            assert!(point("x", &Point3::new(0.0, 0.0, bad)).is_err());
            assert!(direction("x", &Vector3::new(bad, 1.0, 0.0)).is_err());
            assert!(pose("x", &Isometry3::translation(bad, 0.0, 0.0)).is_err());
        }
        assert!(not_negative_or_infinite("x", f64::NAN).is_err());
    }

    #[test]
    fn a_message_names_the_argument_and_what_was_found() {
        let message = positive("radius", -2.0).unwrap_err().to_string();
        assert_eq!(message, "radius: expected a positive, finite number, found -2");
    }

    #[test]
    fn a_quaternion_of_length_zero_is_refused() {
        let broken = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(0.0, 0.0, 0.0, 0.0));
        assert!(pose("pose", &Isometry3::from_parts(Default::default(), broken)).is_err());
    }

    #[test]
    fn a_direction_comes_back_normalised() {
        let up = direction("axis", &Vector3::new(0.0, 0.0, 5.0)).unwrap();
        assert_eq!(up.into_inner(), Vector3::z());
        assert!(direction("axis", &Vector3::zeros()).is_err());
    }
}
