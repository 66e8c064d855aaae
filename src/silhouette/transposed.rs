//! The subject's bits packed by columns, so that the pixels above and below a pixel are in one word too.
//!
//! ```text
//!   row  y   ..abcd..        column x   ..aeim..      a square of 32 x 32 bits is transposed by exchanging its
//!   row y+1  ..efgh..   ─►   column x+1 ..bfjn..      off-diagonal quarters, then those of each quarter, and so on
//! ```

use super::mask_crop::{WORD, Word};
use crate::lock::lock;
use crate::math::vectorised;
use std::sync::{Mutex, OnceLock};

/// Adjacent squares that are transposed at once, one per lane.
const SQUARES: usize = 8;

/// The rows of adjacent squares: row k of all squares, then row k + 1.
type Squares = [[Word; SQUARES]; WORD];

/// Subject bits of a crop, column-major; each column begins in a word's lowest bit. They are built lazily, since only
/// points deeper than 10 pixels use them.
#[derive(Debug, Default)]
pub(crate) struct Transposed {
    subject: OnceLock<Vec<Word>>,
    /// Memory for the bits of the next crop.
    recycled: Mutex<Vec<Word>>,
}

impl Transposed {
    /// Discards the bits when the crop changes.
    pub(super) fn invalidate(&mut self) {
        if let Some(subject) = self.subject.take() {
            *lock(&self.recycled) = subject;
        }
    }

    /// The columns of a crop whose `rows` have `words` words each, and the number of words in a column.
    pub(super) fn columns(&self, rows: &[Word], words: usize) -> (&[Word], usize) {
        let words_in_column = (rows.len() / words.max(1)).div_ceil(WORD);
        let subject = self.subject.get_or_init(|| {
            let mut subject = std::mem::take(&mut *lock(&self.recycled));
            subject.resize(words * WORD * words_in_column, 0);
            if !subject.is_empty() {
                transpose_bits(rows, words, &mut subject, words_in_column);
            }
            subject
        });
        (subject, words_in_column)
    }

    /// Bytes of memory of the bits.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.subject.get().map_or(0, Vec::capacity).max(lock(&self.recycled).capacity())
    }
}

vectorised! {
    /// Writes the bits of `rows` to `columns`.
    fn transpose_bits(rows: &[Word], words: usize, columns: &mut [Word], words_in_column: usize) {
        let mut squares = [[0; SQUARES]; WORD];
        for (down, strip) in rows.chunks(WORD * words).enumerate() {
            for across in (0..words).step_by(SQUARES) {
                for (k, square) in squares.iter_mut().enumerate() {
                    *square = words_from(strip, k * words + across);
                }

                transpose(&mut squares);

                // The last squares may have been read beyond the end of the rows; these are not written.
                for n in 0..SQUARES.min(words - across) {
                    let column = (across + n) * WORD * words_in_column + down;
                    for (column, square) in columns[column..].iter_mut().step_by(words_in_column).zip(&squares) {
                        *column = square[n];
                    }
                }
            }
        }
    }
}

/// The words from index `start` on; zeros after the last one.
#[inline(always)]
fn words_from(words: &[Word], start: usize) -> [Word; SQUARES] {
    let words = words.get(start..).unwrap_or(&[]);
    words.first_chunk().copied().unwrap_or_else(|| {
        let mut padded = [0; SQUARES];
        padded.iter_mut().zip(words).for_each(|(padded, word)| *padded = *word);
        padded
    })
}

/// Transposes each square: bit x of row y becomes bit y of row x.
#[inline(always)]
fn transpose(squares: &mut Squares) {
    let mut side = WORD / 2;
    while side > 0 {
        // The bits of every second group of `side` bits, from the lowest on.
        let low = Word::MAX / ((1 << side) + 1);
        for first in (0..WORD).filter(|row| row & side == 0) {
            // Exchange the upper right with the lower left part.
            let (above, below) = squares.split_at_mut(first + side);
            let (upper, lower) = (&mut above[first], &mut below[0]);
            for n in 0..SQUARES {
                let exchanged = (upper[n] >> side ^ lower[n]) & low;
                lower[n] ^= exchanged;
                upper[n] ^= exchanged << side;
            }
        }
        side /= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Border, Silhouette};
    use image::{GrayImage, Luma};

    #[test]
    fn columns_hold_the_bits_of_the_rows() {
        // The mask is wider than eight words, and neither side is a multiple of a word's bits.
        let mask =
            GrayImage::from_fn(403, 171, |i, j| Luma([if (i * 7 + j * j) % 11 < 6 { 255 } else { 0 }]));
        let silhouette = Silhouette::new(&mask, Border::Background);
        let (rect, (columns, words)) = (silhouette.crop.rect(), silhouette.tables().columns());
        for (x, column) in columns.chunks_exact(words).enumerate() {
            for (y, j) in (0..words * 32).zip(rect.y0..) {
                let is_subject = column[y / 32] >> (y % 32) & 1 == 1;
                assert_eq!(is_subject, silhouette.is_subject(rect.x0 + x as i32, j), "{x} {y}");
            }
        }
    }
}
