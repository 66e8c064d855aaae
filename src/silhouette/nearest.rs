//! The background pixel nearest to a pixel inside.
//!
//! ```text
//!      near: row by row, 32 pixels a word        deep: ring by ring, four sides each
//!        . . . . . . . . .                         +---o-x---+   o the middle of a side, from which it is searched
//!        . . . a . . x . .                         |    a    |     both ways; what lies farther from it than the
//!        . . . . . . . . .                         |         x     nearest pixel found so far is not looked at
//!                                                  +---------+   x background
//! ```

use super::Silhouette;
use super::region::Word;

/// A pixel and its rank: squared distance, then row-major.
type Ranked = (i64, i32, i32);

/// Up to this Chebyshev distance the nearest background pixel is in sight of a row's word: it lies at most 14 pixels
/// away.
const NEAR: i32 = 10;

/// Pixels left of the middle one in a word around it.
const LEFT: i32 = 15;

impl Silhouette {
    /// The background pixel nearest to `(i, j)` (Euclidean, then row-major) within the window of half-width `half`.
    #[inline(always)]
    pub fn nearest_background(&self, i: i32, j: i32, half: i32) -> Option<(i32, i32)> {
        let first = i32::from(self.distance(i, j));
        let region = self.region.rect();
        let in_sight =
            |reach: i32| region.contains(i - reach, j - reach) && region.contains(i + reach, j + reach);
        if first == 0 {
            Some((i, j))
        } else if half < first {
            None
        } else if first <= NEAR && in_sight(LEFT + 1) {
            Some(self.nearest_by_rows(i, j, half))
        } else {
            self.nearest_by_rings(i, j, first, half)
        }
    }

    /// For a pixel whose nearest background is in sight, `half` not less than its distance.
    #[inline(always)]
    fn nearest_by_rows(&self, i: i32, j: i32, half: i32) -> (i32, i32) {
        let half = half.min(LEFT);
        let within = Word::MAX >> (Word::BITS as i32 - 1 - 2 * half) << (LEFT - half);
        let rows = self.region.rows_from(i - LEFT, j);
        let (mut squared, mut best) = (i32::MAX, (0, 0));
        for away in 0..=half {
            if away * away > squared {
                break;
            }
            for dy in [-away, away] {
                let background = !rows.row(dy) & within;
                // The middle pixel is bit LEFT; the left one wins among equals.
                let left = (background << (Word::BITS as i32 - 1 - LEFT)).leading_zeros() as i32;
                let right = (background >> LEFT).trailing_zeros() as i32;
                let dx = if left <= right { -left } else { right };
                let rank = dx * dx + dy * dy;
                if background != 0 && (rank < squared || (rank == squared && (dy, dx) < (best.1, best.0))) {
                    (squared, best) = (rank, (dx, dy));
                }
            }
        }
        (i + best.0, j + best.1)
    }

    #[inline(never)]
    fn nearest_by_rings(&self, i: i32, j: i32, first: i32, half: i32) -> Option<(i32, i32)> {
        let mut best: Option<Ranked> = None;
        let mut ring = first;
        // A ring at Chebyshev radius r holds nothing nearer than r, so the search ends where r exceeds the best.
        while ring <= half && best.is_none_or(|(squared, ..)| i64::from(ring).pow(2) <= squared) {
            for side in [Side::Above, Side::Left, Side::Right, Side::Below] {
                let reach = best.map_or(ring, |(squared, ..)| reach(squared, ring));
                let (down, along) = side.steps();
                let middle = (i + down.0 * ring, j + down.1 * ring);
                let found = |sign: i32| {
                    let offset = self.first_background(middle, along, sign, reach)?;
                    let (x, y) = (middle.0 + along.0 * sign * offset, middle.1 + along.1 * sign * offset);
                    Some((i64::from(ring).pow(2) + i64::from(offset).pow(2), y, x))
                };
                // Most sides are clear from their middle on, farther than anybody looks.
                if self.clear(middle.0, middle.1) <= reach {
                    best = best.into_iter().chain(found(-1)).chain(found(1)).min();
                }
            }
            ring += 1;
        }
        best.map(|(_, y, x)| (x, y))
    }

    /// How many steps along a row or column from `from` on the first background pixel lies, if at most `reach`.
    #[inline]
    fn first_background(&self, from: (i32, i32), along: (i32, i32), sign: i32, reach: i32) -> Option<i32> {
        let region = self.region.rect();
        let end = (from.0 + along.0 * sign * reach, from.1 + along.1 * sign * reach);
        let mut offset = 0;
        if !region.contains(from.0, from.1) || !region.contains(end.0, end.1) {
            while offset <= reach {
                match self.clear(from.0 + along.0 * sign * offset, from.1 + along.1 * sign * offset) {
                    0 => return Some(offset),
                    clear => offset += clear,
                }
            }
            return None;
        }
        let (table, start) = (self.derived_tables().distances.narrow(), region.index(from.0, from.1) as i32);
        let step = sign * (along.0 + along.1 * region.width() as i32);
        while offset <= reach {
            match table[(start + step * offset) as usize] {
                0 => return Some(offset),
                clear => offset += i32::from(clear),
            }
        }
        None
    }

    /// Pixels that may be skipped from `(i, j)` on in any direction: 0 where it is background. A pixel whose distance
    /// is d has no background within d - 1.
    #[inline]
    fn clear(&self, i: i32, j: i32) -> i32 {
        let region = self.region.rect();
        if region.contains(i, j) {
            i32::from(self.derived_tables().distances.at(region.index(i, j)))
        } else {
            i32::from(self.is_subject(i, j))
        }
    }
}

/// How far from a side's middle a pixel at distance `squared` may lie.
fn reach(squared: i64, ring: i32) -> i32 {
    let rest = squared - i64::from(ring).pow(2);
    // A root in double precision is right for squares of pixels, or one too large, which does no harm.
    ((rest as f64).sqrt() as i64).min(i64::from(ring)) as i32
}

/// The sides of a ring.
#[derive(Clone, Copy)]
enum Side {
    Above,
    Left,
    Right,
    Below,
}

impl Side {
    /// From the middle of the ring to the middle of the side, and along it.
    fn steps(self) -> ((i32, i32), (i32, i32)) {
        match self {
            Self::Above => ((0, -1), (1, 0)),
            Self::Below => ((0, 1), (1, 0)),
            Self::Left => ((-1, 0), (0, 1)),
            Self::Right => ((1, 0), (0, 1)),
        }
    }
}
