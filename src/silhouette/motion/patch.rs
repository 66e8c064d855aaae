//! Inverse search: patches of the later image are moved until they fit the earlier one.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::cell_means::CELL_REACH;
use super::level::{Level, PAD};
use crate::math::vectorised;

/// Cells along a side of a patch.
pub(super) const PATCH: usize = 8;

/// The most steps of a patch in one descent.
const MAX_STEPS: usize = 8;

/// A descent ends with a step shorter than this, in cells.
const SHORT_STEP: f32 = 0.03;

/// The longest step along either axis, in cells: the slopes on both sides of a thin part are short.
const LONGEST_STEP: f32 = 1.0;

/// A patch moves by at most this from where a descent began, in cells.
const LONGEST: f32 = PATCH as f32;

/// A patch whose sum of squared differences, in square pixels, is below this fits.
const FITS: f32 = 0.01;

/// Motions that differ by less than this along both axes are not compared, in cells.
const NEAR: f32 = 0.25;

/// A neighbour's motion replaces a patch's own if it fits better by this factor.
const BETTER: f32 = 0.8;

/// Part of the gradient's energy that is added in all directions: along a straight edge no motion can be told.
const DAMPING: f32 = 0.02;

/// The sum of the squared gradient below which a patch has no edge near it.
const FLAT: f32 = 0.5;

/// A patch that a motion leads to may differ by this part of its difference from an image without any edge: beyond it,
/// the motion has led away from what was searched.
const EXPLAINED: f32 = 0.7;

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
    /// The sum of squared differences from an image without any edge.
    edgeless_error: f32,
    is_flat: bool,
    /// The inverse of the damped matrix of gradient products: the elements 00, 01 and 11.
    inverse: [f32; 3],
}

impl Patch {
    /// Whether the patch fits about as badly as without any edge where its motion leads.
    #[inline(always)]
    fn explains_nothing(&self) -> bool {
        self.error > EXPLAINED * self.edgeless_error
    }
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
            let target = Target { level, x: place(i, stride), y: place(j, stride) };
            let mut patch = target.start(i * stride, j * stride);
            if patch.error > FITS && !patch.is_flat {
                target.try_rest(&mut patch);
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
            let target = Target { level, x: place(i, stride), y: place(j, stride) };
            let before = patch.error;
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
    /// The place of the patch's first cell in the padded images.
    x: usize,
    y: usize,
}

/// How well a motion fits, and the gradient of the error by the motion.
#[derive(Debug, Clone, Copy)]
struct Fit {
    error: f32,
    gradient: [f32; 2],
}

impl<'a> Target<'a> {
    /// The patch with the motion that the level begins with at cell `(i, j)`.
    #[inline(always)]
    fn start(&self, i: usize, j: usize) -> Patch {
        let (mut xx, mut xy, mut yy) = ([0.0; PATCH], [0.0; PATCH], [0.0; PATCH]);
        for y in 0..PATCH {
            let [right, down] = self.gradient_row(y);
            for x in 0..PATCH {
                xx[x] += right[x] * right[x];
                xy[x] += right[x] * down[x];
                yy[x] += down[x] * down[x];
            }
        }
        let (xx, xy, yy) = (sum(xx), sum(xy), sum(yy));
        let trace = xx + yy;
        let (a, c) = (xx + DAMPING * trace, yy + DAMPING * trace);
        let determinant = a * c - xy * xy;

        let level = self.level;
        let cell = j.min(level.height - 1) * level.width + i.min(level.width - 1);
        let motion = [level.flow[0][cell], level.flow[1][cell]];
        if trace < FLAT {
            return Patch { motion, is_flat: true, ..Patch::default() };
        }
        let inverse = [c, -xy, a].map(|element| element / determinant);
        let (error, edgeless_error) = (self.error(motion), self.edgeless_error());
        Patch { motion, error, edgeless_error, is_flat: false, inverse }
    }

    /// The sum of squared differences from an image that is background everywhere, or subject.
    #[inline(always)]
    fn edgeless_error(&self) -> f32 {
        let (mut background, mut subject) = ([0.0; PATCH], [0.0; PATCH]);
        for y in 0..PATCH {
            let later = row(&self.level.later, (self.y + y) * self.level.stride() + self.x);
            for x in 0..PATCH {
                let (outside, inside) = (later[x] - CELL_REACH as f32, later[x] + CELL_REACH as f32);
                background[x] += outside * outside;
                subject[x] += inside * inside;
            }
        }
        sum(background).min(sum(subject))
    }

    /// A row of the later image's gradient, right and down.
    #[inline(always)]
    fn gradient_row(&self, y: usize) -> [&'a [f32; PATCH]; 2] {
        let first = (self.y + y) * self.level.stride() + self.x;
        let [right, down] = &self.level.gradient;
        [row(right, first), row(down, first)]
    }

    /// The earlier image, where `motion` leads, minus the later one.
    #[inline(always)]
    fn differences(&self, motion: [f32; 2]) -> Differences<'a> {
        let (stride, height) = (self.level.stride(), self.level.height + 2 * PAD);
        let x = clamp_place(self.x as f32 + motion[0], stride);
        let y = clamp_place(self.y as f32 + motion[1], height);
        let (i, j) = (x as usize, y as usize);
        let (earlier, later) = (j * stride + i, self.y * stride + self.x);
        let mut differences = Differences {
            level: self.level,
            earlier,
            later,
            fx: x - i as f32,
            fy: y - j as f32,
            above: [0.0; PATCH],
        };
        differences.above = differences.along_row();
        differences
    }

