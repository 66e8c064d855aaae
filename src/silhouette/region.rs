//! The part of a mask that is kept: the subject's rectangle with a margin, as packed bits, and with coverage as bytes.
//!
//! ```text
//!   +--------------------------+  image
//!   |    +---------------+     |
//!   |    |  . . ####  .  |     |  region: the rectangle and MARGIN pixels on each side, beyond the image where the
//!   |    |  .  ######  . |     |          subject touches its border; its width a multiple of 8
//!   |    +---------------+     |
//!   +--------------------------+  everything else is background
//! ```

use super::scan::Scan;
use super::undistort::TileMask;
use super::{Border, Rect};
use crate::vectorised::vectorised;
use image::GrayImage;

/// Pixels kept around the subject's rectangle: a contact normal's window around an edge pixel reaches 7 beyond it.
pub(super) const MARGIN: i32 = 8;

/// Pixels side by side as bits, the first in the lowest.
pub(crate) type Word = u32;

/// Indices in 32 bits whose highest is known to be 0, so that a vector of them looks up as many values at a time.
pub(crate) const LOW: u32 = u32::MAX >> 1;

/// How many.
pub(super) const WORD: usize = Word::BITS as usize;

/// Bytes packed at once.
const BLOCK: usize = 256;

/// Bits and bytes of a region, row-major.
#[derive(Debug, Default)]
pub(super) struct Region {
    rect: Option<Rect>,
    /// Subject pixels, the first pixel of a row in its first word's lowest bit; background before the first row and
    /// behind the last.
    subject: Vec<Word>,
    /// The mask's bytes, beyond the image those of the border; none where each is 0 or 255, as the bits tell.
    bytes: Vec<u8>,
    /// Whether it reaches beyond an open border.
    is_open: bool,
    /// A row that reaches beyond the image.
    row: Vec<u8>,
}

/// Rows of bits that begin anywhere in a word.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rows<'a> {
    subject: &'a [Word],
    words: usize,
    first: usize,
    shift: usize,
}

impl Rows<'_> {
    /// The 32 subject bits of the row `down` below the first, the first pixel's lowest.
    #[inline(always)]
    pub(super) fn row(&self, down: i32) -> Word {
        let at = (self.first as isize + down as isize * self.words as isize) as usize;
        let word = |at: usize| u64::from(self.subject.get(at).copied().unwrap_or(0));
        ((word(at) | word(at + 1) << WORD) >> self.shift) as Word
    }
}

impl Region {
    /// Takes up what `scan` found in `mask`.
    pub(super) fn fill(&mut self, mask: &GrayImage, scan: &Scan, border: Border) {
        let rect = self.resize(&scan.rect, &Rect::of_image(mask.width(), mask.height()), border);
        self.bytes.clear();
        if rect.is_empty() {
            return;
        }
        let source = Source { mask, rect, beyond: value_beyond(border) };
        if scan.has_coverage {
            self.bytes.resize(rect.width() * rect.height(), 0);
            for (j, row) in (rect.y0..).zip(self.bytes.chunks_exact_mut(rect.width())) {
                source.copy_row(j, row);
            }
        }
        let pad = self.pad();
        pack(&source, &mut self.subject[pad..], &mut self.row);
        self.clear_pads();
    }

    /// Takes up a mask drawn by tiles, whose subject has this rectangle.
    pub(super) fn fill_from_tiles(&mut self, mask: &TileMask, subject: &Rect, border: Border) {
        let rect = self.resize(subject, &mask.image(), border);
        if rect.is_empty() {
            self.bytes.clear();
            return;
        }

        // All bytes are written anew, so that those of the last mask need not be cleared.
        let beyond = value_beyond(border);
        self.bytes.resize(if mask.has_coverage() { rect.width() * rect.height() } else { 0 }, 0);
        if mask.has_coverage() {
            mask.write_bytes(&rect, beyond, &mut self.row, &mut self.bytes);
        }

        let pad = self.pad();
        mask.write_subject(&rect, beyond, &mut self.row, &mut self.subject[pad..]);
        self.clear_pads();
    }

    /// Makes room for the region around the subject's rectangle, and returns it.
    fn resize(&mut self, subject: &Rect, image: &Rect, border: Border) -> Rect {
        let rect = around(subject);
        self.rect = Some(rect);
        self.subject.resize(self.words() * rect.height() + 2 * self.pad(), 0);
        self.is_open = border == Border::Open && rect.intersection(image) != rect;
        rect
    }

    /// Background before the first row and behind the last.
    fn clear_pads(&mut self) {
        let pad = self.pad();
        let end = self.subject.len() - pad;
        self.subject[..pad].fill(0);
        self.subject[end..].fill(0);
    }

    /// The pixels kept; empty where there is no subject.
    pub(super) fn rect(&self) -> Rect {
        self.rect.unwrap_or(Rect::EMPTY)
    }

    /// Whether bytes are kept beside the bits.
    pub(super) fn has_coverage(&self) -> bool {
        !self.bytes.is_empty()
    }

    /// Whether it reaches beyond an open border, where all is subject: then its rim is not all background.
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Whether pixel `(i, j)` is subject; `None` outside the region.
    #[inline(always)]
    pub(super) fn is_subject(&self, i: i32, j: i32) -> Option<bool> {
        self.rect().contains(i, j).then(|| self.rows_from(i, j).row(0) & 1 == 1)
    }

