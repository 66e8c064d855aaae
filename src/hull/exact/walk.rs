//! Walks of many points through silhouettes side by side, each along its own line.
//!
//! A step is that of [`March`]: from the cell entered to the side of the largest square of subject cells around it. A
//! walk ends in background or at its limit, or where something rare comes up: then [`March`] goes on with it. The
//! next line takes its slot at once.

use super::super::image_line::ImageLine;
use super::super::lanes::{bits, either, floor, index, ones};
use super::super::march::March;
use super::Wide;
use super::exits::Way;
use super::sight::{Block, Field};
use crate::camera::{MIN_DEPTH, Pixel};
use nalgebra::Vector3;

/// Lines that walk side by side.
const SLOTS: usize = 8;

/// One number of each of them.
type Slots = [f64; SLOTS];

/// Point k as the field `place` sees it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Line {
    pub(super) k: usize,
    pub(super) place: usize,
}

/// All that is known of points that are to walk.
pub(super) struct Paths<'a> {
    pub(super) fields: &'a [Field<'a>],
    pub(super) block: &'a Block,
    pub(super) way: &'a Way,
    /// How each view's homogeneous coordinates change along the way.
    pub(super) ahead: &'a [[Wide; 3]],
}

/// Lines on their way: where they are at `t` metres is `start + t ahead`, in homogeneous image coordinates.
#[derive(Debug, Clone, Default)]
pub(super) struct Walkers {
    line: [Line; SLOTS],
    start: [Slots; 3],
    ahead: [Slots; 3],
    /// The cell that each is in, when it entered it, and its distance to background.
    column: Slots,
    row: Slots,
    t: Slots,
    clear: Slots,
    limit: Slots,
    /// Cells are pixels (0), or the squares between four pixel centres (one half).
    shift: Slots,
    stride: Slots,
    origin: Slots,
}

impl Walkers {
    /// Walks `lines`, each up to its point's exit, which comes down to where it leaves.
    #[inline(always)]
    pub(super) fn walk(&mut self, lines: &[Line], paths: &Paths, exit: &mut Wide) {
        let (mut waiting, mut walking) = (lines.iter(), 0_u32);
        loop {
            for slot in ones(!walking & (u32::MAX >> (u32::BITS as usize - SLOTS))) {
                walking |= u32::from(self.take_up(slot, &mut waiting, paths, exit)) << slot;
            }
            if walking == 0 {
                break;
            }
            let (past, rare) = self.step();
            for slot in ones(walking & rare) {
                self.go_on_alone(slot, paths, exit);
            }
            walking &= !(past | rare);
            let mut places = [0; SLOTS];
            for k in 0..SLOTS {
                places[k] = index(self.row[k] * self.stride[k] + self.column[k] + self.origin[k]);
            }
            for slot in ones(walking) {
                let field = &paths.fields[self.line[slot].place];
                let clear = field.clear(places[slot]);
                self.clear[slot] = f64::from(clear);
                if clear == 0 {
                    walking &= !(1 << slot);
                    if field.by_coverage {
                        self.go_on_alone(slot, paths, exit);
                    } else {
                        let exit = &mut exit[self.line[slot].k];
                        *exit = either(self.t[slot] < *exit, self.t[slot], *exit);
                    }
                }
            }
        }
    }

    /// Puts the next of the lines that need a slot into this one; false where none is left.
    #[inline(always)]
    fn take_up<'l>(
        &mut self,
        slot: usize,
        lines: &mut impl Iterator<Item = &'l Line>,
        paths: &Paths,
        exit: &mut Wide,
    ) -> bool {
        for line in lines {
            let (field, sighting) = (&paths.fields[line.place], &paths.block.sightings[line.place]);
            let (column, row, clear) = field.first_cell(sighting, line.k);
            if clear == 0.0 {
                exit[line.k] = walk_alone(line, paths, exit[line.k]);
                continue;
            }
            self.line[slot] = *line;
            for axis in 0..3 {
                self.start[axis][slot] = sighting.at[axis][line.k];
                self.ahead[axis][slot] = paths.ahead[line.place][axis][line.k];
            }
            (self.column[slot], self.row[slot], self.clear[slot]) = (column, row, clear);
            (self.t[slot], self.limit[slot], self.shift[slot]) = (0.0, exit[line.k], field.shift);
            (self.stride[slot], self.origin[slot]) = (field.stride, field.origin);
            return true;
        }
        false
    }

    /// Steps out of the square of clear cells; which lines are past their limits then, and which could not step,
    /// since the camera is near.
    ///
    /// Nobody asks whether a line leaves the silhouette's rectangle: there it steps into background.
    #[inline(always)]
    fn step(&mut self) -> (u32, u32) {
        let (mut past, mut rare) = ([0; SLOTS], [0; SLOTS]);
        for k in 0..SLOTS {
            let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            let [x1, y1, z1] = [self.ahead[0][k], self.ahead[1][k], self.ahead[2][k]];
            let (shift, half) = (self.shift[k], self.clear[k] - 1.0);
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
            let goes_on = z > 2.0 * MIN_DEPTH;
            let (u, v) = ((x0 + x1 * t) / z, (y0 + y1 * t) / z);
            let i = either(first, either(rightwards, column, column - 1.0), within(u - shift, left, right));
            let j = either(first, within(v - shift, above, below), either(downwards, row, row - 1.0));
            self.column[k] = either(goes_on, i, self.column[k]);
            self.row[k] = either(goes_on, j, self.row[k]);
            self.t[k] = either(goes_on, t, self.t[k]);
            past[k] = u32::from(t >= self.limit[k]);
            rare[k] = u32::from(!goes_on);
        }
        (bits(&past), bits(&rare))
    }

    /// Walks a line on from where it stands.
    fn go_on_alone(&self, slot: usize, paths: &Paths, exit: &mut Wide) {
        let Line { k, place } = self.line[slot];
        let field = &paths.fields[place];
        let (cell, t) = ((self.column[slot] as i32, self.row[slot] as i32), self.t[slot]);
        exit[k] = March::from_cell(field.view, paths.line(k, place), cell, t, field.edge).exit_by(t, exit[k]);
    }
}

/// Walks a line from its start.
fn walk_alone(&Line { k, place }: &Line, paths: &Paths, limit: f64) -> f64 {
    let (field, sighting) = (&paths.fields[place], &paths.block.sightings[place]);
    let mut march = if sighting.clear[k] > 0.0 {
        let [x, y, depth] = sighting.at.map(|at| at[k]);
        let at = Pixel { u: x / depth, v: y / depth, depth };
        March::from_inside(field.view, paths.line(k, place), &at, field.edge)
    } else {
        // The point is inside by coverage, though its pixel is background.
        let [x, y, z] = paths.way.direction.map(|along| along[k]);
        March::new(field.view, &paths.block.point(k), &Vector3::new(x, y, z), field.edge)
    };
    march.exit_by(0.0, limit)
}

impl Paths<'_> {
    fn line(&self, k: usize, place: usize) -> ImageLine {
        let vector = |of: &[Wide; 3]| Vector3::from(of.map(|of| of[k]));
        ImageLine::new(vector(&self.block.sightings[place].at), vector(&self.ahead[place]))
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
