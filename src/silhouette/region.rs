//! The part of a mask that is kept: the subject's rectangle with a margin, as bytes and as packed bits.
//!
//! ```text
//!   +--------------------------+  image
//!   |    +---------------+     |
//!   |    |  . . ####  .  |     |  region: the rectangle and MARGIN pixels on each side, beyond the image where the
//!   |    |  .  ######  . |     |          subject touches its border; its width a multiple of 8
//!   |    +---------------+     |
//!   +--------------------------+  everything else is background
//! ```

use super::{Border, Rect, SUBJECT};
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

/// What one pass over a mask tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scan {
    /// The smallest rectangle around the subject.
    pub(super) rect: Rect,
    /// Whether any byte is neither 0 nor 255.
    pub(super) has_coverage: bool,
}

/// Bytes and bits of a region, row-major.
#[derive(Debug, Default)]
pub(super) struct Region {
    rect: Option<Rect>,
    /// The mask's bytes; beyond the image those of the border.
    bytes: Vec<u8>,
    /// Subject pixels, the first pixel of a row in its first word's lowest bit.
    subject: Vec<Word>,
    /// Subject pixels and the eight around each.
    near: Vec<Word>,
    /// Background pixels with a subject pixel beside, above or below.
    edges: Vec<Word>,
    /// Scratch.
    columns: Vec<Word>,
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
    /// Takes up what `rect`, the subject's rectangle in `mask`, needs.
    pub(super) fn fill(&mut self, mask: &GrayImage, rect: &Rect, border: Border) {
        let rect = around(rect);
        self.rect = Some(rect);
        let beyond = if border == Border::Open { 255 } else { 0 };
        crop(mask, &rect, beyond, &mut self.bytes);
        pack(&self.bytes, rect.width(), &mut self.subject);
        for table in [&mut self.near, &mut self.edges, &mut self.columns] {
            table.resize(self.subject.len(), 0);
        }
        let words = rect.width().div_ceil(WORD);
        neighbours(&self.subject, words, &mut self.near, &mut self.edges, &mut self.columns);
    }

    /// The pixels kept; empty where there is no subject.
    pub(super) fn rect(&self) -> Rect {
        self.rect.unwrap_or(Rect::EMPTY)
    }

    /// The mask's byte at `(i, j)`; `None` outside the region.
    #[inline(always)]
    pub(super) fn byte(&self, i: i32, j: i32) -> Option<u8> {
        let rect = self.rect();
        if rect.contains(i, j) { self.bytes.get(rect.index(i, j)).copied() } else { None }
    }

    /// `N` bytes from `(i, j)` on; `None` where they do not all lie in one row of the region.
    pub(super) fn row<const N: usize>(&self, i: i32, j: i32) -> Option<&[u8; N]> {
        let rect = self.rect();
        if !rect.contains(i, j) || i + N as i32 > rect.x1 {
            return None;
        }
        let start = rect.index(i, j);
        self.bytes.get(start..start + N)?.try_into().ok()
    }

    /// Words in a row of bits.
    pub(super) fn words(&self) -> usize {
        self.rect().width().div_ceil(WORD)
    }

    pub(super) fn subject(&self) -> &[Word] {
        &self.subject
    }

    pub(super) fn near(&self) -> &[Word] {
        &self.near
    }

    pub(super) fn edges(&self) -> &[Word] {
        &self.edges
    }

    /// Rows of subject bits from pixel `(i, j)` on, of which the caller reads none that leaves the region.
    #[inline(always)]
    pub(super) fn rows_from(&self, i: i32, j: i32) -> Rows<'_> {
        let (rect, words) = (self.rect(), self.words());
        let x = (i - rect.x0) as usize;
        Rows {
            subject: &self.subject,
            words,
            first: (j - rect.y0) as usize * words + x / WORD,
            shift: x % WORD,
        }
    }

    /// Bytes of memory behind the tables, the mask's own bytes not counted.
    pub(super) fn working_memory(&self) -> usize {
        4 * (self.subject.capacity() + self.near.capacity() + self.edges.capacity() + self.columns.capacity())
    }
}

/// The region around the subject's rectangle.
fn around(rect: &Rect) -> Rect {
    let mut region = rect.grown(MARGIN);
    region.x1 = region.x0 + region.width().next_multiple_of(8) as i32;
    region
}

/// One pass over `mask`; `columns` is scratch.
pub(super) fn scan(mask: &GrayImage, columns: &mut Vec<u8>) -> Scan {
    let width = mask.width() as usize;
    columns.clear();
    columns.resize(width, 0);
    if width == 0 {
        return Scan { rect: Rect::EMPTY, has_coverage: false };
    }
    let (first, last, has_coverage) = scan_rows(mask.as_raw(), columns);
    let is_subject = |byte: &u8| *byte >= SUBJECT;
    let (left, right) = (columns.iter().position(is_subject), columns.iter().rposition(is_subject));
    let rect = match (left, right) {
        (Some(left), Some(right)) => {
            Rect { x0: left as i32, y0: first as i32, x1: right as i32 + 1, y1: last as i32 + 1 }
        }
        _ => Rect::EMPTY,
    };
    Scan { rect, has_coverage }
}

