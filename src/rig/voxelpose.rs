//! The JSON in which VoxelPose (Tu, Wang, Zeng 2020) and its successors carry the Campus and Shelf cameras.
//!
//! ```json
//! {"0": {"R": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "T": [[1774.9], [-5051.7], [1923.4]],
//!        "fx": 438.0, "fy": 438.0, "cx": 185.4, "cy": 139.3, "k": [[0], [0], [0]], "p": [[0], [0]]}}
//! ```
//!
//! An entry for each camera, its key the name. `T` is where the camera stands, so that `x_cam = R (X - T)`; OpenCV's
//! axes and coefficients (k1 k2 k3, p1 p2), millimetres, pixel centres at whole numbers. Sizes are not in it: Campus
//! has 360 x 288 pixels, Shelf 1032 x 776.

use super::calibration::{Contents, Format, Found, Hints, PixelCentres};
use super::json::Field;
use super::pose;
use super::source::Source;
use crate::Result;
use crate::camera::Distortion;
use nalgebra::{Matrix3, Vector3};

pub(super) const FORMAT: Format = Format { name: "VoxelPose's JSON", recognise, read };

const CAMERA: &str = "write R, T, fx, fy, cx, cy, k and p for each camera";
const MILLIMETRE: f64 = 0.001;

fn recognise(source: &Source) -> bool {
    let text = source.text().unwrap_or_default();
    text.trim_start_matches('\u{feff}').trim_start().starts_with('{')
        && ["\"R\"", "\"T\"", "\"fx\""].iter().all(|key| text.contains(key))
}

fn read(source: &Source, _: &Hints) -> Result<Contents> {
    let cameras = Field::document(source.text().unwrap_or_default())?.object()?;
    Ok(Contents {
        cameras: cameras
            .fields
            .into_iter()
            .map(|(name, field)| camera(name, &field))
            .collect::<Result<_>>()?,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(MILLIMETRE),
        notes: vec!["lengths are taken as millimetres, T as where the camera stands".into()],
    })
}

fn camera(name: String, camera: &Field) -> Result<Found> {
    let camera = camera.object()?;
    let get = |key| camera.get(key, CAMERA);
    let number = |key| get(key)?.number();
    let [k1, k2, k3] = camera.find("k").map_or(Ok([0.0; 3]), |k| k.numbers("write k1 k2 k3"))?;
    let [p1, p2] = camera.find("p").map_or(Ok([0.0; 2]), |p| p.numbers("write p1 p2"))?;
    let rotation = get("R")?;
    let matrix = Matrix3::from_row_slice(&rotation.numbers::<9>(CAMERA)?);
    let rotation =
        pose::rotation(&matrix).map_err(|problem| rotation.fail(format!("{problem}; calibrate again")))?;
    let centre = Vector3::from(get("T")?.numbers::<3>(CAMERA)?);
    Ok(Found {
        name,
        size: None,
        k: Matrix3::new(number("fx")?, 0.0, number("cx")?, 0.0, number("fy")?, number("cy")?, 0.0, 0.0, 1.0),
        distortion: Distortion::from_opencv(&[k1, k2, p1, p2, k3])?,
        rotation,
        translation: -(rotation * centre),
    })
}

#[cfg(test)]
mod tests;
