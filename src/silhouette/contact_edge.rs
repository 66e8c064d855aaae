//! The contact normals and edge points of background pixels: the paper's mean with each vector weighted by
//! `(1 - coverage)` and a round kernel, which takes the square window's bias away.
//!
//! A window of 13x13 pixels is dear, and its sums have to be taken in order. So several windows are summed side by
//! side, and so are the half-coverage crossings found.

use super::edge::{Edge, SHORTEST_MEAN};
use super::edge_table::EdgePixel;
use super::{HALF_COVERAGE, Silhouette};
use crate::math::vectorised;
use nalgebra::{Point2, Vector2};

/// Half-width of the window, in pixels.
const WINDOW: i32 = 6;

/// Pixels on its side.
const SIDE: usize = 2 * WINDOW as usize + 1;

/// Windows summed side by side.
const ABREAST: usize = 16;

/// Squared distance, in pixels, at which the contact normal's weights `(1 - r^2 / REACH_SQUARED)^3` end: a round kernel
/// of standard deviation 2.2, wide enough to see past the stairs of a binary edge, narrow enough to follow a finger.
/// It ends inside the window. A Gaussian that the square window cuts off tilts the normals of straight edges by 0.08
/// degrees on average, enough for a sphere on a flat table to roll away; this one by 0.02.
const REACH_SQUARED: f64 = 48.0;

/// The weights of the contact normal's window.
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

/// The weights' sums of windows side by side: times the offset's x, times its y, and alone.
type Sums = [[f64; ABREAST]; 3];

/// The bytes of windows side by side: of each row the first eight, and the last eight, which overlap.
type Bytes = [[[u64; ABREAST]; 2]; SIDE];

/// Where the last eight bytes of a row of a window begin.
const LAST_EIGHT: usize = SIDE - 8;

impl Silhouette {
    /// The contact normal and edge point at background pixel `(i, j)`, computed once a pixel.
    pub fn edge(&self, i: i32, j: i32) -> Option<Edge> {
        self.edge_at(&self.edge_pixel((i, j)))
    }

    /// A background pixel whose edge is to be asked for more than once.
    #[inline(always)]
    pub(crate) fn edge_pixel(&self, at: (i32, i32)) -> EdgePixel {
        let tables = self.derived_tables();
        EdgePixel { at, rank: tables.edges.rank(&tables.boundary, &self.crop, at) }
    }

    /// [`Self::edge`] at a pixel.
    #[inline(always)]
    pub(crate) fn edge_at(&self, pixel: &EdgePixel) -> Option<Edge> {
        self.derived_tables().edges.get(pixel, || at(self, pixel.at))
    }

    /// Whether the caller is the first to ask for the edge at a pixel, and should see to it that it becomes known.
    #[inline(always)]
    pub(crate) fn claim_edge(&self, pixel: &EdgePixel) -> bool {
        pixel.rank.is_some_and(|rank| self.derived_tables().edges.try_claim(rank))
    }
}

/// Finds the edges at some background pixels of a silhouette, which remembers them.
pub(crate) fn compute_edges(silhouette: &Silhouette, pixels: &[EdgePixel]) {
    if pixels.is_empty() {
        return;
    }
    let edges = silhouette.edge_table();
    for pixels in pixels.chunks(ABREAST) {
        let mut at = [pixels[0].at; ABREAST];
        at.iter_mut().zip(pixels).for_each(|(at, pixel)| *at = pixel.at);
        let found = edges_at(silhouette, &at);
        for (pixel, edge) in pixels.iter().zip(found) {
            edges.get(pixel, || edge);
        }
    }
}

/// The edge at one pixel.
pub(super) fn at(silhouette: &Silhouette, pixel: (i32, i32)) -> Option<Edge> {
    edges_at(silhouette, &[pixel; ABREAST])[0]
}

