//! The background pixels nearest to the pixels of a block of points: searched row by row if all of them are near,
//! otherwise ring by ring.
//!
//! ```text
//!     +----o-x--+   a  the pixel whose nearest background is searched for
//!     |         |   x  background
//!     |    a    x   o  the middle of a side: each side is searched from there in both directions, one word of
//!     |         |      pixels at a time, while its pixels are no farther than the nearest background so far
//!     +---------+
//! ```

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::{Bits, Distances, TableSlices};
use crate::math::point_cloud::LANES;

/// An integer for each lane of a block of points.
type Whole = [i32; LANES];

/// A pixel for each lane, counted from the corner of the silhouette's crop.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pixels {
    pub(crate) column: Whole,
    pub(crate) row: Whole,
}

/// The radius or offset of a lane that has nothing left to search. It exceeds the half-width of any window in a
/// silhouette of 60,000 pixels, and twice its square fits an `i32`.
const FAR: i32 = 30_000;

/// Chebyshev distance up to which the search reads one word per row. The Euclidean distance is then less than 15
/// pixels.
pub(crate) const NEAR: i32 = 10;

/// Pixels to the left of the middle pixel in a word around it.
const WORD_REACH: i32 = 15;

/// Pixels in a word.
const WORD: i32 = u32::BITS as i32;

/// A side of a ring.
#[derive(Clone, Copy)]
struct RingSide {
    /// Whether the side runs along a row, or else along a column.
    is_row: bool,
    /// -1 for the upper or left side, 1 for the lower or right side.
    sign: i32,
}

/// The sides of a ring: upper, left, right and lower.
const SIDES: [RingSide; 4] = [
    RingSide { is_row: true, sign: -1 },
    RingSide { is_row: false, sign: -1 },
    RingSide { is_row: false, sign: 1 },
    RingSide { is_row: true, sign: 1 },
];

/// The state of a search by rings.
struct RingSearch<'a> {
    rows: Bits<'a>,
    columns: Bits<'a>,
    distances: Distances<'a>,
    /// The pixels whose nearest background is searched for.
    middle: &'a Pixels,
    /// Chebyshev radius of the current ring.
    radius: Whole,
    /// Squared distance to the nearest background pixel found so far.
    squared: Whole,
    /// The nearest background pixel found so far.
    nearest: Pixels,
}

/// The background pixel nearest to each pixel of `middle`, within its window of half-width `half`, by Euclidean
/// distance. Ties go to the first in row-major order. `first` is the Chebyshev distance of `middle` to the background.
#[inline(always)]
pub(crate) fn nearest(tables: &TableSlices, middle: &Pixels, first: &Whole, half: &Whole) -> Pixels {
    let rows = Bits::new(tables.subject, tables.words);
    if first.iter().all(|&first| first <= NEAR) {
        return nearest_in_word(rows, middle, half);
    }

    let (columns, words_in_column) = tables.columns();
    let mut search = RingSearch {
        rows,
        columns: Bits::new(columns, words_in_column),
        distances: Distances::new(tables.distance_words, tables.width),
        middle,
        radius: *first,
        squared: [i32::MAX; LANES],
        nearest: *middle,
    };
    loop {
        // Lanes whose ring is larger than their window are done.
        for k in 0..LANES {
            search.radius[k] = if search.radius[k] <= half[k] { search.radius[k] } else { FAR };
        }
        if !search.may_improve(&[0; LANES]) {
            return search.nearest;
        }

        for side in SIDES {
            search.search_side(side);
        }
        for k in 0..LANES {
            search.radius[k] += 1;
        }
    }
}

/// [`nearest`] for pixels with background within [`NEAR`]: searches the rows from the middle one outwards.
#[inline(always)]
fn nearest_in_word(rows: Bits, middle: &Pixels, half: &Whole) -> Pixels {
    let (mut squared, mut nearest) = ([i32::MAX; LANES], *middle);
    for distance in 0..=WORD_REACH {
        let mut may_improve = 0;
        for k in 0..LANES {
            let half = half[k].min(WORD_REACH);
            let window = u32::MAX >> (2 * (WORD_REACH - half) + 1) << (WORD_REACH - half);

            // The upper row wins ties with all pixels found before it; the lower row has to be strictly nearer.
            for (dy, handicap) in [(-distance, 0), (distance, 1)] {
                let background = !rows.from(middle.column[k] - WORD_REACH, middle.row[k] + dy) & window;
                let left = (background << (WORD_REACH + 1)).leading_zeros() as i32;
                let right = (background >> WORD_REACH).trailing_zeros() as i32;
                // The pixel on the left wins ties.
                let dx = if left <= right { -left } else { right };
                let rank = dx * dx + dy * dy;
                let is_better = (background != 0) & (distance <= half) & (rank + handicap <= squared[k]);
                squared[k] = if is_better { rank } else { squared[k] };
                nearest.column[k] = if is_better { middle.column[k] + dx } else { nearest.column[k] };
                nearest.row[k] = if is_better { middle.row[k] + dy } else { nearest.row[k] };
            }
            may_improve |= u32::from((distance < half) & ((distance + 1) * (distance + 1) <= squared[k]));
        }

        if may_improve == 0 {
            break;
        }
    }
    nearest
}

