//! The JSON of CMU's Panoptic Studio (<http://domedb.perception.cs.cmu.edu>, `calibration_<sequence>.json`).
//!
//! ```json
//! {"cameras": [{"name": "00_00", "resolution": [1920, 1080],
//!   "K": [[1633.3, 0, 942.3], [0, 1628.8, 557.5], [0, 0, 1]], "distCoef": [-0.2, 0.2, 0, 0, 0.06],
//!   "R": [[0.9, 0, 0.3], [0, 1, 0], [-0.3, 0, 0.9]], "t": [[-50.1], [143.9], [270.4]]}]}
//! ```
//!
//! World to camera, OpenCV's axes and coefficients (k1 k2 p1 p2 k3), centimetres, pixel centres at whole numbers (as
//! the studio's own tools draw). The y axis of its worlds points down.

use super::calibration::{Contents, Format, Found, Hints, PixelCentres};
use super::json::Field;
use super::source::Source;
use super::{lines, pose};
use crate::Result;
use crate::camera::Distortion;
use nalgebra::{Matrix3, Vector3};

pub(super) const FORMAT: Format = Format { name: "Panoptic's JSON", recognise, read };

const CAMERA: &str = "write name, resolution, K, distCoef, R and t for each camera";
const CENTIMETRE: f64 = 0.01;

fn recognise(source: &Source) -> bool {
    let text = source.text().unwrap_or_default();
    let has = |key: &str| text.contains(&format!("\"{key}\""));
    text.trim_start_matches('\u{feff}').trim_start().starts_with('{')
        && has("cameras")
        && (has("distCoef") || has("K") && has("R") && has("t"))
}

fn read(source: &Source, _: &Hints) -> Result<Contents> {
    let document = Field::document(source.text().unwrap_or_default())?;
    let cameras = document.object()?.get("cameras", CAMERA)?.items()?;
    let found: Vec<_> = cameras.iter().map(camera).collect::<Result<_>>()?;
    lines::distinct(found.iter().map(|found| found.name.as_str()), |i| cameras[i].line())?;
    Ok(Contents {
        cameras: found,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(CENTIMETRE),
        notes: vec![
            "lengths are taken as centimetres".into(),
            "the y axis of the Panoptic Studio's worlds points down: gravity is along +y".into(),
        ],
    })
}

fn camera(camera: &Field) -> Result<Found> {
    let camera = camera.object()?;
    let get = |key| camera.get(key, CAMERA);
    let size = camera.find("resolution").map(|size| {
        let sides = size.items()?;
        match &sides[..] {
            [width, height] => Ok((width.pixels()?, height.pixels()?)),
            _ => {
                Err(size.fail(format!("expected [width, height], found {} values; write both", sides.len())))
            }
        }
    });
    let coefficients = match camera.find("distCoef") {
        Some(field) => field.numbers::<5>("write k1 k2 p1 p2 k3")?,
        None => [0.0; 5],
    };
    let rotation = get("R")?;
    let matrix = Matrix3::from_row_slice(&rotation.numbers::<9>(CAMERA)?);
    Ok(Found {
        name: get("name")?.string()?,
        size: size.transpose()?,
        k: Matrix3::from_row_slice(&get("K")?.numbers::<9>(CAMERA)?),
        distortion: Distortion::from_opencv(&coefficients)?,
        rotation: pose::rotation(&matrix)
            .map_err(|problem| rotation.fail(format!("{problem}; calibrate again")))?,
        translation: Vector3::from(get("t")?.numbers::<3>(CAMERA)?),
    })
}

#[cfg(test)]
mod tests;
