//! The part of a mask that a silhouette keeps, as packed bits, and also as bytes if the mask has coverage.
//!
//! ```text
//!   +--------------------------+  image
//!   |    +---------------+     |
//!   |    |  . . ####  .  |     |  crop: the subject's rectangle and MARGIN pixels on each side, also beyond the image
//!   |    |  .  ######  . |     |        where the subject touches its border; its width is a multiple of 8
//!   |    +---------------+     |
//!   +--------------------------+  everything else is background
//! ```

use super::bit_image::{self, BitImage};
use super::packed_mask::Coverage;
use super::undistort::TileMask;
use super::{Border, PackedMask, Rect};
use crate::math::vectorised;

/// Pixels kept around the subject's rectangle. A contact normal's window around an edge pixel reaches 7 pixels beyond
/// it.
pub(super) const MARGIN: i32 = 8;

/// The bits of adjacent pixels of a row, the first in the lowest bit.
pub(crate) type Word = u32;

/// Mask for 32-bit indices. It clears their highest bit, so that the compiler can treat them as signed and look up a
/// vector of values with one gather instruction.
pub(crate) const LOW: u32 = u32::MAX >> 1;

/// Pixels in a [`Word`].
pub(super) const WORD: usize = Word::BITS as usize;

/// Pixels in a word of a [`BitImage`].
const LONG: usize = bit_image::WORD;

/// Words before a row of an image: as far as a crop may begin before it.
const BEFORE: usize = 1;

/// Words after a row of an image: for the margin and the rounding of the crop's width, and one that is read after the
/// last.
const AFTER: usize = 3;

/// The bits and bytes of a crop, row-major.
#[derive(Debug, Default)]
pub(super) struct MaskCrop {
    rect: Option<Rect>,
    /// The bits of subject pixels; each row begins in a word's lowest bit. A row and a word of background stand before
    /// the first row and after the last.
    subject: Vec<Word>,
    /// The mask's bytes; beyond the image the border's byte. Empty if each byte is 0 or 255, as given by the bits.
    bytes: Vec<u8>,
    /// Whether the crop reaches beyond an unknown border.
    is_open: bool,
    /// Scratch memory: the bits of an image row with those beyond the image on both sides.
    long_row: Vec<u64>,
    /// Scratch memory: the bytes of a row drawn by tiles, with those beyond the image.
    row: Vec<u8>,
}

/// Rows of 32 pixels that begin at any column of a crop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rows<'a> {
    subject: &'a [Word],
    /// Words in a row of the crop.
    words: usize,
    /// Index of the word with the first pixel of the first row.
    first: usize,
    /// The first pixel's bit in that word.
    shift: usize,
}

impl Rows<'_> {
    /// The 32 subject bits of the row that is `down` rows below the first, the first pixel in the lowest bit.
    #[inline(always)]
    pub(super) fn row(&self, down: i32) -> Word {
        let at = (self.first as isize + down as isize * self.words as isize) as usize;
        let word = |at: usize| u64::from(self.subject.get(at).copied().unwrap_or(0));
        ((word(at) | word(at + 1) << WORD) >> self.shift) as Word
    }
}

impl MaskCrop {
    /// Fills the crop from a packed mask.
    pub(super) fn fill(&mut self, mask: &PackedMask, border: Border) {
        let (width, height) = mask.size();
        let rect = self.resize(&mask.rect(), &Rect::of_image(width, height), border);
        if rect.is_empty() {
            self.bytes.clear();
            return;
        }

        let beyond = u64::from(border == Border::Unknown).wrapping_neg();
        let pad = self.pad();
        let subject = &mut self.subject[pad..];
        copy_bits(mask.subject(), &rect, beyond, &mut self.long_row, subject);

        // Every byte is written, so the bytes of the last mask need not be cleared.
        self.bytes.resize(if mask.has_coverage() { rect.width() * rect.height() } else { 0 }, 0);
        expand(subject, &rect, mask.coverage(), &mut self.bytes);
        self.clear_pads();
    }

    /// Fills the crop from a mask drawn by tiles, whose subject pixels have the bounding rectangle `subject`.
    pub(super) fn fill_from_tiles(&mut self, mask: &TileMask, subject: &Rect, border: Border) {
        let rect = self.resize(subject, &mask.image(), border);
        if rect.is_empty() {
            self.bytes.clear();
            return;
        }

        // Every byte is written, so the bytes of the last mask need not be cleared.
        let beyond = value_beyond(border);
        self.bytes.resize(if mask.has_coverage() { rect.width() * rect.height() } else { 0 }, 0);
        if mask.has_coverage() {
            mask.write_bytes(&rect, beyond, &mut self.row, &mut self.bytes);
        }

        let pad = self.pad();
        mask.write_subject(&rect, beyond, &mut self.row, &mut self.subject[pad..]);
        self.clear_pads();
    }

