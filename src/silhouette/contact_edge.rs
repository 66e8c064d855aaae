//! The contact normals and edge points at background pixels. The normal is the paper's mean vector with weights of
//! `(1 - coverage)` times a round kernel, which removes the bias of a square window.
//!
//! A window of 13x13 pixels is expensive, and its sums have a fixed order. So the sums of several windows are computed
//! in parallel lanes, and so are the crossings of half coverage.

use super::edge::{Edge, SHORTEST_MEAN};
use super::edge_table::EdgePixel;
use super::{HALF_COVERAGE, Silhouette};
use crate::math::vectorised;
use nalgebra::{Point2, Vector2};

/// Half-width of the window, in pixels.
const WINDOW: i32 = 6;

/// Pixels on a side of the window.
const SIDE: usize = 2 * WINDOW as usize + 1;

/// Windows that are summed at once, one per lane.
const WINDOWS: usize = 16;

/// Squared distance in pixels at which the weights of the contact normal, `(1 - r^2 / REACH_SQUARED)^3`, reach zero.
/// The kernel has a standard deviation of 2.2 pixels: wide enough to average out the stairs of a binary edge, narrow
/// enough to follow a finger. It ends inside the window: a Gaussian that is cut off by the square window tilts the
/// normals of straight edges by 0.08 degrees on average, enough for a sphere on a flat table to roll away; this kernel
/// by 0.02.
const REACH_SQUARED: f64 = 48.0;

