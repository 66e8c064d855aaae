//! The subject's bits once more, packed by columns: what lies above and below a pixel is then in one word, too.
//!
//! ```text
//!   row  y   ..abcd..        column x   ..aeim..      a square of 32 x 32 bits is turned by exchanging the halves
//!   row y+1  ..efgh..   ─►   column x+1 ..bfjn..      of its off-diagonal parts, then the quarters, and so on
//! ```

use super::mask_crop::{WORD, Word};
use crate::lock::lock;
use crate::math::vectorised;
use std::sync::{Mutex, OnceLock};

/// Squares side by side that are turned together.
const TOGETHER: usize = 8;

/// Row k of each of them.
type Squares = [[Word; TOGETHER]; WORD];

/// Subject bits of a region, column-major, the first pixel of a column in its first word's lowest bit. Turned when
/// somebody asks: only points that lie deep want them.
#[derive(Debug, Default)]
pub(crate) struct Transposed {
    subject: OnceLock<Vec<Word>>,
    /// Memory of the last ones.
    recycled: Mutex<Vec<Word>>,
}

impl Transposed {
    /// Forgets what was turned.
    pub(super) fn invalidate(&mut self) {
        if let Some(subject) = self.subject.take() {
            *lock(&self.recycled) = subject;
        }
    }

    /// The columns of `rows` of so many words, and the words in each.
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

    /// Bytes of memory behind the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.subject.get().map_or(0, Vec::capacity).max(lock(&self.recycled).capacity())
    }
}

vectorised! {
    fn transpose_bits(rows: &[Word], words: usize, columns: &mut [Word], words_in_column: usize) {
        let mut squares = [[0; TOGETHER]; WORD];
        for (down, strip) in rows.chunks(WORD * words).enumerate() {
            for across in (0..words).step_by(TOGETHER) {
                for (k, square) in squares.iter_mut().enumerate() {
                    *square = some_words(strip, k * words + across);
                }
                transpose(&mut squares);
                // What lies behind the row's last word is none of it.
                for n in 0..TOGETHER.min(words - across) {
                    let column = (across + n) * WORD * words_in_column + down;
                    for (column, square) in columns[column..].iter_mut().step_by(words_in_column).zip(&squares) {
                        *column = square[n];
                    }
                }
            }
        }
    }
}

/// The words from `start` on, those behind the last one zero.
#[inline(always)]
fn some_words(words: &[Word], start: usize) -> [Word; TOGETHER] {
    let words = words.get(start..).unwrap_or(&[]);
    words.first_chunk().copied().unwrap_or_else(|| {
        let mut some = [0; TOGETHER];
        some.iter_mut().zip(words).for_each(|(some, word)| *some = *word);
        some
    })
}

/// Bit x of row y becomes bit y of row x.
#[inline(always)]
fn transpose(squares: &mut Squares) {
    let mut side = WORD / 2;
    while side > 0 {
        // Of every second group of `side` bits all.
        let low = Word::MAX / ((1 << side) + 1);
        for first in (0..WORD).filter(|row| row & side == 0) {
            let (above, below) = squares.split_at_mut(first + side);
            let (upper, lower) = (&mut above[first], &mut below[0]);
            for n in 0..TOGETHER {
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
        // Wider than eight words, and neither side a multiple of a word's bits.
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
