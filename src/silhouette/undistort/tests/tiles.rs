//! Masks drawn by tiles compared with masks that `apply` computes pixel by pixel, in every bit and byte that is kept.

use super::super::tile_mask::TileMask;
use super::*;
use crate::camera::{Distortion, Fisheye, Lens};
use crate::silhouette::mask_crop::value_beyond;
use crate::silhouette::{Border, Silhouette};
use ode_visual_hull_random::Random;

/// A camera with a random lens, skew and principal point. Its image has a few pixels on a side, or some hundred that
/// are not a multiple of a tile or a block.
fn random_camera(random: &mut Random, k: u32) -> Camera {
    let size = match k % 8 {
        0 => (1 + random.below(6), 1 + random.below(6)),
        1 => (1 + random.below(300), 1 + random.below(20)),
        2 => (1 + random.below(20), 1 + random.below(300)),
        _ => (16 + random.below(280), 16 + random.below(200)),
    };

    let (width, height) = (f64::from(size.0), f64::from(size.1));
    let focal = random.between(0.5, 1.5) * width.max(height);
    let (u, v) = (width * random.between(0.2, 0.8), height * random.between(0.2, 0.8));

    let k1 = random.between(-0.4, 0.3);
    let small = |random: &mut Random, most: f64| random.between(-most, most);
    let mut coefficients =
        vec![k1, small(random, 0.1), small(random, 0.01), small(random, 0.01), small(random, 0.05)];
    if k.is_multiple_of(2) {
        coefficients.extend([small(random, 0.2), small(random, 0.05), small(random, 0.02)]);
    }
    let (focal, lens) = match k % 5 {
        // With these focal lengths the corners stay below 90 degrees off the axis.
        3 => {
            let k1 = 0.2 * k1.abs();
            (1.5 * focal, Fisheye::from_opencv(&[k1, 0.1 * k1, 0.0, 1e-3]).unwrap().into())
        }
        _ => (focal, Lens::from(Distortion::from_opencv(&coefficients).unwrap())),
    };

    let intrinsics = Matrix3::new(focal, random.between(-2.0, 2.0), u, 0.0, focal * 1.01, v, 0.0, 0.0, 1.0);
    Camera::new("random", size, intrinsics, lens, Isometry3::identity()).unwrap()
}

/// A mask of noise with or without coverage, of single pixels, of all subject but one pixel, of one value, or of a
/// disc.
fn random_mask(random: &mut Random, (width, height): (u32, u32), k: u32) -> GrayImage {
    let pixel = |random: &mut Random| (random.below(width), random.below(height));
    let mut mask = GrayImage::new(width, height);
    match k % 9 {
        0 => mask.iter_mut().for_each(|byte| *byte = random.below(256) as u8),
        1 => mask.iter_mut().for_each(|byte| *byte = 255 * random.below(2) as u8),
        2 => (0..6).for_each(|_| {
            let (x, y) = pixel(random);
            mask.put_pixel(x, y, Luma([random.below(256) as u8]));
        }),
        3 => {
            mask.fill(255);
            let (x, y) = pixel(random);
            mask.put_pixel(x, y, Luma([random.below(128) as u8]));
        }
        4 => mask.fill(random.below(128) as u8),
        5 => {}
        kind => {
            // A disc with a sharp or a soft rim, which often touches the image's border.
            let (x, y) = pixel(random);
            let radius = random.between(0.05, 0.7) * f64::from(width.max(height));
            let softness = if kind == 6 { 0.01 } else { random.between(0.5, 6.0) };
            for (i, j, byte) in mask.enumerate_pixels_mut() {
                let distance = (f64::from(i) - f64::from(x)).hypot(f64::from(j) - f64::from(y));
                byte.0[0] = (127.5 + 127.5 * (radius - distance) / softness).clamp(0.0, 255.0) as u8;
            }
        }
    }
    mask
}

/// Checks that two silhouettes are equal in everything that is kept of the mask.
fn assert_same(drawn: &Silhouette, expected: &Silhouette, what: &str) {
    assert_eq!(drawn.image(), expected.image(), "{what}");
    assert_eq!(drawn.rect(), expected.rect(), "{what}");
    assert_eq!(drawn.border(), expected.border(), "{what}");
    assert_eq!(drawn.has_coverage(), expected.has_coverage(), "{what}");
    assert_eq!(drawn.crop.rect(), expected.crop.rect(), "{what}");
    assert_eq!(drawn.crop.is_open(), expected.crop.is_open(), "{what}");
    assert_eq!(drawn.crop.subject(), expected.crop.subject(), "{what}");
    if !drawn.crop.rect().is_empty() {
        assert_eq!(drawn.crop.subject_and_around(), expected.crop.subject_and_around(), "{what}");
    }
    assert!(drawn.crop.bytes() == expected.crop.bytes(), "{what}");
}

