//! Pictures without jagged edges: drawn larger, then reduced.

use crate::picture::Picture;
use image::RgbImage;
use image::imageops::{FilterType, resize};
use nalgebra::Matrix3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::{Camera, Lens};

/// `camera` with `samples` x `samples` pixels in place of each, as a pinhole.
///
/// # Errors
/// A picture that would be too large.
pub fn enlarged(camera: &Camera, samples: u32) -> Result<Camera> {
    let (width, height) = camera.size();
    let factor = f64::from(samples);
    let scale = Matrix3::new(factor, 0.0, 0.0, 0.0, factor, 0.0, 0.0, 0.0, 1.0);
    let size = (width.saturating_mul(samples), height.saturating_mul(samples));
    Camera::new(camera.name(), size, scale * camera.intrinsics(), Lens::none(), *camera.cam_from_world())
}

/// The colours of `picture`, drawn with [`enlarged`], at the size wanted.
pub fn reduced(picture: Picture, samples: u32) -> RgbImage {
    if samples == 1 {
        return picture.colour;
    }
    let (width, height) = picture.colour.dimensions();
    resize(&picture.colour, width / samples, height / samples, FilterType::Triangle)
}
