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
use super::tile_mask::TileMask;
use crate::silhouette::Rect;
use crate::silhouette::region::{MARGIN, WORD, Word};
use crate::vectorised::vectorised;
use std::ops::Range;

/// Bytes of eight pixels before a row of tiles, as far as a region reaches beyond the image.
const BEFORE: usize = MARGIN as usize / SIDE;

/// Bytes of eight pixels behind a row of tiles: the margin, what the region's width is rounded up by, and two words.
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

    /// Writes the bytes of `rect`; where there are no tiles they are `beyond`.
    pub(in crate::silhouette) fn write_bytes(&self, rect: &Rect, beyond: u8, bytes: &mut [u8]) {
        let down = self.subject.len() / self.across;
        let tiles = Rect::of_image((SIDE * self.across) as u32, (SIDE * down) as u32);
        if rect.intersection(&tiles) != *rect {
            bytes.fill(beyond);
        }
        let columns = tile_range(rect.x0, rect.x1, self.across);
        for row in tile_range(rect.y0, rect.y1, down) {
            // The rows of pixels of this row of tiles that lie in the rectangle.
            let top = (SIDE * row) as i32 - rect.y0;
            let rows = (-top).max(0) as usize..(rect.height() as i32 - top).min(SIDE as i32) as usize;
            let first = (top + rows.start as i32) as usize * rect.width();
            for column in columns.clone() {
                let tile = &self.tile(row * self.across + column).as_chunks().0[rows.clone()];
                copy_rows(tile, (SIDE * column) as i32 - rect.x0, rect.width(), &mut bytes[first..]);
            }
        }
    }
}

/// The tiles that the pixels `low..high` touch of `count` side by side.
fn tile_range(low: i32, high: i32, count: usize) -> Range<usize> {
    low.max(0) as usize / SIDE..(high.max(0) as usize).div_ceil(SIDE).min(count)
}

/// Copies a tile's rows to column `left` of `bytes`, which are `width` wide; what does not fit is cut off.
#[inline(always)]
fn copy_rows(rows: &[[u8; SIDE]], left: i32, width: usize, bytes: &mut [u8]) {
    if left >= 0 && left as usize + SIDE <= width {
        let bytes = &mut bytes[left as usize..][..(rows.len() - 1) * width + SIDE];
        for (row, start) in rows.iter().zip((0..).step_by(width)) {
            bytes[start..start + SIDE].copy_from_slice(row);
        }
        return;
    }
    let columns = left.max(0) as usize..(left + SIDE as i32).clamp(0, width as i32) as usize;
    let skipped = (-left).max(0) as usize;
    for (row, bytes) in rows.iter().zip(bytes.chunks_mut(width)) {
        bytes[columns.clone()].copy_from_slice(&row[skipped..skipped + columns.len()]);
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
