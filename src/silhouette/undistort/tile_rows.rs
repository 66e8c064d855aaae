//! Conversion of a mask in tiles to the rows of bits and bytes of a crop.
//!
//! ```text
//!      tiles     +-------+-------+-------+
//!                |   +---|-------|---+   |
//!                |   |   |       |   |   |   the crop begins and ends anywhere in a tile, and may reach beyond the
//!                +---|---+-------+---|---+   image, where the border defines the pixels
//! ```

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::source_blocks::FOREGROUND;
use super::tile_map::SIDE;
use super::tile_mask::TileMask;
use crate::math::vectorised;
use crate::silhouette::Rect;
use crate::silhouette::mask_crop::{MARGIN, WORD, Word};

/// Bytes of eight pixels before a row of tiles: as far as a crop may begin before the image.
const BEFORE: usize = MARGIN as usize / SIDE;

/// Bytes of eight pixels after a row of tiles: for the margin, the rounding of the crop's width, and a word.
const BEHIND: usize = BEFORE + 1 + 2 * WORD / SIDE;

impl TileMask {
    /// Writes the subject bits of `rect`, and zeros in the rest of each row's last word. `beyond` is the byte of pixels
    /// outside the drawn tiles; `row` is scratch memory.
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

    /// Writes the bytes of `rect`; pixels outside the drawn tiles are `beyond`. `row` is scratch memory.
    pub(in crate::silhouette) fn write_bytes(
        &self,
        rect: &Rect,
        beyond: u8,
        row: &mut Vec<u8>,
        bytes: &mut [u8],
    ) {
        row.clear();
        row.resize(SIDE * (BEFORE + self.across + BEHIND), beyond);
        write_uniform(self, rect, beyond, row, bytes);

        // The tiles that are not uniform replace what was written. They ascend, so that their row is found on the way.
        let (mut row, width) = (self.drawn.rows.start, rect.width());
        for (tile, rows) in self.mixed() {
            while tile >= (row + 1) * self.across {
                row += 1;
            }

            // The rows of pixels of this tile that lie in the rectangle.
            let top = (SIDE * row) as i32 - rect.y0;
            let (first, end) = ((-top).max(0), (rect.height() as i32 - top).min(SIDE as i32));
            let left = (SIDE * (tile - row * self.across)) as i32 - rect.x0;
            if first < end && left > -(SIDE as i32) && left < width as i32 {
                let rows = &rows.as_chunks().0[first as usize..end as usize];
                copy_rows(rows, left, width, &mut bytes[(top + first) as usize * width..]);
            }
        }
    }
}

/// Copies a tile's rows to column `left` of `bytes`, whose rows have `width` bytes. What does not fit is cut off.
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
    /// Writes the bytes of `rect` as if all tiles were uniform. `row` holds `beyond`, except in the part of the drawn
    /// tiles, which is scratch memory.
    fn write_uniform(mask: &TileMask, rect: &Rect, beyond: u8, row: &mut [u8], bytes: &mut [u8]) {
        let (width, drawn) = (rect.width(), &mask.drawn);
        let start = (rect.x0 + MARGIN) as usize;
        let mut y = rect.y0;
        let mut rest = bytes;
        while y < rect.y1 {
            // All rows of pixels in a row of uniform tiles are equal.
            let tiles = y.div_euclid(SIDE as i32);
            let end = (SIDE as i32 * (tiles + 1)).min(rect.y1);
            let inner = &mut row.as_chunks_mut::<SIDE>().0[BEFORE..][drawn.columns.clone()];
            match usize::try_from(tiles).ok().filter(|tiles| drawn.rows.contains(tiles)) {
                Some(tiles) => {
                    let classes = &mask.classes_in_row(tiles)[..inner.len()];
                    for k in 0..inner.len() {
                        inner[k] = [u8::from(classes[k] == FOREGROUND).wrapping_neg(); SIDE];
                    }
                }
                None => inner.fill([beyond; SIDE]),
            }

            let rows;
            (rows, rest) = rest.split_at_mut((end - y) as usize * width);
            for bytes in rows.chunks_exact_mut(width) {
                bytes.copy_from_slice(&row[start..start + width]);
            }
            y = end;
        }
    }
}

vectorised! {
    /// Writes the bits of `rect`. `row` holds `beyond`, except in the part of the drawn tiles, which is scratch memory.
    fn write_bits(mask: &TileMask, rect: &Rect, beyond: u8, row: &mut [u8], subject: &mut [Word]) {
        let (width, words, drawn) = (rect.width(), rect.width().div_ceil(WORD), &mask.drawn);
        let first = (rect.x0 + MARGIN) as usize;
        let (start, shift) = (first / SIDE, first % SIDE);
        let within = Word::MAX >> (words * WORD - width);
        for (y, bits) in (rect.y0..rect.y1).zip(subject.chunks_exact_mut(words)) {
            let tiles = usize::try_from(y).ok().filter(|y| drawn.rows.contains(&(y / SIDE))).map(|y| {
                (&mask.subject[y / SIDE * mask.across..][drawn.columns.clone()], SIDE * (y % SIDE))
            });
            let inner = &mut row[BEFORE..][drawn.columns.clone()];
            match tiles {
                Some((tiles, down)) => {
                    let tiles = &tiles[..inner.len()];
                    for k in 0..inner.len() {
                        inner[k] = (tiles[k] >> down) as u8;
                    }
                }
                None => inner.fill(beyond),
            }

            // The crop may begin within a byte.
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
