//! Errors of the hull from pixels against the analytic hull, and agreement of its queries with one another.

use super::analytic::footprint;
use super::scene::Scene;
use crate::random::Random;
use nalgebra::{Isometry3, Point2, Point3, Translation3, Vector3};
use ode_visual_hull::hull::{Aabb, Culls, EdgeModel, Hull, NearestEdge, reference};
use ode_visual_hull::sample::{self, Samples};

/// Range of the depths of probes in the analytic hull, in pixels of the view in which a probe is shallowest.
const DEPTH_PX: std::ops::RangeInclusive<f64> = 1.0..=40.0;

/// Metres beyond its response by which a point is moved to be outside.
const NANOMETRE: f64 = 1e-9;

/// A point inside the analytic hull, with the outward normal of the nearest surface as its exit direction.
///
/// In a direction that grazes the surface, a small error of the silhouette moves the exit far, so that the result would
/// describe the direction and not the hull.
pub struct Probe {
    /// The point, in the world.
    pub p: Point3<f64>,
    /// The exit direction, a unit vector.
    pub direction: Vector3<f64>,
    /// Distance along the direction to the analytic hull's surface, in metres.
    pub exit: f64,
}

/// `count` random probes.
pub fn probes(scene: &Scene, count: usize, seed: u64) -> Vec<Probe> {
    let mut random = Random(seed);
    let mut probes = Vec::with_capacity(count);
    while probes.len() < count {
        let p = random_point(&mut random, scene.binary.aabb());
        if !scene.analytic.contains(&p) || !DEPTH_PX.contains(&scene.analytic.depth_px(&p)) {
            continue;
        }
        if let Some(direction) = scene.analytic.exit_direction(&p) {
            let (exit, _) = scene.analytic.exit(&p, &direction);
            probes.push(Probe { p, direction, exit });
        }
    }

    probes
}

/// The share of random points in and around the hull that both hulls classify alike. Points within a pixel of a contour
/// in some view are left out.
pub fn inside_agreement(scene: &Scene, count: usize, seed: u64) -> f64 {
    let around = around(&scene.binary);
    let mut random = Random(seed);
    let points = std::iter::repeat_with(|| random_point(&mut random, &around));
    let clear = points.filter(|p| !scene.analytic.near_a_contour(p, 1.0)).take(count);
    share(clear.map(|p| scene.binary.inside(&p) == scene.analytic.contains(&p)))
}

/// The share of results that all 16 combinations of culls leave as they are: of inside tests of points in and around
/// the hull by both edge models, and of culling bodies, which is wrong where a sample of the body is inside.
pub fn culls_agree(scene: &Scene, count: usize, seed: u64) -> f64 {
    let mut random = Random(seed);
    let around = around(&scene.binary);
    let points: Vec<_> = (0..count).map(|_| random_point(&mut random, &around)).collect();

    let bodies = [sample::sphere(0.05, 0.03), sample::box_(Vector3::new(0.2, 0.1, 0.05), 0.03)];
    let bodies = bodies.map(|body| body.expect("a valid shape"));
    let poses: Vec<_> = (0..count / 20).map(|_| pose(&mut random, &around.grown(0.1))).collect();

    let mut agreed = Vec::new();
    for hull in [&scene.binary, &scene.coverage] {
        let plain = hull.clone().with_culls(Culls::NONE);
        for culls in all_culls() {
            let culled = hull.clone().with_culls(culls);
            for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
                agreed.extend(points.iter().map(|p| culled.inside_by(p, edge) == plain.inside_by(p, edge)));
            }
            for body in &bodies {
                agreed.extend(poses.iter().map(|pose| !culls_a_touching_body(&culled, &plain, body, pose)));
            }
        }
    }

    share(agreed.into_iter())
}

fn culls_a_touching_body(culled: &Hull, plain: &Hull, body: &Samples, pose: &Isometry3<f64>) -> bool {
    let (centre, radius) = body.bounding_sphere();
    let inside = |p: Point3<f64>| plain.inside(&p) || plain.inside_by(&p, EdgeModel::Coverage);
    !culled.may_touch(&(pose * centre), radius)
        && body.points().iter().any(|sample| inside(pose * sample.point))
}

fn all_culls() -> impl Iterator<Item = Culls> {
    (0..16).map(|bits: u32| {
        let on = |bit: u32| bits >> bit & 1 == 1;
        Culls { rectangle: on(0), frustum: on(1), frustum_box: on(2), body_box: on(3) }
    })
}

/// The share of points inside for which the hull's response and the reference's have the same deciding view and end
/// within a quarter of a pixel of each other.
pub fn reference_agree(scene: &Scene, count: usize, seed: u64) -> f64 {
    let hull = &scene.binary;
    share(inside(hull, count, seed).map(|p| {
        let (Some(found), Some(expected)) = (hull.respond(&p), reference::respond(hull, &p)) else {
            return false;
        };
        let distance = (found.w() - expected.normal * expected.depth).norm();
        let view = &hull.views()[expected.view];
        found.nearest.view.name() == view.name() && distance <= 0.25 * footprint(view.camera(), &p)
    }))
}

