//! Inverse search: patches of the later image are moved until they fit the earlier one.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::level::{Level, PAD};
use crate::math::vectorised;

/// Cells along a side of a patch.
pub(super) const PATCH: usize = 8;

/// The most steps of a patch in one descent.
const MAX_STEPS: usize = 8;

/// A descent ends with a step shorter than this, in cells.
const SHORT_STEP: f32 = 0.03;

/// A patch moves by at most this from where a descent began, in cells.
const LONGEST: f32 = PATCH as f32;

/// A patch whose sum of squared differences, in square pixels, is below this fits.
const FITS: f32 = 0.01;

/// A neighbour's motion replaces a patch's own if it fits better by this factor.
const BETTER: f32 = 0.8;

/// Part of the gradient's energy that is added in all directions: along a straight edge no motion can be told.
const DAMPING: f32 = 0.02;

/// The sum of the squared gradient below which a patch has no edge near it.
const FLAT: f32 = 0.5;

/// The rows of a patch.
type Rows = [[f32; PATCH]; PATCH];

/// Finds the flow of a level, and keeps memory for the next one.
#[derive(Debug, Default)]
pub(super) struct PatchSearch {
    columns: usize,
    patches: Vec<Patch>,
    /// Sums of weights and of weighted motions, over the cells of the level.
    sums: [Vec<f32>; 3],
}

/// A patch of the later image and its motion.
#[derive(Debug, Clone, Copy, Default)]
struct Patch {
    motion: [f32; 2],
    /// The sum of squared differences.
    error: f32,
    is_flat: bool,
    /// The inverse of the damped matrix of gradient products: the elements 00, 01 and 11.
    inverse: [f32; 3],
}

impl PatchSearch {
    /// Improves the flow of `level`, with patches `stride` cells apart.
    pub(super) fn run(&mut self, level: &mut Level, stride: usize) {
        if level.width > 0 && level.height > 0 {
            let Self { columns, patches, sums } = self;
            *columns = level.width.div_ceil(stride) + 1;
            patches.clear();
            patches.resize(*columns * (level.height.div_ceil(stride) + 1), Patch::default());
            search(level, stride, *columns, patches);
            average(level, stride, *columns, patches, sums);
        }
    }
}

/// The position of a patch's first cell in the padded image.
#[inline(always)]
fn place(k: usize, stride: usize) -> usize {
    PAD - (PATCH - stride) + stride * k
}

vectorised! {
    /// Moves all patches until they fit.
    fn search(level: &Level, stride: usize, columns: usize, patches: &mut [Patch]) {
        // First from the upper left to the lower right, then back, so that a good motion spreads in all directions.
        for k in 0..patches.len() {
            let (i, j) = (k % columns, k / columns);
            let target = Target::new(level, place(i, stride), place(j, stride));
            let mut patch = target.start(level, i * stride, j * stride);
            if patch.error > FITS && !patch.is_flat {
                target.try_motion(&mut patch, [0.0; 2]);
                if i > 0 {
                    target.try_motion(&mut patch, patches[k - 1].motion);
                }
                if j > 0 {
                    target.try_motion(&mut patch, patches[k - columns].motion);
                }
                target.descend(&mut patch);
            }
            patches[k] = patch;
        }

        for k in (0..patches.len()).rev() {
            let (i, j) = (k % columns, k / columns);
            let mut patch = patches[k];
            if patch.error <= FITS || patch.is_flat {
                continue;
            }
            let (before, target) = (patch.error, Target::new(level, place(i, stride), place(j, stride)));
            if i + 1 < columns {
                target.try_motion(&mut patch, patches[k + 1].motion);
            }
            if k + columns < patches.len() {
                target.try_motion(&mut patch, patches[k + columns].motion);
            }
            if patch.error < before {
                target.descend(&mut patch);
                patches[k] = patch;
            }
        }
    }
}

/// A patch of the later image, and the earlier image in which it is searched.
struct Target<'a> {
    level: &'a Level,
    x: usize,
    y: usize,
    later: Rows,
}

impl<'a> Target<'a> {
    #[inline(always)]
    fn new(level: &'a Level, x: usize, y: usize) -> Self {
        let later = rows(&level.later, level.stride(), x, y);
        Self { level, x, y, later }
    }

    /// The patch with the motion that the level begins with at cell `(i, j)`.
    #[inline(always)]
    fn start(&self, level: &Level, i: usize, j: usize) -> Patch {
        let [right, down] = self.gradient();
        let (mut xx, mut xy, mut yy) = ([0.0; PATCH], [0.0; PATCH], [0.0; PATCH]);
        for y in 0..PATCH {
            for x in 0..PATCH {
                xx[x] += right[y][x] * right[y][x];
                xy[x] += right[y][x] * down[y][x];
                yy[x] += down[y][x] * down[y][x];
            }
        }
        let [xx, xy, yy] = [xx, xy, yy].map(|lanes| lanes.iter().sum::<f32>());
        let trace = xx + yy;
        let (a, c) = (xx + DAMPING * trace, yy + DAMPING * trace);
        let determinant = a * c - xy * xy;
        let is_flat = trace < FLAT;
        let inverse = if is_flat { [0.0; 3] } else { [c, -xy, a].map(|element| element / determinant) };

        let cell = j.min(level.height - 1) * level.width + i.min(level.width - 1);
        let motion = [level.flow[0][cell], level.flow[1][cell]];
        Patch { motion, error: self.differences(motion).1, is_flat, inverse }
    }

