//! Walks of many points through silhouettes at once, each along its own line.
//!
//! As in [`march`](super::super::march): a step leads to the side of the largest square of subject pixels around, and
//! crosses into the pixel behind it. Points that have arrived wait for the others.

use super::super::points::{LANES, Lane};
use super::fold::{Homogeneous, bits_of, either};

/// No walk takes more steps; a line through the largest image takes fewer.
const MOST_STEPS: usize = 1 << 18;

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

/// Walks every line whose bit is set in `walking` until background or its `limit`, and lowers the limit to where it
/// left.
#[inline(always)]
pub(super) fn walk(lines: &Lines, limit: &mut Lane, mut walking: u32) {
    let (start, ahead) = (&lines.start, &lines.ahead);
    let (mut column, mut row, mut t) = (lines.column, lines.row, [0.0_f32; LANES]);
    for _ in 0..MOST_STEPS {
        let (mut places, mut pixels) = ([0; LANES], [0_u32; LANES]);
        for k in 0..LANES {
            places[k] = bits_of(row[k]) * lines.width[k] + bits_of(column[k]);
        }
        let mut rest = walking;
        while rest != 0 {
            let k = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            pixels[k] = u32::from(lines.table[k].get(places[k] as usize).copied().unwrap_or(0));
            if pixels[k] == 0 {
                limit[k] = either(t[k] < limit[k], t[k], limit[k]);
                walking &= !(1 << k);
            }
        }
        if walking == 0 {
            return;
        }
        let mut clear = [0.0; LANES];
        for k in 0..LANES {
            clear[k] = pixels[k] as f32;
        }
        let (mut past, mut next_column, mut next_row) = ([0_u32; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let (su, sv, sd) = (start.u[k], start.v[k], start.depth[k]);
            let (au, av, ad) = (ahead.u[k], ahead.v[k], ahead.depth[k]);
            // The signs of du/dt and dv/dt: the depth squared that divides both is positive.
            let (rightwards, downwards) = (au * sd - su * ad > 0.0, av * sd - sv * ad > 0.0);
            let right = column[k] + either(rightwards, clear[k], 1.0 - clear[k]);
            let below = row[k] + either(downwards, clear[k], 1.0 - clear[k]);
            let by_column = crossing(right * sd - su, au - right * ad, sd, ad);
            let by_row = crossing(below * sd - sv, av - below * ad, sd, ad);
            let first = by_column <= by_row;
            let when = either(first, by_column, by_row);
            let when = either(when > t[k], when, t[k]);
            past[k] = u32::from(when >= limit[k]);
            let per_depth = 1.0 / (sd + when * ad);
            let (u, v) = (((su + when * au) * per_depth).floor(), ((sv + when * av) * per_depth).floor());
            let beside = clear[k] - 1.0;
            let (u, v) = (within(u, column[k], beside), within(v, row[k], beside));
            next_column[k] = either(first, either(rightwards, right, right - 1.0), u);
            next_row[k] = either(first, v, either(downwards, below, below - 1.0));
            t[k] = when;
        }
        (column, row) = (next_column, next_row);
        for (k, past) in past.into_iter().enumerate() {
            walking &= !(past << k);
        }
        if walking == 0 {
            return;
        }
    }
}

/// When a line reaches a side, at `numerator / slope`; one that never does crosses it behind the camera, or nowhere.
#[inline(always)]
fn crossing(numerator: f32, slope: f32, depth: f32, ahead: f32) -> f32 {
    let t = numerator / slope;
    let is_ahead = (depth + t * ahead > 0.0) & (t.abs() < f32::INFINITY);
    either(is_ahead, t, f32::INFINITY)
}

/// `x` kept within `reach` of `middle`.
#[inline(always)]
fn within(x: f32, middle: f32, reach: f32) -> f32 {
    let x = either(x > middle - reach, x, middle - reach);
    either(x < middle + reach, x, middle + reach)
}
