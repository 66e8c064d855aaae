//! Walks of many points through one silhouette side by side, each along its own line.
//!
//! A step is that of [`March`]: from the cell entered to the side of the largest square of subject cells around it. A
//! walk ends in background or at its limit, or where something rare comes up: then [`March`] goes on with it. Most have
//! arrived after a few steps; the others go on with one another, each in a lane that is free.

use super::super::image_line::ImageLine;
use super::super::lanes::{bits, either, floor, ones};
use super::super::march::March;
use super::super::points::LANES;
use super::Wide;
use super::exits::Block;
use super::sight::Field;
use crate::camera::{MIN_DEPTH, Pixel};
use crate::vectorised::vectorised;
use nalgebra::Vector3;

/// Steps after which is first asked who has arrived,
const YOUNG: usize = 2;

/// and then again and again.
const STEPS: usize = 2;

/// So few lines are sooner walked one by one.
const FEW: u32 = 4;

/// Lines in one view: where they are at `t` metres is `start + t ahead`, in homogeneous image coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lines {
    /// The places of the points that walk them.
    pub(super) point: [u32; LANES],
    start: [Wide; 3],
    ahead: [Wide; 3],
    /// The cell that each is in, when it entered it, and its distance to background. Cells are pixels; where the view's
    /// edge is taken inside pixels, the squares between four pixel centres, once a line sets out.
    column: Wide,
    row: Wide,
    clear: Wide,
    t: Wide,
    /// After which nobody cares.
    pub(super) limit: Wide,
}

/// Lines of one view on their way.
#[derive(Debug, Default)]
pub(super) struct Walkers {
    young: Lines,
    count: usize,
    old: Lines,
    walking: u32,
}

impl Default for Lines {
    fn default() -> Self {
        let (vector, lane) = ([[0.0; LANES]; 3], [0.0; LANES]);
        Self {
            point: [0; LANES],
            start: vector,
            ahead: vector,
            column: lane,
            row: lane,
            clear: lane,
            t: lane,
            limit: lane,
        }
    }
}

impl Walkers {
    /// Lets the lines `which` walk as soon as there are enough of them; `exits` come down to where they leave.
    #[inline(always)]
    pub(super) fn set_out(&mut self, field: &Field, lines: &Lines, which: u32, exits: &mut [f64]) {
        for k in ones(which) {
            self.young.take(self.count, lines, k);
            self.count += 1;
            if self.count == LANES {
                walk(self, field, false, exits);
            }
        }
    }

    /// Walks all that are left to their ends.
    #[inline(always)]
    pub(super) fn arrive(&mut self, field: &Field, exits: &mut [f64]) {
        if self.count > 0 || self.walking != 0 {
            walk(self, field, true, exits);
        }
    }
}

vectorised! {
    /// Walks the young lines a few steps, and the old ones until there is room for those that are left, or, where no
    /// others will come, to their ends.
    fn walk(walkers: &mut Walkers, field: &Field, are_last: bool, exits: &mut [f64]) {
        let Walkers { young, count, old, walking } = walkers;
        let used = u32::MAX.checked_shr((LANES - *count) as u32).unwrap_or(0);
        *count = 0;
        let alone = young.enter_first_cell(field) & used;
        for k in ones(alone) {
            young.walk_alone(k, field, exits);
        }
        let mut left = used & !alone;
        let arrived = young.step(YOUNG, field) & left;
        young.report(arrived, field, exits);
        left &= !arrived;
        loop {
            while left != 0 && *walking != u32::MAX {
                let (k, free) = (left.trailing_zeros() as usize, walking.trailing_ones() as usize);
                old.take(free, young, k);
                (*walking, left) = (*walking | 1 << free, left & (left - 1));
            }
            if left == 0 && (!are_last || walking.count_ones() <= FEW) {
                break;
            }
            let arrived = old.step(STEPS, field) & *walking;
            old.report(arrived, field, exits);
            *walking &= !arrived;
        }
        if are_last {
            for k in ones(*walking) {
                old.go_on_alone(k, field, exits);
            }
            *walking = 0;
        }
    }
}

