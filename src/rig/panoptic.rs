//! The JSON of CMU's Panoptic Studio (<http://domedb.perception.cs.cmu.edu>, `calibration_<sequence>.json`).
//!
//! ```json
//! {"cameras": [{"name": "00_00", "resolution": [1920, 1080],
//!   "K": [[1633.3, 0, 942.3], [0, 1628.8, 557.5], [0, 0, 1]], "distCoef": [-0.2, 0.2, 0, 0, 0.06],
//!   "R": [[0.9, 0, 0.3], [0, 1, 0], [-0.3, 0, 0.9]], "t": [[-50.1], [143.9], [270.4]]}]}
//! ```
//!
//! The pose is world to camera with OpenCV's axes and coefficients (k1 k2 p1 p2 k3), in centimetres; pixel centres are
//! at whole numbers, as the studio's own tools draw. The y axis of its worlds points down.

use super::document::{self, Entry};
use super::format::{Format, Hints, LensModel, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::lines;
use super::source::Source;
use crate::Result;

pub(super) const FORMAT: Format = Format { name: "Panoptic's JSON", recognise, read };

const CAMERA: &str = "write name, resolution, K, distCoef, R and t for each camera";
const CENTIMETRE: f64 = 0.01;

fn recognise(source: &Source) -> bool {
    let has = |key: &str| source.json().is_some_and(|text| text.contains(&format!("\"{key}\"")));
    has("cameras") && (has("distCoef") || has("K") && has("R") && has("t"))
}

fn read(source: &Source, _: &Hints) -> Result<RawCalibration> {
    let document = document::parse(source.text().unwrap_or_default())?;
    let cameras = document.require("cameras", CAMERA)?.items()?;
    let found: Vec<_> = cameras.iter().map(camera).collect::<Result<_>>()?;
    lines::distinct(found.iter().map(|found| found.name.as_str()), |i| cameras[i].node.line)?;

    Ok(RawCalibration {
        cameras: found,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(CENTIMETRE),
        notes: vec![
            "lengths are taken as centimetres".into(),
            "the y axis of the Panoptic Studio's worlds points down: gravity is along +y".into(),
        ],
    })
}

fn camera(camera: &Entry) -> Result<RawCamera> {
    let get = |key| camera.require(key, CAMERA);
    let lens = camera.entry("distCoef").map(|entry| entry.lens(LensModel::OpenCv)).transpose()?;
    Ok(RawCamera {
        name: get("name")?.text()?.to_owned(),
        size: camera.entry("resolution").map(|entry| entry.size()).transpose()?,
        k: get("K")?.matrix3()?,
        lens: lens.unwrap_or_else(RawLens::none),
        rotation: get("R")?.rotation()?,
        translation: get("t")?.vector3()?,
    })
}

#[cfg(test)]
pub(super) mod tests;
