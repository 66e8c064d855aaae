//! Masks whose outlines are displaced at random, as those of live segmentations are.

use crate::random::Random;
use image::{GrayImage, Luma};
use ode_visual_hull::silhouette::{Border, Silhouette};

/// Half the width, in pixels, of the box by which the displacement is smoothed, twice: neighbours along an edge are
/// correlated over about three pixels.
const HALF_WIDTH: i32 = 1;

/// The mask with its edge displaced by `deviation` pixels (one standard deviation) along its normal. Masks of different
/// seeds are independent.
pub fn displace_edge(mask: &GrayImage, deviation: f64, seed: u64) -> GrayImage {
    let silhouette = Silhouette::new(mask, Border::Background);
    let rect = silhouette.rect().grown(8).intersection(&silhouette.image());
    let distance = silhouette.signed_distance(&rect);
    let noise = smooth_noise(rect.width(), rect.height(), seed);

    let mut displaced = GrayImage::new(mask.width(), mask.height());
    for j in rect.y0..rect.y1 {
        for i in rect.x0..rect.x1 {
            let (byte, at) = (mask.get_pixel(i as u32, j as u32).0[0], f64::from(distance.at(i, j)));
            // Next to the edge, coverage tells where it is.
            let at = if at.abs() <= 0.5 { (127.5 - f64::from(byte)) / 255.0 } else { at };
            let at = at - deviation * noise[rect.index(i, j)];
            let byte = (127.5 - 255.0 * at).round().clamp(0.0, 255.0) as u8;
            displaced.put_pixel(i as u32, j as u32, Luma([byte]));
        }
    }
    displaced
}

/// Random numbers of mean 0 and deviation 1, row-major, smoothed by a box twice.
fn smooth_noise(width: usize, height: usize, seed: u64) -> Vec<f64> {
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bd1_e995);
    let mut noise: Vec<f64> = (0..width * height).map(|_| random.between(-1.0, 1.0)).collect();
    for _ in 0..2 {
        let before = noise.clone();
        for (index, value) in noise.iter_mut().enumerate() {
            let (x, y) = ((index % width) as i32, (index / width) as i32);
            let at = |dx: i32, dy: i32| {
                let x = (x + dx).clamp(0, width as i32 - 1) as usize;
                before[(y + dy).clamp(0, height as i32 - 1) as usize * width + x]
            };
            let around = -HALF_WIDTH..=HALF_WIDTH;
            *value = around
                .clone()
                .flat_map(|dy| around.clone().map(move |dx| (dx, dy)))
                .map(|(dx, dy)| at(dx, dy))
                .sum();
        }
    }
    let deviation = (noise.iter().map(|value| value * value).sum::<f64>() / noise.len().max(1) as f64).sqrt();
    noise.iter_mut().for_each(|value| *value /= deviation.max(f64::MIN_POSITIVE));
    noise
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_of_a_disc_is_displaced_by_the_deviation() {
        let disc = GrayImage::from_fn(200, 200, |i, j| {
            let inwards = 80.2 - (f64::from(i) - 99.5).hypot(f64::from(j) - 99.5);
            Luma([(127.5 + 255.0 * inwards).clamp(0.0, 255.0) as u8])
        });
        let area = |mask: &GrayImage| mask.iter().map(|&byte| f64::from(byte) / 255.0).sum::<f64>();
        let radii: Vec<f64> = (0..200)
            .map(|seed| (area(&displace_edge(&disc, 1.0, seed)) / std::f64::consts::PI).sqrt())
            .collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        // The radius of a whole disc varies by 1 px over the root of its independent parts, about 170.
        assert!((mean - 80.2).abs() < 0.05, "{mean}");

        let noisy = displace_edge(&disc, 1.0, 7);
        let row = |mask: &GrayImage, j: u32| {
            (0..200).map(|i| f64::from(mask.get_pixel(i, j).0[0]) / 255.0).sum::<f64>()
        };
        let widths: Vec<f64> = (70..130).map(|j| row(&noisy, j) - row(&disc, j)).collect();
        let deviation = (widths.iter().map(|width| width * width).sum::<f64>() / widths.len() as f64).sqrt();
        // Two edges a row, each displaced by 1 px.
        assert!((1.0..2.0).contains(&deviation), "{deviation}");
    }
}
