//! Finds places where boxes come to rest on a subject: level places of the hull seen from above, each tried in a
//! simulation.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::{Hull, HullData, Motion};
use ode_visual_hull::shape::Shape;
use ode_visual_hull_film::{Simulation, Support};
use std::sync::Arc;

/// Grid of the heights, in metres.
const CELL: f64 = 0.015;

/// Least share of the cells below a box that must be the subject's.
const MIN_COVERED: f64 = 0.7;

/// Roughness, in metres, that counts as much as a slope of 1.
const ROUGHNESS_OF_SLOPE: f64 = 0.04;

/// Least height of a place, in metres: lower ones are feet and floor.
const MIN_HEIGHT: f64 = 0.3;

/// Limit of the places that are tried.
const MAX_TRIALS: usize = 150;

/// Duration of a trial in seconds.
const TRIAL_SECONDS: f64 = 1.5;

/// Height above the place from which a box is dropped, in metres.
pub const DROP: f64 = 0.06;

/// A place for a box.
#[derive(Debug, Clone, Copy)]
struct Placement {
    /// The centre of the place, at the height that a box touches first.
    top: Point3<f64>,
    /// 1 for an even, level place, less for others.
    flatness: f64,
}

/// Poses from which to drop `n` boxes with edges of `side` metres, apart from each other: first those from which a
/// single box came to rest on the subject, then others, the most level places first.
pub fn poses(data: &Arc<HullData>, n: usize, side: f64, pixel_size: f64) -> Result<Vec<Isometry3<f64>>> {
    let Some((_, hull)) = data.latest() else { return Ok(Vec::new()) };
    let mut placements = Heights::of(&hull).placements(side);
    placements.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let places = apart(placements.iter().map(|placement| placement.top), 0.3 * side, MAX_TRIALS);
    let mut chosen: Vec<Isometry3<f64>> = Vec::new();
    let mut unsteady = Vec::new();
    for (i, top) in places.iter().enumerate() {
        let turn = Vector3::z() * 0.15 * (i % 3) as f64;
        let pose = Isometry3::new(top.coords + Vector3::z() * (0.5 * side + DROP), turn);
        if chosen.len() < n && is_apart(&pose, &chosen, side) {
            let kept = if is_steady(data, &pose, side, pixel_size)? { &mut chosen } else { &mut unsteady };
            kept.push(pose);
        }
    }

    for pose in unsteady {
        if chosen.len() < n && is_apart(&pose, &chosen, side) {
            chosen.push(pose);
        }
    }

    Ok(chosen)
}

/// Whether a box at `pose` is clear of the `others`.
fn is_apart(pose: &Isometry3<f64>, others: &[Isometry3<f64>], side: f64) -> bool {
    let offset = |other: &Isometry3<f64>| (other.translation.vector - pose.translation.vector).xy().amax();
    others.iter().all(|other| offset(other) >= 1.1 * side)
}

/// Whether a box dropped from `pose` comes to rest on the subject near by.
fn is_steady(data: &Arc<HullData>, pose: &Isometry3<f64>, side: f64, pixel_size: f64) -> Result<bool> {
    let mut trial = Simulation::new(data, pixel_size, Motion::Held)?;
    trial.add(&Shape::cube(side), pose, [0; 3])?;
    trial.advance(TRIAL_SECONDS)?;
    let state = trial.states()[0];
    let strayed = state.pose.translation.vector - pose.translation.vector;
    Ok(trial.supports()[0] == Support::Subject
        && state.linear_velocity.norm() < 0.01
        && strayed.xy().norm() < 0.5 * side)
}

/// The first `n` of `points` that lie at least `distance` apart along x or y.
fn apart(points: impl Iterator<Item = Point3<f64>>, distance: f64, n: usize) -> Vec<Point3<f64>> {
    let mut chosen: Vec<Point3<f64>> = Vec::new();
    for point in points {
        if chosen.len() < n && chosen.iter().all(|other| (other - point).xy().amax() >= distance) {
            chosen.push(point);
        }
    }
    chosen
}

