//! Where on a person a box could come to rest: the level places of the hull, seen from above.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::Hull;

/// Grid of the heights, in metres.
const CELL: f64 = 0.02;

/// Surfaces that differ by less carry a box together, in metres.
const LEVEL: f64 = 0.03;

/// Lower places, feet and floor, are left alone, in metres.
const LOWEST: f64 = 0.3;

/// A place for a box.
#[derive(Debug, Clone, Copy)]
pub struct Landing {
    /// The middle of the place, at the height that a box of that size touches first.
    pub top: Point3<f64>,
    /// The part of the box's base that has a level surface below it, 0 to 1.
    pub carried: f64,
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
        self.carried + 0.15 * self.top.z
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

    /// A box whose base covers `n` by `n` cells from (x, y) on. It must be carried around its middle, or it would tip.
    fn landing(&self, x: usize, y: usize, n: usize) -> Option<Landing> {
        let cells = (0..n * n).map(|k| (k % n, k / n));
        let height = |(i, j): (usize, usize)| self.values[(y + j) * self.columns + x + i];
        let top = cells.clone().map(height).fold(f64::NEG_INFINITY, f64::max);
        if top < LOWEST {
            return None;
        }
        let level: Vec<_> = cells.filter(|&cell| top - height(cell) < LEVEL).collect();
        let middle = (n as f64 - 1.0) / 2.0;
        let mean = |pick: fn((usize, usize)) -> usize| {
            level.iter().map(|&cell| pick(cell) as f64 - middle).sum::<f64>() / level.len() as f64
        };
        let off_middle = mean(|cell| cell.0).hypot(mean(|cell| cell.1)) / n as f64;
        let carried = level.len() as f64 / (n * n) as f64 * (1.0 - 2.0 * off_middle).max(0.0);
        let offset = Vector3::new(x as f64 + 0.5 * n as f64, y as f64 + 0.5 * n as f64, 0.0) * CELL;
        let corner = Point3::new(self.origin.x, self.origin.y, top);
        Some(Landing { top: corner + offset, carried })
    }
}
