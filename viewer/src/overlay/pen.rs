//! A pen that draws on the pixels of a picture, faintly behind its surfaces.

use super::Ink;
use crate::picture::Picture;
use image::{Rgb, RgbImage};

/// Pictures wider than this, in pixels, have lines of two pixels.
const WIDE: u32 = 900;

/// How much deeper than a surface something may lie that is drawn as on it: in metres, and as a part of the depth. Contacts lie
/// a few millimetres inside bodies, and depths are rounded.
const ON_SURFACE: f64 = 0.008;
const ON_SURFACE_PART: f64 = 0.002;

/// A pen that draws on the pixels of a picture.
pub(super) struct Pen<'p> {
    pub(super) image: &'p mut RgbImage,
    depths: &'p [f32],
    /// Width of a line, in pixels.
    pub(super) width: f64,
}

impl<'p> Pen<'p> {
    pub(super) fn new(picture: &'p mut Picture) -> Self {
        let width = if picture.colour.width() > WIDE { 2.0 } else { 1.0 };
        Self { image: &mut picture.colour, depths: &picture.depth, width }
    }

    /// Width and height of the picture, in pixels.
    pub(super) fn size(&self) -> (f64, f64) {
        (f64::from(self.image.width()), f64::from(self.image.height()))
    }

    /// The opacity of what is drawn with `ink` in pixel `(x, y)` at a depth in metres.
    pub(super) fn opacity(&self, x: i64, y: i64, depth: f64, ink: Ink) -> f32 {
        let (width, height) = (i64::from(self.image.width()), i64::from(self.image.height()));
        let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
        let surface = is_inside.then(|| self.depths.get((y * width + x) as usize)).flatten();
        let on_surface = (depth - ON_SURFACE) * (1.0 - ON_SURFACE_PART);
        if surface.is_some_and(|&surface| f64::from(surface) < on_surface) { ink.hidden } else { 1.0 }
    }

    /// Draws on a part `coverage` of pixel `(x, y)`, from 0 to 1, at a depth in metres; pixels outside the picture are left out.
    pub(super) fn draw(&mut self, x: i64, y: i64, depth: f64, coverage: f64, ink: Ink) {
        let opacity = coverage.clamp(0.0, 1.0) as f32 * self.opacity(x, y, depth, ink);
        blend(self.image, x, y, ink.colour, opacity);
    }
}

/// Mixes a colour into pixel `(x, y)` of an image by its `opacity`, from 0 to 1; pixels outside are left out.
pub(super) fn blend(image: &mut RgbImage, x: i64, y: i64, colour: [u8; 3], opacity: f32) {
    let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
    let Some(Rgb(pixel)) = image.get_pixel_mut_checked(x, y) else { return };
    for (value, new) in pixel.iter_mut().zip(colour) {
        let (old, new) = (f32::from(*value), f32::from(new));
        *value = (old + opacity * (new - old)).round() as u8;
    }
}