impl Placement {
    /// Of two equally level places the higher one is better.
    fn score(&self) -> f64 {
        self.flatness + 0.1 * self.top.z
    }
}

/// Heights of the hull over a grid, minus infinity beside the hull.
struct Heights {
    origin: Point3<f64>,
    columns: usize,
    rows: usize,
    values: Vec<f64>,
}

impl Heights {
    fn of(hull: &Hull) -> Self {
        let aabb = hull.aabb();
        let size = (aabb.max - aabb.min) / CELL;
        let (columns, rows) = (size.x.max(0.0) as usize + 1, size.y.max(0.0) as usize + 1);
        let top = aabb.max.z + 0.01;
        let value = |k: usize| {
            let (x, y) = (k % columns, k / columns);
            let offset = Vector3::new(x as f64 + 0.5, y as f64 + 0.5, 0.0) * CELL;
            let start = Point3::new(aabb.min.x, aabb.min.y, top) + offset;
            let entry = hull.ray_cast(&Ray { origin: start, direction: -Vector3::z() });
            entry.and_then(|(entry, _)| entry).map_or(f64::NEG_INFINITY, |hit| top - hit.t)
        };
        Self { origin: aabb.min, columns, rows, values: (0..columns * rows).map(value).collect() }
    }

    /// All places for a box of edge length `side`.
    fn placements(&self, side: f64) -> Vec<Placement> {
        let n = (side / CELL).round().max(1.0) as usize;
        let places = (0..(self.rows + 1).saturating_sub(n))
            .flat_map(|y| (0..(self.columns + 1).saturating_sub(n)).map(move |x| (x, y)));
        places.filter_map(|(x, y)| self.placement_at(x, y, n)).collect()
    }

    /// The place for a box whose base covers `n` by `n` cells from cell (x, y) on.
    fn placement_at(&self, x: usize, y: usize, n: usize) -> Option<Placement> {
        let half = 0.5 * (n as f64 - 1.0);
        let cells: Vec<Vector3<f64>> = (0..n * n)
            .map(|k| (k % n, k / n))
            .map(|(i, j)| {
                let height = self.values[(y + j) * self.columns + x + i];
                Vector3::new((i as f64 - half) * CELL, (j as f64 - half) * CELL, height)
            })
            .filter(|cell| cell.z.is_finite())
            .collect();
        let top = cells.iter().map(|cell| cell.z).fold(f64::NEG_INFINITY, f64::max);
        let covered = cells.len() as f64 / (n * n) as f64;
        if top < MIN_HEIGHT || covered < MIN_COVERED {
            return None;
        }
        let (slope, roughness) = plane(&cells)?;
        let offset = Vector3::new(x as f64 + 0.5 * n as f64, y as f64 + 0.5 * n as f64, 0.0) * CELL;
        let corner = Point3::new(self.origin.x, self.origin.y, top);

        Some(Placement { top: corner + offset, flatness: covered - slope - roughness / ROUGHNESS_OF_SLOPE })
    }
}

/// The slope of the least-squares plane of `points`, and the RMS of their heights above it.
fn plane(points: &[Vector3<f64>]) -> Option<(f64, f64)> {
    let (mut matrix, mut vector) = (Matrix3::zeros(), Vector3::zeros());
    for point in points {
        let row = Vector3::new(point.x, point.y, 1.0);
        matrix += row * row.transpose();
        vector += row * point.z;
    }
    let fit = matrix.try_inverse()? * vector;
    let square = |point: &Vector3<f64>| (point.z - fit.dot(&Vector3::new(point.x, point.y, 1.0))).powi(2);
    let mean_square = points.iter().map(square).sum::<f64>() / points.len() as f64;
    Some((fit.x.hypot(fit.y), mean_square.sqrt()))
}
