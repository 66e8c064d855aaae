//! Branch-free look-ups in a silhouette's tables, for many lanes at once. Indices have 32 bits, so that a vector
//! register holds many of them.

use super::mask_crop::{LOW, Word};

/// A look-up of Chebyshev distances to the background in pixels; 255 stands for all above 254.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Distances<'a> {
    /// Four distances per word, the first in the lowest byte.
    words: &'a [u32],
    /// Index of the last word.
    last: u32,
    width: u32,
}

/// A look-up of packed bits, such as the bits of subject pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bits<'a> {
    words: &'a [Word],
    /// Index of the last word.
    last: u32,
    /// Bits in a row.
    stride: u32,
}

impl<'a> Distances<'a> {
    /// A look-up in a table of this width in pixels.
    #[inline(always)]
    pub(crate) fn new(words: &'a [u32], width: usize) -> Self {
        let words: &[u32] = if words.is_empty() { &[0] } else { words };
        let last = (words.len() - 1) as u32 & LOW;
        Self { words: &words[..=last as usize], last, width: width as u32 }
    }

    /// The distance at a pixel of the crop; an arbitrary value for any other pixel.
    #[inline(always)]
    pub(crate) fn at(&self, column: u32, row: u32) -> u32 {
        self.at_place(row.wrapping_mul(self.width).wrapping_add(column))
    }

    /// The distance at a row-major index of the table; an arbitrary value beyond its end.
    #[inline(always)]
    pub(crate) fn at_place(&self, index: u32) -> u32 {
        u32::from_le(self.words[(index / 4).min(self.last) as usize]) >> (index % 4 * 8) & 255
    }
}

impl<'a> Bits<'a> {
    /// A look-up in rows of `words_in_row` words.
    #[inline(always)]
    pub(crate) fn new(words: &'a [Word], words_in_row: usize) -> Self {
        let words: &[Word] = if words.is_empty() { &[0] } else { words };
        let last = (words.len() - 1) as u32 & LOW;
        Self { words: &words[..=last as usize], last, stride: words_in_row as u32 * Word::BITS }
    }

    /// The bit of a pixel of the crop, 0 or 1.
    #[inline(always)]
    pub(crate) fn at(&self, column: u32, row: u32) -> u32 {
        let index = row * self.stride + column;
        self.words[(index / Word::BITS).min(self.last) as usize] >> (index % Word::BITS) & 1
    }

    /// The 32 bits of a row from `column` on, the first lowest. Bits beside the crop come from the adjacent rows, first
    /// from their margins, which are background.
    #[inline(always)]
    pub(crate) fn from(&self, column: i32, row: i32) -> Word {
        let index = (row as u32).wrapping_mul(self.stride).wrapping_add(column as u32);
        let (word, shift) = (index / Word::BITS, index % Word::BITS);
        let low = self.words[word.min(self.last) as usize];
        let high = self.words[(word + 1).min(self.last) as usize];
        low >> shift | (high << 1) << (Word::BITS - 1 - shift)
    }
}
