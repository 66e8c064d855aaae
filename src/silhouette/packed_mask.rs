//! A compact mask for storage and transfer: one bit per pixel, and one byte for each pixel that the subject covers in
//! part.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

mod coverage;

use super::bit_image::{BitImage, WORD, pack};
use super::{MaskView, Rect, SUBJECT};
use crate::math::lanes::set_bits;
use crate::math::vectorised;
pub(super) use coverage::Coverage;
use coverage::CoverageRow;
use image::GrayImage;

/// A packed mask: one bit per pixel that tells whether it is subject, and the bytes that are neither 0 nor 255.
///
/// It holds the same information as the bytes of a mask in about a tenth of their memory;
/// [`to_mask`](Self::to_mask) returns the bytes. A [`Segmenter`](crate::segment::Segmenter) produces packed masks, and
/// [`HullData::set_packed`](crate::hull::HullData::set_packed) accepts them.
///
/// ```
/// use image::{GrayImage, Luma};
/// use ode_visual_hull::silhouette::PackedMask;
///
/// let mask = GrayImage::from_fn(640, 480, |x, _| Luma([if x < 200 { 255 } else if x == 200 { 99 } else { 0 }]));
/// let packed = PackedMask::new(&mask);
/// assert_eq!((packed.size(), packed.rect().x1, packed.has_coverage()), ((640, 480), 200, true));
/// assert_eq!(packed.to_mask(), mask);
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PackedMask {
    subject: BitImage,
    coverage: Coverage,
    rect: Rect,
}

/// Words that are packed at once.
const WORDS_PACKED: usize = 4;

impl PackedMask {
    /// Packs a mask.
    pub fn new<'a>(mask: impl Into<MaskView<'a>>) -> Self {
        let mut packed = Self::default();
        packed.pack(mask);
        packed
    }

    /// Packs another mask in the memory of the last one.
    pub fn pack<'a>(&mut self, mask: impl Into<MaskView<'a>>) {
        let mask = mask.into();
        self.subject.resize(mask.size().0 as usize, mask.size().1 as usize);
        self.coverage.restart();
        pack_rows(&mask, &mut self.subject, &mut self.coverage);
        self.rect = self.subject.rect();
    }

    /// Copies the bits of `subject`, and replaces some pixels by bytes: `cover` calls its argument with column, row and
    /// byte of each, row-major.
    pub(crate) fn take_bits(
        &mut self,
        subject: &BitImage,
        cover: impl FnOnce(&mut dyn FnMut(usize, usize, u8)),
    ) {
        self.subject.copy(subject);
        self.coverage.restart();

        let (bits, coverage) = (&mut self.subject, &mut self.coverage);
        cover(&mut |x, y, byte| {
            bits.set(x, y, byte >= SUBJECT);
            if byte != 0 && byte != 255 {
                coverage.push(x, y, byte);
            }
        });

        coverage.end_rows(bits.height());
        self.rect = bits.rect();
    }

    /// Starts an empty mask of this size, to which bits and coverage are written row by row. [`Self::close_mask`] ends
    /// it.
    pub(super) fn restart(&mut self, size: (u32, u32)) {
        self.subject.resize(size.0 as usize, size.1 as usize);
        self.subject.words_mut().fill(0);
        self.coverage.restart();
        self.rect = Rect::EMPTY;
    }

    /// Appends a byte of coverage. Its row is not above the row of the last one.
    pub(super) fn push_coverage(&mut self, x: usize, y: usize, byte: u8) {
        self.coverage.push(x, y, byte);
    }

    /// The coverage of row `y`, which is not above the row of the last byte, with room for `count` more bytes.
    #[inline(always)]
    pub(super) fn coverage_of_row(&mut self, y: usize, count: usize) -> CoverageRow<'_> {
        self.coverage.begin_row(y, count)
    }

    /// Completes a mask that was begun with [`Self::restart`].
    pub(super) fn close_mask(&mut self) {
        self.coverage.end_rows(self.subject.height());
        self.rect = self.subject.rect();
    }

    /// Copies `other` with the bits of `subject`. Pixels that change sides become 0 or 255, the others keep their
    /// coverage.
    pub(crate) fn copy_with_bits(&mut self, other: &Self, subject: &BitImage) {
        self.take_bits(subject, |cover| {
            for y in 0..subject.height() {
                for (x, byte) in
                    other.coverage.row(y).filter(|&(x, byte)| subject.get(x, y) == (byte >= SUBJECT))
                {
                    cover(x, y, byte);
                }
            }
        });
    }

    /// Sets all pixels that are not `visible` to background, or to subject.
    pub(crate) fn hide(&mut self, visible: &BitImage, as_subject: bool) {
        let last_word = visible.last_word();
        let stride = visible.stride();
        for (k, (word, &seen)) in self.subject.words_mut().iter_mut().zip(visible.words()).enumerate() {
            let pixels = if (k + 1) % stride == 0 { last_word } else { u64::MAX };
            *word = if as_subject { *word | !seen & pixels } else { *word & seen };
        }

        if self.has_coverage() {
            let all = std::mem::take(&mut self.coverage);
            for y in 0..self.subject.height() {
                for (x, byte) in all.row(y).filter(|&(x, _)| visible.get(x, y)) {
                    self.coverage.push(x, y, byte);
                }
            }
            self.coverage.end_rows(self.subject.height());
        }
        self.rect = self.subject.rect();
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.subject.width() as u32, self.subject.height() as u32)
    }

    /// The smallest rectangle that holds every subject pixel.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// Whether any byte is neither 0 nor 255.
    pub fn has_coverage(&self) -> bool {
        !self.coverage.is_empty()
    }

    /// Whether every pixel is subject.
    pub fn is_full(&self) -> bool {
        let last = self.subject.last_word();
        let mut rows = self.subject.words().chunks_exact(self.subject.stride().max(1));
        rows.all(|row| {
            row.split_last()
                .is_none_or(|(end, inner)| *end == last && inner.iter().all(|&word| word == u64::MAX))
        })
    }

    /// The mask without coverage: each byte is 255 if its pixel is subject, and 0 otherwise.
    pub fn binary(mut self) -> Self {
        self.coverage.restart();
        self.coverage.end_rows(self.subject.height());
        self
    }

    /// The mask with one byte per pixel.
    pub fn to_mask(&self) -> GrayImage {
        let mut mask = GrayImage::default();
        self.write_to(&mut mask);
        mask
    }

    /// Writes the mask with one byte per pixel to `mask`, which is resized to fit.
    pub fn write_to(&self, mask: &mut GrayImage) {
        let (width, height) = self.size();
        if mask.dimensions() != (width, height) {
            *mask = GrayImage::new(width, height);
        }
        for (y, row) in mask.chunks_exact_mut(width.max(1) as usize).enumerate() {
            self.write_row(y, row);
        }
    }

    /// Writes the bytes of row `y`.
    pub(crate) fn write_row(&self, y: usize, row: &mut [u8]) {
        self.subject.write_row(y, row);
        for (x, byte) in self.coverage.row(y) {
            row[x] = byte;
        }
    }

    /// The bits of subject pixels.
    pub(crate) fn subject(&self) -> &BitImage {
        &self.subject
    }

    /// The bits of subject pixels, for writing between [`Self::restart`] and [`Self::close_mask`].
    pub(super) fn subject_mut(&mut self) -> &mut BitImage {
        &mut self.subject
    }

    /// The bytes that are neither 0 nor 255.
    pub(super) fn coverage(&self) -> &Coverage {
        &self.coverage
    }
}

