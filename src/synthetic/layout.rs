//! Camera layouts: rings, a hemisphere, and heights staggered along a lift.
//!
//! ```text
//!     ring                hemisphere             staggered
//!   c---c---c               c  c                    c        the top of a lifted
//!    \  |  /              c      c              c             always lies at some
//!     \ | /              c   x    c                  x c      camera's height
//!       x                                      c
//! ```
//!
//! All cameras look at `target` with z up, have square pixels and no distortion, and are named `cam0`, `cam1`, ...
//! counter-clockwise as seen from above, starting at +x. Units are metres, radians and pixels.

use crate::camera::Camera;
use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// `n` cameras evenly spaced around the vertical axis through `target`, `radius` metres from it, at the world height
/// `height`.
///
/// # Errors
/// No camera, a radius that is not positive; all errors of [`Camera::look_at`].
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

/// `n` cameras evenly spaced around the vertical axis through `target`, `radius` metres from it, at the world heights
/// `heights` in turn.
///
/// A camera at the height of a table's top looks along it and shows the space above as empty. With heights spread
/// along a lift, such a camera is near at every moment.
///
/// # Errors
/// No camera, no height, a radius that is not positive; all errors of [`Camera::look_at`].
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

/// `n` cameras spread evenly over the upper half of the sphere of `radius` metres about `target`, starting at the
/// lowest.
///
/// # Errors
/// No camera, a radius that is not positive; all errors of [`Camera::look_at`].
pub fn hemisphere(
    n: usize,
    radius: f64,
    target: Point3<f64>,
    size: (u32, u32),
    horizontal_fov: f64,
) -> Result<Vec<Camera>> {
    check(n, radius)?;
    // Equal steps in height divide a sphere into equal areas; the golden angle keeps neighbours apart.
    let golden = TAU * (1.0 - 2.0 / (1.0 + 5f64.sqrt()));
    let eyes = (0..n).map(|i| {
        let up = (i as f64 + 0.5) / n as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let horizontal = (1.0 - up * up).sqrt();
        target + Vector3::new(horizontal * cos, horizontal * sin, up) * radius
    });
    looking(eyes, target, size, horizontal_fov)
}

/// Four cameras whose hull of a box *is* the box, except for its underside: each looks along the top and along one
/// side.
///
/// The box has full side `lengths` and its centre at the origin of its frame, z up. Camera 0 stands in front of the +x
/// side in the planes of the top and of the +y side, each next one a quarter turn further; all are `distance` metres
/// from the side that they face, look at the box's centre and are rolled about their axis by multiples of `roll`, so
/// that the box's edges cross the pixels obliquely.
///
/// # Errors
/// A distance that is not positive; all errors of [`Camera::look_at`].
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

/// Cameras at `eyes` that look at `target`.
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
