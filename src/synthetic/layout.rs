//! Where to put the cameras: rings, a hemisphere, and heights staggered through a lift.
//!
//! ```text
//!     ring                hemisphere             staggered
//!   c---c---c               c  c                    c        the top of what is lifted
//!    \  |  /              c      c              c             always lies at some
//!     \ | /              c   x    c                  x c      camera's height
//!       x                                      c
//! ```
//!
//! All cameras look at `target`, z up, have square pixels and no distortion, and are named `cam0`, `cam1`, ...
//! counter-clockwise as seen from above, from +x. Metres, radians, pixels.

use crate::camera::Camera;
use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// `n` cameras evenly around the vertical through `target`, `radius` metres from it, at the world height `height`.
///
/// # Errors
/// No camera, a radius that is not positive, and what [`Camera::look_at`] refuses.
pub fn ring(
    n: usize,
    radius: f64,
    height: f64,
    target: Point3<f64>,
    size: (u32, u32),
    horizontal_fov: f64,
) -> Result<Vec<Camera>> {
    staggered(n, radius, &[height], target, size, horizontal_fov)
}

/// `n` cameras evenly around the vertical through `target`, `radius` metres from it, at the world heights `heights`
/// in turn.
///
/// A camera at the height of a table's top looks along it, so that nothing can hide above it there. Heights spread
/// through a lift have such a camera near at every moment of it.
///
/// # Errors
/// No camera, no height, a radius that is not positive, and what [`Camera::look_at`] refuses.
pub fn staggered(
    n: usize,
    radius: f64,
    heights: &[f64],
    target: Point3<f64>,
    size: (u32, u32),
    horizontal_fov: f64,
) -> Result<Vec<Camera>> {
    check(n, radius)?;
    if heights.is_empty() {
        return Err(Error::argument("expected at least one camera height, found none"));
    }
    let eyes = (0..n).map(|i| {
        let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
        Point3::new(target.x + radius * cos, target.y + radius * sin, heights[i % heights.len()])
    });
    looking(eyes, target, size, horizontal_fov)
}

/// `n` cameras spread evenly over the upper half of the sphere of `radius` metres about `target`, the first ones lowest.
///
/// # Errors
/// No camera, a radius that is not positive, and what [`Camera::look_at`] refuses.
pub fn hemisphere(
    n: usize,
    radius: f64,
    target: Point3<f64>,
    size: (u32, u32),
    horizontal_fov: f64,
) -> Result<Vec<Camera>> {
    check(n, radius)?;
    // Equal steps in height cut a sphere into equal areas; the golden angle keeps neighbours apart.
    let golden = TAU * (1.0 - 2.0 / (1.0 + 5f64.sqrt()));
    let eyes = (0..n).map(|i| {
        let up = (i as f64 + 0.5) / n as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let out = (1.0 - up * up).sqrt();
        target + Vector3::new(out * cos, out * sin, up) * radius
    });
    looking(eyes, target, size, horizontal_fov)
}

/// Four cameras whose hull of a box *is* the box, its underside apart: each looks along the top and along one side.
///
/// The box has full side `lengths` and its centre at the origin of its frame, z up. Camera 0 stands before the +x
/// side in the planes of the top and of the +y side, the next ones a quarter turn on; all are `distance` metres from
/// the side that they face, look at the box's centre and are rolled about their axis by `roll` and its multiples, so
/// that the box's edges cross the pixels at a slant.
///
/// # Errors
/// A distance that is not positive, and what [`Camera::look_at`] refuses.
pub fn face_on(
    lengths: Vector3<f64>,
    world_from_box: &Isometry3<f64>,
    distance: f64,
    roll: f64,
    size: (u32, u32),
    horizontal_fov: f64,
) -> Result<Vec<Camera>> {
    check(4, distance)?;
    let half = lengths / 2.0;
    let camera = |k: usize| {
        let (reach, along) = if k.is_multiple_of(2) { (half.x, half.y) } else { (half.y, half.x) };
        let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), TAU / 4.0 * k as f64);
        let eye = world_from_box * (quarter * Point3::new(reach + distance, along, half.z));
        let target = world_from_box * Point3::origin();
        let axis = Unit::new_normalize(target - eye);
        let up =
            UnitQuaternion::from_axis_angle(&axis, roll * (k as f64 + 1.0)) * (world_from_box * Vector3::z());
        Camera::look_at(format!("cam{k}"), size, horizontal_fov, eye, target, up)
    };
    (0..4).map(camera).collect()
}

fn check(n: usize, radius: f64) -> Result<()> {
    if n == 0 {
        return Err(Error::argument("expected at least one camera, found 0"));
    }
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(Error::argument(format!("expected a positive radius in metres, found {radius}")));
    }
    Ok(())
}

fn looking(
    eyes: impl Iterator<Item = Point3<f64>>,
    target: Point3<f64>,
    size: (u32, u32),
    horizontal_fov: f64,
) -> Result<Vec<Camera>> {
    let camera =
        |(i, eye)| Camera::look_at(format!("cam{i}"), size, horizontal_fov, eye, target, Vector3::z());
    eyes.enumerate().map(camera).collect()
}
