//! Walks of many points through silhouettes at once, each along its own line.
//!
//! As in [`march`](super::super::march): a step leads to the side of the largest square of subject pixels around, and
//! crosses into the pixel behind it. Points that have arrived wait for the others; the last few, which often have far
//! to go, go on one by one.

use super::super::points::{LANES, Lane};
use super::fold::{Homogeneous, bits_of, either};

/// No walk takes more steps; a line through the largest image takes fewer.
const MOST_STEPS: usize = 1 << 18;

/// So few lines are sooner done one by one.
const FEW: u32 = 6;

/// Lines of as many points as walk together: where they are at `t` metres is `start + t ahead`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lines<'a> {
    pub(super) start: Homogeneous,
    pub(super) ahead: Homogeneous,
    /// The pixel that each point starts in.
    pub(super) column: Lane,
    pub(super) row: Lane,
    /// Each view's distances, and how many pixels a row of them has.
    pub(super) table: [&'a [u8]; LANES],
    pub(super) width: [u32; LANES],
}

/// One line, `(u depth, v depth, depth)` at its start and a metre's change.
#[derive(Clone, Copy)]
struct Line {
    start: [f32; 3],
    ahead: [f32; 3],
}

/// Where a walk is: a pixel, and when it entered it.
#[derive(Clone, Copy)]
struct Place {
    column: f32,
    row: f32,
    t: f32,
}

/// Walks every line whose bit is set in `walking` until background or its `limit`, and lowers the limit to where it
/// left.
#[inline(always)]
pub(super) fn walk(lines: &Lines, limit: &mut Lane, mut walking: u32) {
    let (mut column, mut row, mut t) = (lines.column, lines.row, [0.0_f32; LANES]);
    while walking.count_ones() > FEW {
        let (mut places, mut pixels) = ([0; LANES], [0_u32; LANES]);
        for k in 0..LANES {
            places[k] = bits_of(row[k]) * lines.width[k] + bits_of(column[k]);
        }
        for k in bits(walking) {
            pixels[k] = u32::from(lines.table[k].get(places[k] as usize).copied().unwrap_or(0));
            if pixels[k] == 0 {
                limit[k] = either(t[k] < limit[k], t[k], limit[k]);
                walking &= !(1 << k);
            }
        }
        let mut past = [0_u32; LANES];
        for k in 0..LANES {
            let here = Place { column: column[k], row: row[k], t: t[k] };
            let next = lines.line(k).step(&here, pixels[k] as f32);
            (column[k], row[k], t[k]) = (next.column, next.row, next.t);
            past[k] = u32::from(next.t >= limit[k]);
        }
        for (k, past) in past.into_iter().enumerate() {
            walking &= !(past << k);
        }
    }
    for k in bits(walking) {
        limit[k] = lines.walk_alone(k, Place { column: column[k], row: row[k], t: t[k] }, limit[k]);
    }
}

impl Lines<'_> {
    #[inline(always)]
    fn line(&self, k: usize) -> Line {
        Line {
            start: [self.start.u[k], self.start.v[k], self.start.depth[k]],
            ahead: [self.ahead.u[k], self.ahead.v[k], self.ahead.depth[k]],
        }
    }

    /// Where line k, which is at `here`, leaves, if before `limit`.
    #[inline(always)]
    fn walk_alone(&self, k: usize, mut here: Place, limit: f32) -> f32 {
        let (line, table, width) = (self.line(k), self.table[k], self.width[k]);
        for _ in 0..MOST_STEPS {
            let place = bits_of(here.row) * width + bits_of(here.column);
            let pixels = table.get(place as usize).copied().unwrap_or(0);
            if pixels == 0 || here.t >= limit {
                break;
            }
            here = line.step(&here, f32::from(pixels));
        }
        either(here.t < limit, here.t, limit)
    }
}

impl Line {
    /// From `here` into the pixel behind the square of `clear` pixels around.
    #[inline(always)]
    fn step(&self, here: &Place, clear: f32) -> Place {
        let ([su, sv, sd], [au, av, ad]) = (self.start, self.ahead);
        // The signs of du/dt and dv/dt: the depth squared that divides both is positive.
        let (rightwards, downwards) = (au * sd - su * ad > 0.0, av * sd - sv * ad > 0.0);
        let right = here.column + either(rightwards, clear, 1.0 - clear);
        let below = here.row + either(downwards, clear, 1.0 - clear);
        let by_column = self.crossing(right * sd - su, au - right * ad);
        let by_row = self.crossing(below * sd - sv, av - below * ad);
        let first = by_column <= by_row;
        let t = either(first, by_column, by_row);
        let t = either(t > here.t, t, here.t);
        let per_depth = 1.0 / (sd + t * ad);
        let beside = clear - 1.0;
        let u = within((su + t * au) * per_depth, here.column, beside);
        let v = within((sv + t * av) * per_depth, here.row, beside);
        Place {
            column: either(first, either(rightwards, right, right - 1.0), u),
            row: either(first, v, either(downwards, below, below - 1.0)),
            t,
        }
    }

    /// When the line reaches a side, at `numerator / slope`; one that never does crosses it behind the camera, or
    /// nowhere.
    #[inline(always)]
    fn crossing(&self, numerator: f32, slope: f32) -> f32 {
        let t = numerator / slope;
        let is_ahead = (self.start[2] + t * self.ahead[2] > 0.0) & (t.abs() < f32::INFINITY);
        either(is_ahead, t, f32::INFINITY)
    }
}

/// The pixel of position `x`, within `reach` of the pixel `middle`.
#[inline(always)]
fn within(x: f32, middle: f32, reach: f32) -> f32 {
    // Bounded first: what is left is small and not negative, where adding a large number rounds to whole ones.
    let x = either(x > middle - reach + 0.5, x, middle - reach + 0.5);
    let x = either(x < middle + reach + 0.5, x, middle + reach + 0.5);
    bits_of(x - 0.5) as f32
}

/// The places of the set bits.
#[inline(always)]
pub(super) fn bits(mut word: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (place < u32::BITS).then_some(place as usize)
    })
}
