//! Binary images with one bit per pixel, so that 64 pixels of a row are processed at once.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::Rect;
use crate::math::lanes::set_bits;
use crate::math::vectorised;

/// Pixels in a word, the first in the lowest bit.
pub(crate) const WORD: usize = 64;

/// Words of a row that are united at once.
const COLUMNS: usize = 8;

/// A binary image, row-major. Each row begins with a new word, and the bits after its end are zero.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct BitImage {
    width: usize,
    height: usize,
    words: Vec<u64>,
}

impl BitImage {
    /// Sets the size, in the memory that it has. The pixels are unspecified until the caller writes them.
    pub(crate) fn resize(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.words.resize(width.div_ceil(WORD) * height, 0);
    }

    /// Pixels in a row.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub(crate) fn height(&self) -> usize {
        self.height
    }

    /// Words in a row.
    pub(crate) fn stride(&self) -> usize {
        self.width.div_ceil(WORD)
    }

    /// The bits of a row's last word that are pixels.
    pub(crate) fn last_word(&self) -> u64 {
        u64::MAX >> (self.stride() * WORD - self.width)
    }

    /// The words of all rows.
    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }

    /// The words of all rows, for writing. The bits after the end of a row must stay zero.
    pub(crate) fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words
    }

    /// The words of row `y`.
    pub(crate) fn row(&self, y: usize) -> &[u64] {
        &self.words[y * self.stride()..][..self.stride()]
    }

    /// Whether a pixel is set.
    #[inline(always)]
    pub(crate) fn get(&self, x: usize, y: usize) -> bool {
        self.words[y * self.stride() + x / WORD] >> (x % WORD) & 1 == 1
    }

    /// Sets or clears a pixel.
    #[inline(always)]
    pub(crate) fn set(&mut self, x: usize, y: usize, is_set: bool) {
        let at = y * self.stride() + x / WORD;
        let word = &mut self.words[at];
        *word = *word & !(1 << (x % WORD)) | u64::from(is_set) << (x % WORD);
    }

    /// Inverts the pixels `start..end` of row `y`.
    pub(crate) fn flip_run(&mut self, y: usize, start: usize, end: usize) {
        let stride = self.stride();
        let row = &mut self.words[y * stride..][..stride];
        let (first, last) = (start / WORD, (end - 1) / WORD);
        for (k, word) in row.iter_mut().enumerate().take(last + 1).skip(first) {
            let from = if k == first { u64::MAX << (start % WORD) } else { u64::MAX };
            let to = if k == last { u64::MAX >> (WORD - 1 - (end - 1) % WORD) } else { u64::MAX };
            *word ^= from & to;
        }
    }

    /// The smallest rectangle around the pixels that are set.
    pub(crate) fn rect(&self) -> Rect {
        let stride = self.stride().max(1);
        let is_occupied = |row: &[u64]| row.iter().fold(0, |any, word| any | word) != 0;

        // The first and the last row with a pixel that is set.
        let mut rows = self.words.chunks_exact(stride);
        let Some(first) = rows.position(is_occupied) else {
            return Rect::EMPTY;
        };
        let last = first + rows.rposition(is_occupied).map_or(0, |after| after + 1);

        // The first and the last column with a pixel that is set in any of these rows.
        let (mut left, mut right) = (None, 0);
        for start in (0..stride).step_by(COLUMNS) {
            let any = unite(
                &self.words[first * stride + start..],
                stride,
                last + 1 - first,
                COLUMNS.min(stride - start),
            );
            for (k, word) in (start..).zip(any).filter(|(_, word)| *word != 0) {
                left = left.or(Some(k * WORD + word.trailing_zeros() as usize));
                right = (k + 1) * WORD - word.leading_zeros() as usize;
            }
        }
        Rect { x0: left.unwrap_or(0) as i32, y0: first as i32, x1: right as i32, y1: last as i32 + 1 }
    }

    /// Makes this a copy of `other`.
    pub(crate) fn copy(&mut self, other: &Self) {
        self.resize(other.width, other.height);
        self.words.copy_from_slice(&other.words);
    }

    /// The number of pixels that are set.
    pub(crate) fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Calls `visit` with column and row of each pixel that is set, row-major.
    pub(crate) fn for_each(&self, mut visit: impl FnMut(usize, usize)) {
        for (y, row) in self.words.chunks_exact(self.stride().max(1)).enumerate() {
            for (k, &word) in row.iter().enumerate() {
                set_bits(word).for_each(|bit| visit(k * WORD + bit, y));
            }
        }
    }

    /// Writes row `y` as bytes: 255 for pixels that are set, 0 for others.
    pub(crate) fn write_row(&self, y: usize, bytes: &mut [u8]) {
        expand(self.row(y), bytes);
    }
}

/// Packs the highest bit of each byte into words, the first byte's into the lowest bit.
#[inline(always)]
pub(crate) fn pack<const WORDS: usize>(bytes: &[[u8; WORD]; WORDS]) -> [u64; WORDS] {
    let (eights, mut packed) = (bytes.as_flattened().as_chunks::<8>().0, [[0; 8]; WORDS]);
    let bytes = packed.as_flattened_mut();
    for k in 0..bytes.len() {
        bytes[k] = top_bits(&eights[k]);
    }
    packed.map(u64::from_le_bytes)
}

/// Packs the highest bits of eight bytes into one byte, the first byte's into the lowest bit.
#[inline(always)]
pub(super) fn top_bits(bytes: &[u8; 8]) -> u8 {
    // Move the highest bit of byte m to bit m, in steps of one, two and four bytes.
    let tops = u64::from_le_bytes(*bytes) >> 7 & 0x0101_0101_0101_0101;
    let pairs = tops | tops >> 7;
    let fours = pairs | pairs >> 14;
    (fours | fours >> 28) as u8
}

vectorised! {
    /// The union of the first `width` words of `count` rows that begin `stride` words apart.
    fn unite(rows: &[u64], stride: usize, count: usize, width: usize) -> [u64; COLUMNS] {
        let mut any = [0; COLUMNS];
        for row in rows.chunks(stride).take(count) {
            match row.first_chunk::<COLUMNS>() {
                Some(row) => {
                    for k in 0..COLUMNS {
                        any[k] |= row[k];
                    }
                }
                None => {
                    for k in 0..width {
                        any[k] |= row[k];
                    }
                }
            }
        }

        // Words after the end of a row belong to the next one.
        any[width..].fill(0);
        any
    }
}

vectorised! {
    /// Writes the bits of a row as bytes: 255 for bits that are set, 0 for others.
    fn expand(words: &[u64], bytes: &mut [u8]) {
        for (&word, bytes) in words.iter().zip(bytes.chunks_mut(WORD)) {
            if word == 0 || word == u64::MAX {
                bytes.fill(word as u8);
                continue;
            }

            for (k, byte) in bytes.iter_mut().enumerate() {
                *byte = 0u8.wrapping_sub((word >> k & 1) as u8);
            }
        }
    }
}