vectorised! {
    /// First and last row with a subject pixel, and whether any byte is neither 0 nor 255; gathers in `columns` which
    /// columns hold subject.
    fn scan_rows(mask: &[u8], columns: &mut [u8]) -> (usize, usize, bool) {
        let (mut first, mut last, mut has_coverage) = (usize::MAX, 0, false);
        for (j, row) in mask.chunks_exact(columns.len()).enumerate() {
            let (any, partial) = row.iter().fold((0, 0), |(any, partial), &byte| {
                // One more than 0 or 255 has no bit set but the lowest.
                (any | byte, partial | (byte.wrapping_add(1) & !1))
            });
            has_coverage |= partial != 0;
            if any >= SUBJECT {
                first = first.min(j);
                last = j;
                columns.iter_mut().zip(row).for_each(|(column, byte)| *column |= byte);
            }
        }
        (first, last, has_coverage)
    }
}

/// The bytes of `rect`, those beyond the image `beyond`.
fn crop(mask: &GrayImage, rect: &Rect, beyond: u8, bytes: &mut Vec<u8>) {
    let image = Rect::of_image(mask.width(), mask.height());
    let (x0, x1) = (rect.x0.clamp(0, image.x1), rect.x1.clamp(0, image.x1));
    let (left, right) = ((x0 - rect.x0) as usize, (rect.x1 - x1) as usize);
    bytes.clear();
    for j in rect.y0..rect.y1 {
        if j < 0 || j >= image.y1 {
            bytes.resize(bytes.len() + rect.width(), beyond);
            continue;
        }
        let start = image.index(x0, j);
        bytes.resize(bytes.len() + left, beyond);
        bytes.extend_from_slice(&mask.as_raw()[start..start + (x1 - x0) as usize]);
        bytes.resize(bytes.len() + right, beyond);
    }
}

vectorised! {
    /// The subject bits of `bytes`, rows of `width`, a multiple of 8.
    fn pack(bytes: &[u8], width: usize, bits: &mut Vec<Word>) {
        bits.clear();
        for row in bytes.chunks_exact(width.max(1)) {
            let (whole, rest) = row.as_chunks::<WORD>();
            bits.extend(whole.iter().map(|chunk| pack_word(chunk)));
            if !rest.is_empty() {
                bits.push(pack_word(rest));
            }
        }
    }
}

/// Up to 32 bytes, in whole eights, as bits.
#[inline(always)]
fn pack_word(bytes: &[u8]) -> Word {
    let eights = bytes.as_chunks::<8>().0.iter().enumerate();
    eights.fold(0, |word, (k, eight)| {
        let tops = u64::from_le_bytes(*eight) >> 7 & 0x0101_0101_0101_0101;
        // Byte m's bit comes to stand at 56 + m; no two products share a bit, so that nothing carries.
        word | ((tops.wrapping_mul(0x0102_0408_1020_4080) >> 56) as Word) << (8 * k)
    })
}

vectorised! {
    /// From the subject's bits those near it, and the background pixels at its edge; `columns` is scratch.
    ///
    /// Bits are carried over the ends of rows too. There the margin is background, or lies beyond an open border, where
    /// nobody minds a pixel too many.
    fn neighbours(
        subject: &[Word],
        words: usize,
        near: &mut [Word],
        edges: &mut [Word],
        columns: &mut [Word],
    ) {
        let count = subject.len();
        if count == 0 {
            return;
        }
        // Nothing is above the first row and below the last one.
        let above = |k: usize| if k < words { 0 } else { subject[k - words] };
        let below = |k: usize| if k + words < count { subject[k + words] } else { 0 };
        let word = |k: usize| subject.get(k).copied().unwrap_or(0);
        let edge = |k: usize, beside: Word| !subject[k] & (above(k) | below(k) | beside);
        for k in (0..words.min(count)).chain(words.max(count - words)..count) {
            columns[k] = above(k) | subject[k] | below(k);
            edges[k] = edge(k, spread(word(k.wrapping_sub(1)), subject[k], word(k + 1)));
        }
        if count > 2 * words {
            let inner = words..count - words;
            let (above, below) = (&subject[..count - 2 * words], &subject[2 * words..]);
            let (left, right) = (&subject[words - 1..], &subject[words + 1..]);
            let here = subject[inner.clone()].iter().zip(left.iter().zip(right)).zip(above.iter().zip(below));
            let made = columns[inner.clone()].iter_mut().zip(&mut edges[inner]);
            for ((columns, edges), ((&here, (&left, &right)), (above, below))) in made.zip(here) {
                *columns = above | here | below;
                *edges = !here & (above | below | spread(left, here, right));
            }
        }
        let at = |k: usize| columns.get(k).copied().unwrap_or(0);
        near[0] = columns[0] | spread(0, columns[0], at(1));
        near[count - 1] = columns[count - 1] | spread(at(count.wrapping_sub(2)), columns[count - 1], 0);
        for (near, columns) in near[1..].iter_mut().zip(columns.windows(3)) {
            *near = columns[1] | spread(columns[0], columns[1], columns[2]);
        }
    }
}

/// The pixels left and right of those in `here`, with the words before and after.
#[inline(always)]
fn spread(before: Word, here: Word, after: Word) -> Word {
    here << 1 | before >> (WORD - 1) | here >> 1 | after << (WORD - 1)
}