/// The edges at background pixels.
fn edges_at(silhouette: &Silhouette, pixels: &[(i32, i32); ABREAST]) -> [Option<Edge>; ABREAST] {
    let centre = |k: usize| Point2::new(f64::from(pixels[k].0) + 0.5, f64::from(pixels[k].1) + 0.5);
    let normals = |[x, y, total]: &Sums| -> [Option<Vector2<f64>>; ABREAST] {
        std::array::from_fn(|k| (Vector2::new(x[k], y[k]) / total[k]).try_normalize(SHORTEST_MEAN))
    };
    let (normals, depths) = if silhouette.has_coverage {
        let bytes = silhouette.bytes_around(pixels);
        let normals = normals(&sums_of_bytes(&bytes));
        (normals, depths_of_edges(&bytes, pixels, &normals.map(Option::unwrap_or_default)))
    } else {
        // The edge lies at the pixels' border.
        (normals(&sums_of_bits(&silhouette.background_around(pixels))), [0.5; ABREAST])
    };
    std::array::from_fn(|k| {
        let normal = normals[k]?;
        Some(Edge { point: centre(k) - normal * depths[k], normal })
    })
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

vectorised! {
    /// The sums of windows with coverage.
    fn sums_of_bytes(bytes: &Bytes) -> Sums {
        let [mut x, mut y, mut total] = [[0.0; ABREAST]; 3];
        for ((dy, row), weights) in (-WINDOW..).zip(bytes).zip(&KERNEL) {
            for (place, &weight) in weights.iter().enumerate() {
                // Adding nothing changes no bit.
                if weight == 0.0 {
                    continue;
                }
                let (eight, shift) = byte_of_row(place);
                let dx = f64::from(place as i32 - WINDOW);
                for k in 0..ABREAST {
                    let weight = f64::from(255 - (row[eight][k] >> shift) as u8) * weight;
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
    /// How far inwards of background pixels' centres their edges lie, in pixels: where coverage reaches one half on the
    /// way along the normal, or half a pixel where it does not within two.
    fn depths_of_edges(
        bytes: &Bytes,
        pixels: &[(i32, i32); ABREAST],
        normals: &[Vector2<f64>; ABREAST],
    ) -> [f64; ABREAST] {
        const STEP: f64 = 0.125;
        let (mut before, mut found) = ([f64::INFINITY; ABREAST], [f64::INFINITY; ABREAST]);
        for step in 0..=16 {
            let (depth, mut missing) = (f64::from(step) * STEP, 0);
            for k in 0..ABREAST {
                let (i, j) = pixels[k];
                let u = f64::from(i) + 0.5 - normals[k].x * depth;
                let v = f64::from(j) + 0.5 - normals[k].y * depth;
                let here = coverage(bytes, k, (u, i), (v, j)) - HALF_COVERAGE;
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

/// Coverage in window k at a position within three pixels of its middle: [`Silhouette::coverage`] in the image.
#[inline(always)]
fn coverage(bytes: &Bytes, k: usize, (u, i): (f64, i32), (v, j): (f64, i32)) -> f64 {
    let (left, above) = ((u - 0.5).floor(), (v - 0.5).floor());
    let (x, y) = (u - 0.5 - left, v - 0.5 - above);
    let (place, row) = (left as i32 - i + WINDOW, above as i32 - j + WINDOW);
    let (eight, shift) = if place < 7 { (0, 8 * place) } else { (1, 8 * (place - LAST_EIGHT as i32)) };
    let pair = |row: i32| {
        let two = bytes[row.clamp(0, SIDE as i32 - 1) as usize][eight][k] >> (shift & 63);
        (f64::from(two as u8), f64::from((two >> 8) as u8))
    };
    let ((c00, c10), (c01, c11)) = (pair(row), pair(row + 1));
    (c00 * (1.0 - x) + c10 * x) * (1.0 - y) + (c01 * (1.0 - x) + c11 * x) * y
}

/// Which of the two eights of a row holds a byte, and by how many bits it is shifted there.
#[inline(always)]
fn byte_of_row(place: usize) -> (usize, usize) {
    if place < 8 { (0, 8 * place) } else { (1, 8 * (place - LAST_EIGHT)) }
}

/// What a pixel that is background altogether adds to the sums.
const WHOLE_WEIGHTS: [[[f64; 3]; SIDE]; SIDE] = {
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
    /// Which pixels of the rows of windows are background, the first of a row in the lowest bit.
    fn background_around(&self, pixels: &[(i32, i32); ABREAST]) -> [[u64; ABREAST]; SIDE] {
        const ALL: u32 = (1 << SIDE) - 1;
        let (rect, mut background) = (self.crop.rect(), [[0; ABREAST]; SIDE]);
        for (k, &(i, j)) in pixels.iter().enumerate() {
            let (left, above) = (i - WINDOW, j - WINDOW);
            if rect.contains(left, above) && rect.contains(i + WINDOW, j + WINDOW) {
                let rows = self.crop.rows_from(left, above);
                for (down, row) in background.iter_mut().enumerate() {
                    row[k] = u64::from(!rows.row(down as i32) & ALL);
                }
            } else {
                let is_background = |x: usize, y: usize| !self.is_subject(left + x as i32, above + y as i32);
                for (y, row) in background.iter_mut().enumerate() {
                    row[k] = (0..SIDE).fold(0, |bits, x| bits | u64::from(is_background(x, y)) << x);
                }
            }
        }
        background
    }

    /// The bytes of windows around pixels, of a mask with coverage.
    fn bytes_around(&self, pixels: &[(i32, i32); ABREAST]) -> Bytes {
        let (rect, mut bytes) = (self.crop.rect(), [[[0; ABREAST]; 2]; SIDE]);
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
