//! The background pixels nearest to many points: by rows where they are near, else by rings of growing radius.
//!
//! ```text
//!     +---o-x---+   o the middle of a side, from which it is searched both ways, a word of pixels at a time; what lies
//!     |    a    |     farther from it than the nearest pixel found so far is not looked at
//!     |         x   x background
//!     +---------+
//! ```

use super::{Bits, Distances, TableSlices};
use crate::math::point_cloud::LANES;

/// Whole numbers of as many points as are asked together.
type Whole = [i32; LANES];

/// Pixels of one view, from the corner of its silhouette's region.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pixels {
    pub(crate) column: Whole,
    pub(crate) row: Whole,
}

/// No ring: farther than a window in a silhouette of 60,000 pixels reaches. Its square, twice, fits.
const FAR: i32 = 30_000;

/// Up to this Chebyshev distance the nearest background pixel is in sight of a row's word: it lies at most 14 pixels
/// away.
pub(crate) const NEAR: i32 = 10;

/// Pixels left of the middle one in a word around it.
const WORD_REACH: i32 = 15;

/// Pixels of a word.
const WORD: i32 = u32::BITS as i32;

/// A side of a ring: whether it runs along a row, and whether it lies above or left of the middle, -1, or else 1.
#[derive(Clone, Copy)]
struct RingSide {
    is_row: bool,
    sign: i32,
}

const SIDES: [RingSide; 4] = [
    RingSide { is_row: true, sign: -1 },
    RingSide { is_row: false, sign: -1 },
    RingSide { is_row: false, sign: 1 },
    RingSide { is_row: true, sign: 1 },
];

/// What is searched, and what is found for as many points as are asked together.
struct RingSearch<'a> {
    rows: Bits<'a>,
    columns: Bits<'a>,
    distances: Distances<'a>,
    middle: &'a Pixels,
    /// Of the ring that is searched now.
    radius: Whole,
    /// Squared distance of the nearest background so far, and where it is.
    squared: Whole,
    nearest: Pixels,
}

/// The background pixel nearest to each middle (Euclidean, then row-major) within its window of half-width `half`,
/// where `first` is the Chebyshev distance of the nearest ones.
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
        for k in 0..LANES {
            // No ring beyond the window.
            search.radius[k] = if search.radius[k] <= half[k] { search.radius[k] } else { FAR };
        }
        if !search.is_open(&[0; LANES]) {
            return search.nearest;
        }
        for side in SIDES {
            search.look_along(side);
        }
        for k in 0..LANES {
            search.radius[k] += 1;
        }
    }
}

/// The same for pixels near background, by rows outwards.
#[inline(always)]
fn nearest_in_word(rows: Bits, middle: &Pixels, half: &Whole) -> Pixels {
    let (mut squared, mut nearest) = ([i32::MAX; LANES], *middle);
    for away in 0..=WORD_REACH {
        let mut left_to_see = 0;
        for k in 0..LANES {
            let half = half[k].min(WORD_REACH);
            let within = u32::MAX >> (2 * (WORD_REACH - half) + 1) << (WORD_REACH - half);
            for (dy, handicap) in [(-away, 0), (away, 1)] {
                let background = !rows.from(middle.column[k] - WORD_REACH, middle.row[k] + dy) & within;
                let left = (background << (WORD_REACH + 1)).leading_zeros() as i32;
                let right = (background >> WORD_REACH).trailing_zeros() as i32;
                // The left one wins among equals, and so does the upper one.
                let dx = if left <= right { -left } else { right };
                let rank = dx * dx + dy * dy;
                let better = (background != 0) & (away <= half) & (rank + handicap <= squared[k]);
                squared[k] = if better { rank } else { squared[k] };
                nearest.column[k] = if better { middle.column[k] + dx } else { nearest.column[k] };
                nearest.row[k] = if better { middle.row[k] + dy } else { nearest.row[k] };
            }
            left_to_see |= u32::from((away < half) & ((away + 1) * (away + 1) <= squared[k]));
        }
        if left_to_see == 0 {
            break;
        }
    }
    nearest
}

