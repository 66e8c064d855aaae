//! The part of a camera's image that a film shows.

use nalgebra::Point3;
use ode_visual_hull::camera::{Camera, Pixel};

/// A part of an image, in pixels.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    /// Columns left of it.
    pub left: u32,
    /// Rows above it.
    pub top: u32,
    /// Its columns.
    pub width: u32,
    /// Its rows.
    pub height: u32,
}

impl Window {
    /// The whole image of a camera.
    pub fn full(camera: &Camera) -> Self {
        let (width, height) = camera.size();
        Self { left: 0, top: 0, width, height }
    }

    /// The smallest window that holds the images of `points` (world), cut off at the image's border; the whole image
    /// where none of them is in it.
    pub fn around(camera: &Camera, points: &[Point3<f64>]) -> Self {
        let (width, height) = camera.size();
        let pixels: Vec<_> = points.iter().filter_map(|point| camera.project(point)).collect();
        let least = |x: f64, most: u32| x.clamp(0.0, f64::from(most)) as u32;
        let fold = |pick: fn(&Pixel) -> f64, first: f64, better: fn(f64, f64) -> f64, most: u32| {
            least(pixels.iter().map(pick).fold(first, better), most)
        };
        let left = fold(|p| p.u, f64::INFINITY, f64::min, width);
        let right = fold(|p| p.u, f64::NEG_INFINITY, f64::max, width);
        let top = fold(|p| p.v, f64::INFINITY, f64::min, height);
        let bottom = fold(|p| p.v, f64::NEG_INFINITY, f64::max, height);
        if right <= left || bottom <= top {
            return Self::full(camera);
        }

        Self { left, top, width: right - left, height: bottom - top }
    }
}
