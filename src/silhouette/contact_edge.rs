//! The contact normals and edge points of background pixels: the paper's mean with each vector weighted by
//! `(1 - coverage)` and a bell, which takes the square window's bias away.
//!
//! A window of 13x13 pixels is dear, and its sums have to be taken in order. So several windows are summed side by
//! side.

use super::edge::{Edge, EdgePixel, SHORTEST_MEAN};
use super::{HALF_COVERAGE, Silhouette};
use crate::vectorised::vectorised;
use nalgebra::{Point2, Vector2};

/// Half-width of the window, in pixels.
const WINDOW: i32 = 6;

/// Pixels on its side.
const SIDE: usize = 2 * WINDOW as usize + 1;

/// Windows summed side by side.
const ABREAST: usize = 16;

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

/// The weights' sums of windows side by side: times the offset's x, times its y, and alone.
type Sums = [[f64; ABREAST]; 3];

/// Finds the edges at some background pixels of a silhouette, which remembers them.
pub(crate) fn compute_edges(silhouette: &Silhouette, pixels: &[EdgePixel]) {
    let edges = &silhouette.derived_tables().edges;
    for pixels in pixels.chunks(ABREAST) {
        let sums = sums_around(silhouette, pixels.iter().map(|pixel| pixel.at));
        for (slot, pixel) in pixels.iter().enumerate() {
            edges.get(pixel, || edge(silhouette, pixel.at, &sums, slot));
        }
    }
}

/// The edge at one pixel.
pub(super) fn at(silhouette: &Silhouette, pixel: (i32, i32)) -> Option<Edge> {
    edge(silhouette, pixel, &sums_around(silhouette, std::iter::once(pixel)), 0)
}

fn edge(silhouette: &Silhouette, (i, j): (i32, i32), [x, y, total]: &Sums, slot: usize) -> Option<Edge> {
    let normal = (Vector2::new(x[slot], y[slot]) / total[slot]).try_normalize(SHORTEST_MEAN)?;
    let centre = Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
    let point = centre - normal * silhouette.depth_of_edge(centre, normal);
    Some(Edge { point, normal })
}

fn sums_around(silhouette: &Silhouette, pixels: impl Iterator<Item = (i32, i32)>) -> Sums {
    if silhouette.has_coverage {
        return sums_of_bytes(silhouette, pixels);
    }
    let mut background = [[0; ABREAST]; SIDE];
    for (slot, pixel) in pixels.enumerate() {
        for (row, bits) in background.iter_mut().zip(silhouette.background_around(pixel)) {
            row[slot] = bits;
        }
    }
    sums_of_bits(&background)
}

vectorised! {
    /// The sums of windows given as bits: set where a pixel is background.
    fn sums_of_bits(background: &[[u64; ABREAST]; SIDE]) -> Sums {
        let [mut x, mut y, mut total] = [[0.0; ABREAST]; 3];
        for (row, weights) in background.iter().zip(&WHOLE_WEIGHTS) {
            for (place, &[dx, dy, weight]) in weights.iter().enumerate() {
                for k in 0..ABREAST {
                    // Adding nothing changes no bit, and leaves the sums in registers.
                    let is_background = row[k] >> place & 1 == 1;
                    x[k] += if is_background { dx } else { 0.0 };
                    y[k] += if is_background { dy } else { 0.0 };
                    total[k] += if is_background { weight } else { 0.0 };
                }
            }
        }
        [x, y, total]
    }
}

/// The sums of windows with coverage.
fn sums_of_bytes(silhouette: &Silhouette, pixels: impl Iterator<Item = (i32, i32)>) -> Sums {
    let [mut x, mut y, mut total] = [[0.0; ABREAST]; 3];
    for (slot, (i, j)) in pixels.enumerate() {
        for (dy, bells) in (-WINDOW..).zip(&BELL) {
            for ((dx, bell), value) in (-WINDOW..).zip(bells).zip(silhouette.values_around(i, j + dy)) {
                // Most pixels weigh nothing, and adding nothing changes no bit.
                if value != 255 && *bell != 0.0 {
                    let weight = f64::from(255 - value) * bell;
                    x[slot] += f64::from(dx) * weight;
                    y[slot] += f64::from(dy) * weight;
                    total[slot] += weight;
                }
            }
        }
    }
    [x, y, total]
}

/// What a pixel that is background altogether adds to the sums.
const WHOLE_WEIGHTS: [[[f64; 3]; SIDE]; SIDE] = {
    let mut weights = [[[0.0; 3]; SIDE]; SIDE];
    let mut k = 0;
    while k < SIDE * SIDE {
        let (dx, dy) = ((k % SIDE) as i32 - WINDOW, (k / SIDE) as i32 - WINDOW);
        let weight = 255.0 * BELL[k / SIDE][k % SIDE];
        weights[k / SIDE][k % SIDE] = [dx as f64 * weight, dy as f64 * weight, weight];
        k += 1;
    }
    weights
};

impl Silhouette {
    /// Which pixels of the rows of a window are background, the first of a row in the lowest bit.
    #[inline(always)]
    fn background_around(&self, (i, j): (i32, i32)) -> [u64; SIDE] {
        const ALL: u32 = (1 << SIDE) - 1;
        let (rect, corner) = (self.region.rect(), (i - WINDOW, j - WINDOW));
        if rect.contains(corner.0, corner.1) && rect.contains(i + WINDOW, j + WINDOW) {
            let rows = self.region.rows_from(corner.0, corner.1);
            std::array::from_fn(|down| u64::from(!rows.row(down as i32) & ALL))
        } else {
            let is_background =
                |k: usize, down: usize| !self.is_subject(corner.0 + k as i32, corner.1 + down as i32);
            std::array::from_fn(|down| {
                (0..SIDE).fold(0, |bits, k| bits | u64::from(is_background(k, down)) << k)
            })
        }
    }

    /// The bytes of row `j` in a window around column `i`.
    fn values_around(&self, i: i32, j: i32) -> [u8; SIDE] {
        match self.region.row::<SIDE>(i - WINDOW, j) {
            Some(row) => row,
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