impl RingSearch<'_> {
    /// Whether background so far along a side of the ring is of interest to any point.
    #[inline(always)]
    fn is_open(&self, offset: &Whole) -> bool {
        let mut open = 0;
        for k in 0..LANES {
            open |= u32::from(is_in_question(self.radius[k], offset[k], self.squared[k]));
        }
        open != 0
    }

    /// Looks at a whole side, as far as it matters.
    #[inline(always)]
    fn look_along(&mut self, side: RingSide) {
        // Most sides are clear from their middle on, farther than anybody looks.
        let mut clear = [0; LANES];
        for k in 0..LANES {
            let (column, row) = self.pixel(side, k, 0);
            clear[k] = self.distances.at(column as u32, row as u32) as i32;
        }
        for way in [-1, 1] {
            let mut from = clear;
            while self.is_open(&from) {
                let mut offset = [0; LANES];
                for k in 0..LANES {
                    let start = if way < 0 { 1 - WORD - from[k] } else { from[k] };
                    let background = !self.side_word(side, k, start);
                    let on = if way < 0 { background.leading_zeros() } else { background.trailing_zeros() };
                    let found = way * (from[k] + on as i32);
                    offset[k] = if background != 0 { found } else { FAR };
                    from[k] += WORD;
                }
                self.keep_nearer(side, &offset);
            }
        }
    }

    /// Takes up the background pixels so far along a side, where they are better.
    #[inline(always)]
    fn keep_nearer(&mut self, side: RingSide, offset: &Whole) {
        for k in 0..LANES {
            let (column, row) = self.pixel(side, k, offset[k]);
            let (best_column, best_row) = (self.nearest.column[k], self.nearest.row[k]);
            let rank = self.radius[k] * self.radius[k] + offset[k] * offset[k];
            let upper = (row < best_row) | ((row == best_row) & (column < best_column));
            let in_question = is_in_question(self.radius[k], offset[k], self.squared[k]);
            let better = in_question & ((rank < self.squared[k]) | upper);
            self.squared[k] = if better { rank } else { self.squared[k] };
            self.nearest.column[k] = if better { column } else { best_column };
            self.nearest.row[k] = if better { row } else { best_row };
        }
    }

    /// The subject's bits along a side from so far behind its middle on.
    #[inline(always)]
    fn side_word(&self, side: RingSide, k: usize, offset: i32) -> u32 {
        let (column, row) = self.pixel(side, k, offset);
        if side.is_row { self.rows.from(column, row) } else { self.columns.from(row, column) }
    }

    /// The pixel so far along a side.
    #[inline(always)]
    fn pixel(&self, side: RingSide, k: usize, offset: i32) -> (i32, i32) {
        let (column, row, out) = (self.middle.column[k], self.middle.row[k], side.sign * self.radius[k]);
        if side.is_row { (column + offset, row + out) } else { (column + out, row + offset) }
    }
}

/// Whether a pixel of a ring is, and is not farther away than the nearest background so far.
#[inline(always)]
fn is_in_question(radius: i32, offset: i32, squared: i32) -> bool {
    (radius < FAR) & (offset.abs() <= radius) & (radius * radius + offset * offset <= squared)
}

#[cfg(test)]
mod tests {
    use super::super::tests::Random;
    use super::super::{Border, Silhouette};
    use super::*;
    use image::{GrayImage, Luma};

    /// Some pixel of the masks.
    fn pixel(random: &mut Random) -> (i32, i32) {
        ((230.0 * random.unit()) as i32, (190.0 * random.unit()) as i32)
    }

    /// An ellipse with specks of background, so that nearest ones lie on all sides and at all depths, ties among them.
    fn mask(specks: usize) -> GrayImage {
        let mut random = Random(specks as u64);
        let holes: Vec<_> = (0..specks).map(|_| pixel(&mut random)).collect();
        GrayImage::from_fn(230, 190, |i, j| {
            let (u, v) = ((f64::from(i) - 115.0) / 110.0, (f64::from(j) - 95.0) / 90.0);
            Luma([if u.hypot(v) < 1.0 && !holes.contains(&(i as i32, j as i32)) { 255 } else { 0 }])
        })
    }

    #[test]
    fn lanes_find_the_pixel_that_a_single_search_finds_near_and_deep() {
        for specks in [0, 3, 12, 60] {
            let silhouette = Silhouette::new(&mask(specks), Border::Background);
            let (tables, mut random) = (silhouette.tables(), Random(7));
            let (x, y) = tables.corner;
            for (round, more) in (0..60).zip([0, 1, 9].into_iter().cycle()) {
                // In every third round all pixels are near their background, so that only rows are searched.
                let most = if round % 3 == 0 { NEAR as u16 } else { u16::MAX };
                let (mut middle, mut first, mut half) = (Pixels::default(), [0; LANES], [0; LANES]);
                for k in 0..LANES {
                    let (i, j) = std::iter::repeat_with(|| pixel(&mut random))
                        .find(|&(i, j)| (1..=most).contains(&silhouette.distance(i, j)))
                        .unwrap();
                    (middle.column[k], middle.row[k]) = (i - x, j - y);
                    first[k] = i32::from(silhouette.distance(i, j));
                    half[k] = first[k] + more;
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