    /// Sets the crop to the subject's rectangle with its margin, and returns it.
    fn resize(&mut self, subject: &Rect, image: &Rect, border: Border) -> Rect {
        let rect = around(subject);
        self.rect = Some(rect);
        self.subject.resize(self.words() * rect.height() + 2 * self.pad(), 0);
        self.is_open = border == Border::Unknown && rect.intersection(image) != rect;
        rect
    }

    /// Writes background before the first row and after the last.
    fn clear_pads(&mut self) {
        let pad = self.pad();
        let end = self.subject.len() - pad;
        self.subject[..pad].fill(0);
        self.subject[end..].fill(0);
    }

    /// The pixels that are kept; empty if there is no subject.
    pub(super) fn rect(&self) -> Rect {
        self.rect.unwrap_or(Rect::EMPTY)
    }

    /// Whether bytes are kept in addition to the bits.
    pub(super) fn has_coverage(&self) -> bool {
        !self.bytes.is_empty()
    }

    /// Whether the crop reaches beyond an unknown border. All pixels there count as subject, so its rim is not all
    /// background.
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Whether pixel `(i, j)` is subject; `None` outside the crop.
    #[inline(always)]
    pub(super) fn is_subject(&self, i: i32, j: i32) -> Option<bool> {
        self.rect().contains(i, j).then(|| self.rows_from(i, j).row(0) & 1 == 1)
    }

    /// The mask's byte at pixel `(i, j)`; `None` outside the crop.
    #[inline(always)]
    pub(super) fn byte(&self, i: i32, j: i32) -> Option<u8> {
        let is_subject = self.is_subject(i, j)?;
        Some(self.bytes.get(self.rect().index(i, j)).copied().unwrap_or(byte_of(is_subject)))
    }

    /// Writes the bytes of row `j` of the crop from column `i` on.
    pub(super) fn write_row(&self, i: i32, j: i32, bytes: &mut [u8]) {
        if !self.bytes.is_empty() {
            let start = self.rect().index(i, j);
            return bytes.copy_from_slice(&self.bytes[start..][..bytes.len()]);
        }
        for (k, bytes) in bytes.chunks_mut(WORD).enumerate() {
            let bits = self.rows_from(i + (WORD * k) as i32, j).row(0);
            for (n, byte) in bytes.iter_mut().enumerate() {
                *byte = ((bits >> n & 1) as u8).wrapping_neg();
            }
        }
    }

    /// The mask's bytes, row-major; empty if each is 0 or 255.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The `N` bytes from pixel `(i, j)` on; `None` unless all of them lie in one row of the crop. `N` is at most 32.
    #[inline(always)]
    pub(super) fn row<const N: usize>(&self, i: i32, j: i32) -> Option<[u8; N]> {
        let rect = self.rect();
        if !rect.contains(i, j) || i + N as i32 > rect.x1 {
            return None;
        }
        if self.bytes.is_empty() {
            let bits = self.rows_from(i, j).row(0);
            return Some(std::array::from_fn(|k| byte_of(bits >> k & 1 == 1)));
        }
        let start = rect.index(i, j);
        self.bytes.get(start..start + N)?.try_into().ok()
    }

    /// Words in a row of bits.
    pub(super) fn words(&self) -> usize {
        self.rect().width().div_ceil(WORD)
    }

    /// Words before the first row and after the last: a row and a word.
    fn pad(&self) -> usize {
        self.words() + 1
    }

    /// The bits of subject pixels, row-major.
    pub(super) fn subject(&self) -> &[Word] {
        let pad = self.pad();
        self.subject.get(pad..self.subject.len() - pad).unwrap_or(&[])
    }

    /// [`Self::subject`] with a row and a word of background before and after it, if the crop is not empty.
    pub(super) fn subject_and_around(&self) -> &[Word] {
        &self.subject
    }

