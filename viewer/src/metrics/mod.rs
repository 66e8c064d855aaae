//! How close a drawn picture is to an image.

mod comparison;
mod similarity;

pub use comparison::{Comparison, Truth};
pub use similarity::structural_similarity;

use image::RgbImage;

/// The peak signal-to-noise ratio of `found` against `truth` over the pixels of `mask`, in dB: that of the mean squared
/// error over all pixels and channels. Infinite for equal pixels, NaN where `mask` has none.
///
/// All three have the same number of pixels, row by row.
pub fn psnr(found: &RgbImage, truth: &RgbImage, mask: &[bool]) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u64);
    for ((a, b), _) in found.pixels().zip(truth.pixels()).zip(mask).filter(|(_, counts)| **counts) {
        for (a, b) in a.0.into_iter().zip(b.0) {
            sum += (f64::from(a) - f64::from(b)).powi(2);
            count += 1;
        }
    }
    10.0 * (255.0_f64.powi(2) * count as f64 / sum).log10()
}

/// The number of pixels in both masks over that of the pixels in either; NaN where both are empty.
pub fn intersection_over_union(a: &[bool], b: &[bool]) -> f64 {
    let count = |both: fn(bool, bool) -> bool| a.iter().zip(b).filter(|(a, b)| both(**a, **b)).count() as f64;
    count(|a, b| a && b) / count(|a, b| a || b)
}

/// The mean change of `pixels` from one picture to the next, in grey levels: the mean absolute difference over all
/// channels. NaN where `mask` has no pixel.
pub fn mean_change(before: &RgbImage, after: &RgbImage, mask: &[bool]) -> f64 {
    let (mut sum, mut count) = (0_u64, 0_u64);
    for ((a, b), _) in before.pixels().zip(after.pixels()).zip(mask).filter(|(_, counts)| **counts) {
        sum += a.0.into_iter().zip(b.0).map(|(a, b)| u64::from(a.abs_diff(b))).sum::<u64>();
        count += 3;
    }
    sum as f64 / count as f64
}
