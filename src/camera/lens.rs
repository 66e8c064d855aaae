//! The lens of a camera: one of OpenCV's models.
//!
//! To add a model:
//!
//! 1. Write it into a file of its own beside this one, as [`Fisheye`]: from coefficients, `distort`, `undistort`, both
//!    `None` beyond the range in which the model grows, `max_radius`, and `Display`.
//! 2. Add a variant to [`Lens`], a line to each `match` below, and a `From`.
//! 3. Add a lens of it to those that `camera/tests.rs` and `silhouette/undistort/tests.rs` go through.
//! 4. Let the readers in `rig` that have a name for it make it, and `rig/toml.rs` write it.
//!
//! Silhouettes, hulls and contacts need nothing else: masks are redrawn as a pinhole camera sees them.

use super::{Distortion, Fisheye};
use nalgebra::{Matrix3, Point2};
use std::fmt;

/// Where a camera's lens puts what a pinhole would see elsewhere.
///
/// Positions are those on the plane at depth 1: `(x, y) = (X / Z, Y / Z)` in the camera's frame. The intrinsic matrix
/// maps distorted positions to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Lens {
    /// OpenCV's polynomial or rational model, thin prism and tilted sensor included. Without coefficients a pinhole.
    OpenCv(Distortion),
    /// OpenCV's fisheye model.
    Fisheye(Fisheye),
}

impl Lens {
    /// A pinhole's.
    pub fn none() -> Self {
        Self::OpenCv(Distortion::none())
    }

    /// Whether it is a pinhole's, which leaves every position where it is.
    pub fn is_none(&self) -> bool {
        match self {
            Self::OpenCv(lens) => lens.is_none(),
            // Without coefficients it is the equidistant projection.
            Self::Fisheye(_) => false,
        }
    }

    /// The model's coefficients in OpenCV's order, absent ones zero: the 14 of [`Distortion`], the 4 of [`Fisheye`].
    pub fn coefficients(&self) -> &[f64] {
        match self {
            Self::OpenCv(lens) => lens.coefficients(),
            Self::Fisheye(lens) => lens.coefficients(),
        }
    }

    /// The distorted position of `p`; `None` beyond the model's range.
    pub fn distort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        match self {
            Self::OpenCv(lens) => lens.distort(p),
            Self::Fisheye(lens) => lens.distort(p),
        }
    }

    /// The position that [`distort`](Self::distort) maps to `p`, to 1e-12; `None` beyond the model's range.
    pub fn undistort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        match self {
            Self::OpenCv(lens) => lens.undistort(p),
            Self::Fisheye(lens) => lens.undistort(p),
        }
    }

    /// The radius on the plane at depth 1 up to which the model holds; infinity where it holds everywhere.
    pub(crate) fn max_radius(&self) -> f64 {
        match self {
            Self::OpenCv(lens) => lens.max_radius(),
            Self::Fisheye(lens) => lens.max_radius(),
        }
    }

    /// Whether an image of `size` pixels can be this lens's; `to_plane` is the inverse of the intrinsic matrix.
    ///
    /// # Errors
    /// What was expected and found, and what to do.
    pub(super) fn check_image(
        &self,
        to_plane: &Matrix3<f64>,
        size: (u32, u32),
    ) -> std::result::Result<(), String> {
        match self {
            Self::OpenCv(_) => Ok(()),
            Self::Fisheye(lens) => lens.check_image(to_plane, size),
        }
    }
}

impl From<Distortion> for Lens {
    fn from(lens: Distortion) -> Self {
        Self::OpenCv(lens)
    }
}

impl From<Fisheye> for Lens {
    fn from(lens: Fisheye) -> Self {
        Self::Fisheye(lens)
    }
}

impl fmt::Display for Lens {
    /// `pinhole`, or the model and its coefficients with all their digits: `OpenCV fisheye [0.1, 0.0, 0.0, 0.0]`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            _ if self.is_none() => write!(f, "pinhole"),
            Self::OpenCv(lens) => lens.fmt(f),
            Self::Fisheye(lens) => lens.fmt(f),
        }
    }
}