impl Lines {
    /// Begins at the points of `block`, all of them inside: in the pixel where the view sees each.
    #[inline(always)]
    pub(super) fn sight(&mut self, field: &Field, block: &Block) {
        let ([x, y, z], [dx, dy, dz]) = (&block.point, &block.direction);
        for (axis, row) in field.p.iter().enumerate() {
            for k in 0..LANES {
                self.start[axis][k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k] + row[3];
                self.ahead[axis][k] = row[0] * dx[k] + row[1] * dy[k] + row[2] * dz[k];
            }
        }
        for k in 0..LANES {
            let [x, y, depth] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            (self.column[k], self.row[k], self.t[k]) = (floor(x / depth), floor(y / depth), 0.0);
        }
        field.find_distances(&self.column, &self.row, 0.0, &mut self.clear);
    }

    /// Which lines the view surely sees inside up to their limits: those ends lie in the square of subject pixels
    /// around the start, and so does all between, since a line's image is straight.
    #[inline(always)]
    pub(super) fn stay_inside(&self, field: &Field) -> u32 {
        // Beyond the pixels' centres there may be an edge by coverage; the rest is far more than rounding.
        let rim = if field.by_coverage { 1.0 + 1e-6 } else { 0.5 + 1e-6 };
        let (mut stays, [x, y, z], [dx, dy, dz]) = ([0; LANES], &self.start, &self.ahead);
        for k in 0..LANES {
            let (reach, t) = (self.clear[k] - rim, self.limit[k]);
            let (end_x, end_y, end_z) = (x[k] + dx[k] * t, y[k] + dy[k] * t, z[k] + dz[k] * t);
            let (du, dv) = (end_x - (self.column[k] + 0.5) * end_z, end_y - (self.row[k] + 0.5) * end_z);
            // Both sides times the depth.
            let near = (du.abs() < reach * end_z) & (dv.abs() < reach * end_z);
            stays[k] = u32::from((end_z > 0.0) & near & (reach > 0.0));
        }
        bits(&stays)
    }

    /// From the pixel where each line starts into its first cell; which have to walk alone, since an edge crosses that.
    #[inline(always)]
    fn enter_first_cell(&mut self, field: &Field) -> u32 {
        let mut alone = [0; LANES];
        for k in 0..LANES {
            alone[k] = u32::from(self.clear[k] == 0.0);
        }
        if !field.by_coverage {
            return bits(&alone);
        }
        let (mut column, mut row, mut clear) = (self.column, self.row, [0.0; LANES]);
        for k in 0..LANES {
            // The cell begins at a pixel's centre: at that of the point's pixel, or of the one before.
            let cell = |x: f64, pixel: f64| either(x - field.shift < pixel, pixel - 1.0, pixel);
            let [x, y, depth] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            (column[k], row[k]) = (cell(x / depth, column[k]), cell(y / depth, row[k]));
        }
        field.find_clear(&column, &row, &mut clear);
        for k in 0..LANES {
            alone[k] |= u32::from(clear[k] == 0.0);
        }
        let alone = bits(&alone);
        for k in ones(!alone) {
            (self.column[k], self.row[k], self.clear[k]) = (column[k], row[k], clear[k]);
        }
        alone
    }

    /// Line k is line j of `other`.
    #[inline(always)]
    fn take(&mut self, k: usize, other: &Self, j: usize) {
        for axis in 0..3 {
            self.start[axis][k] = other.start[axis][j];
            self.ahead[axis][k] = other.ahead[axis][j];
        }
        (self.point[k], self.t[k], self.limit[k]) = (other.point[j], other.t[j], other.limit[j]);
        (self.column[k], self.row[k], self.clear[k]) = (other.column[j], other.row[j], other.clear[j]);
    }

