//! Distances, flow and warped masks, against plain definitions and known motions.

use super::cell_means::CELL;
use super::distance_image::REACH;
use super::*;
use crate::silhouette::{Border, SUBJECT};
use image::{GrayImage, Luma};
use nalgebra::{Point2, Vector2};
use ode_visual_hull_random::Random;

/// Distances are stored in steps of this, in pixels.
const STEP: f32 = 1.0 / 256.0;

const SIZE: (u32, u32) = (200, 150);

/// A mask with coverage of a shape given by the signed distance of each pixel's centre from its outline.
fn drawn(distance: impl Fn(f64, f64) -> f64) -> GrayImage {
    GrayImage::from_fn(SIZE.0, SIZE.1, |i, j| {
        let distance = distance(f64::from(i) + 0.5, f64::from(j) + 0.5);
        Luma([(127.5 - 255.0 * distance).clamp(0.0, 255.0) as u8])
    })
}

fn disc(x: f64, y: f64, radius: f64) -> GrayImage {
    drawn(|u, v| (u - x).hypot(v - y) - radius)
}

/// Some discs and rectangles at random places, also beyond the image, with or without coverage.
fn random_mask(random: &mut Random, is_binary: bool) -> GrayImage {
    let shapes: Vec<[f64; 4]> = (0..random.below(5) + 1)
        .map(|_| {
            [random.between(0.0, 200.0), random.between(0.0, 150.0), random.between(1.0, 40.0), random.unit()]
        })
        .collect();
    let mut mask = drawn(|u, v| {
        let outside = |[x, y, size, kind]: [f64; 4]| {
            let (x, y) = (u - x, v - y);
            if kind < 0.5 { x.hypot(y) - size } else { (x.abs() - size).max(y.abs() - 0.3 * size) }
        };
        shapes.iter().map(|&shape| outside(shape)).fold(f64::INFINITY, f64::min)
    });
    if is_binary {
        mask.iter_mut().for_each(|byte| *byte = if *byte >= SUBJECT { 255 } else { 0 });
    }
    mask
}

fn distances(mask: &GrayImage) -> Arc<EdgeDistances> {
    let mut distances = EdgeDistances::default();
    distances.fill(&Silhouette::new(mask, Border::Background));
    Arc::new(distances)
}

fn motion(earlier: &GrayImage, later: &GrayImage) -> MaskMotion {
    let mut motion = MaskMotion::default();
    motion.fill(distances(earlier), distances(later));
    motion
}

fn warped(motion: &MaskMotion, s: f64) -> GrayImage {
    motion.warp(s, SIZE, &mut WarpedMask::default()).to_mask()
}

/// Centre of mass and area of a mask.
fn moments(mask: &GrayImage) -> (Point2<f64>, f64) {
    let (mut sum, mut area) = (Vector2::zeros(), 0.0);
    for (i, j, Luma([byte])) in mask.enumerate_pixels() {
        let part = f64::from(*byte) / 255.0;
        sum += Vector2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * part;
        area += part;
    }
    (Point2::from(sum / area), area)
}

#[test]
fn distances_within_reach_are_the_exact_signed_distances_of_the_mask_continued_beyond_the_image() {
    let mut random = Random(3);
    for _ in 0..20 {
        let mask = random_mask(&mut random, true);
        // The continued mask, as a larger image.
        let pad = REACH as u32 + 1;
        let continued = GrayImage::from_fn(SIZE.0 + 2 * pad, SIZE.1 + 2 * pad, |i, j| {
            let clamp = |x: u32, end: u32| x.saturating_sub(pad).min(end - 1);
            *mask.get_pixel(clamp(i, SIZE.0), clamp(j, SIZE.1))
        });
        let exact = Silhouette::new(&continued, Border::Unknown);
        let exact = exact.signed_distance(&exact.image());

        let found = distances(&mask);
        for j in 0..SIZE.1 {
            for i in 0..SIZE.0 {
                let reach = REACH as f32;
                let expected = exact.at((i + pad) as i32, (j + pad) as i32).clamp(-reach, reach);
                let found = found.0.sample(i as f32 + 0.5, j as f32 + 0.5);
                // Beyond the rectangle that is kept, positions are moved to its border.
                let are_far = found.min(expected) >= reach - 0.5;
                let is_equal = (found - expected).abs() <= STEP;
                assert!(is_equal || are_far, "({i}, {j}): {found}, expected {expected}");
            }
        }
    }
}

#[test]
fn beside_the_edge_coverage_tells_the_distance() {
    let found = distances(&drawn(|u, _| u - 100.3));
    // The row's edge lies at 100.3: bytes hold steps of 1/255, and distances steps of 1/64.
    for (u, expected) in [(99.5, -0.5), (100.5, 0.2), (101.5, 1.2)] {
        let found = found.0.sample(u, 70.5);
        assert!((found - expected).abs() <= 0.31, "{u}: {found}, expected {expected}");
    }
    assert!((found.0.sample(100.5, 70.5) - 0.2).abs() <= STEP + 1.0 / 255.0);
}

