//! Batches against the single queries: they return the same bits, for views of every kind.

use super::*;
use crate::camera::{Camera, Fisheye};
use crate::hull::tests::{POLICIES, bounds, cameras, degenerate_directions, hull, mask, point_in};
use crate::hull::{Aabb, HullData, Unseen, View, reference};
use crate::silhouette::{Border, Silhouette};
use image::{GrayImage, Luma};
use nalgebra::{Matrix3, point, vector};
use ode_visual_hull_random::Random;
use std::sync::{Arc, LazyLock};

/// The kind of views that a hull has.
#[derive(Debug, Clone, Copy)]
struct Kind {
    unseen: Unseen,
    has_coverage: bool,
    /// Whether lenses see only a disc of the image.
    has_lenses: bool,
    /// Whether one view is disabled, one has no lens, and one has no coverage.
    is_mixed: bool,
}

/// Hulls of a plain subject with and without coverage, seen by pinholes and by fisheyes; and hulls of masks full of
/// holes, which reach up to the image's border, with and without lenses. All are made for both policies, some also with
/// views that are overruled, and once for all tests.
fn hulls() -> &'static [Hull] {
    static HULLS: LazyLock<Vec<Hull>> = LazyLock::new(render_hulls);
    &HULLS
}

fn render_hulls() -> Vec<Hull> {
    let plain = POLICIES.into_iter().flat_map(|unseen| [1, 4].map(|samples| hull(unseen, samples)));
    let both = [false, true];
    let kinds = POLICIES.into_iter().flat_map(|unseen| {
        both.into_iter().flat_map(move |has_coverage| {
            both.into_iter().flat_map(move |has_lenses| {
                both.map(|is_mixed| Kind { unseen, has_coverage, has_lenses, is_mixed })
            })
        })
    });
    let fisheyes =
        POLICIES.into_iter().flat_map(|unseen| [1, 4].map(|samples| fisheye_hull(unseen, samples)));
    let mut hulls: Vec<Hull> = plain.chain(kinds.map(perforated_hull)).chain(fisheyes).collect();
    hulls.extend(hulls.clone().into_iter().step_by(3).map(|hull| hull.with_overrule_depth(Some(0.04))));
    hulls
}

