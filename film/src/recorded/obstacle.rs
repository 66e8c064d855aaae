//! Finds a place on the floor where a stack stands in the way of a moving subject.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::{Aabb, Hull};
use std::sync::Arc;

/// Grid of the candidate places, in metres.
const CELL: f64 = 0.04;

/// Distance of the stack from the subject in the first frame, in metres.
const CLEARANCE: f64 = 0.04;

/// Share of the stack's upper two thirds that the subject fills at a time: the least that surely knocks it over, and
/// the best. More makes the boxes fly.
const MIN_OVERLAP: f64 = 0.05;
const BEST_OVERLAP: f64 = 0.15;

/// The foot of a stack of this `side` and `height` where the subject is not in the first of `hulls` but comes later:
/// into the upper part, so that the stack falls, and in the first two thirds of the hulls, so that the film shows it.
/// `None` if the subject comes to no such place.
pub fn in_the_way(hulls: &[Arc<Hull>], side: f64, height: f64) -> Option<Point3<f64>> {
    let (first, later) = hulls.split_first()?;
    let later = &later[..(2 * later.len()).div_ceil(3)];
    let whole =
        later.iter().map(|hull| *hull.aabb()).filter(|aabb| !aabb.is_empty()).reduce(|a, b| a.union(&b))?;
    let size = (whole.max - whole.min) / CELL;
    let places = (0..=size.y as usize).flat_map(|y| (0..=size.x as usize).map(move |x| (x, y)));
    let foot = |(x, y): (usize, usize)| {
        Point3::new(whole.min.x + (x as f64 + 0.5) * CELL, whole.min.y + (y as f64 + 0.5) * CELL, 0.0)
    };
    let struck = |foot: Point3<f64>| {
        let upper = column(&foot, 0.5 * side, height / 3.0, height);
        let most = later.iter().map(|hull| part_inside(hull, &upper)).fold(0.0, f64::max);
        let is_clear =
            || part_inside(first, &column(&foot, 0.5 * side + CLEARANCE, 0.0, height + CLEARANCE)) == 0.0;
        (most >= MIN_OVERLAP && is_clear()).then_some(((most - BEST_OVERLAP).abs(), foot))
    };
    let best = places.map(foot).filter_map(struck).min_by(|a, b| a.0.total_cmp(&b.0));

    best.map(|(_, foot)| foot)
}

/// The highest point of `hull` at `(x, y)`, else the floor.
pub fn ground(hull: &Hull, x: f64, y: f64) -> Point3<f64> {
    let top = hull.aabb().max.z + 0.01;
    let ray = Ray { origin: Point3::new(x, y, top), direction: -Vector3::z() };
    let entry = hull.ray_cast(&ray).and_then(|(entry, _)| entry);
    Point3::new(x, y, entry.map_or(0.0, |entry| (top - entry.t).max(0.0)))
}

/// Points of a column around the vertical through `foot`, between two heights.
fn column(foot: &Point3<f64>, half: f64, bottom: f64, top: f64) -> Vec<Point3<f64>> {
    const ACROSS: [f64; 3] = [-1.0, 0.0, 1.0];
    let layers = ((top - bottom) / CELL).ceil().max(1.0);
    let heights = (0..=layers as usize).map(|i| bottom + (top - bottom) * i as f64 / layers);
    let layer = |z: f64| {
        let along = move |y: f64| ACROSS.map(|x| Point3::new(foot.x + x * half, foot.y + y * half, z));
        ACROSS.into_iter().flat_map(along)
    };
    heights.flat_map(layer).collect()
}

fn part_inside(hull: &Hull, points: &[Point3<f64>]) -> f64 {
    let around = Aabb::of_points(points);
    if around.intersection(hull.aabb()).is_empty() {
        return 0.0;
    }
    points.iter().filter(|point| hull.inside(point)).count() as f64 / points.len() as f64
}