#[test]
fn the_flow_of_a_disc_leads_back_by_its_motion() {
    for (right, down) in [(0.0, 0.0), (3.3, -1.2), (12.0, 5.0), (-25.0, 10.0), (-50.0, 20.0)] {
        let motion = motion(&disc(100.0 - right, 75.0 - down, 20.0), &disc(100.0, 75.0, 20.0));
        for angle in 0..16 {
            let (sin, cos) = (f64::from(angle) * std::f64::consts::TAU / 16.0).sin_cos();
            let [x, y] = motion.flow.between().at((100.0 + 20.0 * cos) as f32, (75.0 + 20.0 * sin) as f32);
            // Along the normal, which is all that an outline shows, to a tenth of a cell.
            let error = (f64::from(x) + right) * cos + (f64::from(y) + down) * sin;
            assert!(error.abs() < 0.1 * f64::from(CELL), "({right}, {down}) at {angle}: {error}");
        }
    }
}

#[test]
fn at_its_ends_a_motion_shows_the_two_masks() {
    let mut random = Random(5);
    for k in 0..30 {
        let [earlier, later] = [(); 2].map(|()| random_mask(&mut random, k % 2 == 0));
        let motion = motion(&earlier, &later);
        for (s, mask) in [(0.0, &earlier), (1.0, &later)] {
            for (found, expected) in warped(&motion, s).iter().zip(mask.iter()) {
                // Distances hold steps of 1/256 pixel, as bytes do. Coverage of pixels that have no neighbour of the other
                // kind is lost.
                let is_close = (i32::from(*found) - i32::from(*expected)).abs() <= 1;
                let is_equal_bit = (*found >= SUBJECT) == (*expected >= SUBJECT);
                assert!(is_equal_bit, "{s}: {found}, expected {expected}");
                assert!(is_close || k % 2 == 1, "{s}: {found}, expected {expected}");
            }
        }
    }
}

#[test]
fn deciding_cells_as_a_whole_changes_no_pixel_where_the_subject_moves_as_a_whole() {
    let mut random = Random(7);
    for _ in 0..30 {
        let (x, y) = (random.between(60.0, 140.0), random.between(50.0, 100.0));
        let (right, down) = (random.between(-12.0, 12.0), random.between(-12.0, 12.0));
        let (half_width, half_height) = (random.between(3.0, 40.0), random.between(3.0, 30.0));
        // A rectangle with a disc, so that there are straight edges, corners and curves.
        let at = |x: f64, y: f64| {
            drawn(|u, v| {
                let rectangle = ((u - x).abs() - half_width).max((v - y).abs() - half_height);
                rectangle.min((u - x - half_width).hypot(v - y) - 12.0)
            })
        };
        let motion = motion(&at(x, y), &at(x + right, y + down));
        for s in [0.25, 0.5, 0.9] {
            let mut memory = WarpedMask::default();
            memory.scratch.more_spread = f32::INFINITY;
            let one_by_one = motion.warp(s, SIZE, &mut memory).to_mask();
            assert!(warped(&motion, s) == one_by_one, "{s}");
        }
    }
}

#[test]
fn a_disc_keeps_its_size_and_moves_steadily_between_two_masks_and_beyond() {
    // Two own widths a mask.
    let (from, to, radius) = (Point2::new(50.0, 60.0), Point2::new(86.0, 78.0), 10.0);
    let motion = motion(&disc(from.x, from.y, radius), &disc(to.x, to.y, radius));
    for s in [0.1, 0.3, 0.5, 0.8, 1.3, 2.0] {
        let (centre, area) = moments(&warped(&motion, s));
        let expected = from + (to - from) * s;
        // Half a cell, of a motion of ten; beyond the second mask, errors of the flow add up.
        assert!((centre - expected).norm() < 1.0 + (s - 1.0).max(0.0), "{s}: {centre}, expected {expected}");
        let whole = std::f64::consts::PI * radius * radius;
        assert!((area / whole - 1.0).abs() < 0.1, "{s}: {area} of {whole}");
    }
}

