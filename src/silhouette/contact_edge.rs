//! The contact normals and edge points of background pixels: the paper's mean with each vector weighted by
//! `(1 - coverage)` and a bell, which takes the square window's bias away.
//!
//! A window of 13x13 pixels is dear, and its sums have to be taken in order. So several windows are summed side by
//! side.

use super::edge::{Edge, SHORTEST_MEAN};
use super::{HALF_COVERAGE, Silhouette};
use crate::vectorised::vectorised;
use nalgebra::{Point2, Vector2};

/// Half-width of the window, in pixels.
const WINDOW: i32 = 6;

/// Pixels on its side.
const SIDE: usize = 2 * WINDOW as usize + 1;

/// Windows summed side by side.
const ABREAST: usize = 8;

/// Squared distance, in pixels, at which the contact normal's weights `(1 - r^2 / REACH_SQUARED)^3` end: a round bell
/// of standard deviation 2.2, wide enough to see past the stairs of a binary edge, narrow enough to follow a finger.
/// It ends inside the window. A Gaussian that the square window cuts off tilts the normals of straight edges by 0.08
/// degrees on average, enough for a sphere on a flat table to roll away; this one by 0.02.
const REACH_SQUARED: f64 = 48.0;

/// The weights of the contact normal's window.
const BELL: [[f64; SIDE]; SIDE] = {
    let mut weights = [[0.0; SIDE]; SIDE];
    let mut k = 0;
    while k < SIDE * SIDE {
        let (dx, dy) = ((k % SIDE) as i32 - WINDOW, (k / SIDE) as i32 - WINDOW);
        let rest = 1.0 - (dx * dx + dy * dy) as f64 / REACH_SQUARED;
        if rest > 0.0 {
            weights[k / SIDE][k % SIDE] = rest * rest * rest;
        }
        k += 1;
    }
    weights
};

/// A background pixel of a silhouette.
type Asked<'a> = (&'a Silhouette, (i32, i32));

/// How much of each pixel is background, 0 to 255, of windows side by side.
type Windows = [[[u8; ABREAST]; SIDE]; SIDE];

/// The weights' sums of windows side by side: times the offset's x, times its y, and alone.
type Sums = [[f64; ABREAST]; 3];

/// Lets the silhouettes know their edges at the pixels asked.
pub(crate) fn compute_edges(asked: &[Asked]) {
    for asked in asked.chunks(ABREAST) {
        let sums = sums_around(asked);
        for (slot, &(silhouette, pixel)) in asked.iter().enumerate() {
            silhouette.edges.get(&silhouette.region, pixel, || edge(silhouette, pixel, &sums, slot));
        }
    }
}

/// The edge at one pixel.
pub(super) fn at(silhouette: &Silhouette, pixel: (i32, i32)) -> Option<Edge> {
    edge(silhouette, pixel, &sums_around(&[(silhouette, pixel)]), 0)
}

fn edge(silhouette: &Silhouette, (i, j): (i32, i32), [x, y, total]: &Sums, slot: usize) -> Option<Edge> {
    let normal = (Vector2::new(x[slot], y[slot]) / total[slot]).try_normalize(SHORTEST_MEAN)?;
    let centre = Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
    let point = centre - normal * silhouette.depth_of_edge(centre, normal);
    Some(Edge { point, normal })
}

fn sums_around(asked: &[Asked]) -> Sums {
    let mut windows = [[[0; ABREAST]; SIDE]; SIDE];
    for (slot, &(silhouette, (i, j))) in asked.iter().enumerate() {
        for (row, dy) in windows.iter_mut().zip(-WINDOW..) {
            let values = silhouette.values_around(i, j + dy);
            for (window, value) in row.iter_mut().zip(values) {
                window[slot] = 255 - value;
            }
        }
    }
    sums(&windows)
}

vectorised! {
    fn sums(windows: &Windows) -> Sums {
        let [mut x, mut y, mut total] = [[0.0; ABREAST]; 3];
        for ((dy, row), bells) in (-WINDOW..).zip(windows).zip(&BELL) {
            for ((dx, window), bell) in (-WINDOW..).zip(row).zip(bells) {
                for k in 0..ABREAST {
                    let weight = f64::from(window[k]) * bell;
                    x[k] += f64::from(dx) * weight;
                    y[k] += f64::from(dy) * weight;
                    total[k] += weight;
                }
            }
        }
        [x, y, total]
    }
}

impl Silhouette {
    /// The bytes of row `j` in a window around column `i`.
    fn values_around(&self, i: i32, j: i32) -> [u8; SIDE] {
        match self.region.row::<SIDE>(i - WINDOW, j) {
            Some(row) => *row,
            None => std::array::from_fn(|k| self.value(i - WINDOW + k as i32, j)),
        }
    }

    /// How far inwards of a background pixel's centre the edge lies, in pixels: where coverage reaches one half, or
    /// half a pixel where the mask carries none.
    fn depth_of_edge(&self, centre: Point2<f64>, normal: Vector2<f64>) -> f64 {
        const STEP: f64 = 0.125;
        if !self.has_coverage {
            return 0.5;
        }
        let coverage = |depth: f64| {
            let inwards = centre - normal * depth;
            self.coverage(inwards.x, inwards.y) - HALF_COVERAGE
        };
        let mut before = coverage(0.0);
        for step in 1..=16 {
            let depth = f64::from(step) * STEP;
            let here = coverage(depth);
            if before < 0.0 && here >= 0.0 {
                return depth - STEP * here / (here - before);
            }
            before = here;
        }
        0.5
    }
}