impl RingSearch<'_> {
    /// Whether background at `offset` along a side of the ring would improve the result of any lane.
    #[inline(always)]
    fn may_improve(&self, offset: &Whole) -> bool {
        let mut any = 0;
        for k in 0..LANES {
            any |= u32::from(is_candidate(self.radius[k], offset[k], self.squared[k]));
        }
        any != 0
    }

    /// Searches a side of the ring for nearer background.
    #[inline(always)]
    fn search_side(&mut self, side: RingSide) {
        // The distance table gives how far the side is subject from its middle on. It mostly exceeds what matters.
        let mut clear = [0; LANES];
        for k in 0..LANES {
            let (column, row) = self.pixel(side, k, 0);
            clear[k] = self.distances.at(column as u32, row as u32) as i32;
        }

        for sign in [-1, 1] {
            let mut from = clear;
            while self.may_improve(&from) {
                // The first background pixel in the next word of each lane.
                let mut offset = [0; LANES];
                for k in 0..LANES {
                    let start = if sign < 0 { 1 - WORD - from[k] } else { from[k] };
                    let background = !self.side_word(side, k, start);
                    let skipped =
                        if sign < 0 { background.leading_zeros() } else { background.trailing_zeros() };
                    let found = sign * (from[k] + skipped as i32);
                    offset[k] = if background != 0 { found } else { FAR };
                    from[k] += WORD;
                }
                self.keep_nearer(side, &offset);
            }
        }
    }

    /// Keeps the background pixel at `offset` along a side in each lane where it is better than the best so far.
    #[inline(always)]
    fn keep_nearer(&mut self, side: RingSide, offset: &Whole) {
        for k in 0..LANES {
            let (column, row) = self.pixel(side, k, offset[k]);
            let (best_column, best_row) = (self.nearest.column[k], self.nearest.row[k]);
            let rank = self.radius[k] * self.radius[k] + offset[k] * offset[k];

            // Among equals the first in row-major order wins.
            let is_earlier = (row < best_row) | ((row == best_row) & (column < best_column));
            let may_win = is_candidate(self.radius[k], offset[k], self.squared[k]);
            let is_better = may_win & ((rank < self.squared[k]) | is_earlier);

            self.squared[k] = if is_better { rank } else { self.squared[k] };
            self.nearest.column[k] = if is_better { column } else { best_column };
            self.nearest.row[k] = if is_better { row } else { best_row };
        }
    }

    /// The word of subject bits along a side that begins at `offset` from its middle, in lane `k`.
    #[inline(always)]
    fn side_word(&self, side: RingSide, k: usize, offset: i32) -> u32 {
        let (column, row) = self.pixel(side, k, offset);
        if side.is_row { self.rows.from(column, row) } else { self.columns.from(row, column) }
    }

    /// Column and row of the pixel at `offset` from the middle of a side, in lane `k`.
    #[inline(always)]
    fn pixel(&self, side: RingSide, k: usize, offset: i32) -> (i32, i32) {
        let (column, row, out) = (self.middle.column[k], self.middle.row[k], side.sign * self.radius[k]);
        if side.is_row { (column + offset, row + out) } else { (column + out, row + offset) }
    }
}

/// Whether an offset lies on the side of a ring, and its pixel is no farther away than the nearest background so far.
#[inline(always)]
fn is_candidate(radius: i32, offset: i32, squared: i32) -> bool {
    (radius < FAR) & (offset.abs() <= radius) & (radius * radius + offset * offset <= squared)
}

#[cfg(test)]
mod tests {
    use super::super::{Border, Silhouette};
    use super::*;
    use image::{GrayImage, Luma};
    use ode_visual_hull_random::Random;

    /// A random pixel of the masks.
    fn pixel(random: &mut Random) -> (i32, i32) {
        ((230.0 * random.unit()) as i32, (190.0 * random.unit()) as i32)
    }

    /// An ellipse with isolated background pixels, so that the nearest background lies on all sides and at all depths,
    /// with ties.
    fn mask(specks: usize) -> GrayImage {
        let mut random = Random(specks as u64);
        let holes: Vec<_> = (0..specks).map(|_| pixel(&mut random)).collect();
        GrayImage::from_fn(230, 190, |i, j| {
            let (u, v) = ((f64::from(i) - 115.0) / 110.0, (f64::from(j) - 95.0) / 90.0);
            Luma([if u.hypot(v) < 1.0 && !holes.contains(&(i as i32, j as i32)) { 255 } else { 0 }])
        })
    }

    #[test]
    fn all_lanes_find_the_pixel_that_the_single_search_finds() {
        for specks in [0, 3, 12, 60] {
            let silhouette = Silhouette::new(&mask(specks), Border::Background);
            let (tables, mut random) = (silhouette.tables(), Random(7));
            let (x, y) = tables.corner;
            for (round, extra) in (0..60).zip([0, 1, 9].into_iter().cycle()) {
                // In every third round all pixels are near the background, so that the search by rows is used.
                let max_distance = if round % 3 == 0 { NEAR as u16 } else { u16::MAX };
                let (mut middle, mut first, mut half) = (Pixels::default(), [0; LANES], [0; LANES]);
                for k in 0..LANES {
                    let (i, j) = std::iter::repeat_with(|| pixel(&mut random))
                        .find(|&(i, j)| (1..=max_distance).contains(&silhouette.distance(i, j)))
                        .unwrap();
                    (middle.column[k], middle.row[k]) = (i - x, j - y);
                    first[k] = i32::from(silhouette.distance(i, j));
                    half[k] = first[k] + extra;
                }

                let found = nearest(&tables, &middle, &first, &half);
                for k in 0..LANES {
                    let (i, j) = (middle.column[k] + x, middle.row[k] + y);
                    let expected = silhouette.nearest_background(i, j, half[k]);
                    assert_eq!(Some((found.column[k] + x, found.row[k] + y)), expected, "of ({i}, {j})");
                }
            }
        }
    }
}
