//! Rows of pixels from tiles: how a mask drawn by tiles becomes a region's bits and bytes.
//!
//! ```text
//!      tiles     +-------+-------+-------+
//!                |   +---|-------|---+   |
//!                |   |   |       |   |   |   the region begins and ends anywhere in a tile, and may reach beyond
//!                +---|---+-------+---|---+   the image, where all is what the border says
//! ```

// A loop over the lanes of several arrays says what happens to lane k, and becomes vector instructions as a whole.
#![allow(clippy::needless_range_loop)]

use super::tile_map::SIDE;
use super::tile_mask::{Tile, TileMask};
use crate::silhouette::Rect;
use crate::silhouette::region::{MARGIN, WORD, Word};
use crate::vectorised::vectorised;

/// Bytes of eight pixels before a row of tiles, as far as a region reaches beyond the image.
const BEFORE: usize = MARGIN as usize / SIDE;

/// Bytes of eight pixels behind a row of tiles: the margin, what the region is rounded up by, and two words.
const BEHIND: usize = BEFORE + 1 + 2 * WORD / SIDE;

impl TileMask {
    /// Writes the subject bits of `rect`, and 0 behind its rows; `row` is scratch.
    pub(in crate::silhouette) fn write_subject(
        &self,
        rect: &Rect,
        beyond: u8,
        row: &mut Vec<u8>,
        subject: &mut [Word],
    ) {
        row.clear();
        row.resize(BEFORE + self.across + BEHIND, beyond);
        write_bits(self, rect, beyond, row, subject);
    }

    /// Writes the bytes of `rect` as far as there are tiles.
    pub(in crate::silhouette) fn write_bytes(&self, rect: &Rect, bytes: &mut [u8]) {
        let (width, height) = (rect.width(), rect.height());
        let rows = self.tile_range(rect.y0, rect.y1, self.places.len() / self.across);
        let columns = self.tile_range(rect.x0, rect.x1, self.across);
        for row in rows {
            // The rows of pixels of this row of tiles that lie in the rectangle.
            let top = (SIDE * row) as i32 - rect.y0;
            let inner_rows = (-top).max(0) as usize..(height as i32 - top).min(SIDE as i32) as usize;
            let first = (top + inner_rows.start as i32) as usize * width;
            let bytes = &mut bytes[first..];
            for column in columns.clone() {
                let tile = &self.bytes[self.places[row * self.across + column] as usize];
                let left = (SIDE * column) as i32 - rect.x0;
                copy_tile(tile, inner_rows.clone(), left, width, bytes);
            }
        }
    }

    /// The tiles that `low..high` touches of `count` side by side.
    fn tile_range(&self, low: i32, high: i32, count: usize) -> std::ops::Range<usize> {
        let high = (high.max(0) as usize).div_ceil(SIDE).min(count);
        low.max(0) as usize / SIDE..high
    }
}

/// Copies a tile's `rows` to column `left` of `bytes`, which are `width` wide; what does not fit is cut off.
#[inline(always)]
fn copy_tile(tile: &Tile, rows: std::ops::Range<usize>, left: i32, width: usize, bytes: &mut [u8]) {
    let source = &tile.as_chunks::<SIDE>().0[rows];
    let fits = left >= 0 && left as usize + SIDE <= width;
    for (row, place) in source.iter().zip(bytes.chunks_mut(width)) {
        if fits {
            place[left as usize..][..SIDE].copy_from_slice(row);
        } else {
            let columns = left.max(0) as usize..(left + SIDE as i32).clamp(0, width as i32) as usize;
            let skipped = (-left).max(0) as usize;
            place[columns.clone()].copy_from_slice(&row[skipped..skipped + columns.len()]);
        }
    }
}

vectorised! {
    /// Writes the bits of `rect`. `row` is `beyond` but for the tiles' part, which is scratch.
    fn write_bits(mask: &TileMask, rect: &Rect, beyond: u8, row: &mut [u8], subject: &mut [Word]) {
        let (width, words, down) = (rect.width(), rect.width().div_ceil(WORD), mask.subject.len() / mask.across);
        let first = (rect.x0 + MARGIN) as usize;
        let (start, shift) = (first / SIDE, first % SIDE);
        let within = Word::MAX >> (words * WORD - width);
        for (y, bits) in (rect.y0..rect.y1).zip(subject.chunks_exact_mut(words)) {
            let tiles = usize::try_from(y).ok().filter(|y| *y < SIDE * down).map(|y| {
                (&mask.subject[y / SIDE * mask.across..][..mask.across], SIDE * (y % SIDE))
            });
            let inner = &mut row[BEFORE..][..mask.across];
            match tiles {
                Some((tiles, down)) => {
                    for k in 0..inner.len() {
                        inner[k] = (tiles[k] >> down) as u8;
                    }
                }
                None => inner.fill(beyond),
            }

            // The region begins within a byte.
            let source = &row[start..].as_chunks::<4>().0[..words + 1];
            let bits = &mut bits[..words];
            for k in 0..words {
                let [low, high] = [source[k], source[k + 1]].map(|word| u64::from(Word::from_le_bytes(word)));
                bits[k] = ((low | high << WORD) >> shift) as Word;
            }
            bits[words - 1] &= within;
        }
    }
}