/// Undistorts `mask` by tiles into `silhouette`, in the memory of `tiles`, and compares it with the result of `apply`.
/// Returns 1 if the silhouette has a subject, or else 0.
fn check(
    silhouette: &mut Silhouette,
    tiles: &mut TileMask,
    lens: &Undistortion,
    mask: &GrayImage,
    what: &str,
) -> u32 {
    for border in [Border::Background, Border::Unknown] {
        let is_full = mask.iter().all(|&byte| byte >= 128);
        let is_prepared = silhouette.refill_undistorted(&mask.into(), lens, border, tiles).unwrap();
        assert_eq!(is_prepared, !is_full, "{what}");
        if is_prepared {
            let undistorted = lens.apply(mask, value_beyond(border)).unwrap();
            assert_same(silhouette, &Silhouette::new(&undistorted, border), &format!("{what}, {border:?}"));
        }
    }
    u32::from(!silhouette.rect().is_empty())
}

#[test]
fn masks_drawn_by_tiles_are_those_that_apply_makes_whatever_was_in_their_memory() {
    let mut random = Random(3);
    let (mut silhouette, mut tiles) = (Silhouette::blank(Border::Unknown), TileMask::default());
    let mut filled = 0;

    // Seven cameras for each kind of size, with each kind of mask and border.
    for k in 0..56 {
        let camera = random_camera(&mut random, k);
        let Some(lens) = Undistortion::new(&camera) else { continue };
        for n in 0..9 {
            let mask = random_mask(&mut random, camera.size(), n);
            let what = format!("lens {k} of {:?} and {:?}, mask {n}", camera.size(), camera.lens());
            filled += check(&mut silhouette, &mut tiles, &lens, &mask, &what);
        }
    }
    assert!(filled > 250, "{filled}");
}

#[test]
fn absurd_lenses_are_drawn_as_apply_does() {
    let mut random = Random(4);
    let (mut silhouette, mut tiles) = (Silhouette::blank(Border::Unknown), TileMask::default());
    for size in [(1, 1), (1, 9), (9, 1), (2, 2), (16, 15), (64, 64), (65, 67), (130, 70)] {
        for coefficients in [
            [-0.1, 0.0, 0.0, 0.0],
            [-1e6, 0.0, 0.0, 0.0],
            [1e9, 1e9, 1e3, 1e3],
            [0.0, 0.0, 5.0, 5.0],
            [3.0, 0.0, 0.0, 0.0],
        ] {
            for (focal, axis) in [(3.0, 0.5), (3.0, 1e5), (3.0, -1e5), (40.0, 33.0)] {
                let k = Matrix3::new(focal, 0.0, axis, 0.0, focal, 0.5, 0.0, 0.0, 1.0);
                let distortion = Distortion::from_opencv(&coefficients).unwrap();
                let camera = Camera::new("absurd", size, k, distortion, Isometry3::identity()).unwrap();
                let lens = Undistortion::new(&camera).unwrap();
                for n in 0..9 {
                    let mask = random_mask(&mut random, size, n);
                    let what = format!("{size:?}, {coefficients:?}, axis {axis}, mask {n}");
                    check(&mut silhouette, &mut tiles, &lens, &mask, &what);
                }
            }
        }
    }
}

#[test]
fn a_full_mask_leaves_the_silhouette_as_it_was() {
    let lens = Undistortion::new(&cameras()[0]).unwrap();
    let mut silhouette = Silhouette::new(&lens.apply(&star(), 0).unwrap(), Border::Background);
    let full = GrayImage::from_pixel(SIZE.0, SIZE.1, Luma([128]));
    let mut tiles = TileMask::default();
    assert!(!silhouette.refill_undistorted(&(&full).into(), &lens, Border::Unknown, &mut tiles).unwrap());
    let expected = Silhouette::new(&lens.apply(&star(), 0).unwrap(), Border::Background);
    assert_same(&silhouette, &expected, "after a full mask");
}

#[test]
fn a_mask_of_another_size_is_not_drawn() {
    let lens = Undistortion::new(&cameras()[0]).unwrap();
    let mut silhouette = Silhouette::blank(Border::Background);
    let mask = GrayImage::new(10, 20);
    let result =
        silhouette.refill_undistorted(&(&mask).into(), &lens, Border::Background, &mut TileMask::default());
    assert!(result.unwrap_err().to_string().contains("found 10 x 20"));
}
