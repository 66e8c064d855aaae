//! Mean distances of the cells of a distance image, which the flow is computed from.
//!
//! Distances of pixels are clipped to [`REACH`]. Those of cells are continued from cell to cell beyond it, which is cheaper
//! than more pixels, since a cell holds sixteen.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::distance_image::{DistanceImage, REACH, UNIT};
use crate::math::lanes::select;
use crate::math::vectorised;

/// Pixels along a side of a cell, over which distances are averaged for the flow.
pub(super) const CELL: i32 = 4;

/// The largest mean distance of a cell, in pixels. The flow of a part that moves farther than this has no slope to
/// follow, unless larger cells show one.
pub(super) const CELL_REACH: i32 = 24;

/// Steps from cell to cell between the two.
const CELL_STEPS: usize = ((CELL_REACH - REACH) / CELL) as usize;

impl DistanceImage {
    /// Continues the mean distances of cells up to [`CELL_REACH`].
    pub(super) fn fill_cells(&mut self, means: &[f32], [spread, next]: &mut [Vec<f32>; 2]) {
        let side = CELL as usize;
        self.cell_rect = self.rect.grown(CELL_REACH - REACH);
        let (columns, rows) = (self.cell_rect.width() / side, self.cell_rect.height() / side);
        self.cells.clear();
        self.cells.resize(columns * rows, CELL_REACH as f32);
        if means.is_empty() || self.rect.is_empty() {
            return;
        }

        let stride = columns + 2;
        for memory in [&mut *spread, &mut *next] {
            memory.clear();
            memory.resize(stride * (rows + 2), CELL_REACH as f32);
        }
        let own = self.rect.width() / side;
        for (y, means) in means.chunks_exact(own).enumerate() {
            let first = (y + CELL_STEPS) * columns + CELL_STEPS;
            self.cells[first..][..own].copy_from_slice(means);
            let first = (y + CELL_STEPS + 1) * stride + CELL_STEPS + 1;
            for (spread, mean) in spread[first..][..own].iter_mut().zip(means) {
                let distance = mean.abs();
                *spread = select(distance < REACH as f32, distance, CELL_REACH as f32);
            }
        }

        for _ in 0..CELL_STEPS {
            step_to_neighbours(spread, next, stride);
            std::mem::swap(spread, next);
        }
        for (cells, spread) in self.cells.chunks_exact_mut(columns).zip(spread.chunks_exact(stride).skip(1)) {
            for (cell, spread) in cells.iter_mut().zip(&spread[1..]) {
                *cell = spread.copysign(*cell);
            }
        }
    }
}

vectorised! {
    /// Averages the distances over cells, in pixels.
    pub(super) fn average_cells(values: &[i16], width: usize, cells: &mut [f32]) {
        let (side, columns) = (CELL as usize, width / CELL as usize);
        for (rows, cells) in values.chunks_exact(side * width).zip(cells.chunks_exact_mut(columns)) {
            for (x, cell) in cells.iter_mut().enumerate() {
                let mut sum = 0;
                for y in 0..side {
                    let row = &rows[y * width + side * x..][..side];
                    for k in 0..side {
                        sum += i32::from(row[k]);
                    }
                }
                *cell = sum as f32 / (UNIT * (CELL * CELL) as f32);
            }
        }
    }
}

vectorised! {
    /// Writes to `next` the least of each cell's distance and of those of its neighbours plus the way to them; the
    /// outermost cells stay. Rows have `stride` cells.
    fn step_to_neighbours(distances: &[f32], next: &mut [f32], stride: usize) {
        let (beside, diagonal) = (CELL as f32, CELL as f32 * std::f32::consts::SQRT_2);
        let width = stride - 2;
        let rows = next.chunks_exact_mut(stride).skip(1).take(distances.len() / stride - 2);
        for (y, next) in rows.enumerate() {
            let row = |down: usize| &distances[(y + down) * stride..][..stride];
            let [above, own, below] = [row(0), row(1), row(2)];
            let next = &mut next[1..][..width];
            for x in 0..width {
                let straight = own[x].min(own[x + 2]).min(above[x + 1]).min(below[x + 1]) + beside;
                let across = above[x].min(above[x + 2]).min(below[x]).min(below[x + 2]) + diagonal;
                next[x] = own[x + 1].min(straight).min(across);
            }
        }
    }
}