/// The share of points inside that are outside after moving by their response and a nanometre. The response is the
/// paper's in the binary hull, and the exit vector in the hull with coverage.
pub fn response_leaves(scene: &Scene, count: usize, seed: u64) -> f64 {
    let paper = inside(&scene.binary, count, seed).map(|p| {
        let response = scene.binary.respond(&p);
        response.is_some_and(|r| !scene.binary.inside(&(p + r.normal * (r.depth + NANOMETRE))))
    });
    let contact = inside(&scene.coverage, count, seed).filter_map(|p| {
        let push = scene.coverage.exit_vector(&p)?;
        let left = p + push.direction * (push.depth + NANOMETRE);
        Some(!scene.coverage.inside_by(&left, EdgeModel::Coverage))
    });
    share(paper.chain(contact))
}

/// The distances between the exits in `hull` and the analytic hull's surface, in pixels.
pub fn exit_errors_px(scene: &Scene, hull: &Hull, edge: EdgeModel, probes: &[Probe]) -> Vec<f64> {
    let single_view =
        |view: &_| Hull::new(vec![Clone::clone(view)], *hull.bounds(), hull.unseen(), hull.time());
    let single_views: Vec<Hull> = hull.views().iter().map(single_view).collect();
    probes.iter().map(|probe| exit_error_px(scene, hull, &single_views, edge, probe)).collect()
}

/// The error of an exit that lies before the true one is its distance from the contour in the view that ended the line.
/// Behind the true one it is the farthest distance outside along the line from the true exit on, so that a gap that was
/// skipped counts in full.
fn exit_error_px(scene: &Scene, hull: &Hull, single_views: &[Hull], edge: EdgeModel, probe: &Probe) -> f64 {
    let exit = |hull: &Hull| hull.exit(&probe.p, &probe.direction, edge);
    let found = exit(hull);
    let at = |t: f64| probe.p + probe.direction * t;
    if found <= probe.exit {
        let by_view = |a: &usize, b: &usize| exit(&single_views[*a]).total_cmp(&exit(&single_views[*b]));
        let ending = (0..single_views.len()).min_by(by_view).map(|view| &scene.analytic.contours()[view]);
        return ending.map_or(f64::NAN, |contour| contour.signed_distance_of(&at(found)).abs());
    }
    let between = (1..=4).map(|k| at(probe.exit + (found - probe.exit) * f64::from(k) / 4.0));
    between.map(|p| scene.analytic.stray_px(&p)).fold(0.0, f64::max)
}

/// The error of a normal against the analytic one.
#[derive(Debug, Clone, Copy)]
pub struct NormalError {
    /// The angle between the two normals.
    pub degrees: f64,
    /// Whether the hull has an edge there ([`super::analytic::AnalyticHull::near_edge`]).
    pub near_edge: bool,
}

/// Errors of the paper's normals of the probes, in the binary hull.
pub fn paper_normal_errors(scene: &Scene, probes: &[Probe]) -> Vec<NormalError> {
    let error = |probe: &Probe| {
        let response = scene.binary.respond(&probe.p)?;
        normal_error(scene, &response.nearest, &response.normal)
    };
    probes.iter().filter_map(error).collect()
}

/// Errors of the contact normals of the probes in `hull`.
pub fn contact_normal_errors(scene: &Scene, hull: &Hull, probes: &[Probe]) -> Vec<NormalError> {
    let error = |probe: &Probe| {
        let (push, nearest) = (hull.exit_vector(&probe.p)?, hull.nearest_edge(&probe.p)?);
        normal_error(scene, &nearest, &push.direction)
    };
    probes.iter().filter_map(error).collect()
}

/// The error of a normal against that of the contour point nearest to the centre of b's pixel in the deciding view;
/// `None` in a corner.
fn normal_error(scene: &Scene, nearest: &NearestEdge, found: &Vector3<f64>) -> Option<NormalError> {
    let contours = scene.analytic.contours();
    let view = contours.iter().position(|contour| contour.camera().name() == nearest.view.name())?;
    let b = Point2::new(f64::from(nearest.b.0) + 0.5, f64::from(nearest.b.1) + 0.5);
    let on = contours[view].nearest(&b);
    let expected = contours[view].normal_in_world(&on)?;
    let near_edge = scene.analytic.near_edge(view, &on, nearest.a.depth);
    Some(NormalError { degrees: found.angle(&expected).to_degrees(), near_edge })
}

/// `count` random points inside `hull`.
fn inside(hull: &Hull, count: usize, seed: u64) -> impl Iterator<Item = Point3<f64>> {
    let mut random = Random(seed);
    let points = std::iter::repeat_with(move || random_point(&mut random, hull.aabb()));
    points.filter(|p| hull.inside(p)).take(count)
}

/// The hull's bounding box grown by 0.2 m, within the work volume.
fn around(hull: &Hull) -> Aabb {
    hull.aabb().grown(0.2).intersection(hull.bounds())
}

fn random_point(random: &mut Random, aabb: &Aabb) -> Point3<f64> {
    random.point(aabb.min, aabb.max)
}

fn pose(random: &mut Random, aabb: &Aabb) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(random_point(random, aabb)), random.rotation())
}

/// The share of `results` that are true; NaN if there are none.
pub fn share(results: impl Iterator<Item = bool>) -> f64 {
    let (yes, all) = results.fold((0, 0), |(yes, all), result| (yes + u32::from(result), all + 1));
    f64::from(yes) / f64::from(all)
}

/// The mean; NaN if there are no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The 99th percentile; NaN if there are no values.
pub fn p99(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (0.99 * values.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}
