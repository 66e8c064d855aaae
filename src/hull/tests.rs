//! The optimised queries against the reference and against invariants of the paper. The masks show a ball and a slab
//! with a hole, rendered here for five cameras without any symmetry.

use super::*;
use crate::camera::{Camera, Ray};
use crate::silhouette::{Border, Silhouette};
use image::{GrayImage, Luma};
use nalgebra::{Vector3, point, vector};
use ode_visual_hull_random::Random;
use std::sync::{Arc, OnceLock};

/// A random point of `aabb`.
pub(super) fn point_in(random: &mut Random, aabb: &Aabb) -> Point3<f64> {
    random.point(aabb.min, aabb.max)
}

pub(super) fn bounds() -> Aabb {
    Aabb::new(point![-0.6, -0.6, -0.1], point![0.6, 0.6, 0.9]).unwrap()
}

pub(super) fn cameras() -> Vec<Camera> {
    // In metres.
    let eyes = [[2.0, 0.2, 0.5], [0.1, 2.2, 1.4], [-1.8, -1.1, 0.3], [0.3, -0.2, 2.9], [1.2, -1.6, 1.0]];
    // Horizontal, in radians.
    let fov = [0.9, 0.8, 1.0, 0.7, 0.95];

    let look = |k: usize| {
        let eye = Point3::from(eyes[k]);
        Camera::look_at(
            format!("cam{k}"),
            (160, 120),
            fov[k],
            eye,
            point![0.0, 0.0, 0.35],
            vector![0.02, 0.1, 1.0],
        )
    };

    (0..5).map(|k| look(k).unwrap()).collect()
}

/// Whether a ray meets the subject: a ball with a radius of 0.3 m, and a slab with a hole if `with_slab`.
fn sees_subject(ray: &Ray, with_slab: bool) -> bool {
    let to_centre = point![0.05, 0.0, 0.35] - ray.origin;
    let nearest = ray.origin + ray.direction * to_centre.dot(&ray.direction);
    let slab = ray.origin + ray.direction * ((0.2 - ray.origin.z) / ray.direction.z);
    let on_slab = slab.x.abs() < 0.5 && slab.y.abs() < 0.25 && (slab.x - 0.38).hypot(slab.y) > 0.06;
    (nearest - point![0.05, 0.0, 0.35]).norm() < 0.3 || (with_slab && on_slab)
}

/// The masks of the subject, from `samples` times `samples` rays a pixel, at most 8 times 8. They are rendered once for
/// all tests, since that takes longer than most of them.
fn masks(samples: u32) -> &'static [GrayImage] {
    static MASKS: [OnceLock<Vec<GrayImage>>; 9] = [const { OnceLock::new() }; 9];
    let render = || cameras().iter().map(|camera| mask(camera, samples)).collect();
    MASKS[samples as usize].get_or_init(render)
}

/// The mask of the subject seen by one camera, from `samples` times `samples` rays a pixel.
pub(super) fn mask(camera: &Camera, samples: u32) -> GrayImage {
    let (width, height) = camera.size();
    GrayImage::from_fn(width, height, |i, j| {
        let offset = |k: u32| (f64::from(k) + 0.5) / f64::from(samples);
        let hit = |k: u32| {
            let (u, v) = (f64::from(i) + offset(k % samples), f64::from(j) + offset(k / samples));
            sees_subject(&camera.ray(u, v).unwrap(), true)
        };
        let hits = (0..samples * samples).filter(|&k| hit(k)).count() as f64;
        Luma([(255.0 * hits / f64::from(samples * samples)).round() as u8])
    })
}

pub(super) fn hull(unseen: Unseen, samples: u32) -> Hull {
    let border = if unseen == Unseen::Outside { Border::Background } else { Border::Unknown };
    let view = |(camera, mask): (Camera, &GrayImage)| {
        View::new(Arc::new(camera), Arc::new(Silhouette::new(mask, border)), None)
    };
    Hull::new(cameras().into_iter().zip(masks(samples)).map(view).collect(), bounds(), unseen, 0.0)
}

pub(super) const POLICIES: [Unseen; 2] = [Unseen::Outside, Unseen::Abstain { min_views: 3 }];

#[test]
fn inside_agrees_with_the_reference_whatever_the_culls() {
    for unseen in POLICIES {
        let with_all = hull(unseen, 1).with_culls(Culls::ALL);
        let with_none = with_all.clone().with_culls(Culls::NONE);

        let mut random = Random(1);
        for _ in 0..20_000 {
            let p = point_in(&mut random, &bounds().grown(0.05));
            let expected = reference::inside(&with_all, &p);
            assert_eq!(with_none.inside(&p), expected, "{p}");
            assert_eq!(with_all.inside(&p), expected, "{p}");
            assert_eq!(with_none.inside_by(&p, EdgeModel::Coverage), expected, "{p}");
        }
    }
}

