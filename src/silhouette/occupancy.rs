//! Occupancy of a mask's tiles of 8 x 8 pixels as a summed-area table: four look-ups tell whether any tile in a
//! rectangle holds subject.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::mask_crop::{LOW, MaskCrop, WORD, Word};
use crate::math::vectorised;

/// Pixels on a side of a tile.
const SIDE: usize = 8;

/// Tiles in the width of a word.
const TILES: usize = WORD / SIDE;

/// Words of a row that are processed at once.
const BLOCK: usize = 32;

/// A summed-area table of occupied tiles.
#[derive(Debug, Default)]
pub(crate) struct Occupancy {
    /// For each corner of a tile the number of occupied tiles above and to the left of it, row-major.
    sums: Vec<u32>,
    /// Columns of tiles.
    columns: usize,
    /// Rows of tiles.
    rows: usize,
}

vectorised! {
    /// Computes the table below the first row of `sums`, which is zero. `subject` has rows of `words` words.
    fn sum(subject: &[Word], words: usize, columns: usize, sums: &mut [u32]) {
        let stride = columns + 1;
        for (row, start) in (0..subject.len()).step_by(SIDE * words).enumerate() {
            let (above, here) = sums[row * stride..].split_at_mut(stride);
            here[0] = 0;

            // The number of occupied tiles to the left in this row is added to the sum above.
            let mut sum = 0;
            let (here, above) = (here[1..].as_chunks_mut::<TILES>().0, above[1..].as_chunks::<TILES>().0);
            let blocks = here.chunks_mut(BLOCK).zip(above.chunks(BLOCK));
            for ((here, above), start) in blocks.zip((start..).step_by(BLOCK)) {
                let any = unite_rows(subject, words, start);
                for ((here, above), any) in here.iter_mut().zip(above).zip(any) {
                    // Set each byte that is not zero to 1, then replace each byte by the sum of all bytes up to it.
                    let ones = (((any & 0x7f7f_7f7f) + 0x7f7f_7f7f) | any) >> 7 & 0x0101_0101;
                    let counts = ones.wrapping_mul(0x0101_0101).to_le_bytes();
                    for k in 0..TILES {
                        here[k] = above[k] + sum + u32::from(counts[k]);
                    }
                    sum += u32::from(counts[TILES - 1]);
                }
            }
        }
    }
}

/// The union of the bits of a row of tiles, from word `start` on. A block may extend beyond the end of the row.
#[inline(always)]
fn unite_rows(subject: &[Word], words: usize, start: usize) -> [Word; BLOCK] {
    let mut any = [0; BLOCK];
    for start in (start..subject.len()).step_by(words).take(SIDE) {
        match subject[start..].first_chunk::<BLOCK>() {
            Some(row) => {
                for k in 0..BLOCK {
                    any[k] |= row[k];
                }
            }
            None => any.iter_mut().zip(&subject[start..]).for_each(|(any, word)| *any |= word),
        }
    }
    any
}

impl Occupancy {
    /// Computes the table of `crop`.
    pub(super) fn fill(&mut self, crop: &MaskCrop) {
        let words = crop.words();
        (self.columns, self.rows) = (words * TILES, crop.rect().height().div_ceil(SIDE));
        self.sums.resize((self.columns + 1) * (self.rows + 1), 0);
        self.sums[..=self.columns].fill(0);
        if words > 0 {
            sum(crop.subject(), words, self.columns, &mut self.sums);
        }
    }

    /// A borrowed table for many look-ups.
    #[inline(always)]
    pub(crate) fn lookup(&self) -> OccupancyLookup<'_> {
        let sums: &[u32] = if self.sums.is_empty() { &[0] } else { &self.sums };
        let last = (sums.len() - 1) as u32 & LOW;
        let (columns, rows) = (self.columns as u32, self.rows as u32);
        OccupancyLookup { sums: &sums[..=last as usize], last, columns, rows }
    }

    /// Bytes of memory of the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.sums.capacity()
    }
}

/// A branch-free look-up of occupancy, for many lanes at once. Indices have 32 bits, so that a vector register holds
/// many of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OccupancyLookup<'a> {
    sums: &'a [u32],
    /// Index of the last sum.
    last: u32,
    columns: u32,
    rows: u32,
}

impl OccupancyLookup<'_> {
    /// Whether any tile that overlaps the pixels `from..to` holds subject. Both are a column and a row, counted from
    /// the crop's corner, and `to` is not less than `from`.
    #[inline(always)]
    pub(crate) fn any_occupied(&self, from: [u32; 2], to: [u32; 2]) -> bool {
        let side = SIDE as u32;
        let (x0, x1) = ((from[0] / side).min(self.columns), to[0].div_ceil(side).min(self.columns));
        let (y0, y1) = ((from[1] / side).min(self.rows), to[1].div_ceil(side).min(self.rows));
        let sum = |x: u32, y: u32| self.sums[(y * (self.columns + 1) + x).min(self.last) as usize];
        sum(x1, y1) + sum(x0, y0) > sum(x1, y0) + sum(x0, y1)
    }
}
