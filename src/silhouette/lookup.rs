//! A silhouette's tables as many lanes look them up: without a branch, and with indices of which a vector holds many.

use super::mask_crop::{LOW, Word};

/// Chebyshev distances to the background, up to 255.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Distances<'a> {
    /// Four a word, the first in the lowest byte.
    words: &'a [u32],
    last: u32,
    width: u32,
}

/// Packed bits, such as those of the subject's pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bits<'a> {
    words: &'a [Word],
    last: u32,
    /// Bits in a row.
    stride: u32,
}

impl<'a> Distances<'a> {
    #[inline(always)]
    pub(crate) fn new(words: &'a [u32], width: usize) -> Self {
        let words: &[u32] = if words.is_empty() { &[0] } else { words };
        let last = (words.len() - 1) as u32 & LOW;
        Self { words: &words[..=last as usize], last, width: width as u32 }
    }

    /// The distance at a pixel of the region; some distance for any other.
    #[inline(always)]
    pub(crate) fn at(&self, column: u32, row: u32) -> u32 {
        self.at_place(row.wrapping_mul(self.width).wrapping_add(column))
    }

    /// The distance at a place of the table; some distance beyond.
    #[inline(always)]
    pub(crate) fn at_place(&self, place: u32) -> u32 {
        u32::from_le(self.words[(place / 4).min(self.last) as usize]) >> (place % 4 * 8) & 255
    }
}

impl<'a> Bits<'a> {
    #[inline(always)]
    pub(crate) fn new(words: &'a [Word], words_in_row: usize) -> Self {
        let words: &[Word] = if words.is_empty() { &[0] } else { words };
        let last = (words.len() - 1) as u32 & LOW;
        Self { words: &words[..=last as usize], last, stride: words_in_row as u32 * Word::BITS }
    }

    /// The bit of a pixel of the region, 0 or 1.
    #[inline(always)]
    pub(crate) fn at(&self, column: u32, row: u32) -> u32 {
        let place = row * self.stride + column;
        self.words[(place / Word::BITS).min(self.last) as usize] >> (place % Word::BITS) & 1
    }

    /// The bits of a row from `column` on, the first lowest. What lies beside the region are bits of the rows
    /// before and after it: of their margins first, which are background.
    #[inline(always)]
    pub(crate) fn from(&self, column: i32, row: i32) -> Word {
        let place = (row as u32).wrapping_mul(self.stride).wrapping_add(column as u32);
        let (word, shift) = (place / Word::BITS, place % Word::BITS);
        let low = self.words[word.min(self.last) as usize];
        let high = self.words[(word + 1).min(self.last) as usize];
        low >> shift | (high << 1) << (Word::BITS - 1 - shift)
    }
}
