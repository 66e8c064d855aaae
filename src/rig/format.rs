//! What every reader of a calibration format fills in: cameras as the file has them, before units and pixel centres are
//! brought to those of this crate.

use super::source::Source;
use crate::Result;
use crate::camera::Distortion;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// What a calibration file does not say, or says in a unit of its own.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hints {
    /// Width and height of the images, in pixels, for cameras of which the file does not tell.
    pub size: Option<(u32, u32)>,
    /// Metres per unit of length in the file, instead of the format's own.
    pub metres_per_unit: Option<f64>,
}

/// One format.
pub(super) struct Format {
    /// For people.
    pub(super) name: &'static str,
    /// Whether the content looks like it; cheap.
    pub(super) recognise: fn(&Source) -> bool,
    pub(super) read: fn(&Source, &Hints) -> Result<RawCalibration>,
}

/// What a file holds.
pub(super) struct RawCalibration {
    pub(super) cameras: Vec<RawCamera>,
    pub(super) pixel_centres: PixelCentres,
    /// Of the format; `None` where its lengths are arbitrary and somebody has to give the scale.
    pub(super) metres_per_unit: Option<f64>,
    pub(super) notes: Vec<String>,
}

/// A camera as a file has it.
pub(super) struct RawCamera {
    pub(super) name: String,
    /// Pixels, where the file says.
    pub(super) size: Option<(u32, u32)>,
    pub(super) k: Matrix3<f64>,
    pub(super) distortion: Distortion,
    /// World to camera, OpenCV's axes.
    pub(super) rotation: UnitQuaternion<f64>,
    /// World to camera, in the file's unit of length.
    pub(super) translation: Vector3<f64>,
}

/// Which image coordinates a pixel's centre has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PixelCentres {
    /// The first pixel's is (0, 0): OpenCV and kin.
    Whole,
    /// The first pixel's is (0.5, 0.5), as in this crate.
    Half,
}

/// The side of an image, of a whole number of pixels that image files can have.
pub(super) fn pixels(side: f64) -> Option<u32> {
    (side.fract() == 0.0 && (1.0..=65_535.0).contains(&side)).then_some(side as u32)
}
