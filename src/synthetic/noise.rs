//! Noise of real sensors and segmentations, added to clean images.

use super::random::{Random, mix, unit};
use crate::{Error, Result};
use image::{GrayImage, Luma, RgbImage};

/// Adds independent normal noise with standard deviation `sigma` grey levels to each channel of each pixel; values are
/// rounded and clamped to 0 to 255. The same seed gives the same noise.
///
/// # Errors
/// A `sigma` that is negative or not finite.
pub fn add_noise(image: &mut RgbImage, sigma: f64, seed: u64) -> Result<()> {
    if !(sigma >= 0.0 && sigma.is_finite()) {
        return Err(Error::argument(format!(
            "expected a noise deviation of 0 grey levels or more, found {sigma}"
        )));
    }
    let mut random = Random::new(seed);
    for pair in image.chunks_mut(2) {
        for (value, noise) in pair.iter_mut().zip(random.normal_pair()) {
            *value = (f64::from(*value) + sigma * noise).round().clamp(0.0, 255.0) as u8;
        }
    }
    Ok(())
}

/// Flips each boundary pixel of a mask with the given probability, to 0 or 255. A boundary pixel, inside or outside,
/// has a neighbour of the other kind on the left, right, above or below (inside is >= 128).
///
/// The random draw depends on the pixel's position: with the same seed, noise is constant in time even if the mask
/// moves; with a seed per frame it changes each frame.
///
/// # Errors
/// A probability outside [0, 1].
pub fn flip_boundary(mask: &mut GrayImage, probability: f64, seed: u64) -> Result<()> {
    if !(0.0..=1.0).contains(&probability) {
        return Err(Error::argument(format!("expected a probability from 0 to 1, found {probability}")));
    }

    let before = mask.clone();
    let inside = |x: u32, y: u32| before.get_pixel_checked(x, y).map(|pixel| pixel.0[0] >= 128);
    let key = mix(seed);

    for (x, y, pixel) in mask.enumerate_pixels_mut() {
        let own = before.get_pixel(x, y).0[0] >= 128;
        let neighbours =
            [inside(x.wrapping_sub(1), y), inside(x + 1, y), inside(x, y.wrapping_sub(1)), inside(x, y + 1)];

        let is_boundary = neighbours.into_iter().flatten().any(|other| other != own);
        if is_boundary && unit(mix(key ^ (u64::from(y) << 32 | u64::from(x)))) < probability {
            *pixel = Luma([if own { 0 } else { 255 }]);
        }
    }
    Ok(())
}
