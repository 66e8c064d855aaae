//! The background pixel nearest to a pixel inside: rings of growing radius, four sides each.
//!
//! ```text
//!      +---o-x---+     o the middle of a side, from which a side is searched both ways; what lies farther from it
//!      |    a    |       than the nearest pixel found so far is not looked at
//!      |         x     x background
//!      +---------+
//! ```

use super::Silhouette;

/// A pixel and its rank: squared distance, then row-major.
type Ranked = (i64, i32, i32);

impl Silhouette {
    /// The background pixel nearest to `(i, j)` (Euclidean, then row-major) within the window of half-width `half`.
    pub fn nearest_background(&self, i: i32, j: i32, half: i32) -> Option<(i32, i32)> {
        let first = i32::from(self.distance(i, j));
        if first == 0 {
            return Some((i, j));
        }
        let mut best: Option<Ranked> = None;
        let mut ring = first;
        // A ring at Chebyshev radius r holds nothing nearer than r, so the search ends where r exceeds the best.
        while ring <= half && best.is_none_or(|(squared, ..)| i64::from(ring).pow(2) <= squared) {
            for side in [Side::Above, Side::Left, Side::Right, Side::Below] {
                let reach = best.map_or(ring, |(squared, ..)| reach(squared, ring));
                if let Some(found) = self.nearest_on_side(i, j, ring, side, reach) {
                    best = Some(best.map_or(found, |best| best.min(found)));
                }
            }
            ring += 1;
        }
        best.map(|(_, y, x)| (x, y))
    }

    /// The nearest background pixel on one side of a ring, at most `reach` from the side's middle.
    fn nearest_on_side(&self, i: i32, j: i32, ring: i32, side: Side, reach: i32) -> Option<Ranked> {
        let at = |offset: i32| match side {
            Side::Above => (i + offset, j - ring),
            Side::Below => (i + offset, j + ring),
            Side::Left => (i - ring, j + offset),
            Side::Right => (i + ring, j + offset),
        };
        // A pixel whose distance is d has no background within d - 1.
        let walk = |sign: i32| {
            let mut offset = 0;
            while offset <= reach {
                let (x, y) = at(sign * offset);
                match self.skip(x, y) {
                    0 => return Some(offset),
                    clear => offset = offset.saturating_add(clear),
                }
            }
            None
        };
        let rank = |offset: i32| {
            let (x, y) = at(offset);
            (i64::from(ring).pow(2) + i64::from(offset).pow(2), y, x)
        };
        [walk(-1).map(|offset| rank(-offset)), walk(1).map(rank)].into_iter().flatten().min()
    }

    /// Pixels that may be skipped from `(i, j)` on in any direction: 0 where it is background.
    fn skip(&self, i: i32, j: i32) -> i32 {
        let region = self.region.rect();
        if region.contains(i, j) {
            i32::from(self.distances.at(region.index(i, j)))
        } else {
            i32::from(self.is_subject(i, j))
        }
    }
}

/// How far from a side's middle a pixel at distance `squared` may lie.
fn reach(squared: i64, ring: i32) -> i32 {
    let rest = squared - i64::from(ring).pow(2);
    let mut reach = (rest as f64).sqrt() as i64;
    while reach * reach > rest {
        reach -= 1;
    }
    reach.min(i64::from(ring)) as i32
}

/// The sides of a ring.
#[derive(Clone, Copy)]
enum Side {
    Above,
    Left,
    Right,
    Below,
}