    /// The mask's byte at `(i, j)`; `None` outside the region.
    #[inline(always)]
    pub(super) fn byte(&self, i: i32, j: i32) -> Option<u8> {
        let is_subject = self.is_subject(i, j)?;
        Some(self.bytes.get(self.rect().index(i, j)).copied().unwrap_or(byte_of(is_subject)))
    }

    /// The mask's bytes, row-major; none where each is 0 or 255.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// `N` bytes from `(i, j)` on; `None` where they do not all lie in one row of the region. At most 32.
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

    /// Words before the first row's, and behind the last one's: a block and a row.
    fn pad(&self) -> usize {
        self.words() + BLOCK / WORD
    }

    pub(super) fn subject(&self) -> &[Word] {
        let pad = self.pad();
        self.subject.get(pad..self.subject.len() - pad).unwrap_or(&[])
    }

    /// The same with a row and a word of background before and behind; not for an empty region.
    pub(super) fn subject_and_around(&self) -> &[Word] {
        let beside = self.pad() - self.words() - 1;
        &self.subject[beside..self.subject.len() - beside]
    }

    /// Rows of subject bits from pixel `(i, j)` on, of which the caller reads none that leaves the region.
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

    /// Bytes of memory behind the tables, the mask's own bytes not counted.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.subject.capacity() + self.row.capacity()
    }
}

/// The byte of all pixels beyond the image.
pub(super) fn value_beyond(border: Border) -> u8 {
    byte_of(border == Border::Open)
}

/// The byte of a pixel that the subject covers wholly or not at all.
#[inline(always)]
fn byte_of(is_subject: bool) -> u8 {
    if is_subject { 255 } else { 0 }
}

/// The region around the subject's rectangle.
fn around(rect: &Rect) -> Rect {
    let mut region = rect.grown(MARGIN);
    region.x1 = region.x0 + region.width().next_multiple_of(8) as i32;
    region
}

/// A part of a mask, and what counts for its bytes beyond the image.
struct Source<'a> {
    mask: &'a GrayImage,
    rect: Rect,
    beyond: u8,
}

impl Source<'_> {
    /// The bytes of row `j` as far as it lies in the image, and how many of it are beyond on the left.
    fn inner(&self, j: i32) -> (usize, &[u8]) {
        let image = Rect::of_image(self.mask.width(), self.mask.height());
        let (x0, x1) = (self.rect.x0.clamp(0, image.x1), self.rect.x1.clamp(0, image.x1));
        if j < 0 || j >= image.y1 {
            return (0, &[]);
        }
        let start = image.index(x0, j);
        ((x0 - self.rect.x0) as usize, &self.mask.as_raw()[start..start + (x1 - x0) as usize])
    }

    /// The bytes of row `j`.
    fn copy_row(&self, j: i32, row: &mut [u8]) {
        let (left, inner) = self.inner(j);
        row.fill(self.beyond);
        row[left..left + inner.len()].copy_from_slice(inner);
    }

    /// The bytes of row `j` and those that follow it in memory, `length` in all; `None` where it reaches beyond.
    fn whole_row(&self, j: i32, length: usize) -> Option<&[u8]> {
        let image = Rect::of_image(self.mask.width(), self.mask.height());
        let whole = image.contains(self.rect.x0, j) && self.rect.x1 <= image.x1;
        let start = whole.then(|| image.index(self.rect.x0, j))?;
        self.mask.as_raw().get(start..start + length)
    }
}

vectorised! {
    /// The subject's bits; `row` is scratch.
    fn pack(source: &Source, subject: &mut [Word], row: &mut Vec<u8>) {
        let width = source.rect.width();
        let words = width.div_ceil(WORD);
        let length = words.next_multiple_of(BLOCK / WORD) * WORD;
        row.resize(length, 0);
        let within = Word::MAX >> (words * WORD - width);
        for (j, start) in (source.rect.y0..source.rect.y1).zip((0..).step_by(words)) {
            let bytes = match source.whole_row(j, length) {
                Some(bytes) => bytes,
                None => {
                    source.copy_row(j, &mut row[..width]);
                    &row[..]
                }
            };
            // What follows the row in memory is none of it: the next row's bits are written over it.
            for (bits, block) in subject[start..].as_chunks_mut().0.iter_mut().zip(bytes.as_chunks().0) {
                *bits = pack_block(block);
            }
            subject[start + words - 1] &= within;
        }
    }
}

/// The highest bits of a block's bytes.
#[inline(always)]
fn pack_block(bytes: &[u8; BLOCK]) -> [Word; BLOCK / WORD] {
    let (eights, mut packed) = (bytes.as_chunks::<8>().0, [0; BLOCK / 8]);
    for k in 0..packed.len() {
        packed[k] = top_bits(&eights[k]);
    }
    bytemuck::cast::<_, [Word; BLOCK / WORD]>(packed).map(Word::from_le)
}

/// The highest bits of eight bytes, the first one's lowest.
#[inline(always)]
pub(super) fn top_bits(bytes: &[u8; 8]) -> u8 {
    // Byte m's highest bit comes to stand at m.
    let tops = u64::from_le_bytes(*bytes) >> 7 & 0x0101_0101_0101_0101;
    let pairs = tops | tops >> 7;
    let fours = pairs | pairs >> 14;
    (fours | fours >> 28) as u8
}
