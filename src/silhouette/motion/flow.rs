//! Dense optical flow between two silhouettes by dense inverse search (Kroeger, Timofte, Dai and Van Gool 2016), on
//! their signed distances.
//!
//! ```text
//!   cells of 32 x 32 pixels      patches of 8 x 8 cells, each moved until it fits the earlier image best
//!        | x 2                   their motions, averaged over the patches that hold a cell, start the next level
//!   cells of 16 x 16
//!       ...
//!   cells of 4 x 4               smoothed: the flow
//! ```
//!
//! Signed distances have a slope at every pixel near an edge, so that a patch beside the edge of a mask without any
//! texture knows how far the edge has moved.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::cell_means::{CELL, CELL_REACH};
use super::distance_image::DistanceImage;
use super::level::Level;
use super::patch::{PATCH, PatchSearch};
use super::sampling::{Lookup, place_between};
use crate::math::lanes::select;
use crate::math::vectorised;
use crate::silhouette::Rect;

/// Levels of the pyramid: cells of 4, 8, 16 and 32 pixels.
const LEVELS: usize = 4;

/// Cells from one patch to the next: patches overlap by half.
const STRIDE: usize = PATCH / 2;

/// Cells that are computed at once.
const LANES: usize = 8;

/// A five-tap Gaussian whose standard deviation is one cell.
const GAUSSIAN: [f32; 3] = [0.402_62, 0.244_2, 0.054_49];

/// The motion of an image's cells from the later to the earlier of two silhouettes.
#[derive(Debug, Default)]
pub(super) struct Flow {
    /// The cells that have a motion, in pixels of the image. The motion of all others is zero.
    rect: Rect,
    /// Right and down, in pixels, row-major over the cells of `rect`.
    right: Vec<f32>,
    down: Vec<f32>,
    longest: f32,
    /// As `right` and `down`, for warping ahead: shorter where the later image does not fit the earlier one, and nowhere
    /// longer than [`MAX_AHEAD`].
    ahead: [Vec<f32>; 2],
    /// The mean distances of these cells in the earlier and the later image.
    distances: [Vec<f32>; 2],
}

/// The motions of a flow, as a warp needs them.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlowView<'a> {
    rect: Rect,
    right: &'a [f32],
    down: &'a [f32],
    distances: [&'a [f32]; 2],
}

/// The longest motion ahead, in pixels.
pub(super) const MAX_AHEAD: f32 = 64.0;

/// Differences of the distances at a cell and where its motion leads, in pixels: up to the first the motion is trusted,
/// from the second on it is not.
const TRUSTED: [f32; 2] = [1.5, 4.0];

/// A row of cells, from the left of a flow's rectangle on.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlowRow<'a> {
    pub(super) right: &'a [f32],
    pub(super) down: &'a [f32],
    /// The mean distances in the earlier and the later image.
    pub(super) distances: [&'a [f32]; 2],
}

/// Memory for computing a flow.
#[derive(Debug, Default)]
pub(super) struct FlowScratch {
    levels: [Level; LEVELS],
    search: PatchSearch,
    /// A row and an image that are being smoothed.
    row: Vec<f32>,
    smoothed: Vec<f32>,
}

impl Flow {
    /// Computes the flow from `later` back to `earlier`, in the memory of the last one.
    pub(super) fn fill(&mut self, earlier: &DistanceImage, later: &DistanceImage, scratch: &mut FlowScratch) {
        self.rect = later.cell_rect.union(&earlier.cell_rect);
        let FlowScratch { levels, search, row, smoothed } = scratch;

        let (finest, coarser) = levels.split_at_mut(1);
        finest[0].fill(&self.rect, earlier, later);
        let mut finer = &mut finest[0];
        for level in coarser {
            level.halve(finer);
            finer = level;
        }

        for k in (0..LEVELS).rev() {
            let (fine, coarse) = levels.split_at_mut(k + 1);
            fine[k].start_from(coarse.first());
            search.run(&mut fine[k], STRIDE);
        }

        let finest = &levels[0];
        finest.write_flow(&mut self.right, &mut self.down);
        for (image, cells) in [earlier, later].into_iter().zip(&mut self.distances) {
            copy_cells(&self.rect, image, cells);
        }
        let columns = self.rect.width() / CELL as usize;
        self.longest = 0.0;
        for component in [&mut self.right, &mut self.down] {
            if columns > 0 {
                smooth(component, columns, CELL as f32, row, smoothed);
            }
            let longest = component.iter().fold(0.0, |longest: f32, motion| longest.max(motion.abs()));
            self.longest = self.longest.max(longest);
        }
        self.shorten_ahead(earlier);
    }

