//! Every table compared with its definition, pixel by pixel, for random masks of many sizes.

use super::super::{Border, Rect, SUBJECT, Silhouette, contact_edge};
use image::{GrayImage, Luma};
use ode_visual_hull_random::Random;

/// Masks of a few rectangles, some with holes, which touch any border of the image. Every third mask has coverage.
fn masks() -> impl Iterator<Item = (GrayImage, Border)> {
    let mut random = Random(5);
    (0..160).map(move |k| {
        // All widths modulo the bits of a word, and widths below that of a block.
        let (width, height) = (1 + k, 1 + random.below(60));
        let mut mask = GrayImage::new(width, height);

        for n in 0..random.below(5) {
            let (x0, y0) = (random.below(width), random.below(height));
            let (x1, y1) = (x0 + 1 + random.below(width), y0 + 1 + random.below(height));
            let value = if n == 2 { 0 } else { 255 };
            for (x, y) in (y0..y1.min(height)).flat_map(|y| (x0..x1.min(width)).map(move |x| (x, y))) {
                mask.put_pixel(x, y, Luma([value]));
            }
        }

        if k % 3 == 0 {
            for _ in 0..random.below(width * height) {
                let (x, y) = (random.below(width), random.below(height));
                mask.put_pixel(x, y, Luma([random.below(256) as u8]));
            }
        }

        (mask, if random.below(2) == 0 { Border::Background } else { Border::Unknown })
    })
}

/// The definitions of a silhouette's values, from its mask and border.
struct Plain<'a>(&'a GrayImage, Border);

impl Plain<'_> {
    /// The byte of a pixel, also beyond the image.
    fn value(&self, i: i32, j: i32) -> u8 {
        let inside = i >= 0 && j >= 0 && i < self.0.width() as i32 && j < self.0.height() as i32;
        match self.1 {
            _ if inside => self.0.get_pixel(i as u32, j as u32)[0],
            Border::Background => 0,
            Border::Unknown => 255,
        }
    }

    fn is_subject(&self, i: i32, j: i32) -> bool {
        self.value(i, j) >= SUBJECT
    }

    fn any_subject(&self, rect: &Rect) -> bool {
        pixels(rect).any(|(i, j)| self.is_subject(i, j))
    }

    /// The Chebyshev distance to background, by growing a window until it holds background.
    fn distance(&self, i: i32, j: i32) -> u16 {
        let end = (self.0.width() + self.0.height()) as i32;
        let has_background =
            |&half: &i32| pixels(&Rect::window(i, j, half)).any(|(x, y)| !self.is_subject(x, y));
        (0..end).find(has_background).map_or(u16::MAX, |half| half as u16)
    }
}

fn pixels(rect: &Rect) -> impl Iterator<Item = (i32, i32)> + use<> {
    let Rect { x0, y0, x1, y1 } = *rect;
    (y0..y1).flat_map(move |j| (x0..x1).map(move |i| (i, j)))
}

#[test]
fn every_table_matches_its_definition_for_every_mask_in_reused_memory() {
    let mut s = Silhouette::blank(Border::Background);
    let mut subject = 0;
    for (mask, border) in masks() {
        s.refill(&mask, border);
        let plain = Plain(&mask, border);
        let image = Rect::of_image(mask.width(), mask.height());
        assert_eq!(s.image(), image);

        let mut rect = Rect { x0: i32::MAX, y0: i32::MAX, x1: 0, y1: 0 };
        for (i, j) in pixels(&image).filter(|&(i, j)| plain.is_subject(i, j)) {
            rect = Rect {
                x0: rect.x0.min(i),
                y0: rect.y0.min(j),
                x1: rect.x1.max(i + 1),
                y1: rect.y1.max(j + 1),
            };
            subject += 1;
        }
        assert_eq!(s.rect(), if rect.is_empty() { Rect::EMPTY } else { rect });
        assert_eq!(s.has_coverage(), mask.iter().any(|byte| (1..255).contains(byte)));

        // Eight pixels around the subject are kept; bytes farther out count as background.
        for (i, j) in pixels(&image.grown(3)) {
            let is_kept = rect.grown(8).contains(i, j) || !image.contains(i, j);
            assert_eq!(s.value(i, j), if is_kept { plain.value(i, j) } else { 0 }, "{image:?} ({i}, {j})");
            assert_eq!(s.is_subject(i, j), plain.is_subject(i, j));
        }

        for (i, j) in pixels(&image) {
            assert_eq!(s.distance(i, j), plain.distance(i, j), "{image:?} {border:?} ({i}, {j})");
        }

        check_bits(&s, &plain);
        check_edges(&s, &plain);
        check_occupancy(&s, &plain);
    }

    // Enough of the masks' pixels were subject.
    assert!(subject > 80_000, "{subject}");
}

