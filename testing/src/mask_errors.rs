//! Gross errors of segmentations: single pixels that flip, and parts of the subject that are missing.

use crate::random::Random;
use image::{GrayImage, Luma};
use nalgebra::Point2;

/// The mask with a share of its pixels flipped. Masks of different seeds are independent.
pub fn speckled(mask: &GrayImage, share: f64, seed: u64) -> GrayImage {
    let mut random = Random(seed << 32);
    let mut speckled = mask.clone();
    for byte in speckled.iter_mut() {
        if random.unit() < share {
            *byte = 255 - *byte;
        }
    }
    speckled
}

/// The mask without a disc around `centre`, in pixels, whose area is the given share of the subject's.
pub fn bitten(mask: &GrayImage, share: f64, centre: &Point2<f64>) -> GrayImage {
    let area = mask.iter().map(|&byte| f64::from(byte) / 255.0).sum::<f64>();
    let radius = (share * area / std::f64::consts::PI).sqrt();
    GrayImage::from_fn(mask.width(), mask.height(), |i, j| {
        let distance = (f64::from(i) + 0.5 - centre.x).hypot(f64::from(j) + 0.5 - centre.y);
        if distance < radius { Luma([0]) } else { *mask.get_pixel(i, j) }
    })
}

/// The mean position of a mask's subject, in pixels.
pub fn centroid(mask: &GrayImage) -> Point2<f64> {
    let (mut sum, mut area) = (Point2::origin(), 0.0);
    for (i, j, Luma([byte])) in mask.enumerate_pixels() {
        let weight = f64::from(*byte);
        sum += Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5).coords * weight;
        area += weight;
    }
    sum / f64::max(area, 1.0)
}