#[test]
fn an_edge_moves_along_its_normal_as_fast_as_the_subject() {
    let at = |frame: f64| Point2::new(80.0 + 7.0 * frame, 75.0 - 3.0 * frame);
    let masks: Vec<GrayImage> = (0..4).map(|k| disc(at(f64::from(k)).x, at(f64::from(k)).y, 25.0)).collect();
    let motions = masks.windows(2).rev().map(|two| Arc::new(motion(&two[0], &two[1]))).collect();
    let chain = MotionChain::new(motions, 0.3, 0.1);

    // Half a frame before the last mask.
    let centre = at(2.5);
    for angle in 0..16 {
        let (sin, cos) = (f64::from(angle) * std::f64::consts::TAU / 16.0).sin_cos();
        let normal = Vector2::new(cos, sin);
        let shift = chain.edge_shift(&(centre + normal * 25.0), 0.5).expect("an edge");
        let speed = Vector2::new(70.0, -30.0).dot(&normal);
        // A twentieth of a pixel over 0.3 s, twice, and the curvature of the disc where the flow is not exact.
        assert!((shift.speed - speed).abs() < 2.5, "{angle}: {} px/s, expected {speed}", shift.speed);
        assert!(shift.normal.dot(&normal) > 0.99, "{angle}");
    }
    assert!(chain.edge_shift(&Point2::new(10.0, 10.0), 0.5).is_none(), "there is no edge");
}

#[test]
fn the_speed_of_an_edge_is_that_of_now_and_an_edge_that_starts_at_once_does_not_seem_faster() {
    // Places along x in frames of a tenth of a second, and the speed a quarter of a frame before the last mask.
    let accelerated = |frame: f64| 60.0 + 1.5 * frame * frame;
    let started = |frame: f64| 70.0 + 8.0 * (frame - 2.0).max(0.0);
    type Place<'f> = &'f dyn Fn(f64) -> f64;
    let cases: [(Place, f64); 2] = [(&accelerated, 10.0 * 3.0 * 2.75), (&started, 80.0)];
    for (place, expected) in cases {
        let masks: Vec<GrayImage> = (0..4).map(|k| disc(place(f64::from(k)), 75.0, 25.0)).collect();
        let motions = masks.windows(2).rev().map(|two| Arc::new(motion(&two[0], &two[1]))).collect();
        let chain = MotionChain::new(motions, 0.3, 0.1);
        let centre = Point2::new(0.75 * place(3.0) + 0.25 * place(2.0), 75.0);
        for (side, sign) in [(25.0, 1.0), (-25.0, -1.0)] {
            let shift = chain.edge_shift(&(centre + Vector2::x() * side), 0.25).expect("an edge");
            // A twentieth of a pixel over 0.1 s, four times.
            let found = sign * (shift.speed + shift.gained);
            assert!((found - expected).abs() < 2.5, "{found} px/s, expected {expected}");
        }
    }
}

#[test]
fn an_empty_mask_moves_nowhere() {
    let (nothing, something) = (GrayImage::new(SIZE.0, SIZE.1), disc(100.0, 75.0, 20.0));
    let both = motion(&nothing, &nothing);
    assert_eq!(moments(&warped(&both, 0.5)).1, 0.0);
    let area = moments(&something).1;
    for (earlier, later, areas) in [(&nothing, &something, [0.0, area]), (&something, &nothing, [area, 0.0])]
    {
        let motion = motion(earlier, later);
        assert_eq!(motion.flow.longest(), 0.0);
        for (s, expected) in [(0.0, areas[0]), (1.0, areas[1]), (2.0, areas[1])] {
            // Pixels of coverage lose less than a byte's step each.
            assert!((moments(&warped(&motion, s)).1 - expected).abs() < 1.0, "{s}");
        }
    }
}

#[test]
fn reused_memory_gives_equal_masks() {
    let mut random = Random(11);
    let (mut reused, mut memory) = (MaskMotion::default(), WarpedMask::default());
    for k in 0..20 {
        let [earlier, later] = [(); 2].map(|()| random_mask(&mut random, k % 2 == 0));
        reused.fill(distances(&earlier), distances(&later));
        let found = reused.warp(0.4, SIZE, &mut memory).to_mask();
        assert_eq!(found, warped(&motion(&earlier, &later), 0.4));
    }
}

#[test]
fn a_thin_rod_is_followed_over_several_of_its_widths() {
    // Half the width and half the length of the rod, in pixels; the sides' slopes do not reach from one rod to the other.
    for (half_width, half_length) in [(6.25, 75.0), (6.25, 30.0), (3.0, 50.0)] {
        for way in [10.0, 17.0, 25.0, 33.0, 42.0, 50.0, 60.0] {
            let rod = |x: f64| {
                drawn(|u, v| {
                    let (across, along) = (u - x, ((v - 75.0).abs() - half_length).max(0.0));
                    across.hypot(along) - half_width
                })
            };
            let motion = motion(&rod(100.0 - 0.5 * way), &rod(100.0 + 0.5 * way));
            for s in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let (expected, area) = moments(&rod(100.0 + way * (s - 0.5)));
                let (found, found_area) = moments(&warped(&motion, s));
                // A tenth of a pixel for smoothing; the ridge of a rod's distances is rounded off by up to half a pixel.
                assert!((found - expected).norm() < 0.1, "{way} px, at {s}: {found}, expected {expected}");
                assert!((found_area / area - 1.0).abs() < 0.1, "{way} px, at {s}: {found_area}, of {area}");
            }
        }
    }
}