/// The hull of cameras with fisheye lenses. In some of their images the subject is near a border, which cuts it off;
/// the corner on the other side is up to 83 degrees from the axis.
fn fisheye_hull(unseen: Unseen, samples: u32) -> Hull {
    let lens = Fisheye::from_opencv(&[0.01, -0.004, 5e-4, -2e-5]).unwrap();
    let data = HullData::new();
    data.set_bounds(bounds()).unwrap();
    data.set_unseen(unseen).unwrap();

    for (k, camera) in cameras().iter().enumerate() {
        // The principal point, and with it the subject, lies in the middle, to the right or to the left.
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

/// A hull whose masks are full of holes.
fn perforated_hull(Kind { unseen, has_coverage, has_lenses, is_mixed }: Kind) -> Hull {
    let border = if unseen == Unseen::Outside { Border::Background } else { Border::Unknown };
    let mut random = Random(3);

    let view = |(k, camera): (usize, Camera)| {
        let mut mask = perforated_mask(&mut random, has_coverage && !(is_mixed && k == 1));

        // Outside the lens's disc the mask continues as it does beyond the image's border.
        let has_lens = has_lenses && !(is_mixed && k == 2);
        let lens_disc = has_lens.then(|| disc(75.0));
        if let Some(lens_disc) = &lens_disc {
            let beyond = if border == Border::Unknown { 255 } else { 0 };
            let pixels = mask.iter_mut().zip(lens_disc.iter());
            pixels.filter(|(_, visible)| **visible == 0).for_each(|(pixel, _)| *pixel = beyond);
        }

        let field_of_view = lens_disc.map(|disc| Arc::new(Silhouette::new(&disc, Border::Background)));
        let silhouette = Arc::new(Silhouette::new(&mask, border));
        View::new(Arc::new(camera), silhouette, field_of_view).with_enabled(!(is_mixed && k == 3))
    };

    // The work volume reaches beyond what every view sees.
    let volume = bounds().grown(0.4);
    Hull::new(cameras().into_iter().enumerate().map(view).collect(), volume, unseen, 0.0)
}

/// The mask of a disc with a radius in pixels.
fn disc(radius: f64) -> GrayImage {
    GrayImage::from_fn(160, 120, |i, j| {
        Luma([if (f64::from(i) - 80.0).hypot(f64::from(j) - 60.0) < radius { 255 } else { 0 }])
    })
}

/// A mask of subject with 30 holes, each up to 7 pixels in radius; with coverage, their pixels are random greys.
fn perforated_mask(random: &mut Random, has_coverage: bool) -> GrayImage {
    let holes: Vec<_> = (0..30).map(|_| [160.0, 120.0, 7.0].map(|max| max * random.unit())).collect();
    GrayImage::from_fn(160, 120, |i, j| {
        let in_hole = holes.iter().any(|[x, y, r]| (f64::from(i) - x).hypot(f64::from(j) - y) < *r);
        let grey = if has_coverage { (220.0 * random.unit()) as u8 } else { 0 };
        Luma([if in_hole { grey } else { 255 }])
    })
}

fn points(hull: &Hull, count: usize) -> Vec<Point3<f64>> {
    let mut random = Random(7);
    (0..count).map(|_| point_in(&mut random, &hull.aabb().grown(0.02))).collect()
}

/// The exit direction of a point, by the single queries [`Hull::exit_vector`] and [`Hull::respond`]; `None` if it is
/// outside.
fn single_direction(hull: &Hull, point: Point3<f64>, edge: EdgeModel) -> Option<Vector3<f64>> {
    match edge {
        EdgeModel::Coverage => hull.exit_vector(&point).map(|exit| exit.direction),
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
                let Some(direction) = single_direction(hull, point, edge) else { continue };
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
    for (n, hull) in hulls().iter().enumerate().filter(|(_, hull)| hull.overrule_depth().is_none()) {
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

        // The search stops with the block that holds the last ray wanted.
        for min_count in [0, 1, 7, 40] {
            hull.exit_rays(&points, EdgeModel::Coverage, min_count, &mut scratch, &mut places, &mut few);
            assert!(few.len() >= min_count && few.len() < min_count + LANES && all.starts_with(&few));
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
        // Random directions, and some along the axes.
        let cube = Aabb { min: point![-1.0, -1.0, -1.0], max: point![1.0, 1.0, 1.0] };
        let mut directions: Vec<_> =
            (0..6).map(|_| point_in(&mut random, &cube).coords.normalize()).collect();
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

/// Moves a point to where a camera sees it in the outer half pixel of its image, at the top or on the left.
fn moved_to_border(camera: &Camera, p: &Point3<f64>, random: &mut Random) -> Option<Point3<f64>> {
    let at = camera.project(p)?;
    let outer = random.between(0.0, 0.5);
    let (u, v) = if random.below(2) == 0 { (at.u, outer) } else { (outer, at.v) };
    camera.unproject(u, v, at.depth)
}

#[test]
fn many_exits_from_the_outer_half_pixel_of_an_image_have_the_bits_of_single_ones() {
    let (mut scratch, mut places, mut rays, mut exits) =
        (Scratch::default(), Vec::new(), Vec::new(), Vec::new());
    let mut random = Random(13);
    let mut count = 0;
    for (n, hull) in hulls().iter().enumerate() {
        let points = points(hull, 1003);
        for camera in hull.views().iter().map(View::camera) {
            let at_border: Vec<_> =
                points.iter().filter_map(|p| moved_to_border(camera, p, &mut random)).collect();
            let edge = EdgeModel::Coverage;
            hull.exit_rays(&at_border, edge, usize::MAX, &mut scratch, &mut places, &mut rays);

            // Nearly parallel to the image, so that the lines stay in the outer cells for long.
            let centre = camera.centre();
            for ray in &mut rays {
                let sight = (ray.point - centre).normalize();
                ray.direction = (sight.cross(&random.direction()) + sight * 0.1).normalize();
            }
            hull.exits_within(&mut rays, edge, f64::INFINITY, &mut scratch, &mut exits);
            for (exit, ray) in exits.iter().zip(&rays) {
                let single = hull.exit(&ray.point, &ray.direction, edge);
                assert_eq!(*exit, single, "hull {n}, {}, {}", ray.point, ray.direction);
            }
            count += rays.len();
        }
    }
    assert!(count > 1000, "{count} rays");
}

#[test]
fn many_exits_along_degenerate_lines_have_the_bits_of_single_ones() {
    let (mut scratch, mut places, mut rays, mut exits) =
        (Scratch::default(), Vec::new(), Vec::new(), Vec::new());
    for (n, hull) in hulls().iter().enumerate() {
        let points = points(hull, 151);
        for camera in hull.views().iter().map(View::camera) {
            // On the border and in the middle of pixels, and elsewhere.
            let snapped = points.iter().enumerate().filter_map(|(k, p)| {
                let at = camera.project(p)?;
                let snap = |x: f64, k: usize| [x.round(), x.floor() + 0.5, x][k % 3];
                camera.unproject(snap(at.u, k), snap(at.v, k / 3), at.depth)
            });
            let snapped: Vec<_> = snapped.collect();

            for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
                hull.exit_rays(&snapped, edge, usize::MAX, &mut scratch, &mut places, &mut rays);
                for k in 0..8 {
                    rays.iter_mut()
                        .for_each(|ray| ray.direction = degenerate_directions(camera, &ray.point)[k]);
                    hull.exits_within(&mut rays, edge, f64::INFINITY, &mut scratch, &mut exits);
                    for (exit, ray) in exits.iter().zip(&rays) {
                        let single = hull.exit(&ray.point, &ray.direction, edge);
                        assert_eq!(*exit, single, "hull {n}, {edge:?}, {}, {k}", ray.point);
                    }
                }
            }
        }
    }
}

#[test]
fn a_ray_that_provably_exits_before_a_distance_has_a_shorter_exit() {
    let (mut scratch, mut places, mut rays, mut random) =
        (Scratch::default(), Vec::new(), Vec::new(), Random(11));
    for hull in hulls() {
        for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
            hull.exit_rays(&points(hull, 1003), edge, usize::MAX, &mut scratch, &mut places, &mut rays);
            let (mut proven, mut shorter) = (0, 0);
            for ray in &rays {
                // The direction differs a little from the ray's own, as that of a cluster of contacts does.
                let direction = (ray.direction + vector![0.05, -0.1, 0.1]).normalize();
                let ray = ExitRay { direction, ..*ray };
                let t = 0.2 * random.unit();
                let exit = hull.exit_within(&ray.point, &direction, edge, f64::INFINITY);
                let is_proven = hull.provably_exits_before(&ray, edge, t);
                assert!(!is_proven || exit < t, "{} {exit} {t}", ray.point);
                (proven, shorter) = (proven + usize::from(is_proven), shorter + usize::from(exit < t));
            }

            // At least a fifth of the shorter exits are proven, or the test would be vacuous.
            assert!(5 * proven > shorter, "{proven} of {shorter}");
        }
    }
}
