//! Reading masks from image files of several pixel formats.

use crate::{Error, Result, image_file};
use image::{DynamicImage, GrayImage, ImageBuffer, Luma};
use std::path::Path;

type Gray16 = ImageBuffer<Luma<u16>, Vec<u16>>;

/// Reads the mask in an image file: 0 is background, 255 is subject, and the values between are coverage.
///
/// The mask is the alpha channel of an image with any transparency (a cut-out subject), the luma of another colour
/// image, or a grey image itself. Sixteen bits are scaled to eight.
///
/// # Errors
/// If the file is missing or not an image. If the greatest value is 1, or at most 255 in an image of sixteen bits: such
/// a mask would count as empty.
pub fn load_mask(path: impl AsRef<Path>) -> Result<GrayImage> {
    let path = path.as_ref();
    mask_of(image_file::read(path)?).map_err(|problem| Error::file(path, problem))
}

/// The mask in an image, or what is wrong with the image.
fn mask_of(image: DynamicImage) -> std::result::Result<GrayImage, String> {
    let sixteen_bits = image.color().bytes_per_pixel() > image.color().channel_count();
    let mask = match transparency(&image) {
        Some(alpha) => alpha,
        None => image.into_luma16(),
    };

    // The greatest value in the image's own bits. Eight bits were expanded to sixteen by a factor of 257.
    let greatest = mask.iter().max().map_or(0, |&value| if sixteen_bits { value } else { value / 257 });
    match (sixteen_bits, greatest) {
        (false, 1) => Err("expected 0 .. 255, found a greatest value of 1; multiply by 255".into()),
        (true, 1) => Err("expected 0 .. 65535, found a greatest value of 1; multiply by 65535".into()),
        (true, 2..=255) => Err(format!(
            "expected 0 .. 65535 in an image of 16 bits, found a greatest value of {greatest}; save it with 8 bits"
        )),
        _ => Ok(DynamicImage::ImageLuma16(mask).into_luma8()),
    }
}

/// The alpha channel, if any pixel is not opaque.
fn transparency(image: &DynamicImage) -> Option<Gray16> {
    if !image.color().has_alpha() {
        return None;
    }
    let rgba = image.to_rgba16();
    let alpha: Vec<u16> = rgba.pixels().map(|pixel| pixel.0[3]).collect();
    let any = alpha.iter().any(|&a| a < u16::MAX);
    any.then(|| Gray16::from_raw(rgba.width(), rgba.height(), alpha)).flatten()
}

#[cfg(test)]
mod tests;
