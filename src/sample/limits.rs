//! Limits on sizes and densities, and the errors about them.

use crate::{Error, Result};
use nalgebra::Point3;

/// The largest number of samples of one body.
pub const MAX_SAMPLES: usize = 1_000_000;

/// The spacing in metres of a square grid with the covering radius `min_feature / 2`, after checking `min_feature`.
pub(super) fn spacing(min_feature: f64) -> Result<f64> {
    positive("min_feature", min_feature)?;
    Ok(min_feature / std::f64::consts::SQRT_2)
}

/// Checks that a length is finite and above zero.
pub(super) fn positive(what: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(Error::argument(format!("{what} is {value}: give a finite length above 0, in metres")))
}

/// Checks that every coordinate is finite.
pub(super) fn finite<'a>(what: &str, points: impl IntoIterator<Item = &'a Point3<f64>>) -> Result<()> {
    for (index, point) in points.into_iter().enumerate() {
        if !point.iter().all(|x| x.is_finite()) {
            let Point3 { coords } = point;
            return Err(Error::argument(format!(
                "{what} {index} is ({}, {}, {}): give finite coordinates, in metres",
                coords.x, coords.y, coords.z
            )));
        }
    }
    Ok(())
}

/// Refuses a body of more than [`MAX_SAMPLES`] samples. `body` names the shape and its size.
pub(super) fn check_count(body: &str, count: f64, min_feature: f64) -> Result<()> {
    if count <= MAX_SAMPLES as f64 {
        return Ok(());
    }
    Err(Error::argument(format!(
        "{body} would need about {count:.0} samples at min_feature {min_feature} m, at most {MAX_SAMPLES} are \
         allowed: raise min_feature"
    )))
}

/// The number of cells of at most `spacing` that divide `length`, at least `fewest`. It is a float, so that nothing
/// overflows before the count is checked.
pub(super) fn cells(length: f64, spacing: f64, fewest: f64) -> f64 {
    (length / spacing).ceil().max(fewest)
}