    /// Replaces the later image by another one of about the same mask, from which the same flow leads.
    pub(super) fn replace_later(&mut self, later: &DistanceImage) {
        copy_cells(&self.rect, later, &mut self.distances[1]);
    }

    /// The cells that have a motion, as pixels.
    pub(super) fn rect(&self) -> Rect {
        self.rect
    }

    /// The largest motion along either axis, in pixels.
    pub(super) fn longest(&self) -> f32 {
        self.longest
    }

    /// The motions between the two images.
    pub(super) fn between(&self) -> FlowView<'_> {
        self.view(&self.right, &self.down)
    }

    /// The motions for warping ahead of the later image.
    pub(super) fn ahead(&self) -> FlowView<'_> {
        self.view(&self.ahead[0], &self.ahead[1])
    }

    fn view<'a>(&'a self, right: &'a [f32], down: &'a [f32]) -> FlowView<'a> {
        FlowView { rect: self.rect, right, down, distances: [&self.distances[0], &self.distances[1]] }
    }

    /// Shortens the motions for warping ahead where they are not trusted.
    fn shorten_ahead(&mut self, earlier: &DistanceImage) {
        for (ahead, motions) in self.ahead.iter_mut().zip([&self.right, &self.down]) {
            ahead.clone_from(motions);
        }
        if !self.rect.is_empty() {
            shorten(&self.rect, earlier, &self.distances[1], &mut self.ahead);
        }
    }
}

vectorised! {
    /// Shortens the motions of cells where the distances at the cell, `later`, and where the motion leads differ.
    fn shorten(rect: &Rect, earlier: &DistanceImage, later: &[f32], motions: &mut [Vec<f32>; 2]) {
        let columns = rect.width() / CELL as usize;
        let [right, down] = motions;
        let rows = right.chunks_exact_mut(columns).zip(down.chunks_exact_mut(columns)).zip(later.chunks_exact(columns));
        for (y, ((right, down), later)) in rows.enumerate() {
            let (right, right_rest) = right.as_chunks_mut::<LANES>();
            let (down, down_rest) = down.as_chunks_mut::<LANES>();
            let (later, later_rest) = later.as_chunks::<LANES>();
            let at = |x: usize| [centre(rect.x0, x), centre(rect.y0, y)];
            for (x, ((right, down), later)) in right.iter_mut().zip(down).zip(later).enumerate() {
                shorten_lanes(at(LANES * x), earlier, later, right, down);
            }
            let rest = right_rest.iter_mut().zip(down_rest).zip(later_rest);
            for (x, ((right, down), later)) in (columns - columns % LANES..).zip(rest) {
                shorten_lanes(at(x), earlier, &[*later], std::array::from_mut(right), std::array::from_mut(down));
            }
        }
    }
}

/// The centre of a cell along an axis, in pixels, where the first cell begins at `first`.
#[inline(always)]
fn centre(first: i32, cell: usize) -> f32 {
    (first + CELL * cell as i32) as f32 + 0.5 * CELL as f32
}

/// Shortens the motions of `N` cells beside each other; `at` is the centre of the first.
#[inline(always)]
fn shorten_lanes<const N: usize>(
    at: [f32; 2],
    earlier: &DistanceImage,
    later: &[f32; N],
    right: &mut [f32; N],
    down: &mut [f32; N],
) {
    let (mut u, mut v) = ([0.0; N], [0.0; N]);
    for k in 0..N {
        u[k] = at[0] + CELL as f32 * k as f32 + right[k];
        v[k] = at[1] + down[k];
    }
    let before = earlier.sample_cells(&u, &v);

    let [trusted, lost] = TRUSTED;
    for k in 0..N {
        let trust = (lost - (before[k] - later[k]).abs()) * (1.0 / (lost - trusted));
        let trust = select(trust > 0.0, select(trust < 1.0, trust, 1.0), 0.0);
        let length = (right[k] * right[k] + down[k] * down[k]).sqrt();
        let factor = trust * select(length > MAX_AHEAD, MAX_AHEAD / length, 1.0);
        right[k] *= factor;
        down[k] *= factor;
    }
}

impl<'a> FlowView<'a> {
    /// The cells that have a motion, as pixels.
    pub(super) fn rect(&self) -> Rect {
        self.rect
    }

