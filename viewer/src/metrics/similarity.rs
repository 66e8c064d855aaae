//! The structural similarity of two images (Wang, Bovik, Sheikh and Simoncelli 2004).

use image::{GrayImage, RgbImage};

/// Standard deviation of the Gaussian window and its half-width, in pixels.
const SIGMA: f64 = 1.5;
const HALF: usize = 5;

/// The constants that keep the ratios stable, for values up to 255.
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// The mean structural similarity of the luminance of `found` and `truth` over the pixels of `mask`, -1 to 1; windows are
/// Gaussians of 11 x 11 pixels and see all of both images. NaN where `mask` has no pixel.
///
/// All three have the same number of pixels, row by row.
pub fn structural_similarity(found: &RgbImage, truth: &RgbImage, mask: &[bool]) -> f64 {
    let size = (found.width() as usize, found.height() as usize);
    let (x, y) = (luminance(found), luminance(truth));
    let product = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a * b).collect() };
    let mean = |values: &[f64]| blurred(values, size);
    let (mean_x, mean_y) = (mean(&x), mean(&y));
    let (xx, yy, xy) = (mean(&product(&x, &x)), mean(&product(&y, &y)), mean(&product(&x, &y)));

    let at = |i: usize| {
        let (mx, my) = (mean_x[i], mean_y[i]);
        let (vx, vy, cov) = (xx[i] - mx * mx, yy[i] - my * my, xy[i] - mx * my);
        (2.0 * mx * my + C1) * (2.0 * cov + C2) / ((mx * mx + my * my + C1) * (vx + vy + C2))
    };
    let of_mask: Vec<f64> = (0..x.len()).filter(|&i| mask[i]).map(at).collect();
    of_mask.iter().sum::<f64>() / of_mask.len() as f64
}

fn luminance(image: &RgbImage) -> Vec<f64> {
    let grey: GrayImage = image::imageops::grayscale(image);
    grey.iter().map(|&value| f64::from(value)).collect()
}

/// `values`, row by row, under the Gaussian window; beyond the border the outermost values go on.
fn blurred(values: &[f64], (width, height): (usize, usize)) -> Vec<f64> {
    let weight = |k: usize| (-0.5 * ((k as f64 - HALF as f64) / SIGMA).powi(2)).exp();
    let total: f64 = (0..=2 * HALF).map(weight).sum();
    let kernel: Vec<f64> = (0..=2 * HALF).map(|k| weight(k) / total).collect();
    let near = |i: usize, k: usize, length: usize| (i + k).saturating_sub(HALF).min(length - 1);

    let mut rows = vec![0.0; values.len()];
    for (i, row) in rows.iter_mut().enumerate() {
        let (x, first) = (i % width, i - i % width);
        *row = kernel.iter().enumerate().map(|(k, w)| w * values[first + near(x, k, width)]).sum();
    }
    let at = |i: usize| -> f64 {
        let (x, y) = (i % width, i / width);
        kernel.iter().enumerate().map(|(k, w)| w * rows[near(y, k, height) * width + x]).sum()
    };
    (0..values.len()).map(at).collect()
}