    /// Rows of subject bits from pixel `(i, j)` of the crop on. Only pixels of the crop have meaningful bits.
    #[inline(always)]
    pub(super) fn rows_from(&self, i: i32, j: i32) -> Rows<'_> {
        let (rect, words) = (self.rect(), self.words());
        let x = (i - rect.x0) as usize;
        Rows {
            subject: &self.subject,
            words,
            first: self.pad() + (j - rect.y0) as usize * words + x / WORD,
            shift: x % WORD,
        }
    }

    /// Bytes of memory of the crop, without the mask's own bytes.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.subject.capacity() + 8 * self.long_row.capacity() + self.row.capacity()
    }
}

/// The byte of all pixels beyond the image.
pub(super) fn value_beyond(border: Border) -> u8 {
    byte_of(border == Border::Unknown)
}

/// The byte of a pixel that the subject covers completely or not at all.
#[inline(always)]
fn byte_of(is_subject: bool) -> u8 {
    if is_subject { 255 } else { 0 }
}

/// The crop around the subject's rectangle.
fn around(rect: &Rect) -> Rect {
    let mut crop = rect.grown(MARGIN);
    crop.x1 = crop.x0 + crop.width().next_multiple_of(8) as i32;
    crop
}

vectorised! {
    /// Copies the subject bits of `rect` from an image. `beyond` holds the bits of pixels beyond the image, and `row`
    /// is scratch memory.
    fn copy_bits(image: &BitImage, rect: &Rect, beyond: u64, row: &mut Vec<u64>, subject: &mut [Word]) {
        let (width, words, stride) = (rect.width(), rect.width().div_ceil(WORD), image.stride());
        let last_word = Word::MAX >> (words * WORD - width);
        row.clear();
        row.resize(BEFORE + stride + AFTER, beyond);

        // The word and bit of `row` at which the crop begins.
        let first = (rect.x0 + (BEFORE * LONG) as i32) as usize;
        let (start, shift) = (first / LONG, first % LONG);

        let (is_inside, length) = (rect.x0 >= 0 && rect.x1 as usize <= image.width(), words.div_ceil(2) + 1);
        for (y, bits) in (rect.y0..rect.y1).zip(subject.chunks_exact_mut(words)) {
            // Read a row of the image in place if the crop lies within its columns. The word after it may belong to the
            // next row: its bits are cut off below. Otherwise extend the row by the bits beyond the image.
            let y = usize::try_from(y).ok().filter(|&y| y < image.height());
            let inside = y.filter(|_| is_inside).map(|y| y * stride + start - BEFORE);
            let inside = inside.and_then(|first| image.words().get(first..first + length));
            let source = inside.unwrap_or_else(|| {
                let inner = &mut row[BEFORE..][..stride];
                match y {
                    Some(y) => {
                        inner.copy_from_slice(image.row(y));
                        inner[stride - 1] |= beyond & !image.last_word();
                    }
                    None => inner.fill(beyond),
                }
                &row[start..start + length]
            });

            // The crop may begin within a word. The shift to the left is done in two steps, as a shift by a whole word
            // is not defined.
            let (pairs, last) = bits.as_chunks_mut::<2>();
            for k in 0..pairs.len() {
                let both = source[k] >> shift | source[k + 1] << 1 << (LONG - 1 - shift);
                pairs[k] = [both as Word, (both >> WORD) as Word];
            }
            if let [last] = last {
                let k = pairs.len();
                *last = (source[k] >> shift | source[k + 1] << 1 << (LONG - 1 - shift)) as Word;
            }
            bits[words - 1] &= last_word;
        }
    }
}

vectorised! {
    /// Writes the bytes of `rect`: 255 for subject pixels and 0 for others, except where there is coverage.
    fn expand(subject: &[Word], rect: &Rect, coverage: &Coverage, bytes: &mut [u8]) {
        let (width, words) = (rect.width(), rect.width().div_ceil(WORD));
        let rows = subject.chunks_exact(words).zip(bytes.chunks_exact_mut(width));
        for ((bits, row), y) in rows.zip(rect.y0..) {
            for (&word, bytes) in bits.iter().zip(row.chunks_mut(WORD)) {
                if word == 0 || word == Word::MAX {
                    bytes.fill(word as u8);
                    continue;
                }
                for (k, byte) in bytes.iter_mut().enumerate() {
                    *byte = ((word >> k & 1) as u8).wrapping_neg();
                }
            }

            let Ok(y) = usize::try_from(y) else { continue };
            for (x, byte) in coverage.row(y) {
                if let Some(pixel) = row.get_mut((x as i64 - i64::from(rect.x0)) as usize) {
                    *pixel = byte;
                }
            }
        }
    }
}
