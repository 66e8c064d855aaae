//! Many points at once against the single queries: the same bits, for views of every kind.

use super::super::tests::{POLICIES, Random, bounds, cameras, hull, mask};
use super::super::{Aabb, HullData, Unseen, View, reference};
use super::*;
use crate::camera::{Camera, Fisheye};
use crate::silhouette::{Border, Silhouette};
use image::{GrayImage, Luma};
use nalgebra::{Matrix3, point, vector};
use std::sync::{Arc, LazyLock};

/// What a hull's views are like.
#[derive(Debug, Clone, Copy)]
struct Kind {
    unseen: Unseen,
    coverage: bool,
    /// Whether lenses see a disc of the image alone.
    has_lenses: bool,
    /// Whether one view is taken out, one has no lens, and one no coverage.
    is_mixed: bool,
}

/// Hulls with and without coverage, by pinholes and by fisheyes; and of masks full of specks and holes, some of them up
/// to the image's border, by both policies, with and without lenses. Drawn once for all tests.
fn hulls() -> &'static [Hull] {
    static HULLS: LazyLock<Vec<Hull>> = LazyLock::new(draw_hulls);
    &HULLS
}

fn draw_hulls() -> Vec<Hull> {
    let plain = POLICIES.into_iter().flat_map(|unseen| [1, 4].map(|samples| hull(unseen, samples)));
    let both = [false, true];
    let kinds = POLICIES.into_iter().flat_map(|unseen| {
        both.into_iter().flat_map(move |coverage| {
            both.into_iter().flat_map(move |has_lenses| {
                both.map(|is_mixed| Kind { unseen, coverage, has_lenses, is_mixed })
            })
        })
    });
    let fisheyes =
        POLICIES.into_iter().flat_map(|unseen| [1, 4].map(|samples| through_fisheyes(unseen, samples)));
    plain.chain(kinds.map(specked)).chain(fisheyes).collect()
}

/// The hull of cameras with fisheye lenses. In some of their images the subject is near a border, which cuts it off;
/// the corner on the other side is up to 83 degrees from the axis.
fn through_fisheyes(unseen: Unseen, samples: u32) -> Hull {
    let lens = Fisheye::from_opencv(&[0.01, -0.004, 5e-4, -2e-5]).unwrap();
    let data = HullData::new();
    data.set_bounds(bounds()).unwrap();
    data.set_unseen(unseen).unwrap();
    for (k, camera) in cameras().iter().enumerate() {
        let cx = 80.0 + [0.0, 65.0, -65.0][k % 3];
        let intrinsics = Matrix3::new(110.0, 0.0, cx, 0.0, 110.0, 60.0, 0.0, 0.0, 1.0);
        let camera =
            Camera::new(camera.name(), (160, 120), intrinsics, lens, *camera.cam_from_world()).unwrap();
        let mask = mask(&camera, samples);
        let view = data.add_view(camera).unwrap();
        data.set_mask(view, &mask).unwrap();
    }
    Hull::clone(&data.update(0.0).unwrap())
}

/// A hull whose views see specks.
fn specked(Kind { unseen, coverage, has_lenses, is_mixed }: Kind) -> Hull {
    let border = if unseen == Unseen::Outside { Border::Background } else { Border::Unknown };
    let mut random = Random(3);
    let view = |(k, camera): (usize, Camera)| {
        let mut mask = specks(&mut random, coverage && !(is_mixed && k == 1));
        let lens = has_lenses && !(is_mixed && k == 2);
        let field_of_view = lens.then(|| disc(75.0));
        if let Some(seen) = &field_of_view {
            let beyond = if border == Border::Unknown { 255 } else { 0 };
            let pixels = mask.iter_mut().zip(seen.iter());
            pixels.filter(|(_, seen)| **seen == 0).for_each(|(pixel, _)| *pixel = beyond);
        }
        let field_of_view = field_of_view.map(|seen| Arc::new(Silhouette::new(&seen, Border::Background)));
        let silhouette = Arc::new(Silhouette::new(&mask, border));
        View::new(Arc::new(camera), silhouette, field_of_view).with_enabled(!(is_mixed && k == 3))
    };
    // Beyond what every view sees too.
    let volume = bounds().grown(0.4);
    Hull::new(cameras().into_iter().enumerate().map(view).collect(), volume, unseen, 0.0)
}