/// The weights of the contact normal's window, row by row.
const KERNEL: [[f64; SIDE]; SIDE] = {
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

/// The sums over each window: weight times offset in x, weight times offset in y, and weight.
type Sums = [[f64; WINDOWS]; 3];

/// The bytes of each window: the first eight and the last eight bytes of each row, which overlap.
type Bytes = [[[u64; WINDOWS]; 2]; SIDE];

/// Index of the first of the last eight bytes of a window's row.
const LAST_EIGHT: usize = SIDE - 8;

impl Silhouette {
    /// The contact normal and edge point at background pixel `(i, j)`; `None` if the normal is not defined. It is
    /// computed once per pixel and then remembered.
    pub fn edge(&self, i: i32, j: i32) -> Option<Edge> {
        self.edge_at(&self.edge_pixel((i, j)))
    }

    /// A background pixel with its position in the table of edges, for several queries.
    #[inline(always)]
    pub(crate) fn edge_pixel(&self, at: (i32, i32)) -> EdgePixel {
        let tables = self.derived_tables();
        EdgePixel { at, rank: tables.edges.rank(&tables.boundary, &self.crop, at) }
    }

    /// [`Self::edge`] for a pixel from [`Self::edge_pixel`].
    #[inline(always)]
    pub(crate) fn edge_at(&self, pixel: &EdgePixel) -> Option<Edge> {
        self.derived_tables().edges.get(pixel, || at(self, pixel.at))
    }

    /// Returns `true` to the first caller for a pixel whose edge is not known. That caller should compute it, with
    /// [`compute_edges`].
    #[inline(always)]
    pub(crate) fn claim_edge(&self, pixel: &EdgePixel) -> bool {
        pixel.rank.is_some_and(|rank| self.derived_tables().edges.try_claim(rank))
    }
}

/// Computes the edges at background pixels of a silhouette, and stores them in its table.
pub(crate) fn compute_edges(silhouette: &Silhouette, pixels: &[EdgePixel]) {
    if pixels.is_empty() {
        return;
    }

    let table = silhouette.edge_table();
    for pixels in pixels.chunks(WINDOWS) {
        // Unused lanes repeat the first pixel.
        let mut at = [pixels[0].at; WINDOWS];
        at.iter_mut().zip(pixels).for_each(|(at, pixel)| *at = pixel.at);

        let edges = edges_at(silhouette, &at);
        for (pixel, edge) in pixels.iter().zip(edges) {
            table.get(pixel, || edge);
        }
    }
}

/// The edge at one background pixel.
pub(super) fn at(silhouette: &Silhouette, pixel: (i32, i32)) -> Option<Edge> {
    edges_at(silhouette, &[pixel; WINDOWS])[0]
}

/// The edges at several background pixels.
fn edges_at(silhouette: &Silhouette, pixels: &[(i32, i32); WINDOWS]) -> [Option<Edge>; WINDOWS] {
    let centre = |k: usize| Point2::new(f64::from(pixels[k].0) + 0.5, f64::from(pixels[k].1) + 0.5);
    let normals = |[x, y, total]: &Sums| -> [Option<Vector2<f64>>; WINDOWS] {
        std::array::from_fn(|k| (Vector2::new(x[k], y[k]) / total[k]).try_normalize(SHORTEST_MEAN))
    };

    let (normals, depths) = if silhouette.has_coverage {
        let bytes = silhouette.bytes_around(pixels);
        let normals = normals(&sums_of_bytes(&bytes));
        (normals, depths_of_edges(&bytes, pixels, &normals.map(Option::unwrap_or_default)))
    } else {
        // Without coverage the edge lies at the border of the background pixel.
        (normals(&sums_of_bits(&silhouette.background_around(pixels))), [0.5; WINDOWS])
    };

    std::array::from_fn(|k| {
        let normal = normals[k]?;
        Some(Edge { point: centre(k) - normal * depths[k], normal })
    })
}

vectorised! {
    /// The sums of windows without coverage, given as rows of bits that are set for background pixels.
    fn sums_of_bits(background: &[[u64; WINDOWS]; SIDE]) -> Sums {
        let [mut x, mut y, mut total] = [[0.0; WINDOWS]; 3];
        for (row, weights) in background.iter().zip(&BACKGROUND_TERMS) {
            for (column, &[dx, dy, weight]) in weights.iter().enumerate() {
                for k in 0..WINDOWS {
                    // Adding zero changes no bit of a sum, and avoids a branch.
                    let is_background = row[k] >> column & 1 == 1;
                    x[k] += if is_background { dx } else { 0.0 };
                    y[k] += if is_background { dy } else { 0.0 };
                    total[k] += if is_background { weight } else { 0.0 };
                }
            }
        }
        [x, y, total]
    }
}

vectorised! {
    /// The sums of windows with coverage.
    fn sums_of_bytes(bytes: &Bytes) -> Sums {
        let [mut x, mut y, mut total] = [[0.0; WINDOWS]; 3];
        for ((dy, row), weights) in (-WINDOW..).zip(bytes).zip(&KERNEL) {
            for (column, &weight) in weights.iter().enumerate() {
                // Adding zero would change no bit of a sum.
                if weight == 0.0 {
                    continue;
                }

                let (half, shift) = byte_of_row(column);
                let dx = f64::from(column as i32 - WINDOW);
                for k in 0..WINDOWS {
                    let weight = f64::from(255 - (row[half][k] >> shift) as u8) * weight;
                    x[k] += dx * weight;
                    y[k] += f64::from(dy) * weight;
                    total[k] += weight;
                }
            }
        }
        [x, y, total]
    }
}

vectorised! {
    /// The distances from background pixels' centres to the edge against the normal, in pixels. The edge is where
    /// coverage reaches one half, or at half a pixel if it does not within two pixels.
    fn depths_of_edges(
        bytes: &Bytes,
        pixels: &[(i32, i32); WINDOWS],
        normals: &[Vector2<f64>; WINDOWS],
    ) -> [f64; WINDOWS] {
        /// Distance between samples of coverage, in pixels.
        const STEP: f64 = 0.125;

        let (mut before, mut found) = ([f64::INFINITY; WINDOWS], [f64::INFINITY; WINDOWS]);
        for step in 0..=16 {
            let (depth, mut missing) = (f64::from(step) * STEP, 0);
            for k in 0..WINDOWS {
                let (i, j) = pixels[k];
                let u = f64::from(i) + 0.5 - normals[k].x * depth;
                let v = f64::from(j) + 0.5 - normals[k].y * depth;
                let here = coverage(bytes, k, (u, i), (v, j)) - HALF_COVERAGE;

                // The first crossing between two samples, by linear interpolation.
                let crosses = (before[k] < 0.0) & (here >= 0.0) & (found[k] == f64::INFINITY);
                found[k] = if crosses { depth - STEP * here / (here - before[k]) } else { found[k] };
                before[k] = here;
                missing |= u32::from(found[k] == f64::INFINITY);
            }
            if missing == 0 {
                break;
            }
        }
        found.map(|depth| if depth < f64::INFINITY { depth } else { 0.5 })
    }
}

/// [`Silhouette::coverage`] at image position `(u, v)`, from the bytes of window `k` around pixel `(i, j)`. The
/// position is within three pixels of the window's middle.
#[inline(always)]
fn coverage(bytes: &Bytes, k: usize, (u, i): (f64, i32), (v, j): (f64, i32)) -> f64 {
    let (left, above) = ((u - 0.5).floor(), (v - 0.5).floor());
    let (x, y) = (u - 0.5 - left, v - 0.5 - above);

    // A pair of adjacent bytes comes from the half of the row that holds both.
    let (column, row) = (left as i32 - i + WINDOW, above as i32 - j + WINDOW);
    let (half, shift) = if column < 7 { (0, 8 * column) } else { (1, 8 * (column - LAST_EIGHT as i32)) };
    let pair = |row: i32| {
        let two = bytes[row.clamp(0, SIDE as i32 - 1) as usize][half][k] >> (shift & 63);
        (f64::from(two as u8), f64::from((two >> 8) as u8))
    };

    let ((c00, c10), (c01, c11)) = (pair(row), pair(row + 1));
    (c00 * (1.0 - x) + c10 * x) * (1.0 - y) + (c01 * (1.0 - x) + c11 * x) * y
}

/// Which half of a row in [`Bytes`] holds the byte of a column, and the byte's position there in bits.
#[inline(always)]
fn byte_of_row(column: usize) -> (usize, usize) {
    if column < 8 { (0, 8 * column) } else { (1, 8 * (column - LAST_EIGHT)) }
}

/// What a background pixel without coverage adds to the [`Sums`], by row and column of the window.
const BACKGROUND_TERMS: [[[f64; 3]; SIDE]; SIDE] = {
    let mut weights = [[[0.0; 3]; SIDE]; SIDE];
    let mut k = 0;
    while k < SIDE * SIDE {
        let (dx, dy) = ((k % SIDE) as i32 - WINDOW, (k / SIDE) as i32 - WINDOW);
        let weight = 255.0 * KERNEL[k / SIDE][k % SIDE];
        weights[k / SIDE][k % SIDE] = [dx as f64 * weight, dy as f64 * weight, weight];
        k += 1;
    }
    weights
};

impl Silhouette {
    /// The background pixels of each window around a pixel, as rows of bits with the first column in the lowest bit.
    fn background_around(&self, pixels: &[(i32, i32); WINDOWS]) -> [[u64; WINDOWS]; SIDE] {
        const ALL: u32 = (1 << SIDE) - 1;

        let (rect, mut background) = (self.crop.rect(), [[0; WINDOWS]; SIDE]);
        for (k, &(i, j)) in pixels.iter().enumerate() {
            let (left, above) = (i - WINDOW, j - WINDOW);
            if rect.contains(left, above) && rect.contains(i + WINDOW, j + WINDOW) {
                let rows = self.crop.rows_from(left, above);
                for (down, row) in background.iter_mut().enumerate() {
                    row[k] = u64::from(!rows.row(down as i32) & ALL);
                }
            } else {
                // Pixel by pixel where the window leaves the crop.
                let is_background = |x: usize, y: usize| !self.is_subject(left + x as i32, above + y as i32);
                for (y, row) in background.iter_mut().enumerate() {
                    row[k] = (0..SIDE).fold(0, |bits, x| bits | u64::from(is_background(x, y)) << x);
                }
            }
        }
        background
    }

    /// The bytes of the window around each pixel, in a mask with coverage.
    fn bytes_around(&self, pixels: &[(i32, i32); WINDOWS]) -> Bytes {
        let (rect, mut bytes) = (self.crop.rect(), [[[0; WINDOWS]; 2]; SIDE]);
        for (k, &(i, j)) in pixels.iter().enumerate() {
            let (left, above) = (i - WINDOW, j - WINDOW);
            if rect.contains(left, above) && rect.contains(i + WINDOW, j + WINDOW) {
                let rows = self.crop.bytes()[rect.index(left, above)..].chunks(rect.width());
                for (values, row) in rows.zip(&mut bytes) {
                    let (first, last) = (values.first_chunk(), values[..SIDE].last_chunk());
                    row[0][k] = first.map_or(0, |eight| u64::from_le_bytes(*eight));
                    row[1][k] = last.map_or(0, |eight| u64::from_le_bytes(*eight));
                }
            } else {
                // Pixel by pixel where the window leaves the crop.
                for (y, row) in (above..).zip(&mut bytes) {
                    let eight = |x: i32| std::array::from_fn(|n| self.value(left + x + n as i32, y));
                    row[0][k] = u64::from_le_bytes(eight(0));
                    row[1][k] = u64::from_le_bytes(eight(LAST_EIGHT as i32));
                }
            }
        }
        bytes
    }
}
