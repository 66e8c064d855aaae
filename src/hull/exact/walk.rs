//! Walks of many points through silhouettes at once, each along its own line.
//!
//! A step is that of [`March`](super::super::march::March): from the cell entered to the side of the largest square of
//! subject cells around it. A walk ends in background or at its limit, or where something rare comes up: the rest of
//! it is then left to [`March`](super::super::march::March).

use super::super::points::LANES;
use super::sight::{Block, Field};
use super::{Wide, bits, either, floor, gathered, index};
use crate::camera::MIN_DEPTH;

/// Lines of as many points as walk together: where they are at `t` metres is `start + t ahead`, in homogeneous image
/// coordinates.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lines {
    pub(super) start: [Wide; 3],
    pub(super) ahead: [Wide; 3],
    /// The cell that each is in, and when it entered it.
    pub(super) column: Wide,
    pub(super) row: Wide,
    pub(super) t: Wide,
    /// Cells are pixels (0), or the squares between four pixel centres (one half).
    shift: Wide,
    low: [Wide; 2],
    high: [Wide; 2],
    stride: Wide,
    origin: Wide,
    pub(super) field: [usize; LANES],
}

impl Lines {
    /// Puts the line of point `k` in the view `field` into a slot, at its start.
    #[inline(always)]
    pub(super) fn set(
        &mut self,
        slot: usize,
        k: usize,
        place: usize,
        fields: &[Field],
        block: &Block,
        ahead: &[Wide; 3],
    ) {
        let (field, sighting) = (&fields[place], &block.sightings[place]);
        for axis in 0..3 {
            self.start[axis][slot] = sighting.at[axis][k];
            self.ahead[axis][slot] = ahead[axis][k];
        }
        self.t[slot] = 0.0;
        (self.column[slot], self.row[slot]) = (sighting.column[k], sighting.row[k]);
        self.shift[slot] = 0.0;
        if field.by_coverage {
            self.shift[slot] = 0.5;
            // A pixel of the rectangle's, which may be the image's first: the margin reaches beyond.
            let cell = |x: f64, pixel: f64| if x - 0.5 < pixel { pixel - 1.0 } else { pixel };
            let [u, v, depth] = sighting.at.map(|at| at[k]);
            (self.column[slot], self.row[slot]) =
                (cell(u / depth, self.column[slot]), cell(v / depth, self.row[slot]));
        }
        for axis in 0..2 {
            (self.low[axis][slot], self.high[axis][slot]) = (field.low[axis], field.high[axis]);
        }
        (self.stride[slot], self.origin[slot], self.field[slot]) = (field.stride, field.origin, place);
    }

    /// Walks the lines `walking`, each up to its limit, which comes down to where it leaves; which are left to do,
    /// from where they stand.
    #[inline(always)]
    pub(super) fn walk(&mut self, fields: &[Field], limit: &mut Wide, mut walking: u32) -> u32 {
        let mut left = 0;
        while walking != 0 {
            // Lines that do not walk stay where they are.
            let (mut places, mut clear) = ([0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                places[k] = index(self.row[k] * self.stride[k] + self.column[k] + self.origin[k]);
            }
            for k in bits(walking) {
                let field = &fields[self.field[k]];
                let pixels = field.clear(places[k]);
                clear[k] = f64::from(pixels);
                if pixels == 0 {
                    walking &= !(1 << k);
                    if field.by_coverage {
                        left |= 1 << k;
                    } else {
                        limit[k] = either(self.t[k] < limit[k], self.t[k], limit[k]);
                    }
                }
            }
            let (past, rare) = self.step(&clear, limit);
            left |= walking & rare;
            walking &= !(rare | past);
        }
        left
    }

    /// Steps out of the square of `clear` cells; which lines are past their limits then, and which could not step,
    /// since the silhouette's rectangle or the camera is near.
    #[inline(always)]
    fn step(&mut self, clear: &Wide, limit: &Wide) -> (u32, u32) {
        let (mut past, mut rare) = ([0; LANES], [0; LANES]);
        for k in 0..LANES {
            let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            let [x1, y1, z1] = [self.ahead[0][k], self.ahead[1][k], self.ahead[2][k]];
            let (shift, half) = (self.shift[k], clear[k] - 1.0);
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
            let inner = (left > self.low[0][k])
                & (right < self.high[0][k])
                & (above > self.low[1][k])
                & (below < self.high[1][k]);
            let goes_on = (half >= 0.0) & inner & (t < f64::INFINITY) & (z0 + z1 * t > 2.0 * MIN_DEPTH);
            let z = z0 + z1 * t;
            let (u, v) = ((x0 + x1 * t) / z, (y0 + y1 * t) / z);
            let i = either(first, either(rightwards, column, column - 1.0), within(u - shift, left, right));
            let j = either(first, within(v - shift, above, below), either(downwards, row, row - 1.0));
            self.column[k] = either(goes_on, i, self.column[k]);
            self.row[k] = either(goes_on, j, self.row[k]);
            self.t[k] = either(goes_on, t, self.t[k]);
            past[k] = u64::from(t >= limit[k]);
            rare[k] = u64::from(!goes_on);
        }
        (gathered(&past), gathered(&rare))
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
