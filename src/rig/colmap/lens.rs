//! The camera models of COLMAP, as far as they are OpenCV's.

use super::super::format::{LensModel, RawLens};
use super::super::lines::Line;
use super::Intrinsics;
use crate::Result;
use nalgebra::Matrix3;

const CAMERA: &str = "write CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]";

/// A camera model and the order of its parameters: one or two focal lengths, the principal point, then the
/// coefficients in the order of OpenCV's lens model.
struct Model {
    name: &'static str,
    focal_lengths: usize,
    coefficients: usize,
    lens: LensModel,
}

const MODELS: [Model; 9] = [
    Model { name: "SIMPLE_PINHOLE", focal_lengths: 1, coefficients: 0, lens: LensModel::OpenCv },
    Model { name: "PINHOLE", focal_lengths: 2, coefficients: 0, lens: LensModel::OpenCv },
    Model { name: "SIMPLE_RADIAL", focal_lengths: 1, coefficients: 1, lens: LensModel::OpenCv },
    Model { name: "RADIAL", focal_lengths: 1, coefficients: 2, lens: LensModel::OpenCv },
    Model { name: "OPENCV", focal_lengths: 2, coefficients: 4, lens: LensModel::OpenCv },
    Model { name: "FULL_OPENCV", focal_lengths: 2, coefficients: 8, lens: LensModel::OpenCv },
    Model { name: "SIMPLE_RADIAL_FISHEYE", focal_lengths: 1, coefficients: 1, lens: LensModel::Fisheye },
    Model { name: "RADIAL_FISHEYE", focal_lengths: 1, coefficients: 2, lens: LensModel::Fisheye },
    Model { name: "OPENCV_FISHEYE", focal_lengths: 2, coefficients: 4, lens: LensModel::Fisheye },
];

/// Whether a line has the form of a camera: a number, then a model's name.
pub(super) fn is_camera(line: &Line) -> bool {
    let named = |name: &str| {
        name.contains(|c: char| c.is_ascii_uppercase())
            && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
    };
    line.words.len() > 3 && line.words[0].parse::<u32>().is_ok() && named(line.words[1])
}

/// Reads one line of `cameras.txt`.
pub(super) fn read(line: &Line) -> Result<Intrinsics> {
    let Some(name) = line.words.get(1) else {
        return Err(line.fail(format!("expected a camera, found one word; {CAMERA}")));
    };

    let Some(model) = MODELS.iter().find(|model| model.name == *name) else {
        let known = MODELS.map(|model| model.name).join(", ");
        return Err(line.fail(format!(
            "expected one of the camera models {known}, found {name}; undistort the images (colmap \
             image_undistorter) and use the model that it writes"
        )));
    };

    let size = line.size(2)?;
    let parameters = line.words.get(4..).unwrap_or_default();
    let expected = model.focal_lengths + 2 + model.coefficients;
    if parameters.len() != expected {
        let found = parameters.len();
        return Err(line.fail(format!("expected {expected} parameters of {name}, found {found}; {CAMERA}")));
    }

    let numbers = parameters.iter().map(|word| line.number_in(word, CAMERA)).collect::<Result<Vec<_>>>()?;
    let (focal_lengths, rest) = numbers.split_at(model.focal_lengths);
    let (fx, fy) = (focal_lengths[0], focal_lengths[model.focal_lengths - 1]);

    let mut coefficients = rest[2..].to_vec();
    // Radial models have only the first one or two of OpenCV's coefficients.
    coefficients.resize(if model.coefficients > 4 { 8 } else { 4 }, 0.0);

    let lens = RawLens::new(model.lens, &coefficients, format!("line {}", line.number));
    Ok(Intrinsics {
        size,
        k: Matrix3::new(fx, 0.0, rest[0], 0.0, fy, rest[1], 0.0, 0.0, 1.0),
        lens: lens.map_err(|e| line.fail(e))?,
    })
}