#[test]
fn the_box_holds_every_inside_point() {
    for samples in [1, 4] {
        let hull = hull(Unseen::Outside, samples).with_culls(Culls::NONE);
        let mut random = Random(2);
        for _ in 0..20_000 {
            let p = point_in(&mut random, &bounds());
            let inside = hull.inside(&p) || hull.inside_by(&p, EdgeModel::Coverage);
            assert!(!inside || hull.aabb().contains(&p));
        }
    }
}

#[test]
fn responses_agree_with_the_reference() {
    for unseen in POLICIES {
        let hull = hull(unseen, 1);
        let mut random = Random(3);
        let mut compared = 0;

        while compared < 400 {
            let p = point_in(&mut random, hull.aabb());
            let (found, expected) = (hull.respond(&p), reference::respond(&hull, &p));
            let Some(expected) = expected else {
                assert!(found.is_none());
                continue;
            };

            let found = found.unwrap();
            assert_eq!(found.nearest.view.name(), hull.views()[expected.view].name(), "{p}");
            assert_eq!(found.nearest.b, expected.b, "{p}");
            // Both find the same pixel border in closed form.
            assert!((found.depth - expected.depth).abs() < 1e-9, "{p}: {} {}", found.depth, expected.depth);
            compared += 1;
        }
    }
}

#[test]
fn exits_in_any_direction_agree_with_the_reference() {
    for unseen in POLICIES {
        let hull = hull(unseen, 1);
        let mut random = Random(4);
        let mut compared = 0;

        while compared < 400 {
            let (p, direction) = (point_in(&mut random, hull.aabb()), random.direction());
            if hull.inside(&p) {
                let found = hull.exit(&p, &direction, EdgeModel::Pixel);
                let expected = reference::exit(&hull, &p, &direction);
                // Both compute the crossing of a pixel border in closed form.
                assert!((found - expected).abs() < 1e-9, "{p} {direction}: {found} {expected}");
                compared += 1;
            }
        }
    }
}

/// Directions from `p` along which something that a traversal divides by is zero but for rounding in the view of
/// `camera`: along the line of sight, where the image is one point, along a row, along a column, and in their planes.
pub(super) fn degenerate_directions(camera: &Camera, p: &Point3<f64>) -> [Vector3<f64>; 8] {
    let sight = (p - camera.centre()).normalize();
    let axis = |axis: Vector3<f64>| camera.cam_from_world().inverse_transform_vector(&axis);
    let (right, down) = (axis(Vector3::x()), axis(Vector3::y()));
    let (in_column, in_row) = ((sight + down).normalize(), (right - sight).normalize());
    [sight, -sight, right, -right, down, -down, in_column, in_row]
}