vectorised! {
    /// Packs the rows of a mask: in groups of words, then in single words, then the part of a word that remains.
    fn pack_rows(mask: &MaskView, subject: &mut BitImage, coverage: &mut Coverage) {
        let stride = subject.stride().max(1);
        for (y, (row, words)) in mask.rows().zip(subject.words_mut().chunks_exact_mut(stride)).enumerate() {
            let (blocks, rest) = row.as_chunks::<WORD>();
            let (groups, others) = blocks.as_chunks::<WORDS_PACKED>();
            let (packed, last) = words.split_at_mut(WORDS_PACKED * groups.len());
            for (k, (group, words)) in groups.iter().zip(packed.as_chunks_mut().0).enumerate() {
                *words = pack_group(group, WORDS_PACKED * WORD * k, y, coverage);
            }

            let start = WORDS_PACKED * WORD * groups.len();
            for (k, (block, word)) in others.iter().zip(&mut *last).enumerate() {
                [*word] = pack_group(&[*block], start + WORD * k, y, coverage);
            }

            if !rest.is_empty() {
                let mut block = [0; WORD];
                block[..rest.len()].copy_from_slice(rest);
                [last[others.len()]] = pack_group(&[block], row.len() - rest.len(), y, coverage);
            }
        }
        coverage.end_rows(subject.height());
    }
}

/// The bits of a group of pixels that begins in column `x` of row `y`. Bytes of coverage are appended to `coverage`.
#[inline(always)]
fn pack_group<const N: usize>(
    group: &[[u8; WORD]; N],
    x: usize,
    y: usize,
    coverage: &mut Coverage,
) -> [u64; N] {
    // Most pixels are background far from the outline.
    if any_bit(group) == 0 {
        return [0; N];
    }

    // After adding 1, only 0 and 255 have no bit above the lowest.
    let mut partial = *group;
    for byte in partial.as_flattened_mut() {
        *byte = byte.wrapping_add(1) >> 1;
    }
    if any_bit(&partial) != 0 {
        // Adding 127 sets the highest bit of each byte of coverage.
        for byte in partial.as_flattened_mut() {
            *byte += 127;
        }
        for (k, word) in pack(&partial).into_iter().enumerate() {
            for n in set_bits(word) {
                coverage.push(x + WORD * k + n, y, group[k][n]);
            }
        }
    }

    // The highest bit of a byte tells whether its pixel is subject.
    pack(group)
}

/// The union of the bits of all bytes, folded to eight bytes; zero if all bytes are.
#[inline(always)]
fn any_bit<const N: usize>(bytes: &[[u8; WORD]; N]) -> u64 {
    let mut any = [0; 8];
    for block in bytes {
        let eights = block.as_chunks::<8>().0;
        for k in 0..8 {
            any[k] |= u64::from_ne_bytes(eights[k]);
        }
    }
    any.iter().fold(0, |any, word| any | word)
}

#[cfg(test)]
mod tests;
