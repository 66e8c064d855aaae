//! Exact silhouettes of a subject in a camera, binary or with coverage.

use super::eye::{Eye, PatchContent};
use super::subject::Subject;
use crate::camera::Camera;
use image::{GrayImage, Luma};

/// Rays along a pixel's side where an outline crosses the pixel.
const SUBPIXELS: u32 = 16;

/// The binary silhouette: 255 where the ray through the pixel's centre meets the subject, else 0.
///
/// Parts of the subject beyond the image or behind the camera are invisible; a pixel beyond the lens model is 0.
pub fn silhouette(camera: &Camera, subject: &Subject) -> GrayImage {
    let (width, height) = camera.size();
    let mut mask = GrayImage::new(width, height);
    let eye = Eye::new(camera);
    for (tile, solids) in eye.tiles_with(subject) {
        for (x, y) in tile.pixels() {
            let Some(ray) = eye.ray(f64::from(x) + 0.5, f64::from(y) + 0.5) else { continue };
            if solids.iter().any(|placed| placed.is_hit(&ray)) {
                mask.put_pixel(x, y, Luma([255]));
            }
        }
    }
    mask
}

/// The silhouette with its coverage: 255 times the fraction of the pixel's area that the subject covers, rounded.
///
/// Pixels that an outline may cross are sampled by 16 x 16 rays, so that parts thinner than a pixel are not lost; all
/// others are exactly 0 or 255. A pixel with a corner beyond the lens model is 0.
pub fn coverage(camera: &Camera, subject: &Subject) -> GrayImage {
    let (width, height) = camera.size();
    let mut mask = GrayImage::new(width, height);
    let eye = Eye::new(camera);

    let mut met = Vec::new();

    for (tile, solids) in eye.tiles_with(subject) {
        eye.for_each_pixel(&tile, |x, y, patch| {
            let value = match patch.content(&solids, &mut met) {
                PatchContent::Background => return,
                PatchContent::Subject => 255,
                PatchContent::Contour => {
                    let hits =
                        patch.rays(SUBPIXELS).filter(|ray| met.iter().any(|placed| placed.is_hit(ray)));
                    let fraction = hits.count() as f64 / f64::from(SUBPIXELS * SUBPIXELS);
                    (255.0 * fraction).round() as u8
                }
            };

            mask.put_pixel(x, y, Luma([value]));
        });
    }
    mask
}