    #[inline(always)]
    fn gradient(&self) -> [Rows; 2] {
        let stride = self.level.stride();
        [0, 1].map(|axis| rows(&self.level.gradient[axis], stride, self.x, self.y))
    }

    /// The earlier image, where `motion` leads, minus the later one, and the sum of its squares.
    #[inline(always)]
    fn differences(&self, motion: [f32; 2]) -> (Rows, f32) {
        let (stride, height) = (self.level.stride(), self.level.height + 2 * PAD);
        let clamp = |x: f32, end: usize| x.max(0.0).min((end - PATCH - 2) as f32);
        let x = clamp(self.x as f32 + motion[0], stride);
        let y = clamp(self.y as f32 + motion[1], height);
        let (i, j) = (x as usize, y as usize);
        let (fx, fy) = (x - i as f32, y - j as f32);

        // Along a row, then between two rows.
        let along = |j: usize| {
            let row: &[f32; PATCH + 1] = self.level.earlier[j * stride + i..].first_chunk().unwrap();
            std::array::from_fn::<f32, PATCH, _>(|k| row[k] + (row[k + 1] - row[k]) * fx)
        };
        let (mut rows, mut sums, mut above) = ([[0.0; PATCH]; PATCH], [0.0; PATCH], along(j));
        for y in 0..PATCH {
            let below = along(j + y + 1);
            for x in 0..PATCH {
                let difference = above[x] + (below[x] - above[x]) * fy - self.later[y][x];
                rows[y][x] = difference;
                sums[x] += difference * difference;
            }
            above = below;
        }
        (rows, sums.iter().sum())
    }

    /// Takes `motion` if it fits clearly better.
    #[inline(always)]
    fn try_motion(&self, patch: &mut Patch, motion: [f32; 2]) {
        if motion == patch.motion {
            return;
        }
        let (_, error) = self.differences(motion);
        if error < BETTER * patch.error {
            (patch.motion, patch.error) = (motion, error);
        }
    }

    /// Moves a patch by Gauss-Newton steps as long as it fits better.
    #[inline(always)]
    fn descend(&self, patch: &mut Patch) {
        let ([right, down], start) = (self.gradient(), patch.motion);
        let (mut differences, _) = self.differences(start);
        for _ in 0..MAX_STEPS {
            let (mut gx, mut gy) = ([0.0; PATCH], [0.0; PATCH]);
            for y in 0..PATCH {
                for x in 0..PATCH {
                    gx[x] += right[y][x] * differences[y][x];
                    gy[x] += down[y][x] * differences[y][x];
                }
            }
            let [gx, gy] = [gx, gy].map(|lanes| lanes.iter().sum::<f32>());
            let [a, b, c] = patch.inverse;
            let step = [a * gx + b * gy, b * gx + c * gy];
            let motion = [patch.motion[0] - step[0], patch.motion[1] - step[1]];
            if (motion[0] - start[0]).abs() > LONGEST || (motion[1] - start[1]).abs() > LONGEST {
                break;
            }

            let (next, error) = self.differences(motion);
            if error >= patch.error {
                break;
            }
            (patch.motion, patch.error, differences) = (motion, error, next);
            if step[0].abs().max(step[1].abs()) < SHORT_STEP || error < FITS {
                break;
            }
        }
    }
}

/// The cells of a patch in a padded image.
#[inline(always)]
fn rows(image: &[f32], stride: usize, x: usize, y: usize) -> Rows {
    std::array::from_fn(|k| *image[(y + k) * stride + x..].first_chunk().unwrap())
}

vectorised! {
    /// Averages the motions of the patches that hold a cell, weighted by how well they fit there.
    fn average(
        level: &mut Level,
        stride: usize,
        columns: usize,
        patches: &[Patch],
        sums: &mut [Vec<f32>; 3],
    ) {
        // Padded, so that no patch has to be cut off.
        let (padded, length) = (level.stride(), level.later.len());
        for sum in sums.iter_mut() {
            sum.clear();
            sum.resize(length, 0.0);
        }
        for (k, patch) in patches.iter().enumerate() {
            let (x, y) = (place(k % columns, stride), place(k / columns, stride));
            let (differences, _) = Target::new(level, x, y).differences(patch.motion);
            for (row, differences) in differences.iter().enumerate() {
                let at = (y + row) * padded + x;
                let weights = differences.map(|difference| 1.0 / difference.abs().max(1.0));
                for (sum, factor) in sums.iter_mut().zip([1.0, patch.motion[0], patch.motion[1]]) {
                    let lanes: &mut [f32; PATCH] = sum[at..].first_chunk_mut().unwrap();
                    for x in 0..PATCH {
                        lanes[x] += weights[x] * factor;
                    }
                }
            }
        }

        let width = level.width;
        for (component, sum) in level.flow.iter_mut().zip(&sums[1..]) {
            for (y, row) in component.chunks_exact_mut(width).enumerate() {
                let at = (y + PAD) * padded + PAD;
                for (x, motion) in row.iter_mut().enumerate() {
                    *motion = sum[at + x] / sums[0][at + x];
                }
            }
        }
    }
}
