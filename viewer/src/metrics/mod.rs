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

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn grey(level: u8) -> RgbImage {
        RgbImage::from_pixel(16, 16, Rgb([level; 3]))
    }

    /// Vertical stripes four pixels wide, `right` pixels to the right.
    fn stripes(right: u32) -> RgbImage {
        RgbImage::from_fn(16, 16, |x, _| {
            Rgb([if ((x + 16 - right) / 4).is_multiple_of(2) { 60 } else { 180 }; 3])
        })
    }

    #[test]
    fn the_signal_to_noise_ratio_is_that_of_its_definition_over_the_mask_alone() {
        let all = vec![true; 256];
        // An error of 25.5 levels is a tenth of the peak: 20 dB.
        let mut half = grey(100);
        half.pixels_mut()
            .enumerate()
            .filter(|(k, _)| k % 2 == 0)
            .for_each(|(_, pixel)| *pixel = Rgb([136; 3]));
        assert!(
            (psnr(&half, &grey(100), &all) - 20.0 * (255.0 / (36.0 / 2.0_f64.sqrt())).log10()).abs() < 1e-9
        );
        let odd: Vec<bool> = (0..256).map(|k| k % 2 == 1).collect();
        assert_eq!(psnr(&half, &grey(100), &odd), f64::INFINITY);
        assert!(psnr(&half, &grey(100), &[false; 256]).is_nan());
    }

    #[test]
    fn structural_similarity_is_one_for_equal_images_and_falls_with_contrast_and_shift() {
        let all = vec![true; 256];
        let similarity = |other: &RgbImage| structural_similarity(other, &stripes(0), &all);
        assert!((similarity(&stripes(0)) - 1.0).abs() < 1e-12);
        // Without structure only the luminance is similar.
        assert!(similarity(&grey(120)) < 0.1, "{}", similarity(&grey(120)));
        assert!(similarity(&stripes(2)) < 0.5 && similarity(&stripes(4)) < -0.5);
    }

    #[test]
    fn overlap_and_change_are_those_of_their_definitions() {
        let (a, b) = ([true, true, false, false], [false, true, true, false]);
        assert_eq!(intersection_over_union(&a, &b), 1.0 / 3.0);
        assert_eq!(mean_change(&grey(10), &grey(13), &[true; 256]), 3.0);
    }
}