    /// The sum of squared differences.
    #[inline(always)]
    fn error(&self, motion: [f32; 2]) -> f32 {
        let (mut rows, mut sums) = (self.differences(motion), [0.0; PATCH]);
        for _ in 0..PATCH {
            let row = rows.next_row();
            for x in 0..PATCH {
                sums[x] += row[x] * row[x];
            }
        }
        sum(sums)
    }

    #[inline(always)]
    fn fit(&self, motion: [f32; 2]) -> Fit {
        let (mut error, mut gx, mut gy) = ([0.0; PATCH], [0.0; PATCH], [0.0; PATCH]);
        let mut rows = self.differences(motion);
        for y in 0..PATCH {
            let (row, [right, down]) = (rows.next_row(), self.gradient_row(y));
            for x in 0..PATCH {
                error[x] += row[x] * row[x];
                gx[x] += right[x] * row[x];
                gy[x] += down[x] * row[x];
            }
        }
        Fit { error: sum(error), gradient: [sum(gx), sum(gy)] }
    }

    /// Takes no motion, if that fits clearly better or the patch's motion explains nothing.
    #[inline(always)]
    fn try_rest(&self, patch: &mut Patch) {
        if patch.explains_nothing() {
            (patch.motion, patch.error) = ([0.0; 2], self.error([0.0; 2]));
        } else {
            self.try_motion(patch, [0.0; 2]);
        }
    }

    /// Takes `motion` if it fits clearly better. A descent finds what is near by itself.
    #[inline(always)]
    fn try_motion(&self, patch: &mut Patch, motion: [f32; 2]) {
        let away = |k: usize| (motion[k] - patch.motion[k]).abs();
        if away(0).max(away(1)) < NEAR {
            return;
        }
        let error = self.error(motion);
        if error < BETTER * patch.error {
            (patch.motion, patch.error) = (motion, error);
        }
    }

    /// Moves a patch by Gauss-Newton steps as long as it fits better.
    #[inline(always)]
    fn descend(&self, patch: &mut Patch) {
        let before = *patch;
        self.step_down(patch);
        if patch.explains_nothing() {
            *patch = before;
        }
    }

    #[inline(always)]
    fn step_down(&self, patch: &mut Patch) {
        let start = patch.motion;
        let mut fit = self.fit(start);
        for _ in 0..MAX_STEPS {
            let ([a, b, c], [gx, gy]) = (patch.inverse, fit.gradient);
            let step =
                [a * gx + b * gy, b * gx + c * gy].map(|cells| cells.clamp(-LONGEST_STEP, LONGEST_STEP));
            let motion = [patch.motion[0] - step[0], patch.motion[1] - step[1]];
            if (motion[0] - start[0]).abs() > LONGEST || (motion[1] - start[1]).abs() > LONGEST {
                break;
            }

            fit = self.fit(motion);
            if fit.error >= patch.error {
                break;
            }
            (patch.motion, patch.error) = (motion, fit.error);
            if step[0].abs().max(step[1].abs()) < SHORT_STEP || fit.error < FITS {
                break;
            }
        }
    }
}

/// Rows of a patch, one after the other: the earlier image, where a motion leads, minus the later one.
struct Differences<'a> {
    level: &'a Level,
    /// The places in the padded images of the next row.
    earlier: usize,
    later: usize,
    /// The parts of a cell by which the motion leads farther.
    fx: f32,
    fy: f32,
    /// The earlier image above the next row.
    above: [f32; PATCH],
}

impl Differences<'_> {
    #[inline(always)]
    fn next_row(&mut self) -> [f32; PATCH] {
        self.earlier += self.level.stride();
        let below = self.along_row();
        let later = row(&self.level.later, self.later);
        let mut differences = [0.0; PATCH];
        for x in 0..PATCH {
            differences[x] = self.above[x] + (below[x] - self.above[x]) * self.fy - later[x];
        }
        self.later += self.level.stride();
        self.above = below;
        differences
    }

    /// The earlier image between the cells of a row.
    #[inline(always)]
    fn along_row(&self) -> [f32; PATCH] {
        let image = &self.level.earlier;
        let (left, right) = (row(image, self.earlier), row(image, self.earlier + 1));
        let mut along = [0.0; PATCH];
        for x in 0..PATCH {
            along[x] = left[x] + (right[x] - left[x]) * self.fx;
        }
        along
    }
}

/// The place `x`, but not so close to the end of a padded image that a patch would leave it.
#[inline(always)]
fn clamp_place(x: f32, end: usize) -> f32 {
    x.max(0.0).min((end - PATCH - 2) as f32)
}

/// The cells of a patch's row in an image.
#[inline(always)]
fn row(image: &[f32], first: usize) -> &[f32; PATCH] {
    image[first..].first_chunk().unwrap()
}

/// The sum of the lanes.
#[inline(always)]
fn sum(lanes: [f32; PATCH]) -> f32 {
    lanes.iter().sum()
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
            let mut rows = Target { level, x, y }.differences(patch.motion);
            for row in 0..PATCH {
                let (mut weights, differences) = ([0.0; PATCH], rows.next_row());
                for x in 0..PATCH {
                    weights[x] = 1.0 / differences[x].abs().max(1.0);
                }
                let at = (y + row) * padded + x;
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
