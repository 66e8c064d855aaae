use super::*;
use crate::segment::morphology::StructuringElement;
use crate::synthetic::{Subject, coverage, flip_boundary, layout};
use image::Luma;
use imageproc::region_labelling::{Connectivity, connected_components};
use nalgebra::Point3;

/// A person's mask with a ragged outline, holes and specks; its width is not a multiple of a word.
fn ragged(seed: u64) -> GrayImage {
    let target = Point3::new(0.0, 0.0, 0.9);
    let camera = &layout::ring(1, 3.0, 0.9, target, (201, 147), 0.9).unwrap()[0];
    let mut mask = coverage(camera, &Subject::person_at(0.1 * seed as f64));
    mask.iter_mut().for_each(|value| *value = if *value >= 128 { 255 } else { 0 });
    for k in 0..8 {
        flip_boundary(&mut mask, 0.4, 10 * seed + k).unwrap();
    }
    for k in 0..90u64 {
        let index = (k.wrapping_mul(2654435761) ^ (seed * 977)) % (201 * 147);
        let (x, y) = ((index % 201) as u32, (index / 201) as u32);
        let value = 255 - mask.get_pixel(x, y).0[0];
        mask.put_pixel(x, y, Luma([value]));
    }
    mask
}

fn to_bits(mask: &GrayImage) -> BitImage {
    PackedMask::new(mask).subject().clone()
}

fn mask_of(bits: &BitImage) -> GrayImage {
    let mut mask = PackedMask::default();
    mask.take_bits(bits, |_| ());
    mask.to_mask()
}

/// Inverts regions of the value `kind`, found by imageproc, for which `wanted(area, at_border, largest_area)` is true.
fn inverted_regions(
    mask: &GrayImage,
    kind: u8,
    connectivity: Connectivity,
    wanted: impl Fn(u32, bool, u32) -> bool,
) -> GrayImage {
    let labels = connected_components(mask, connectivity, Luma([255 - kind]));
    let count = labels.iter().max().map_or(0, |&last| last as usize) + 1;

    let (mut areas, mut at_border) = (vec![0u32; count], vec![false; count]);
    for (x, y, label) in labels.enumerate_pixels() {
        let label = label.0[0] as usize;
        areas[label] += 1;
        at_border[label] |= x == 0 || y == 0 || x + 1 == mask.width() || y + 1 == mask.height();
    }

    let largest = areas.iter().skip(1).copied().max().unwrap_or(0);
    let mut mask = mask.clone();
    for (value, &label) in mask.iter_mut().zip(labels.iter()) {
        let label = label as usize;
        if label != 0 && wanted(areas[label], at_border[label], largest) {
            *value = 255 - kind;
        }
    }
    mask
}

#[test]
fn converting_to_bits_and_back_keeps_the_mask() {
    for mask in [ragged(1), ragged(2), GrayImage::from_pixel(64, 3, Luma([255]))] {
        assert_eq!(mask_of(&to_bits(&mask)), mask);
    }
}

#[test]
fn regions_equal_those_of_an_independent_labelling() {
    for seed in 0..6 {
        let mask = ragged(seed);
        let mut bits = to_bits(&mask);

        let mut regions = Regions::default();
        regions.drop_small(&mut bits, 7, 0.001);
        let small = |area: u32, _, largest: u32| f64::from(area) < f64::max(7.0, 0.001 * f64::from(largest));
        assert_eq!(
            mask_of(&bits),
            inverted_regions(&mask, 255, Connectivity::Eight, small),
            "specks, seed {seed}"
        );

        let mut bits = to_bits(&mask);
        regions.fill_holes(&mut bits, 9);
        let hole = |area: u32, at_border: bool, _| area < 9 && !at_border;
        assert_eq!(
            mask_of(&bits),
            inverted_regions(&mask, 0, Connectivity::Four, hole),
            "holes, seed {seed}"
        );
    }
}

#[test]
fn a_step_equals_its_definition_by_neighbours() {
    let mask = ragged(3);
    for (shape, inverted) in [
        (StructuringElement::Cross, false),
        (StructuringElement::Square, false),
        (StructuringElement::Cross, true),
        (StructuringElement::Square, true),
    ] {
        let mut bits = to_bits(&mask);
        Morphology::default().step(&mut bits, shape, inverted);

        let is_subject = |x: i64, y: i64| {
            let inside = (0..201).contains(&x) && (0..147).contains(&y);
            if inside { mask.get_pixel(x as u32, y as u32).0[0] == 255 } else { inverted }
        };

        let expected = GrayImage::from_fn(201, 147, |x, y| {
            let around = (-1i64..=1).flat_map(|dy| (-1i64..=1).map(move |dx| (dx, dy)));
            let mut around = around.filter(|(dx, dy)| shape == StructuringElement::Square || dx * dy == 0);
            let at = |(dx, dy): (i64, i64)| is_subject(i64::from(x) + dx, i64::from(y) + dy);
            Luma([if if inverted { around.all(at) } else { around.any(at) } { 255 } else { 0 }])
        });
        assert_eq!(mask_of(&bits), expected, "{shape:?}, inverted {inverted}");
    }
}

#[test]
fn specks_and_holes_are_removed_by_their_area() {
    let mut mask = GrayImage::new(60, 60);
    let mut paint = |left: u32, top: u32, size: u32, value: u8| {
        for (x, y) in (left..left + size).flat_map(|x| (top..top + size).map(move |y| (x, y))) {
            mask.put_pixel(x, y, Luma([value]));
        }
    };

    paint(20, 20, 30, 255);
    paint(2, 2, 3, 255); // a speck of 9
    paint(22, 22, 3, 0); // a hole of 9
    paint(35, 35, 8, 0); // a hole of 64
    let at =
        |mask: &GrayImage| [(30, 30), (3, 3), (23, 23), (38, 38)].map(|(x, y)| mask.get_pixel(x, y).0[0]);

    let cleaned = |area_px: u32| {
        let (smallest_region_px, smallest_hole_px) = (area_px, area_px);
        let mut mask = mask.clone();
        Cleanup { smallest_region_px, smallest_hole_px, ..Cleanup::NONE }.apply(&mut mask).unwrap();
        at(&mask)
    };

    assert_eq!(cleaned(10), [255, 0, 255, 0]);
    assert_eq!(cleaned(9), [255, 255, 0, 0], "regions of exactly that area stay");

    let mut largest = mask.clone();
    Cleanup { smallest_region_share: 1.0, ..Cleanup::NONE }.apply(&mut largest).unwrap();
    assert_eq!(at(&largest), [255, 0, 0, 0], "only the largest region");
}

#[test]
fn pixels_that_keep_their_side_keep_their_coverage() {
    let mut mask = GrayImage::from_fn(40, 40, |x, _| Luma([if x < 20 { 255 } else { 90 }]));
    let before = mask.clone();
    Cleanup::default().apply(&mut mask).unwrap();
    assert_eq!(mask, before);
}
