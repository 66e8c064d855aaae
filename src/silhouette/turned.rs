//! The subject's bits once more, packed by columns: what lies above and below a pixel is then in one word, too.
//!
//! ```text
//!   row  y   ..abcd..        column x   ..aeim..      a square of 32 x 32 bits is turned by exchanging the halves
//!   row y+1  ..efgh..   ─►   column x+1 ..bfjn..      of its off-diagonal parts, then the quarters, and so on
//! ```

use super::region::{Region, WORD, Word};
use crate::vectorised::vectorised;

/// Squares side by side that are turned together.
const TOGETHER: usize = 8;

/// Row k of each of them.
type Squares = [[Word; TOGETHER]; WORD];

/// Subject bits of a region, column-major, the first pixel of a column in its first word's lowest bit.
#[derive(Debug, Default)]
pub(super) struct Turned {
    subject: Vec<Word>,
    words: usize,
}

impl Turned {
    pub(super) fn fill(&mut self, region: &Region) {
        self.words = region.rect().height().div_ceil(WORD);
        self.subject.resize(region.words() * WORD * self.words, 0);
        if !self.subject.is_empty() {
            turn(region.subject(), region.words(), &mut self.subject, self.words);
        }
    }

    /// Columns, each of as many words as the next tells.
    pub(super) fn subject(&self) -> &[Word] {
        &self.subject
    }

    /// Words in a column.
    pub(super) fn words(&self) -> usize {
        self.words
    }

    /// Bytes of memory behind the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.subject.capacity()
    }
}

vectorised! {
    fn turn(rows: &[Word], words: usize, columns: &mut [Word], words_in_column: usize) {
        let mut squares = [[0; TOGETHER]; WORD];
        for (down, strip) in rows.chunks(WORD * words).enumerate() {
            for across in (0..words).step_by(TOGETHER) {
                let count = TOGETHER.min(words - across);
                squares.fill([0; TOGETHER]);
                for (square, row) in squares.iter_mut().zip(strip.chunks_exact(words)) {
                    square[..count].copy_from_slice(&row[across..across + count]);
                }
                transpose(&mut squares);
                for (n, square) in (across..across + count).enumerate() {
                    let first = square * WORD * words_in_column + down;
                    for (k, column) in columns[first..].iter_mut().step_by(words_in_column).take(WORD).enumerate() {
                        *column = squares[k][n];
                    }
                }
            }
        }
    }
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
        let (rect, turned) = (silhouette.region.rect(), &silhouette.derived.turned);
        for (x, column) in turned.subject().chunks_exact(turned.words()).enumerate() {
            for (y, i) in (0..turned.words() * 32).zip(0..) {
                let is_subject = column[y / 32] >> (y % 32) & 1 == 1;
                assert_eq!(is_subject, silhouette.is_subject(rect.x0 + x as i32, rect.y0 + i), "{x} {y}");
            }
        }
    }
}
