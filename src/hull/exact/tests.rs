//! Many points at once against the single queries: the same bits.

use super::super::tests::{POLICIES, Random, bounds, cameras, hull};
use super::super::{Aabb, Unseen, View};
use super::*;
use crate::silhouette::{Border, Silhouette};
use image::{GrayImage, Luma};
use nalgebra::{point, vector};
use std::sync::Arc;

/// Hulls with and without coverage, and of masks full of specks and holes, some of them up to the image's border.
fn hulls() -> Vec<Hull> {
    let plain = POLICIES.into_iter().flat_map(|unseen| [1, 4].map(|samples| hull(unseen, samples)));
    let specked = [false, true].map(|coverage| {
        let mut random = Random(3);
        let view = |camera: crate::camera::Camera| {
            let mask = specks(&mut random, coverage);
            View::new(Arc::new(camera), Arc::new(Silhouette::new(&mask, Border::Background)), None)
        };
        Hull::new(cameras().into_iter().map(view).collect(), bounds(), Unseen::Outside, 0.0)
    });
    plain.chain(specked).collect()
}

fn specks(random: &mut Random, coverage: bool) -> GrayImage {
    let holes: Vec<_> = (0..30).map(|_| [160.0, 120.0, 7.0].map(|most| most * random.unit())).collect();
    GrayImage::from_fn(160, 120, |i, j| {
        let hole = holes.iter().any(|[x, y, r]| (f64::from(i) - x).hypot(f64::from(j) - y) < *r);
        let grey = if coverage { (220.0 * random.unit()) as u8 } else { 0 };
        Luma([if hole { grey } else { 255 }])
    })
}

fn points(hull: &Hull, count: usize) -> Vec<Point3<f64>> {
    let mut random = Random(7);
    (0..count).map(|_| random.point(&hull.aabb().grown(0.02))).collect()
}

#[test]
fn many_ways_out_have_the_bits_of_single_ones() {
    let (mut memory, mut ways) = (Memory::default(), Vec::new());
    for (n, hull) in hulls().iter().enumerate() {
        let points = points(hull, 3001);
        hull.ways_out_of(&points, usize::MAX, &mut memory, &mut ways);
        let mut found = ways.iter();
        for (place, &point) in points.iter().enumerate() {
            let Some((view, direction)) = hull.way_out(&point) else { continue };
            let single = Start { point, direction, view };
            assert_eq!(found.next(), Some(&(place, single)), "hull {n}, {point}");
            assert_eq!(hull.push(&single.point).map(|push| push.direction), Some(direction));
        }
        assert!(found.next().is_none() && ways.len() > 200, "hull {n}: {}", ways.len());
    }
}

#[test]
fn the_first_few_ways_out_are_the_first_of_all() {
    let (mut memory, mut all, mut few) = (Memory::default(), Vec::new(), Vec::new());
    for hull in hulls() {
        let points = points(&hull, 1003);
        hull.ways_out_of(&points, usize::MAX, &mut memory, &mut all);
        for most in [0, 1, 7, 40] {
            hull.ways_out_of(&points, most, &mut memory, &mut few);
            assert!(few.len() >= most && few.len() < most + LANES && all.starts_with(&few));
        }
    }
}

#[test]
fn many_exits_have_the_bits_of_single_ones() {
    let (mut memory, mut ways, mut exits) = (Memory::default(), Vec::new(), Vec::new());
    let mut random = Random(9);
    for (n, hull) in hulls().iter().enumerate() {
        hull.ways_out_of(&points(hull, 1003), usize::MAX, &mut memory, &mut ways);
        let ball = Aabb { min: point![-1.0, -1.0, -1.0], max: point![1.0, 1.0, 1.0] };
        let mut directions: Vec<_> = (0..6).map(|_| random.point(&ball).coords.normalize()).collect();
        directions.extend([Vector3::x(), -Vector3::y(), Vector3::z(), vector![0.6, 0.0, -0.8]]);
        for direction in directions {
            let starts: Vec<_> = ways.iter().map(|(_, start)| Start { direction, ..*start }).collect();
            for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
                for most in [f64::INFINITY, 0.05] {
                    hull.exits_within(&starts, edge, most, &mut memory, &mut exits);
                    assert_eq!(exits.len(), starts.len());
                    for (exit, start) in exits.iter().zip(&starts) {
                        let single = hull.exit_within(&start.point, &direction, edge, most);
                        assert_eq!(*exit, single, "hull {n}, {edge:?}, {most}, {}", start.point);
                    }
                }
            }
        }
    }
}

#[test]
fn what_surely_leaves_before_has_a_shorter_exit() {
    let (mut memory, mut ways, mut random) = (Memory::default(), Vec::new(), Random(11));
    for hull in hulls().iter().filter(|hull| hull.every_view_tells()) {
        hull.ways_out_of(&points(hull, 1003), usize::MAX, &mut memory, &mut ways);
        for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
            let (mut sure, mut shorter) = (0, 0);
            for (_, start) in &ways {
                // A little off, as a cluster's direction is.
                let direction = (start.direction + vector![0.05, -0.1, 0.1]).normalize();
                let start = Start { direction, ..*start };
                let t = 0.2 * random.unit();
                let exit = hull.exit_within(&start.point, &direction, edge, f64::INFINITY);
                let surely = hull.surely_leaves_before(&start, edge, t);
                assert!(!surely || exit < t, "{} {exit} {t}", start.point);
                (sure, shorter) = (sure + usize::from(surely), shorter + usize::from(exit < t));
            }
            assert!(5 * sure > shorter, "{sure} of {shorter}");
        }
    }
}
