//! The common output of all readers: cameras as in the file, before units and pixel centres are converted to this
//! crate's.

use super::source::Source;
use crate::camera::{Distortion, Fisheye, Lens};
use crate::{Error, Result};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::path::{Path, PathBuf};

/// Information that a calibration file lacks, or gives in a unit of its own.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hints {
    /// Width and height of the images in pixels, for cameras whose size is not in the file.
    pub size: Option<(u32, u32)>,
    /// Metres per unit of length in the file; overrides the format's own unit.
    pub metres_per_unit: Option<f64>,
}

/// One calibration format.
pub(super) struct Format {
    /// The format's name, for messages.
    pub(super) name: &'static str,
    /// Whether the content looks like this format; cheap.
    pub(super) recognise: fn(&Source) -> bool,
    pub(super) read: fn(&Source, &Hints) -> Result<RawCalibration>,
}

/// The content of a calibration file.
pub(super) struct RawCalibration {
    pub(super) cameras: Vec<RawCamera>,
    pub(super) pixel_centres: PixelCentres,
    /// The format's unit of length; `None` where it is arbitrary, so that a hint has to give it.
    pub(super) metres_per_unit: Option<f64>,
    pub(super) notes: Vec<String>,
}

/// A camera as in the file.
pub(super) struct RawCamera {
    pub(super) name: String,
    /// Width and height in pixels, if the file has them.
    pub(super) size: Option<(u32, u32)>,
    pub(super) k: Matrix3<f64>,
    pub(super) lens: RawLens,
    /// The rotation from world to camera, with OpenCV's axes.
    pub(super) rotation: UnitQuaternion<f64>,
    /// The translation from world to camera, in the file's unit of length.
    pub(super) translation: Vector3<f64>,
}

/// A lens and its place in the file, for errors that arise only once the image size is known too.
#[derive(Debug, Clone)]
pub(super) struct RawLens {
    pub(super) lens: Lens,
    /// The place in messages, such as `line 5, \`D\``; empty for a lens that fits every image.
    place: String,
    /// The file that holds the lens, if the calibration consists of several.
    path: Option<PathBuf>,
}

/// The lens models that formats name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LensModel {
    /// OpenCV's polynomial or rational model.
    OpenCv,
    /// OpenCV's fisheye model, also called equidistant.
    Fisheye,
}

impl RawLens {
    /// The lens with these coefficients, which stand at `place` in the file.
    ///
    /// # Errors
    /// Too few or too many coefficients; the message does not name the place.
    pub(super) fn new(model: LensModel, coefficients: &[f64], place: String) -> Result<Self> {
        let lens = match model {
            LensModel::OpenCv => Distortion::from_opencv(coefficients)?.into(),
            LensModel::Fisheye if coefficients.is_empty() => {
                let problem = "expected 4 fisheye coefficients (k1 k2 k3 k4), found none";
                return Err(Error::argument(problem));
            }
            LensModel::Fisheye => Fisheye::from_opencv(coefficients)?.into(),
        };
        Ok(Self { lens, place, path: None })
    }

    /// A lens without distortion.
    pub(super) fn none() -> Self {
        Distortion::none().into()
    }

    /// Names the file in errors about this lens.
    pub(super) fn in_file(self, path: &Path) -> Self {
        Self { path: Some(path.to_owned()), ..self }
    }

    /// Adds the lens's place to the error of a camera that cannot have this lens.
    pub(super) fn error_at_place(&self, error: Error) -> Error {
        let error = match error {
            Error::Camera { camera, problem } => Error::camera(camera, format!("{}: {problem}", self.place)),
            other => other,
        };
        self.path.as_ref().map_or(error.clone(), |path| Error::file(path, error))
    }
}

impl From<Distortion> for RawLens {
    fn from(lens: Distortion) -> Self {
        Self { lens: lens.into(), place: String::new(), path: None }
    }
}

/// Which image coordinates a pixel's centre has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PixelCentres {
    /// The first pixel's centre is (0, 0), as in OpenCV.
    Whole,
    /// The first pixel's centre is (0.5, 0.5), as in this crate.
    Half,
}

/// The side of an image if it is a whole number of pixels that image files can have.
pub(super) fn pixels(side: f64) -> Option<u32> {
    (side.fract() == 0.0 && (1.0..=65_535.0).contains(&side)).then_some(side as u32)
}
