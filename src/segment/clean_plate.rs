//! Background subtraction against an image of the empty room.

use crate::{Error, Result};
use image::{GrayImage, Luma, RgbImage};
use imageproc::region_labelling::{Connectivity, connected_components};

/// When a pixel or a region counts as the subject.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholds {
    /// A pixel differs from the clean plate when one of its channels differs by more than this many grey levels.
    ///
    /// Default 24: more than five deviations of the difference of two images with noise of 3 grey levels each.
    pub difference: u8,
    /// A smaller separate region of the subject is dropped, in pixels of area. Default 40.
    pub smallest_region_px: u32,
    /// A smaller hole in the subject is filled, in pixels of area. Default 20: holes that a person makes, between arm
    /// and side, are larger in all but their last moment.
    pub smallest_hole_px: u32,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self { difference: 24, smallest_region_px: 40, smallest_hole_px: 20 }
    }
}

/// The image of the empty room of one fixed camera, against which its images are compared.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use ode_visual_hull::segment::{CleanPlate, Thresholds};
///
/// let room = RgbImage::from_pixel(64, 48, Rgb([90, 140, 100]));
/// let mut image = room.clone();
/// for (x, y) in (20..30).flat_map(|x| (10..40).map(move |y| (x, y))) {
///     image.put_pixel(x, y, Rgb([200, 60, 50]));
/// }
/// let mask = CleanPlate::new(room, Thresholds::default()).subtract(&image)?;
/// assert_eq!((mask.get_pixel(25, 20).0, mask.get_pixel(5, 20).0), ([255], [0]));
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CleanPlate {
    background: RgbImage,
    thresholds: Thresholds,
}

impl CleanPlate {
    /// From an image of the empty room; the mean of several has less noise.
    pub fn new(background: RgbImage, thresholds: Thresholds) -> Self {
        Self { background, thresholds }
    }

    /// The silhouette in `image`: 255 where it differs from the empty room, else 0; cut at half coverage at the
    /// outline, with small specks dropped and small holes filled.
    ///
    /// A shadow that the subject casts counts as the subject once it darkens the room by more than the threshold:
    /// light a real studio softly.
    ///
    /// # Errors
    /// An image of another size than the clean plate.
    pub fn subtract(&self, image: &RgbImage) -> Result<GrayImage> {
        let (expected, found) = (self.background.dimensions(), image.dimensions());
        if expected != found {
            return Err(Error::argument(format!(
                "expected an image of {} x {} pixels, the size of the clean plate, found {} x {}; \
                 take both with the same camera and settings",
                expected.0, expected.1, found.0, found.1
            )));
        }
        let difference = GrayImage::from_fn(found.0, found.1, |x, y| {
            let (pixel, room) = (image.get_pixel(x, y).0, self.background.get_pixel(x, y).0);
            Luma([(0..3).map(|c| pixel[c].abs_diff(room[c])).max().unwrap_or(0)])
        });
        let mut mask = difference.clone();
        for value in mask.iter_mut() {
            *value = if *value > self.thresholds.difference { 255 } else { 0 };
        }
        halve_outline(&mut mask, &difference);
        drop_small(&mut mask, 255, self.thresholds.smallest_region_px);
        drop_small(&mut mask, 0, self.thresholds.smallest_hole_px);
        Ok(mask)
    }
}

/// Takes away outline pixels of which less than half shows the subject.
///
/// There the two colours mix, and a low threshold keeps a pixel of which a fifth is covered: the difference is the
/// full one times the covered fraction. The full difference is read from the neighbours.
fn halve_outline(mask: &mut GrayImage, difference: &GrayImage) {
    let before = mask.clone();
    let (width, height) = before.dimensions();
    for (x, y, value) in mask.enumerate_pixels_mut() {
        if value.0[0] == 0 {
            continue;
        }
        let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
        let (top, bottom) = (y.saturating_sub(1), (y + 1).min(height - 1));
        let is_outline = [(left, y), (right, y), (x, top), (x, bottom)]
            .into_iter()
            .any(|(i, j)| before.get_pixel(i, j).0[0] == 0);
        if is_outline {
            let around = (top..=bottom).flat_map(|j| (left..=right).map(move |i| (i, j)));
            let full = around.map(|(i, j)| difference.get_pixel(i, j).0[0]).max().unwrap_or(0);
            if 2 * u32::from(difference.get_pixel(x, y).0[0]) < u32::from(full) {
                value.0[0] = 0;
            }
        }
    }
}

/// Gives connected regions of `kind` (0 or 255) with fewer than `area_px` pixels to their surroundings.
fn drop_small(mask: &mut GrayImage, kind: u8, area_px: u32) {
    // Diagonal neighbours are one region for the subject and two for the background, else two diagonals could cross.
    let connectivity = if kind == 255 { Connectivity::Eight } else { Connectivity::Four };
    let labels = connected_components(mask, connectivity, Luma([255 - kind]));
    let regions = labels.iter().max().map_or(0, |&last| last as usize);
    let mut areas = vec![0u32; regions + 1];
    for &label in labels.iter() {
        areas[label as usize] += 1;
    }
    for (value, &label) in mask.iter_mut().zip(labels.iter()) {
        if label != 0 && areas[label as usize] < area_px {
            *value = 255 - kind;
        }
    }
}

#[cfg(test)]
mod tests;