    /// The cells of a row, if it is one of [`Self::rect`].
    pub(super) fn row(&self, row: i32) -> Option<FlowRow<'a>> {
        let columns = self.rect.width() / CELL as usize;
        let cells = usize::try_from(row).ok()? * columns;
        let cells = cells..cells + columns;
        let [earlier, later] = self.distances;
        let distances = [earlier.get(cells.clone())?, later.get(cells.clone())?];
        Some(FlowRow { right: self.right.get(cells.clone())?, down: self.down.get(cells)?, distances })
    }

    /// The motion of a cell of [`Self::rect`], right and down in pixels; that of the nearest one for cells outside.
    #[inline(always)]
    pub(super) fn of_cell(&self, column: i32, row: i32) -> [f32; 2] {
        let (columns, rows) = (self.rect.width() as i32 / CELL, self.rect.height() as i32 / CELL);
        let index = (row.clamp(0, rows - 1) * columns + column.clamp(0, columns - 1)) as usize;
        [self.right[index], self.down[index]]
    }

    /// The motion at image position `(u, v)`, as [`Self::at_many`].
    pub(super) fn at(&self, u: f32, v: f32) -> [f32; 2] {
        self.at_many(&[u], &[v]).map(|[motion]| motion)
    }

    /// The motions at `N` image positions, right and down in pixels, bilinear between the centres of cells. A position beyond
    /// the outermost centres has the motion of the nearest position between them.
    #[inline(always)]
    pub(super) fn at_many<const N: usize>(&self, u: &[f32; N], v: &[f32; N]) -> [[f32; N]; 2] {
        let (columns, rows) =
            (self.rect.width() as u32 / CELL as u32, self.rect.height() as u32 / CELL as u32);
        let mut motions = [[0.0; N]; 2];
        if columns < 2 || rows < 2 {
            return motions;
        }

        let (side, half) = (1.0 / CELL as f32, 0.5 * CELL as f32);
        let (left, top) = (self.rect.x0 as f32 + half, self.rect.y0 as f32 + half);
        let (right, down) = (Lookup::new(self.right), Lookup::new(self.down));
        for k in 0..N {
            let (i, fx) = place_between((u[k] - left) * side, columns);
            let (j, fy) = place_between((v[k] - top) * side, rows);
            let first = j * columns + i;
            let row = |of: &Lookup<f32>, first: u32| of.at(first) + (of.at(first + 1) - of.at(first)) * fx;
            let (upper, lower) = (row(&right, first), row(&right, first + columns));
            motions[0][k] = upper + (lower - upper) * fy;
            let (upper, lower) = (row(&down, first), row(&down, first + columns));
            motions[1][k] = upper + (lower - upper) * fy;
        }
        motions
    }
}

/// Copies the mean distances of the cells of `rect`; those beyond the image are as far from its edge as can be.
fn copy_cells(rect: &Rect, image: &DistanceImage, cells: &mut Vec<f32>) {
    let (side, own) = (CELL as usize, image.cell_rect);
    let columns = rect.width() / side;
    cells.clear();
    cells.resize(columns * rect.height() / side, CELL_REACH as f32);
    let inner = own.intersection(rect);
    if inner.is_empty() {
        return;
    }
    let (width, own_columns) = (inner.width() / side, own.width() / side);
    for y in (inner.y0..inner.y1).step_by(side) {
        let place = |of: &Rect, columns: usize| {
            (y - of.y0) as usize / side * columns + (inner.x0 - of.x0) as usize / side
        };
        let row = &image.cells[place(&own, own_columns)..][..width];
        cells[place(rect, columns)..][..width].copy_from_slice(row);
    }
}

vectorised! {
    /// Smooths an image of `width` columns by a Gaussian, along rows and then along columns, and multiplies it by
    /// `factor`. The outermost pixels count as continued.
    fn smooth(image: &mut [f32], width: usize, factor: f32, row_memory: &mut Vec<f32>, smoothed: &mut Vec<f32>) {
        let [centre, next, far] = GAUSSIAN;
        smoothed.resize(image.len(), 0.0);
        row_memory.resize(width + 4, 0.0);
        for (row, smoothed) in image.chunks_exact(width).zip(smoothed.chunks_exact_mut(width)) {
            row_memory[..2].fill(row[0]);
            row_memory[2..][..width].copy_from_slice(row);
            row_memory[width + 2..].fill(row[width - 1]);
            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|shift| &row_memory[shift..][..width]);
            for x in 0..width {
                smoothed[x] = centre * c[x] + next * (b[x] + d[x]) + far * (a[x] + e[x]);
            }
        }

        let last = image.len() / width - 1;
        for (y, row) in image.chunks_exact_mut(width).enumerate() {
            let at = |down: isize| {
                let y = (y as isize + down).clamp(0, last as isize) as usize;
                &smoothed[y * width..][..width]
            };
            let [a, b, c, d, e] = [at(-2), at(-1), at(0), at(1), at(2)];
            for x in 0..width {
                row[x] = factor * (centre * c[x] + next * (b[x] + d[x]) + far * (a[x] + e[x]));
            }
        }
    }
}
