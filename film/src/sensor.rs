//! The noise of the synthetic cameras' sensors.

use image::{Rgb, RgbImage};
use ode_visual_hull::Result;
use ode_visual_hull::synthetic::add_noise;

/// The field is this many pixels wider and higher than an image: each offset gives another noise.
const NOISE_MARGIN: u32 = 64;

/// A field of sensor noise. Each image uses another part of it, which is much faster than drawing a million normal
/// numbers for each image.
pub struct Sensor {
    field: RgbImage,
}

/// The grey on which the field is drawn.
const GREY: u8 = 128;

impl Sensor {
    /// A sensor for images of `size` pixels, with a standard deviation of `sigma` grey levels.
    pub fn new(size: (u32, u32), sigma: f64, seed: u64) -> Result<Self> {
        let mut field = RgbImage::from_pixel(size.0 + NOISE_MARGIN, size.1 + NOISE_MARGIN, Rgb([GREY; 3]));
        add_noise(&mut field, sigma, seed)?;
        Ok(Self { field })
    }

    /// `image` with the noise of exposure number `exposure`.
    pub fn expose(&self, image: &RgbImage, exposure: u32) -> RgbImage {
        // The step is coprime to the number of offsets, so that all are used before one is used again.
        let place = exposure.wrapping_mul(1_597) % (NOISE_MARGIN * NOISE_MARGIN);
        let (left, top) = (place % NOISE_MARGIN, place / NOISE_MARGIN);
        let mut noisy = image.clone();
        let (row, field_row) = (3 * image.width() as usize, 3 * self.field.width() as usize);
        let fields = self.field.as_raw().chunks(field_row).skip(top as usize);
        for (pixels, noise) in noisy.chunks_mut(row).zip(fields) {
            for (value, &noise) in pixels.iter_mut().zip(&noise[3 * left as usize..]) {
                *value = (i16::from(*value) + i16::from(noise) - i16::from(GREY)).clamp(0, 255) as u8;
            }
        }
        noisy
    }
}
