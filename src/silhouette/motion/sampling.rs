//! Bilinear samples of distance images, many at once.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::cell_means::{CELL, CELL_REACH};
use super::distance_image::{DistanceImage, REACH, UNIT};
use crate::math::lanes::{floor_clamped, select};
use crate::silhouette::mask_crop::LOW;

/// Pixels along a side of a cell.
const SIDE: usize = CELL as usize;

/// Pixels of a cell.
pub(super) const PIXELS: usize = SIDE * SIDE;

impl DistanceImage {
    /// The distance at image position `(u, v)`, as [`Self::sample_many`].
    pub(super) fn sample(&self, u: f32, v: f32) -> f32 {
        let [distance] = self.sample_many(&[u], &[v]);
        distance
    }

    /// The distances at `N` image positions, bilinear between pixel centres. A position beyond the outermost centres is
    /// moved to the nearest position between them, where the distance is [`REACH`] unless the image ends there.
    #[inline(always)]
    pub(super) fn sample_many<const N: usize>(&self, u: &[f32; N], v: &[f32; N]) -> [f32; N] {
        let (width, height) = (self.rect.width(), self.rect.height());
        let mut distances = [REACH as f32; N];
        if width < 2 || height < 2 {
            return distances;
        }

        let (left, top) = (self.rect.x0 as f32 + 0.5, self.rect.y0 as f32 + 0.5);
        let (columns, rows) = (width as u32, height as u32);
        let values = Lookup::new(&self.values);
        for k in 0..N {
            let (i, fx) = place_between(u[k] - left, columns);
            let (j, fy) = place_between(v[k] - top, rows);
            let first = j * columns + i;
            let row = |first: u32| {
                let (a, b) = (f32::from(values.at(first)), f32::from(values.at(first + 1)));
                a + (b - a) * fx
            };
            let (upper, lower) = (row(first), row(first + columns));
            distances[k] = (upper + (lower - upper) * fy) * (1.0 / UNIT);
        }
        distances
    }

    /// The distances at a cell's worth of image positions, one pixel from one another, row by row from `(u, v)` on, and
    /// their changes per pixel to the right and down; `None` where these reach beyond the outermost centres.
    #[inline(always)]
    pub(super) fn sample_block(&self, u: f32, v: f32) -> Option<[[f32; PIXELS]; 3]> {
        let (x, y) = (u - (self.rect.x0 as f32 + 0.5), v - (self.rect.y0 as f32 + 0.5));
        let (columns, rows) = (self.rect.width(), self.rect.height());
        let end = |count: usize| count as f32 - (SIDE + 1) as f32;
        if !(x >= 0.0 && y >= 0.0 && x < end(columns) && y < end(rows)) {
            return None;
        }

        let (i, j) = (x as usize, y as usize);
        let (fx, fy) = (x - i as f32, y - j as f32);
        let (mut means, mut changes) = ([[0.0; SIDE]; SIDE + 1], [[0.0; SIDE]; SIDE + 1]);
        let values = &self.values[j * columns + i..];
        for row in 0..=SIDE {
            let values: &[i16; 2 * SIDE] = values[row * columns..].first_chunk()?;
            for k in 0..SIDE {
                let (a, b) = (f32::from(values[k]), f32::from(values[k + 1]));
                changes[row][k] = (b - a) * (1.0 / UNIT);
                means[row][k] = a * (1.0 / UNIT) + changes[row][k] * fx;
            }
        }

        let mut block = [[0.0; PIXELS]; 3];
        for k in 0..PIXELS {
            let (row, column) = (k / SIDE, k % SIDE);
            let down = means[row + 1][column] - means[row][column];
            block[0][k] = means[row][column] + down * fy;
            block[1][k] = changes[row][column] + (changes[row + 1][column] - changes[row][column]) * fy;
            block[2][k] = down;
        }
        Some(block)
    }

    /// The mean distances around `N` image positions, bilinear between the centres of cells, at the ends as in
    /// [`Self::sample_many`].
    #[inline(always)]
    pub(super) fn sample_cells<const N: usize>(&self, u: &[f32; N], v: &[f32; N]) -> [f32; N] {
        let (columns, rows) =
            (self.cell_rect.width() as u32 / CELL as u32, self.cell_rect.height() as u32 / CELL as u32);
        let mut distances = [CELL_REACH as f32; N];
        if columns < 2 || rows < 2 {
            return distances;
        }

        let (side, half) = (1.0 / CELL as f32, 0.5 * CELL as f32);
        let (left, top) = (self.cell_rect.x0 as f32 + half, self.cell_rect.y0 as f32 + half);
        let cells = Lookup::new(&self.cells);
        for k in 0..N {
            let (i, fx) = place_between((u[k] - left) * side, columns);
            let (j, fy) = place_between((v[k] - top) * side, rows);
            let first = j * columns + i;
            let row = |first: u32| cells.at(first) + (cells.at(first + 1) - cells.at(first)) * fx;
            let (upper, lower) = (row(first), row(first + columns));
            distances[k] = upper + (lower - upper) * fy;
        }
        distances
    }
}

/// A table that many lanes look up at once, by one gather instruction.
#[derive(Clone, Copy)]
pub(super) struct Lookup<'a, T> {
    values: &'a [T],
    last: u32,
}

impl<'a, T: Copy> Lookup<'a, T> {
    /// A look-up in a table that is not empty.
    #[inline(always)]
    pub(super) fn new(values: &'a [T]) -> Self {
        let last = (values.len() - 1) as u32 & LOW;
        Self { values: &values[..=last as usize], last }
    }

    /// The value at an index; the last one beyond the end.
    #[inline(always)]
    pub(super) fn at(&self, index: u32) -> T {
        self.values[index.min(self.last) as usize]
    }
}

/// The index below the position `x` among `count` samples, and the rest; both are clamped to the samples. There are at
/// least two.
#[inline(always)]
pub(super) fn place_between(x: f32, count: u32) -> (u32, f32) {
    let last = (count - 2) as f32;
    let below = floor_clamped(x, last);
    let rest = x - below as f32;
    let rest = select(rest > 0.0, rest, 0.0);
    (below, select(rest < 1.0, rest, 1.0))
}