/// The image of a round field of view.
fn disc(radius: f64) -> GrayImage {
    GrayImage::from_fn(160, 120, |i, j| {
        Luma([if (f64::from(i) - 80.0).hypot(f64::from(j) - 60.0) < radius { 255 } else { 0 }])
    })
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

/// The rays of points that are inside, by [`Hull::push`] or [`Hull::respond`], one by one.
fn single_ray(hull: &Hull, point: Point3<f64>, edge: EdgeModel) -> Option<Vector3<f64>> {
    match edge {
        EdgeModel::Coverage => hull.exit_vector(&point).map(|push| push.direction),
        EdgeModel::Pixel => hull.respond(&point).map(|response| response.normal),
    }
}

#[test]
fn many_exit_rays_have_the_bits_of_single_ones() {
    let (mut scratch, mut places, mut rays) = (Scratch::default(), Vec::new(), Vec::new());
    for (n, hull) in hulls().iter().enumerate() {
        let points = points(hull, 3001);
        for edge in [EdgeModel::Coverage, EdgeModel::Pixel] {
            hull.exit_rays(&points, edge, usize::MAX, &mut scratch, &mut places, &mut rays);
            let mut found = places.iter().zip(&rays);
            for (place, &point) in points.iter().enumerate() {
                let Some(direction) = single_ray(hull, point, edge) else { continue };
                let (found_place, ray) = found.next().expect("a ray for each point inside");
                assert_eq!((*found_place, ray.point), (place, point), "hull {n}, {edge:?}");
                assert_eq!(ray.direction, direction, "hull {n}, {edge:?}, {point}");
            }
            assert!(found.next().is_none() && rays.len() > 100, "hull {n}, {edge:?}: {}", rays.len());
        }
    }
}

#[test]
fn many_responses_have_the_bits_of_single_ones() {
    let mut workspace = super::super::Workspace::new();
    for (n, hull) in hulls().iter().enumerate() {
        let points = points(hull, 2003);
        let mut found = hull.respond_many(&points, &mut workspace).iter();
        for (place, point) in points.iter().enumerate() {
            let Some(single) = hull.respond(point) else { continue };
            let many = found.next().expect("a response for each point inside");
            let view = &hull.views()[many.view];
            assert!(many.point == place && std::ptr::eq(view, single.nearest.view), "hull {n}, {point}");
            assert_eq!((many.normal, many.depth), (single.normal, single.depth), "hull {n}, {point}");
        }
        assert!(found.next().is_none());
    }
}

#[test]
fn responses_of_lenses_and_abstaining_views_agree_with_the_reference() {
    let mut workspace = super::super::Workspace::new();
    for (n, hull) in hulls().iter().enumerate() {
        let points = points(hull, 151);
        let mut found = hull.respond_many(&points, &mut workspace).iter().peekable();
        for (place, point) in points.iter().enumerate() {
            let many = found.next_if(|many| many.point == place);
            let expected = reference::respond(hull, point);
            assert_eq!(many.is_some(), expected.is_some(), "hull {n}, {point}");
            let (Some(many), Some(expected)) = (many, expected) else { continue };
            assert_eq!(many.view, expected.view, "hull {n}, {point}");
            assert!((many.normal - expected.normal).norm() < 1e-12, "hull {n}, {point}");
            // Both find the same pixel border in closed form.
            assert!((many.depth - expected.depth).abs() < 1e-9, "hull {n}, {point}: {many:?} {expected:?}");
        }
    }
}

#[test]
fn the_first_few_rays_are_the_first_of_all() {
    let (mut scratch, mut places, mut all, mut few) =
        (Scratch::default(), Vec::new(), Vec::new(), Vec::new());
    for hull in hulls() {
        let points = points(hull, 1003);
        hull.exit_rays(&points, EdgeModel::Coverage, usize::MAX, &mut scratch, &mut places, &mut all);
        for most in [0, 1, 7, 40] {
            hull.exit_rays(&points, EdgeModel::Coverage, most, &mut scratch, &mut places, &mut few);
            assert!(few.len() >= most && few.len() < most + LANES && all.starts_with(&few));
            assert_eq!(places.len(), few.len());
        }
    }
}

#[test]
fn many_exits_have_the_bits_of_single_ones() {
    let (mut scratch, mut places, mut rays, mut exits) =
        (Scratch::default(), Vec::new(), Vec::new(), Vec::new());
    let mut random = Random(9);
    for (n, hull) in hulls().iter().enumerate() {
        let ball = Aabb { min: point![-1.0, -1.0, -1.0], max: point![1.0, 1.0, 1.0] };
        let mut directions: Vec<_> = (0..6).map(|_| random.point(&ball).coords.normalize()).collect();
        directions.extend([Vector3::x(), -Vector3::y(), Vector3::z(), vector![0.6, 0.0, -0.8]]);
        for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
            hull.exit_rays(&points(hull, 1003), edge, usize::MAX, &mut scratch, &mut places, &mut rays);
            for &direction in &directions {
                rays.iter_mut().for_each(|ray| ray.direction = direction);
                for t_max in [f64::INFINITY, 0.05] {
                    hull.exits_within(&mut rays, edge, t_max, &mut scratch, &mut exits);
                    assert_eq!(exits.len(), rays.len());
                    for (exit, ray) in exits.iter().zip(&rays) {
                        let single = hull.exit_within(&ray.point, &direction, edge, t_max);
                        assert_eq!(*exit, single, "hull {n}, {edge:?}, {t_max}, {}", ray.point);
                    }
                }
            }
        }
    }
}

#[test]
fn what_provably_exits_before_has_a_shorter_exit() {
    let (mut scratch, mut places, mut rays, mut random) =
        (Scratch::default(), Vec::new(), Vec::new(), Random(11));
    for hull in hulls() {
        for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
            hull.exit_rays(&points(hull, 1003), edge, usize::MAX, &mut scratch, &mut places, &mut rays);
            let (mut proven, mut shorter) = (0, 0);
            for ray in &rays {
                // A little off, as a cluster's direction is.
                let direction = (ray.direction + vector![0.05, -0.1, 0.1]).normalize();
                let ray = ExitRay { direction, ..*ray };
                let t = 0.2 * random.unit();
                let exit = hull.exit_within(&ray.point, &direction, edge, f64::INFINITY);
                let is_proven = hull.provably_exits_before(&ray, edge, t);
                assert!(!is_proven || exit < t, "{} {exit} {t}", ray.point);
                (proven, shorter) = (proven + usize::from(is_proven), shorter + usize::from(exit < t));
            }
            assert!(5 * proven > shorter, "{proven} of {shorter}");
        }
    }
}