#[test]
fn exits_along_lines_of_sight_rows_and_columns_agree_with_the_reference() {
    for unseen in POLICIES {
        let hull = hull(unseen, 1);
        let mut random = Random(8);
        let inside = std::iter::repeat_with(|| point_in(&mut random, hull.aabb())).filter(|p| hull.inside(p));

        for p in inside.take(40) {
            for camera in hull.views().iter().map(View::camera) {
                for direction in degenerate_directions(camera, &p) {
                    let found = hull.exit(&p, &direction, EdgeModel::Pixel);
                    let expected = reference::exit(&hull, &p, &direction);
                    // Both compute the crossing of a pixel border in closed form.
                    assert!((found - expected).abs() < 1e-9, "{p} {direction}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn coverage_exits_are_where_bilinear_coverage_falls_below_one_half() {
    let hull = hull(Unseen::Outside, 8);
    let mut random = Random(5);
    let mut compared = 0;

    while compared < 300 {
        let (p, direction) = (point_in(&mut random, hull.aabb()), random.direction());
        if hull.inside_by(&p, EdgeModel::Coverage) {
            let t = hull.exit(&p, &direction, EdgeModel::Coverage);
            let inside_at = |t: f64| hull.inside_by(&(p + direction * t), EdgeModel::Coverage);
            assert!(!inside_at(t + 1e-9), "{p}");

            // No earlier exit was skipped: inside all the way, by steps of about a hundredth of a pixel.
            let steps = (t / 1e-4) as usize;
            let before_exit = |k: usize| t * (k as f64 + 0.5) / (steps as f64 + 0.5);
            assert!((0..steps).all(|k| inside_at(before_exit(k))), "{p} {direction}");
            compared += 1;
        }
    }
}

#[test]
fn a_point_moved_by_its_response_is_outside() {
    let hull = hull(Unseen::Outside, 1);
    let mut random = Random(6);
    for _ in 0..4000 {
        let p = point_in(&mut random, hull.aabb());
        if let Some(response) = hull.respond(&p) {
            assert!(!hull.inside(&(p + response.normal * (response.depth + 1e-9))));
        }
    }
}

#[test]
fn a_ray_from_outside_enters_and_leaves_where_the_verdict_changes() {
    for unseen in POLICIES {
        let hull = hull(unseen, 1);
        let mut random = Random(7);
        let (mut hits, mut facing) = (0, 0);
        for _ in 0..2000 {
            let origin = point_in(&mut random, &bounds().grown(0.5));
            let ray = Ray { origin, direction: (point_in(&mut random, hull.aabb()) - origin).normalize() };
            let inside = |t: f64| hull.inside(&ray.at(t));

            // A ray that misses is outside all the way, by steps of a millimetre.
            let Some((entry, exit)) = hull.ray_cast(&ray) else {
                assert!((0..4000).all(|k| !inside(f64::from(k) * 1e-3)));
                continue;
            };

            // The verdict changes within a nanometre of the entry and of the exit.
            let start = entry.map_or(0.0, |hit| hit.t);
            assert_eq!(entry.is_none(), inside(0.0));
            assert!(inside(0.5 * (start + start.min(exit.t) + 1e-9)) || exit.t - start < 2e-9);
            assert!(!inside(exit.t + 1e-9));
            assert!(entry.is_none_or(|hit| !inside(hit.t - 1e-9)));

            hits += 1;
            facing += usize::from(entry.is_none_or(|hit| hit.normal.dot(&ray.direction) < 0.0));
        }
        assert!(hits > 300);
        // Where a ray grazes the surface, the normal of a staircase of pixels may point either way.
        assert!(facing > hits * 95 / 100, "{facing} of {hits}");
    }
}

#[test]
fn a_point_on_a_background_pixel_is_nearest_to_that_pixel() {
    // By the coverage edge a point may be inside although its own pixel is background, which is then the nearest one.
    let hull = hull(Unseen::Outside, 4);
    let mut random = Random(9);
    let mut compared = 0;

    for _ in 0..60_000 {
        let p = point_in(&mut random, hull.aabb());
        let distance = |view: &View| view.pixel(&p).map(|(i, j)| view.silhouette().distance(i, j));
        let on_background = hull.views().iter().find(|view| distance(view) == Some(0));
        if let Some(view) = on_background.filter(|_| hull.inside_by(&p, EdgeModel::Coverage)) {
            let nearest = hull.nearest_edge(&p).unwrap();
            assert_eq!((nearest.view.name(), Some(nearest.b)), (view.name(), view.pixel(&p)));
            compared += 1;
        }
    }

    assert!(compared > 30, "{compared}");
}

#[test]
fn a_view_that_does_not_see_the_point_counts_by_the_policy() {
    // Five views that see the middle of the ball, and one that looks away from it.
    let mut views: Vec<View> = hull(Unseen::ABSTAIN, 1).views().to_vec();
    let away =
        Camera::look_at("away", (64, 48), 0.2, point![3.0, 0.0, 0.3], point![3.0, 3.0, 0.3], Vector3::z());
    let blank = Silhouette::new(&GrayImage::new(64, 48), Border::Unknown);
    views.push(View::new(Arc::new(away.unwrap()), Arc::new(blank), None));
    let middle = point![0.05, 0.0, 0.35];
    assert!(Hull::new(views.clone(), bounds(), Unseen::ABSTAIN, 0.0).inside(&middle));
    assert!(!Hull::new(views.clone(), bounds(), Unseen::Abstain { min_views: 6 }, 0.0).inside(&middle));
    assert!(!Hull::new(views, bounds(), Unseen::Outside, 0.0).inside(&middle));
}

#[test]
fn an_empty_hull_names_the_view_that_emptied_it() {
    // One view with an empty mask.
    let mut views: Vec<View> = hull(Unseen::Outside, 1).views().to_vec();
    let camera = cameras().swap_remove(3);
    let blank = Silhouette::new(&GrayImage::new(160, 120), Border::Background);
    views[3] = View::new(Arc::new(camera), Arc::new(blank), None);
    let emptied = Hull::new(views.clone(), bounds(), Unseen::Outside, 0.0);
    assert_eq!(emptied.empty_reason(), Some(EmptyReason::EmptySilhouette { view: 3 }));
    assert!(emptied.aabb().is_empty());

    // That view is disabled, or there are no views at all.
    views[3] = views[3].clone().with_enabled(false);
    assert_eq!(Hull::new(views.clone(), bounds(), Unseen::Outside, 0.0).empty_reason(), None);
    assert_eq!(
        Hull::new(Vec::new(), bounds(), Unseen::Outside, 0.0).empty_reason(),
        Some(EmptyReason::NoViews)
    );
}
