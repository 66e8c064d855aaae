//! Which squares of 8 x 8 pixels hold subject, summed up, so that any rectangle is asked in four look-ups.

// A loop over the lanes of several arrays says what happens to lane k, and becomes vector instructions as a whole.
#![allow(clippy::needless_range_loop)]

use super::mask_crop::{LOW, MaskCrop, WORD, Word};
use crate::math::vectorised;

/// Pixels on a tile's side.
const SIDE: usize = 8;

/// Tiles side by side in a word.
const TILES: usize = WORD / SIDE;

/// Words done at once.
const BLOCK: usize = 32;

/// Tiles with subject above and left of each corner of the tiles, row-major.
#[derive(Debug, Default)]
pub(crate) struct Occupancy {
    sums: Vec<u32>,
    columns: usize,
    rows: usize,
}

vectorised! {
    /// Sums up tiles with subject below the first row of `sums`, which is zero.
    fn sum(subject: &[Word], words: usize, columns: usize, sums: &mut [u32]) {
        let stride = columns + 1;
        for (tiles, start) in (0..subject.len()).step_by(SIDE * words).enumerate() {
            let (above, here) = sums[tiles * stride..].split_at_mut(stride);
            let mut sum = 0;
            here[0] = 0;
            let (here, above) = (here[1..].as_chunks_mut::<TILES>().0, above[1..].as_chunks::<TILES>().0);
            let blocks = here.chunks_mut(BLOCK).zip(above.chunks(BLOCK));
            for ((here, above), start) in blocks.zip((start..).step_by(BLOCK)) {
                let any = any_of(subject, words, start);
                for ((here, above), any) in here.iter_mut().zip(above).zip(any) {
                    // One in each byte that is not zero, then in each byte how many there are up to it.
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

/// The bits of a row of tiles from the word `start` on: as many words as a block has, though a row may have fewer.
#[inline(always)]
fn any_of(subject: &[Word], words: usize, start: usize) -> [Word; BLOCK] {
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
    pub(super) fn fill(&mut self, region: &MaskCrop) {
        let words = region.words();
        (self.columns, self.rows) = (words * TILES, region.rect().height().div_ceil(SIDE));
        self.sums.resize((self.columns + 1) * (self.rows + 1), 0);
        self.sums[..=self.columns].fill(0);
        if words > 0 {
            sum(region.subject(), words, self.columns, &mut self.sums);
        }
    }

    /// The table, to be looked up many times.
    #[inline(always)]
    pub(crate) fn lookup(&self) -> OccupancyLookup<'_> {
        let sums: &[u32] = if self.sums.is_empty() { &[0] } else { &self.sums };
        let last = (sums.len() - 1) as u32 & LOW;
        let (columns, rows) = (self.columns as u32, self.rows as u32);
        OccupancyLookup { sums: &sums[..=last as usize], last, columns, rows }
    }

    /// Bytes of memory behind the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.sums.capacity()
    }
}

/// Tiles as many lanes look them up: without a branch, and with indices of which a vector holds many.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OccupancyLookup<'a> {
    sums: &'a [u32],
    last: u32,
    columns: u32,
    rows: u32,
}

impl OccupancyLookup<'_> {
    /// Whether a tile that the pixels `from..to` touch, counted from the region's corner, holds subject; `to` is not
    /// less than `from`.
    #[inline(always)]
    pub(crate) fn any_occupied(&self, from: [u32; 2], to: [u32; 2]) -> bool {
        let side = SIDE as u32;
        let (x0, x1) = ((from[0] / side).min(self.columns), to[0].div_ceil(side).min(self.columns));
        let (y0, y1) = ((from[1] / side).min(self.rows), to[1].div_ceil(side).min(self.rows));
        let sum = |x: u32, y: u32| self.sums[(y * (self.columns + 1) + x).min(self.last) as usize];
        sum(x1, y1) + sum(x0, y0) > sum(x1, y0) + sum(x0, y1)
    }
}