/// Compares the slices of bits and distances. Pixels beyond an unknown border are left out: their bits do not matter.
fn check_bits(s: &Silhouette, plain: &Plain) {
    let (tables, image) = (s.tables(), s.image());
    let bit = |table: &[u32], x: usize, y: usize| table[y * tables.words + x / 32] >> (x % 32) & 1 == 1;
    for (x, y) in (0..tables.height).flat_map(|y| (0..tables.width).map(move |x| (x, y))) {
        let (i, j) = (tables.corner.0 + x as i32, tables.corner.1 + y as i32);
        if s.border() == Border::Unknown && !image.contains(i, j) {
            continue;
        }

        let around = Rect { x0: i - 1, y0: j - 1, x1: i + 2, y1: j + 2 };
        assert_eq!(bit(tables.subject, x, y), plain.is_subject(i, j));
        if s.border() == Border::Background {
            assert_eq!(bit(tables.dilated, x, y), plain.any_subject(&around), "{image:?} ({i}, {j})");
        } else {
            // Extra bits along an unknown border are allowed.
            assert!(bit(tables.dilated, x, y) || !plain.any_subject(&around.intersection(&image)));
        }

        let index = y * tables.width + x;
        let distance = tables.distance_words[index / 4].to_ne_bytes()[index % 4];
        assert_eq!(u16::from(distance), s.distance(i, j).min(255));
    }

    assert_eq!(tables.subject.len(), tables.words * tables.height);
    assert_eq!(tables.dilated.len(), tables.words * tables.height);
}

/// Compares the edge pixels with their definition, and remembered edges with computed ones.
fn check_edges(s: &Silhouette, plain: &Plain) {
    let image = s.image();
    let subject = |(i, j): (i32, i32)| image.contains(i, j) && plain.is_subject(i, j);
    let is_edge = |&(i, j): &(i32, i32)| {
        !plain.is_subject(i, j) && [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)].into_iter().any(subject)
    };
    assert!(s.edge_pixels().eq(pixels(&image.grown(1)).filter(is_edge)));
    for (i, j) in s.edge_pixels() {
        let edge = contact_edge::at(s, (i, j));
        assert_eq!(s.edge(i, j), edge);
        assert_eq!(s.edge(i, j), edge, "second query");
    }
}

/// Compares the occupancy of each tile with its pixels.
fn check_occupancy(s: &Silhouette, plain: &Plain) {
    let (tables, tile) = (s.tables(), 8);
    let (lookup, corner) = (tables.occupancy.lookup(), tables.corner);
    for y in 0..tables.height.div_ceil(tile) {
        for x in 0..tables.width / tile {
            let (x, y) = ((x * tile) as u32, (y * tile) as u32);
            let (i, j) = (corner.0 + x as i32, corner.1 + y as i32);
            let pixels = Rect { x0: i, y0: j, x1: i + 8, y1: (j + 8).min(corner.1 + tables.height as i32) };
            assert_eq!(lookup.any_occupied([x, y], [x + 1, y + 1]), plain.any_subject(&pixels));
        }
    }
}

#[test]
fn distances_of_large_masks_equal_those_of_a_raster_scan_pixel_by_pixel() {
    // With this seed two of the masks have distances that exceed a byte.
    let mut random = Random(12);
    let mut s = Silhouette::blank(Border::Background);
    let mut deepest = 0;
    for k in 0..12 {
        let (width, height) = (200 + random.below(500), 300 + random.below(400));
        let mut mask = GrayImage::new(width, height);

        // A union of random ellipses.
        for _ in 0..1 + random.below(9) {
            let centre = [random.below(width), random.below(height)].map(f64::from);
            let half = [1 + random.below(320), 1 + random.below(320)].map(f64::from);
            for (x, y, pixel) in mask.enumerate_pixels_mut() {
                let (dx, dy) = ((f64::from(x) - centre[0]) / half[0], (f64::from(y) - centre[1]) / half[1]);
                if dx.hypot(dy) < 1.0 {
                    *pixel = Luma([255]);
                }
            }
        }

        let border = if k % 4 == 3 { Border::Unknown } else { Border::Background };
        s.refill(&mask, border);
        let expected = raster_scan(&Plain(&mask, border));
        for (i, j) in pixels(&s.image()) {
            let distance = expected[j as usize + 1][i as usize + 1];
            assert_eq!(s.distance(i, j), distance, "{width} x {height} {border:?} ({i}, {j})");
            deepest = deepest.max(distance);
        }
    }

    // Some distances exceed a byte.
    assert!(deepest > 255, "{deepest}");
}

/// Distances pixel by pixel: from the four neighbours that precede a pixel in row-major order, then from the four that
/// follow it. The table has a rim of one pixel beyond the image.
fn raster_scan(plain: &Plain) -> Vec<Vec<u16>> {
    let (width, height) = (plain.0.width() as usize + 2, plain.0.height() as usize + 2);
    let start = |x: usize, y: usize| if plain.is_subject(x as i32 - 1, y as i32 - 1) { u16::MAX } else { 0 };
    let mut table: Vec<Vec<_>> = (0..height).map(|y| (0..width).map(|x| start(x, y)).collect()).collect();

    let mut update = |x: usize, y: usize, sign: isize| {
        for (dx, dy) in [(-1, 0), (-1, -1), (0, -1), (1, -1)] {
            let at = |k: usize, step: isize| k.wrapping_add_signed(sign * step);
            let neighbour =
                table.get(at(y, dy)).and_then(|row| row.get(at(x, dx))).copied().unwrap_or(u16::MAX);
            table[y][x] = table[y][x].min(neighbour.saturating_add(1));
        }
    };

    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        update(x, y, 1);
    }
    for (y, x) in (0..height).rev().flat_map(|y| (0..width).rev().map(move |x| (y, x))) {
        update(x, y, -1);
    }
    table
}
