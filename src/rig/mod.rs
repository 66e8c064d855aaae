//! A set of calibrated cameras that look at one subject, and the files it is read from.
//!
//! Every file format has a small file of its own here and ends in the same [`Rig`]: metres, world to camera, pixel
//! corners at whole numbers. Print [`Rig::describe`] after reading: most calibrations that "do not work" are in
//! another frame or unit, and that shows in where the cameras stand and look.

mod calibration;
mod colmap;
mod coverage;
mod document;
mod easymocap;
mod format;
mod image_names;
mod kalibr;
mod length;
mod lines;
mod matrices;
mod middlebury;
mod nerfstudio;
mod opencv;
mod panoptic;
mod pixels;
mod pose;
mod pose_convention;
mod projections;
mod qualisys;
mod ros;
mod selfcal;
mod source;
#[cfg(test)]
mod testing;
mod toml;
mod voxelpose;

pub use calibration::Calibration;
pub use format::Hints;
pub use pose_convention::PoseConvention;

use crate::camera::Camera;
use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

/// An ordered set of cameras with unique names; never empty.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    cameras: Vec<Camera>,
}

#[expect(clippy::len_without_is_empty, reason = "a rig has at least one camera")]
impl Rig {
    /// A rig of `cameras`, in this order.
    ///
    /// # Errors
    /// No cameras, a camera without a name, two cameras of the same name.
    pub fn new(cameras: Vec<Camera>) -> Result<Self> {
        if cameras.is_empty() {
            return Err(Error::argument(
                "expected at least one camera, found none; add the cameras of the rig",
            ));
        }

        // Errors name a camera by its name, so names must exist and be unique.
        let mut positions = HashMap::new();
        for (i, camera) in cameras.iter().enumerate() {
            let name = camera.name();
            if name.is_empty() {
                return Err(Error::camera(
                    name,
                    format!("expected a name for camera {i}, found an empty one"),
                ));
            }
            if let Some(first) = positions.insert(name, i) {
                let problem =
                    format!("expected unique names, found this one at positions {first} and {i}; rename one");
                return Err(Error::camera(name, problem));
            }
        }

        Ok(Self { cameras })
    }

    /// Reads a calibration file or folder of any format that [`Calibration::load`] knows, without hints and without
    /// keeping the notes.
    ///
    /// # Errors
    /// All errors of [`Calibration::load`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        Ok(Calibration::load(path, &Hints::default())?.rig)
    }

    /// The cameras, in order.
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// The number of cameras, at least one.
    pub fn len(&self) -> usize {
        self.cameras.len()
    }

    /// The position of the camera called `name`.
    pub fn index_of(&self, name: &str) -> Option<usize> {
        self.cameras.iter().position(|camera| camera.name() == name)
    }

    /// This rig in another world frame: `world_from_old` maps coordinates of the present world to the new one.
    ///
    /// # Errors
    /// A motion that is not finite.
    pub fn transformed(&self, world_from_old: &Isometry3<f64>) -> Result<Self> {
        let old_from_world = world_from_old.inverse();
        let moved = |camera: &Camera| {
            let cam_from_world = camera.cam_from_world() * old_from_world;
            Camera::new(camera.name(), camera.size(), *camera.intrinsics(), *camera.lens(), cam_from_world)
        };

        Ok(Self { cameras: self.cameras.iter().map(moved).collect::<Result<_>>()? })
    }

    /// One line per camera: where it stands (metres), where it looks (unit vector), how wide it sees (degrees,
    /// along the image's middle row) and where the world's origin appears (pixels).
    pub fn describe(&self) -> String {
        let width = self.cameras.iter().map(|c| c.name().chars().count()).max().unwrap_or(0);

        let mut text = String::new();
        for camera in &self.cameras {
            let (w, h) = camera.size();
            let _ = writeln!(
                text,
                "{:width$}  {w} x {h}  at {} m  looks {}  {}  {}",
                camera.name(),
                triple(camera.centre().coords, 3),
                triple(camera.forward(), 2),
                field_of_view(camera),
                origin(camera),
            );
        }
        text
    }
}

/// `(x, y, z)` with the given number of decimals, and no minus sign before a zero.
fn triple(v: Vector3<f64>, decimals: i32) -> String {
    let unit = 10_f64.powi(decimals);
    let [x, y, z]: [f64; 3] = v.map(|x| (x * unit).round() / unit + 0.0).into();
    let decimals = decimals as usize;
    format!("({x:.decimals$}, {y:.decimals$}, {z:.decimals$})")
}

/// The horizontal angle between the rays through the left and right end of the middle row, as text.
fn field_of_view(camera: &Camera) -> String {
    let (width, middle) = (f64::from(camera.size().0), f64::from(camera.size().1) / 2.0);
    match (camera.ray(0.0, middle), camera.ray(width, middle)) {
        (Some(left), Some(right)) => {
            format!("sees {:.1} deg", left.direction.angle(&right.direction).to_degrees())
        }
        _ => "sees less than its image (the lens model folds back inside it)".into(),
    }
}

/// Where the world's origin appears in the image, as text.
fn origin(camera: &Camera) -> String {
    let depth = (camera.cam_from_world() * Point3::origin()).z;
    match camera.project(&Point3::origin()) {
        Some(p) => {
            let (w, h) = (f64::from(camera.size().0), f64::from(camera.size().1));
            let inside = (0.0..w).contains(&p.u) && (0.0..h).contains(&p.v);
            let place = if inside { "" } else { ", outside its image" };
            format!("origin at ({:.1}, {:.1}) px{place}", p.u, p.v)
        }
        None if depth <= crate::camera::MIN_DEPTH => "origin behind it".into(),
        None => "origin beyond its lens model".into(),
    }
}

#[cfg(test)]
mod tests;
