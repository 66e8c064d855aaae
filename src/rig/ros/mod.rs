//! ROS camera files with poses.
//!
//! `camera_info`, as ROS's `camera_calibration` writes it (or a message as `rostopic echo` prints it, with `K`, `D`,
//! `width` and `height`):
//!
//! ```yaml
//! image_width: 640
//! image_height: 480
//! camera_name: left
//! camera_matrix: { rows: 3, cols: 3, data: [500, 0, 319.5, 0, 500, 239.5, 0, 0, 1] }
//! distortion_model: plumb_bob                # or rational_polynomial, or equidistant: k1 k2 k3 k4 of a fisheye
//! distortion_coefficients: { rows: 1, cols: 5, data: [-0.1, 0.01, 0, 0, 0] }
//! ```
//!
//! ROS keeps poses as transforms, not in files. They are read from `<file's stem>_pose.yaml`, or by camera from
//! `poses.yaml` beside it, as tf2 and geometry_msgs print them, possibly under `transform` (or as a `pose`, with
//! `position` and `orientation`):
//!
//! ```yaml
//! left:
//!   translation: { x: 0.0, y: 1.0, z: 2.0 }
//!   rotation: { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
//! ```
//!
//! This is the pose *of the camera's optical frame in the world*, `world_from_cam`, as `tf2_echo world
//! left_optical_frame` prints it: metres, and axes x right, y down, z forward. (A frame `left_link` has x forward and
//! differs.) A file is a camera, a folder of such files is a rig; a camera is called `camera_name`, or else like its
//! file. Pixel *centres* are whole numbers. `rectification_matrix` and `projection_matrix` are ignored: images are
//! taken as they come from the camera. Source: the documentation of sensor_msgs/CameraInfo, REP 103 and REP 104.

mod pose;

use super::document::{self, Node};
use super::format::{Format, Hints, LensModel, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::source::{self, Source};
use crate::{Error, Result};
use std::path::{Path, PathBuf};

pub(super) const FORMAT: Format = Format {
    name: "ROS camera_info",
    recognise: |source| source.text().map_or_else(|| !files(source).is_empty(), recognise),
    read,
};

/// Whether a text is a `camera_info`. The files of OpenCV's calibration sample have the same keys, but OpenCV's tags.
fn recognise(text: &str) -> bool {
    let has =
        |key: &str| text.lines().any(|line| line.split_once(':').is_some_and(|(found, _)| found == key));
    !text.contains("opencv-matrix") && !text.starts_with("%YAML") && has("distortion_model")
        || has("camera_name") && has("camera_matrix")
}

fn read(source: &Source, _: &Hints) -> Result<RawCalibration> {
    let cameras = match source.text() {
        Some(text) => vec![camera(source, &source.path, text).map_err(|e| at(&source.path, e))?],
        None => {
            let of_file = |path: &PathBuf| {
                source::read(path).and_then(|text| camera(source, path, &text)).map_err(|e| at(path, e))
            };
            files(source).iter().map(of_file).collect::<Result<_>>()?
        }
    };
    Ok(RawCalibration {
        cameras,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(1.0),
        notes: Vec::new(),
    })
}

/// The folder's files that are a `camera_info`.
fn files(folder: &Source) -> Vec<PathBuf> {
    let is_yaml = |path: &Path| path.extension().is_some_and(|end| end == "yaml" || end == "yml");
    let is_one = |path: &&PathBuf| is_yaml(path) && source::read(path).is_ok_and(|text| recognise(&text));
    folder.files().iter().filter(is_one).cloned().collect()
}

/// Adds the path to an error that names no file yet.
fn at(path: &Path, error: Error) -> Error {
    match error {
        Error::File { .. } => error,
        other => Error::file(path, other),
    }
}

/// The camera in the file at `path`, which is the opened file or lies in the opened folder.
fn camera(source: &Source, path: &Path, text: &str) -> Result<RawCamera> {
    let document = document::parse(text)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = match document.entry("camera_name") {
        Some(entry) => entry.text()?.to_owned(),
        None => stem.clone().into_owned(),
    };

    let fail = |e| match e {
        Error::File { .. } => e,
        other => Error::camera(&name, other),
    };

    let size = size(&document).map_err(fail)?;
    let matrix = first_of(&document, &["camera_matrix", "K", "k"], "give fx 0 cx 0 fy cy 0 0 1 in pixels")
        .map_err(fail)?;
    let k = matrix.matrix3().map_err(fail)?;
    let lens = lens(&document).map_err(fail)?.in_file(path);
    let (rotation, translation) = pose::of(source, &stem, &name).map_err(fail)?;
    Ok(RawCamera { name, size: Some(size), k, lens, rotation, translation })
}

fn size(document: &Node) -> Result<(u32, u32)> {
    let side = |keys| first_of(document, keys, "give the image's size in pixels")?.pixels();
    Ok((side(&["image_width", "width"])?, side(&["image_height", "height"])?))
}

/// The lens by its model and coefficients.
fn lens(document: &Node) -> Result<RawLens> {
    let entry = document.entry("distortion_model");
    let model = match entry.as_ref().map_or("", |entry| entry.text().unwrap_or_default()) {
        // ROS writes an empty model for a lens without distortion.
        "" | "plumb_bob" | "rational_polynomial" => LensModel::OpenCv,
        "equidistant" => LensModel::Fisheye,
        other => {
            let problem = format!(
                "expected plumb_bob, rational_polynomial or equidistant, found \"{other}\", which is not supported \
                 yet; undistort the images first and calibrate them with one of these"
            );
            return Err(entry.map_or(Error::argument(&problem), |entry| entry.fail(&problem)));
        }
    };
    first_of(document, &["distortion_coefficients", "D", "d"], "give k1 k2 p1 p2 k3, or [] for none")?
        .lens(model)
}

/// The first of `keys` that exists; else an error that asks for the first one.
fn first_of<'a>(document: &'a Node, keys: &[&str], next_step: &str) -> Result<document::Entry<'a>> {
    let found = keys.iter().find_map(|key| document.entry(key));
    found.map_or_else(|| document.require(keys[0], next_step), Ok)
}

#[cfg(test)]
pub(super) mod tests;
