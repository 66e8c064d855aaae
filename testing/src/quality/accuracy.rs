//! How far the hull from pixels is from the analytic one, and whether its queries agree with one another.

use super::analytic::footprint;
use super::scene::Scene;
use crate::random::Random;
use nalgebra::{Isometry3, Point2, Point3, Translation3, Vector3};
use ode_visual_hull::hull::{Aabb, Culls, EdgeModel, Hull, NearestEdge, reference};
use ode_visual_hull::sample::{self, Samples};

/// Depth of the probes in the analytic hull, in pixels of the view in which they are shallowest.
const DEPTH_PX: std::ops::RangeInclusive<f64> = 1.0..=40.0;

/// A point moved by its response and this far beyond, in metres, has to be outside.
const NANOMETRE: f64 = 1e-9;

/// A point inside the analytic hull and its exit direction, the outward normal of the nearest surface.
///
/// In a direction that grazes the surface a small error of the silhouette moves the exit far. That would measure the
/// direction and not the hull.
pub struct Probe {
    /// Inside the analytic hull, in the world.
    pub p: Point3<f64>,
    /// The exit direction, a unit vector.
    pub direction: Vector3<f64>,
    /// Metres along the direction to the analytic hull's surface.
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

/// The share of random points in and around the hull whose verdict is the analytic one. Points within a pixel of a contour
/// in some view are left out.
pub fn inside_agreement(scene: &Scene, count: usize, seed: u64) -> f64 {
    let around = around(&scene.binary);
    let mut random = Random(seed);
    let points = std::iter::repeat_with(|| random_point(&mut random, &around));
    let clear = points.filter(|p| !scene.analytic.near_a_contour(p, 1.0)).take(count);
    share(clear.map(|p| scene.binary.inside(&p) == scene.analytic.contains(&p)))
}

/// The share of verdicts that stay the same with all 16 choices of culls: of points in and around the hull, by both
/// edge models, and of bodies, whose box must not be culled where a sample of theirs is inside.
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

/// The share of points inside at which the hull and the reference name the same view and exits within a quarter of a
/// pixel of each other.
pub fn reference_agree(scene: &Scene, count: usize, seed: u64) -> f64 {
    let hull = &scene.binary;
    share(inside(hull, count, seed).map(|p| {
        let (Some(found), Some(expected)) = (hull.respond(&p), reference::respond(hull, &p)) else {
            return false;
        };
        let apart = (found.w() - expected.normal * expected.depth).norm();
        let view = &hull.views()[expected.view];
        found.nearest.view.name() == view.name() && apart <= 0.25 * footprint(view.camera(), &p)
    }))
}

/// The share of points inside that are outside once moved by their response and a nanometre: by the paper's in the
/// binary hull, and by the contacts' in the one with coverage.
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

/// Distances of the exits of `hull` from the analytic hull's surface, in pixels.
pub fn exit_errors_px(scene: &Scene, hull: &Hull, edge: EdgeModel, probes: &[Probe]) -> Vec<f64> {
    let lone = |view: &_| Hull::new(vec![Clone::clone(view)], *hull.bounds(), hull.unseen(), hull.time());
    let lone: Vec<Hull> = hull.views().iter().map(lone).collect();
    probes.iter().map(|probe| exit_error_px(scene, hull, &lone, edge, probe)).collect()
}

/// The error of an exit that lies before the true one is its distance from the contour in the view that ended the line.
/// Behind the true one it is the farthest distance outside along the line from the true exit on, so that a gap that was
/// skipped counts in full.
fn exit_error_px(scene: &Scene, hull: &Hull, lone: &[Hull], edge: EdgeModel, probe: &Probe) -> f64 {
    let exit = |hull: &Hull| hull.exit(&probe.p, &probe.direction, edge);
    let found = exit(hull);
    let at = |t: f64| probe.p + probe.direction * t;
    if found <= probe.exit {
        let by_view = |a: &usize, b: &usize| exit(&lone[*a]).total_cmp(&exit(&lone[*b]));
        let ending = (0..lone.len()).min_by(by_view).map(|view| &scene.analytic.contours()[view]);
        return ending.map_or(f64::NAN, |contour| contour.signed_distance_of(&at(found)).abs());
    }
    let between = (1..=4).map(|k| at(probe.exit + (found - probe.exit) * f64::from(k) / 4.0));
    between.map(|p| scene.analytic.stray_px(&p)).fold(0.0, f64::max)
}

/// The error of a normal.
#[derive(Debug, Clone, Copy)]
pub struct NormalError {
    /// The angle between the two normals.
    pub degrees: f64,
    /// Whether the hull has an edge there ([`super::analytic::AnalyticHull::near_edge`]).
    pub near_edge: bool,
}

/// The paper's normals of the probes in the binary hull.
pub fn paper_normal_errors(scene: &Scene, probes: &[Probe]) -> Vec<NormalError> {
    let error = |probe: &Probe| {
        let response = scene.binary.respond(&probe.p)?;
        normal_error(scene, &response.nearest, &response.normal)
    };
    probes.iter().filter_map(error).collect()
}

/// The contact normals of the probes in `hull`.
pub fn contact_normal_errors(scene: &Scene, hull: &Hull, probes: &[Probe]) -> Vec<NormalError> {
    let error = |probe: &Probe| {
        let (push, nearest) = (hull.exit_vector(&probe.p)?, hull.nearest_edge(&probe.p)?);
        normal_error(scene, &nearest, &push.direction)
    };
    probes.iter().filter_map(error).collect()
}

/// The angle to the normal at the contour point nearest to the centre of b's pixel, in the same view; `None` in a corner.
fn normal_error(scene: &Scene, nearest: &NearestEdge, found: &Vector3<f64>) -> Option<NormalError> {
    let contours = scene.analytic.contours();
    let view = contours.iter().position(|contour| contour.camera().name() == nearest.view.name())?;
    let b = Point2::new(f64::from(nearest.b.0) + 0.5, f64::from(nearest.b.1) + 0.5);
    let on = contours[view].nearest(&b);
    let expected = contours[view].normal_in_world(&on)?;
    let near_edge = scene.analytic.near_edge(view, &on, nearest.a.depth);
    Some(NormalError { degrees: found.angle(&expected).to_degrees(), near_edge })
}

/// `count` points inside `hull`.
fn inside(hull: &Hull, count: usize, seed: u64) -> impl Iterator<Item = Point3<f64>> {
    let mut random = Random(seed);
    let points = std::iter::repeat_with(move || random_point(&mut random, hull.aabb()));
    points.filter(|p| hull.inside(p)).take(count)
}

/// The hull's box grown by 0.2 m, within the work volume.
fn around(hull: &Hull) -> Aabb {
    hull.aabb().grown(0.2).intersection(hull.bounds())
}

fn random_point(random: &mut Random, aabb: &Aabb) -> Point3<f64> {
    random.point(aabb.min, aabb.max)
}

fn pose(random: &mut Random, aabb: &Aabb) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(random_point(random, aabb)), random.rotation())
}

/// The share of verdicts that are true; NaN without any.
pub fn share(verdicts: impl Iterator<Item = bool>) -> f64 {
    let (yes, all) = verdicts.fold((0, 0), |(yes, all), verdict| (yes + u32::from(verdict), all + 1));
    f64::from(yes) / f64::from(all)
}

/// The mean; NaN without values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The value that 99 in 100 do not exceed; NaN without values.
pub fn p99(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (0.99 * values.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}
