//! Kalibr's `camchain.yaml`.
//!
//! ```yaml
//! cam0:
//!   camera_model: pinhole
//!   intrinsics: [500.0, 500.0, 319.5, 239.5]         # fu fv pu pv, pixels
//!   distortion_model: radtan                         # or equidistant, none
//!   distortion_coeffs: [-0.1, 0.01, 0.0, 0.0]        # k1 k2 p1 p2; equidistant: k1 k2 k3 k4
//!   resolution: [640, 480]
//! cam1:
//!   T_cn_cnm1:                                       # from cam0's frame to cam1's, metres
//!   - [1.0, 0.0, 0.0, -0.2]
//!   ...
//! ```
//!
//! The file is a chain: each camera's pose is relative to the camera before it, and the world is the first camera's
//! frame, so that up is the direction of that camera's upper image edge. Axes x right, y down, z forward; pixel
//! *centres* are whole numbers, as in the corner finders that Kalibr builds on. `T_cam_imu` and other keys are
//! ignored. Source: Kalibr's wiki, "Yaml formats" and "Supported models".

use super::document::{self, Entry, Node};
use super::format::{Format, Hints, LensModel, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::source::Source;
use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3};

pub(super) const FORMAT: Format = Format {
    name: "Kalibr's camchain",
    recognise: |source| source.text().is_some_and(recognise),
    read: |source: &Source, _: &Hints| read(source.text().unwrap_or_default()),
};

const FIRST_FRAME: &str =
    "the world is the frame of the first camera, y down and z forward; turn it if z should be up";
const NO_CHAIN: &str =
    "the file holds one camera and no pose; it is put at the world's origin, y down and z forward";

fn recognise(text: &str) -> bool {
    text.contains("intrinsics")
        && text.lines().any(|line| number(line.trim_end().trim_end_matches(':')).is_some())
}

/// The number in a camera's key: `1` of `cam1`.
fn number(key: &str) -> Option<u32> {
    key.strip_prefix("cam")?.parse().ok()
}

fn read(text: &str) -> Result<RawCalibration> {
    let document = document::parse(text)?;
    let mut entries: Vec<_> =
        document.entries().filter_map(|entry| Some((number(&entry.key)?, entry))).collect();
    entries.sort_by_key(|(number, _)| *number);

    // Each pose is the product of the steps from the first camera on.
    let mut cam_from_world = Isometry3::identity();
    let mut cameras = Vec::new();
    for (i, (number, entry)) in entries.iter().enumerate() {
        let name = &entry.key;
        if i as u32 != *number {
            let problem =
                format!("expected the chain to go on with cam{i}, found {name}; put the camera between back");
            return Err(Error::camera(name, problem));
        }

        let fail = |e| Error::camera(name, e);
        if i > 0 {
            cam_from_world = step(entry.node).map_err(fail)? * cam_from_world;
        }
        cameras.push(camera(entry, &cam_from_world).map_err(fail)?);
    }

    let note = if cameras.len() == 1 { NO_CHAIN } else { FIRST_FRAME };
    Ok(RawCalibration {
        cameras,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(1.0),
        notes: vec![note.into()],
    })
}

/// The motion from the frame of the previous camera to this one's.
fn step(node: &Node) -> Result<Isometry3<f64>> {
    let next_step = "give the motion from the camera before, T_cn_cnm1, as Kalibr does with several cameras";
    let (rotation, translation) = node.require("T_cn_cnm1", next_step)?.motion()?;
    Ok(Isometry3::from_parts(translation.into(), rotation))
}

fn camera(entry: &Entry, cam_from_world: &Isometry3<f64>) -> Result<RawCamera> {
    let node = entry.node;
    let undistort = "undistort the images first, or calibrate with pinhole-radtan or pinhole-equi";
    if let Some(model) = node.entry("camera_model")
        && model.text()? != "pinhole"
    {
        let problem = "expected the camera model pinhole, found";
        return Err(
            model.fail(format!("{problem} {}, which is not supported yet; {undistort}", model.text()?))
        );
    }

    let coefficients = |next_step| node.require("distortion_coeffs", next_step);
    let lens = match node.entry("distortion_model") {
        Some(model) => match model.text()? {
            "radtan" => coefficients("give k1 k2 p1 p2")?.lens(LensModel::OpenCv)?,
            "equidistant" => coefficients("give k1 k2 k3 k4")?.lens(LensModel::Fisheye)?,
            "none" => RawLens::none(),
            other => {
                let problem = "expected the distortion model radtan, equidistant or none, found";
                return Err(model.fail(format!("{problem} {other}, which is not supported yet; {undistort}")));
            }
        },
        None => RawLens::none(),
    };

    let intrinsics = node.require("intrinsics", "give fu fv pu pv in pixels")?;
    let [fx, fy, cx, cy] = intrinsics.array()?;
    let size = node.entry("resolution").map(|entry| entry.size()).transpose()?;

    Ok(RawCamera {
        name: entry.key.to_string(),
        size,
        k: Matrix3::new(fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0),
        lens,
        rotation: cam_from_world.rotation,
        translation: cam_from_world.translation.vector,
    })
}

#[cfg(test)]
pub(super) mod tests;
