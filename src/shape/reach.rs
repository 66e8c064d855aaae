//! How large shapes may be.

use crate::{Error, Result};
use nalgebra::Point3;

/// The largest coordinate, offset and size of a shape, and of everything in a world of ODE, in metres: 10 000 km.
///
/// ODE's hash space numbers its cells with 32-bit integers and aborts the process when they overflow. A body that
/// flies or falls beyond this limit is stopped by the step in which it does.
pub const REACH: f64 = 1e7;

/// The smallest size of a shape, in metres: a micrometre. ODE's colliders divide by squares of sizes, and abort the process
/// or never return for much smaller ones.
pub const MIN_SIZE: f64 = 1e-6;

/// The largest ratio of the longest to the shortest size of one shape, for the same reason.
#[cfg(feature = "ode")]
pub(crate) const MAX_ASPECT: f64 = 1e7;

/// Accepts a point whose coordinates are each within [`REACH`].
pub(crate) fn check_point(name: &str, value: &Point3<f64>) -> Result<()> {
    if value.iter().all(|x| x.abs() <= REACH) {
        Ok(())
    } else {
        let [x, y, z] = [value.x, value.y, value.z];
        Err(Error::argument(format!(
            "{name}: expected finite coordinates of at most {REACH} m, found ({x}, {y}, {z})"
        )))
    }
}
