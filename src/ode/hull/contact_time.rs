//! The time of a contact that has not begun, in the number of ODE's contact that tells a triangle for meshes.

use super::class;
use ode_sys::{dContactGeom, dGeomID};

/// The number of a contact that touches now, as of ODE's own classes without triangles.
pub(super) const TOUCHES: i32 = -1;

/// In which part of a second times are counted: 31 bits hold two seconds.
const NANOSECOND: f64 = 1e-9;

/// The number that stands for a contact in `seconds`.
pub(super) fn side_of(seconds: f64) -> i32 {
    (seconds / NANOSECOND).round() as i32
}

/// Seconds until two geoms touch, by their contact; 0 where they do, and where none of them is a hull.
pub(crate) fn contact_seconds(contact: &dContactGeom) -> f64 {
    seconds_by([contact.g1, contact.g2], [contact.side1, contact.side2]).unwrap_or(0.0)
}

/// The seconds of a contact, by the side of the geom that is a hull; `None` where none is.
fn seconds_by(geoms: [dGeomID; 2], sides: [i32; 2]) -> Option<f64> {
    let hull = geoms.into_iter().position(|geom| class::find_current(geom).is_some())?;
    Some(if sides[hull] < 0 { 0.0 } else { f64::from(sides[hull]) * NANOSECOND })
}
