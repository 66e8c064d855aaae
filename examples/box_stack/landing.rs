//! Where on a person a box could come to rest: the level places of the hull, seen from above.

use nalgebra::{Matrix3, Point3, Vector3};
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::Hull;

/// Grid of the heights, in metres.
const CELL: f64 = 0.015;

/// Of the cells below a box, this part at least must be the subject's.
const MOSTLY: f64 = 0.7;

/// A surface this rough, in metres, carries a box no better than one of slope 1.
const LEVEL: f64 = 0.04;

/// Lower places, feet and floor, are left alone, in metres.
const LOWEST: f64 = 0.3;

/// A place for a box.
#[derive(Debug, Clone, Copy)]
pub struct Landing {
    /// The middle of the place, at the height that a box of that size touches first.
    pub top: Point3<f64>,
    /// 1 for an even, level place, less for others.
    firmness: f64,
}

/// The best `n` places for boxes with edges of `side` metres, apart from each other, the most level first.
pub fn find(hull: &Hull, n: usize, side: f64) -> Vec<Landing> {
    let heights = Heights::of(hull);
    let mut candidates = heights.landings(side);
    candidates.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let mut chosen: Vec<Landing> = Vec::new();
    for candidate in candidates {
        let is_free = |other: &Landing| (other.top - candidate.top).xy().amax() > 1.1 * side;
        if chosen.len() < n && chosen.iter().all(is_free) {
            chosen.push(candidate);
        }
    }
    chosen
}

impl Landing {
    /// Heads before laps where both are as level.
    fn score(&self) -> f64 {
        self.firmness + 0.1 * self.top.z
    }
}

/// Heights of the hull over a grid; minus infinity beside it.
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
            let entry = hull.first_span(&Ray { origin: start, direction: -Vector3::z() });
            entry.and_then(|(entry, _)| entry).map_or(f64::NEG_INFINITY, |hit| top - hit.t)
        };
        Self { origin: aabb.min, columns, rows, values: (0..columns * rows).map(value).collect() }
    }

    fn landings(&self, side: f64) -> Vec<Landing> {
        let n = (side / CELL).round().max(1.0) as usize;
        let places = (0..(self.rows + 1).saturating_sub(n))
            .flat_map(|y| (0..(self.columns + 1).saturating_sub(n)).map(move |x| (x, y)));
        places.filter_map(|(x, y)| self.landing(x, y, n)).collect()
    }

    /// A box whose base covers `n` by `n` cells from (x, y) on.
    fn landing(&self, x: usize, y: usize, n: usize) -> Option<Landing> {
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
        if top < LOWEST || covered < MOSTLY {
            return None;
        }
        let (slope, roughness) = plane(&cells)?;
        let offset = Vector3::new(x as f64 + 0.5 * n as f64, y as f64 + 0.5 * n as f64, 0.0) * CELL;
        let corner = Point3::new(self.origin.x, self.origin.y, top);
        Some(Landing { top: corner + offset, firmness: covered - slope - roughness / LEVEL })
    }
}

/// The slope of the plane nearest to `points`, and the RMS of their heights above it.
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
