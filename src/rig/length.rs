//! The unit of length in formats that name none.

use super::format::{Hints, RawCamera};
use crate::{Error, MissingHint, Result};

/// A camera farther than this from the world's origin, in metres, suggests another unit.
pub(super) const FARTHEST: f64 = 100.0;

/// The note that accompanies [`as_metres`].
pub(super) const NOTE: &str = "the file names no unit of length; it is taken as metres";

/// Refuses cameras whose positions cannot be metres, unless the caller has given the unit; otherwise returns the notes
/// about the assumed unit.
///
/// # Errors
/// A camera more than 100 units from the origin.
pub(super) fn as_metres(cameras: &[RawCamera], hints: &Hints) -> Result<Vec<String>> {
    if hints.metres_per_unit.is_some() {
        return Ok(Vec::new());
    }

    let far = cameras.iter().find(|camera| camera.translation.norm() > FARTHEST);
    match far {
        Some(camera) => {
            let problem = format!(
                "expected lengths in metres, found a camera {:.1} units from the world's origin in a file that names \
                 no unit; give the metres per unit, 0.001 if these are millimetres",
                camera.translation.norm()
            );
            Err(Error::missing_hint(MissingHint::MetresPerUnit, Error::camera(&camera.name, problem)))
        }
        None => Ok(vec![NOTE.into()]),
    }
}
