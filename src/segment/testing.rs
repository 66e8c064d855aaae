//! Test images for segmentation, and measures of a mask's quality.

use image::{GrayImage, Rgb, RgbImage};

/// `image` with a rectangle painted over it.
pub(super) fn painted(image: &RgbImage, left: u32, top: u32, w: u32, h: u32, colour: [u8; 3]) -> RgbImage {
    let mut image = image.clone();
    for (x, y) in (left..left + w).flat_map(|x| (top..top + h).map(move |y| (x, y))) {
        image.put_pixel(x, y, Rgb(colour));
    }
    image
}

/// The number of pixels inside.
pub(super) fn area(mask: &GrayImage) -> f64 {
    mask.iter().filter(|&&value| value >= 128).count() as f64
}

/// Intersection over union of two masks.
pub(super) fn overlap(a: &GrayImage, b: &GrayImage) -> f64 {
    let pairs = a.iter().zip(b.iter()).map(|(&a, &b)| (a >= 128, b >= 128));
    let both = pairs.clone().filter(|&(a, b)| a && b).count();
    both as f64 / pairs.filter(|&(a, b)| a || b).count() as f64
}

/// The mean coverage error, 0 to 1, over the pixels that the exact outline crosses.
pub(super) fn coverage_error(mask: &GrayImage, exact: &GrayImage) -> f64 {
    let pairs = mask.iter().zip(exact.iter()).filter(|&(_, &exact)| exact > 0 && exact < 255);
    let errors: Vec<_> = pairs.map(|(&a, &b)| f64::from(a.abs_diff(b)) / 255.0).collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}
