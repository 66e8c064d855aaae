//! The JSON in which VoxelPose (Tu, Wang, Zeng 2020) and its successors carry the Campus and Shelf cameras.
//!
//! ```json
//! {"0": {"R": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "T": [[1774.9], [-5051.7], [1923.4]],
//!        "fx": 438.0, "fy": 438.0, "cx": 185.4, "cy": 139.3, "k": [[0], [0], [0]], "p": [[0], [0]]}}
//! ```
//!
//! There is one entry per camera, its key the name. `T` is the camera's centre, so that `x_cam = R (X - T)`; OpenCV's
//! axes and coefficients (k1 k2 k3, p1 p2), millimetres, pixel centres at whole numbers. Image sizes are not in the
//! file: Campus has 360 x 288 pixels, Shelf 1032 x 776.

use super::document::{self, Entry};
use super::format::{Format, Hints, PixelCentres, RawCalibration, RawCamera};
use super::source::Source;
use crate::Result;
use crate::camera::Distortion;
use nalgebra::Matrix3;

pub(super) const FORMAT: Format = Format { name: "VoxelPose's JSON", recognise, read };

const CAMERA: &str = "write R, T, fx, fy, cx, cy, k and p for each camera";
const MILLIMETRE: f64 = 0.001;

fn recognise(source: &Source) -> bool {
    source.json().is_some_and(|text| ["\"R\"", "\"T\"", "\"fx\""].iter().all(|key| text.contains(key)))
}

fn read(source: &Source, _: &Hints) -> Result<RawCalibration> {
    let document = document::parse(source.text().unwrap_or_default())?;
    Ok(RawCalibration {
        cameras: document.entries().map(|entry| camera(&entry)).collect::<Result<_>>()?,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(MILLIMETRE),
        notes: vec!["lengths are taken as millimetres, T as where the camera stands".into()],
    })
}

fn camera(camera: &Entry) -> Result<RawCamera> {
    let get = |key| camera.require(key, CAMERA);
    let number = |key| get(key)?.number();
    let [k1, k2, k3] = camera.entry("k").map_or(Ok([0.0; 3]), |entry| entry.array())?;
    let [p1, p2] = camera.entry("p").map_or(Ok([0.0; 2]), |entry| entry.array())?;
    let rotation = get("R")?.rotation()?;
    let centre = get("T")?.vector3()?;

    Ok(RawCamera {
        name: camera.key.to_string(),
        size: None,
        k: Matrix3::new(number("fx")?, 0.0, number("cx")?, 0.0, number("fy")?, number("cy")?, 0.0, 0.0, 1.0),
        lens: Distortion::from_opencv(&[k1, k2, p1, p2, k3])?.into(),
        rotation,
        translation: -(rotation * centre),
    })
}

#[cfg(test)]
pub(super) mod tests;