    /// Some steps of all; which lines have arrived, in background or at their limits, or cannot step, since the camera
    /// is near.
    ///
    /// Nobody asks whether a line leaves the silhouette's rectangle: there it steps into background.
    #[inline(always)]
    fn step(&mut self, steps: usize, field: &Field) -> u32 {
        let (shift, mut goes) = (field.shift, [0; LANES]);
        for _ in 0..steps {
            for k in 0..LANES {
                let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
                let [x1, y1, z1] = [self.ahead[0][k], self.ahead[1][k], self.ahead[2][k]];
                let half = self.clear[k] - 1.0;
                let (left, above) = (self.column[k] - half, self.row[k] - half);
                let (right, below) = (self.column[k] + half + 1.0, self.row[k] + half + 1.0);
                let (rightwards, downwards) = (x1 * z0 - x0 * z1 > 0.0, y1 * z0 - y0 * z1 > 0.0);
                let (column, row) = (either(rightwards, right, left), either(downwards, below, above));
                let (u, v) = (column + shift, row + shift);
                let by_column = ahead((u * z0 - x0) / (x1 - u * z1), z0, z1);
                let by_row = ahead((v * z0 - y0) / (y1 - v * z1), z0, z1);
                let first = by_column <= by_row;
                let t = either(first, by_column, by_row);
                let t = either(t > self.t[k], t, self.t[k]);
                // Up to its limit a line lies in the work volume, so that it comes near the camera only there.
                let z = z0 + z1 * either(t < self.limit[k], t, self.limit[k]);
                let is_going = (self.clear[k] > 0.0) & (self.t[k] < self.limit[k]) & (z > 2.0 * MIN_DEPTH);
                // The side fixes one coordinate; the other is where the line is.
                let beside = either(first, y0 + y1 * t, x0 + x1 * t) / z - shift;
                let cell = within(beside, either(first, above, left), either(first, below, right));
                let i = either(first, either(rightwards, column, column - 1.0), cell);
                let j = either(first, cell, either(downwards, row, row - 1.0));
                self.column[k] = either(is_going, i, self.column[k]);
                self.row[k] = either(is_going, j, self.row[k]);
                self.t[k] = either(is_going, t, self.t[k]);
                goes[k] = u32::from(is_going);
            }
            field.find_clear(&self.column, &self.row, &mut self.clear);
            for k in 0..LANES {
                goes[k] &= u32::from((self.clear[k] > 0.0) & (self.t[k] < self.limit[k]));
            }
        }
        !bits(&goes)
    }

    /// Lowers the exits of the points whose lines have arrived before their limits.
    #[inline(always)]
    fn report(&self, arrived: u32, field: &Field, exits: &mut [f64]) {
        for k in ones(arrived) {
            if self.t[k] >= self.limit[k] {
                continue;
            } else if self.clear[k] > 0.0 || field.by_coverage {
                self.go_on_alone(k, field, exits);
            } else {
                let exit = &mut exits[self.point[k] as usize];
                *exit = either(self.t[k] < *exit, self.t[k], *exit);
            }
        }
    }

    /// Walks a line on from where it stands.
    fn go_on_alone(&self, k: usize, field: &Field, exits: &mut [f64]) {
        let (exit, t) = (&mut exits[self.point[k] as usize], self.t[k]);
        let cell = (self.column[k] as i32, self.row[k] as i32);
        *exit = March::from_cell(field.view, self.line(k), cell, t, field.edge).exit_by(t, *exit);
    }

    /// Walks a line from its start.
    fn walk_alone(&self, k: usize, field: &Field, exits: &mut [f64]) {
        let mut march = if self.clear[k] > 0.0 {
            let [x, y, depth] = self.start.map(|start| start[k]);
            let at = Pixel { u: x / depth, v: y / depth, depth };
            March::from_inside(field.view, self.line(k), &at, field.edge)
        } else {
            // The point is inside by coverage, though its pixel is background.
            March::from_start(field.view, self.line(k), field.edge)
        };
        let exit = &mut exits[self.point[k] as usize];
        *exit = march.exit_by(0.0, *exit);
    }

    fn line(&self, k: usize) -> ImageLine {
        let vector = |of: &[Wide; 3]| Vector3::from(of.map(|of| of[k]));
        ImageLine::new(vector(&self.start), vector(&self.ahead))
    }
}

/// A crossing behind the camera, or one that there is none of, is never reached.
#[inline(always)]
fn ahead(crossing: f64, z0: f64, z1: f64) -> f64 {
    let is_ahead = (crossing.abs() < f64::INFINITY) & (z0 + crossing * z1 > 0.0);
    either(is_ahead, crossing, f64::INFINITY)
}

/// The cell of position `x` among those from `first` to before `end`.
#[inline(always)]
fn within(x: f64, first: f64, end: f64) -> f64 {
    let x = either(x > first, x, first);
    floor(either(x < end - 0.5, x, end - 0.5))
}
