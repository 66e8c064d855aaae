//! Walks of many points through silhouettes at once, each along its own line.
//!
//! As in [`march`](super::super::march): a step leads to the side of the largest square of subject pixels around, and
//! crosses into the pixel behind it. Points that have arrived wait for the others.

use super::super::points::{LANES, Lane};
use super::fold::Homogeneous;

/// No walk takes more steps; a line through the largest image takes fewer.
const MOST_STEPS: usize = 1 << 18;

/// Lines of as many points as walk together: where they are at `t` metres is `start + t ahead`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lines {
    pub(super) start: Homogeneous,
    pub(super) ahead: Homogeneous,
    /// The pixel that each point starts in.
    pub(super) column: Lane,
    pub(super) row: Lane,
}

/// Walks every line whose bit is set in `walking` until background or its `limit`, and lowers the limit to where it
/// left. `distance(k, column, row)` is line k's distance table.
#[inline(always)]
pub(super) fn walk(
    lines: &Lines,
    limit: &mut Lane,
    mut walking: u32,
    distance: impl Fn(usize, u32, u32) -> u8,
) {
    let (start, ahead) = (&lines.start, &lines.ahead);
    let (mut column, mut row, mut t) = (lines.column, lines.row, [0.0_f32; LANES]);
    for _ in 0..MOST_STEPS {
        let mut clear = [0.0_f32; LANES];
        for k in 0..LANES {
            if walking >> k & 1 == 1 {
                let pixels = distance(k, column[k] as u32, row[k] as u32);
                clear[k] = f32::from(pixels);
                if pixels == 0 {
                    limit[k] = limit[k].min(t[k]);
                    walking &= !(1 << k);
                }
            }
        }
        if walking == 0 {
            return;
        }
        let (mut past, mut next_column, mut next_row) = ([false; LANES], column, row);
        for k in 0..LANES {
            // The signs of du/dt and dv/dt: the depth squared that divides both is positive.
            let rightwards = ahead.u[k] * start.depth[k] - start.u[k] * ahead.depth[k] > 0.0;
            let downwards = ahead.v[k] * start.depth[k] - start.v[k] * ahead.depth[k] > 0.0;
            let side =
                |from: f32, forwards: bool| if forwards { from + clear[k] } else { from - clear[k] + 1.0 };
            let (right, below) = (side(column[k], rightwards), side(row[k], downwards));
            let crossing = |side: f32, start_x: f32, ahead_x: f32| {
                let t = (side * start.depth[k] - start_x) / (ahead_x - side * ahead.depth[k]);
                // A line that never reaches the side crosses it behind the camera, or nowhere.
                let is_ahead = t.is_finite() && start.depth[k] + t * ahead.depth[k] > 0.0;
                if is_ahead { t } else { f32::INFINITY }
            };
            let by_column = crossing(right, start.u[k], ahead.u[k]);
            let by_row = crossing(below, start.v[k], ahead.v[k]);
            let when = by_column.min(by_row).max(t[k]);
            past[k] = when >= limit[k];
            let per_depth = 1.0 / (start.depth[k] + when * ahead.depth[k]);
            let keep =
                |x: f32, middle: f32| x.floor().max(middle - clear[k] + 1.0).min(middle + clear[k] - 1.0);
            let u = keep((start.u[k] + when * ahead.u[k]) * per_depth, column[k]);
            let v = keep((start.v[k] + when * ahead.v[k]) * per_depth, row[k]);
            let entered = |side: f32, forwards: bool| if forwards { side } else { side - 1.0 };
            let first = by_column <= by_row;
            next_column[k] = if first { entered(right, rightwards) } else { u };
            next_row[k] = if first { v } else { entered(below, downwards) };
            t[k] = when;
        }
        (column, row) = (next_column, next_row);
        for (k, past) in past.into_iter().enumerate() {
            walking &= !(u32::from(past) << k);
        }
        if walking == 0 {
            return;
        }
    }
}
