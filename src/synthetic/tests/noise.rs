use super::*;
use image::{GrayImage, Luma, Rgb, RgbImage};

#[test]
fn sensor_noise_has_its_standard_deviation_and_no_bias() {
    let mut image = RgbImage::from_pixel(200, 150, Rgb([100, 128, 180]));
    let clean = image.clone();
    add_noise(&mut image, 3.0, 7).unwrap();
    let errors: Vec<f64> =
        image.iter().zip(clean.iter()).map(|(a, b)| f64::from(*a) - f64::from(*b)).collect();

    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let variance = errors.iter().map(|e| e * e).sum::<f64>() / n;
    // 90,000 draws have standard errors of 0.01 and 0.04. Rounding to whole levels adds 1/12 to the variance.
    assert!(mean.abs() < 0.04 && (variance - 9.0 - 1.0 / 12.0).abs() < 0.2, "{mean}, {variance}");

    let neighbours = errors.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / n;
    assert!(neighbours.abs() < 0.15, "neighbours are independent: {neighbours}");

    let mut again = clean.clone();
    add_noise(&mut again, 3.0, 7).unwrap();
    assert_eq!(again, image);
    add_noise(&mut again, 3.0, 8).unwrap();
    assert_ne!(again, image);
}

/// A disc with a radius of 60 px and its centre at (`centre`, 100).
fn disc(centre: f64) -> GrayImage {
    GrayImage::from_fn(200, 200, |x, y| {
        let inside = (f64::from(x) - centre).hypot(f64::from(y) - 100.0) < 60.0;
        Luma([if inside { 255 } else { 0 }])
    })
}

fn is_boundary(mask: &GrayImage, x: u32, y: u32) -> bool {
    let kind = |x: u32, y: u32| mask.get_pixel(x, y).0[0];
    [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)].into_iter().any(|(i, j)| kind(i, j) != kind(x, y))
}

#[test]
fn boundary_pixels_flip_with_their_probability_and_no_others() {
    let (clean, mut noisy) = (disc(100.0), disc(100.0));
    flip_boundary(&mut noisy, 0.37, 1).unwrap();
    let (mut boundary, mut flipped) = (0.0, 0.0);
    for (x, y) in (1..199).flat_map(|x| (1..199).map(move |y| (x, y))) {
        let differs = clean.get_pixel(x, y) != noisy.get_pixel(x, y);
        if is_boundary(&clean, x, y) {
            boundary += 1.0;
            flipped += f64::from(u8::from(differs));
        } else {
            assert!(!differs);
        }
    }
    // About 1000 boundary pixels give a standard error of 0.015.
    assert!((flipped / boundary - 0.37f64).abs() < 0.05, "{flipped} of {boundary}");
}

#[test]
fn flips_depend_only_on_seed_and_position() {
    let flips = |seed: u64, centre: f64| {
        let mut mask = disc(centre);
        flip_boundary(&mut mask, 0.37, seed).unwrap();
        let clean = disc(centre);
        let boundary: Vec<_> = (1..199)
            .flat_map(|x| (1..199).map(move |y| (x, y)))
            .filter(|&(x, y)| is_boundary(&clean, x, y))
            .map(|(x, y)| ((x, y), mask.get_pixel(x, y) != clean.get_pixel(x, y)))
            .collect();
        boundary.into_iter().collect::<std::collections::HashMap<_, _>>()
    };
    let (first, moved, other_seed) = (flips(1, 100.0), flips(1, 101.0), flips(2, 100.0));
    assert!(first.iter().all(|(position, flip)| moved.get(position).is_none_or(|other| other == flip)));
    assert!(first != other_seed);
}

#[test]
fn impossible_noise_is_refused() {
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(add_noise(&mut RgbImage::new(2, 2), bad, 0).is_err());
        assert!(flip_boundary(&mut GrayImage::new(2, 2), bad, 0).is_err());
    }
    assert!(flip_boundary(&mut GrayImage::new(2, 2), 1.1, 0).is_err());
}
