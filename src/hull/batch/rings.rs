//! The background pixels nearest to points that lie deep, by rings of growing radius.
//!
//! ```text
//!     +---o-x---+   o the middle of a side, from which it is searched both ways, by as many pixels at a time as are
//!     |    a    |     surely subject; what lies farther from it than the nearest pixel found so far is not looked at
//!     |         x   x background
//!     +---------+
//! ```

use super::super::points::LANES;
use super::edge::{Pixels, Whole};
use super::lookup::Distances;

/// Outwards from the middle pixel, and along the side.
type Side = ((i32, i32), (i32, i32));

const SIDES: [Side; 4] = [((0, -1), (1, 0)), ((-1, 0), (0, 1)), ((1, 0), (0, 1)), ((0, 1), (1, 0))];

/// No offset on a side, and no ring: farther than a window in a silhouette of 60,000 pixels reaches. Its square,
/// twice, fits.
const FAR: i32 = 30_000;

/// What is found for as many points as are asked together.
struct Found {
    /// Squared distance of the nearest background so far, and where it is.
    squared: Whole,
    nearest: Pixels,
}

/// The background pixel nearest to each middle (Euclidean, then row-major) within its window of half-width `half`,
/// where `first` is the Chebyshev distance of the nearest ones.
#[inline(always)]
pub(super) fn nearest(distances: Distances, middle: &Pixels, first: &Whole, half: &Whole) -> Pixels {
    let mut found = Found { squared: [i32::MAX; LANES], nearest: *middle };
    let mut radius = *first;
    loop {
        for k in 0..LANES {
            // No ring beyond the window.
            radius[k] = if radius[k] <= half[k] { radius[k] } else { FAR };
        }
        if !found.is_open(&radius, &[0; LANES]) {
            return found.nearest;
        }
        // Most sides are clear from their middle on, farther than anybody looks.
        let mut clear = [[0; LANES]; SIDES.len()];
        for (side, clear) in SIDES.into_iter().zip(&mut clear) {
            *clear = found.look(distances, middle, &radius, side, &[0; LANES]);
        }
        for (side, clear) in SIDES.into_iter().zip(&clear) {
            for way in [-1, 1] {
                let mut offset = on(&[0; LANES], clear, way);
                while found.is_open(&radius, &offset) {
                    let clear = found.look(distances, middle, &radius, side, &offset);
                    offset = on(&offset, &clear, way);
                }
            }
        }
        for k in 0..LANES {
            radius[k] += 1;
        }
    }
}

/// So many pixels on, unless it is none.
#[inline(always)]
fn on(offset: &Whole, clear: &Whole, way: i32) -> Whole {
    let mut next = [0; LANES];
    for k in 0..LANES {
        next[k] = if clear[k] > 0 { offset[k] + clear[k] * way } else { FAR };
    }
    next
}

impl Found {
    /// Whether background so far along a side of the ring is of interest to any point.
    #[inline(always)]
    fn is_open(&self, radius: &Whole, offset: &Whole) -> bool {
        let mut open = 0;
        for k in 0..LANES {
            open |= u32::from(is_in_question(radius[k], offset[k], self.squared[k]));
        }
        open != 0
    }

    /// Looks at the pixels so far along a side, and says how far from there no background is: 0 where it is background
    /// itself, or out of question.
    #[inline(always)]
    fn look(
        &mut self,
        distances: Distances,
        middle: &Pixels,
        radius: &Whole,
        (out, along): Side,
        offset: &Whole,
    ) -> Whole {
        let mut clear = [0; LANES];
        for k in 0..LANES {
            let column = middle.column[k] + out.0 * radius[k] + along.0 * offset[k];
            let row = middle.row[k] + out.1 * radius[k] + along.1 * offset[k];
            clear[k] = distances.at(column as u32, row as u32) as i32;
        }
        for k in 0..LANES {
            let column = middle.column[k] + out.0 * radius[k] + along.0 * offset[k];
            let row = middle.row[k] + out.1 * radius[k] + along.1 * offset[k];
            let rank = radius[k] * radius[k] + offset[k] * offset[k];
            let (best_column, best_row) = (self.nearest.column[k], self.nearest.row[k]);
            let upper = (row < best_row) | ((row == best_row) & (column < best_column));
            let in_question = is_in_question(radius[k], offset[k], self.squared[k]);
            let better = in_question & (clear[k] == 0) & ((rank < self.squared[k]) | upper);
            self.squared[k] = if better { rank } else { self.squared[k] };
            self.nearest.column[k] = if better { column } else { best_column };
            self.nearest.row[k] = if better { row } else { best_row };
            clear[k] = if in_question { clear[k] } else { 0 };
        }
        clear
    }
}

/// Whether a pixel of a ring is, and is not farther away than the nearest background so far.
#[inline(always)]
fn is_in_question(radius: i32, offset: i32, squared: i32) -> bool {
    (radius < FAR) & (offset.abs() <= radius) & (radius * radius + offset * offset <= squared)
}
