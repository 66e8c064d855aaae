//! Bits of the pixels around the subject: those near it, and the background pixels at its edge.

use super::mask_crop::{MaskCrop, WORD, Word};
use crate::math::vectorised;

/// Bits of a region, row-major, in as many words a row as the subject's.
#[derive(Debug, Default)]
pub(super) struct Boundary {
    /// Subject pixels and the eight around each.
    dilated: Vec<Word>,
    /// Background pixels with a subject pixel beside, above or below.
    boundary_pixels: Vec<Word>,
}

impl Boundary {
    pub(super) fn fill(&mut self, region: &MaskCrop) {
        let count = region.subject().len();
        self.dilated.resize(count, 0);
        self.boundary_pixels.resize(count, 0);
        if count > 0 {
            dilate(region.subject_and_around(), region.words(), &mut self.dilated, &mut self.boundary_pixels);
        }
    }

    pub(super) fn dilated(&self) -> &[Word] {
        &self.dilated
    }

    pub(super) fn boundary_pixels(&self) -> &[Word] {
        &self.boundary_pixels
    }

    /// Bytes of memory behind the bits.
    pub(super) fn working_memory(&self) -> usize {
        4 * (self.dilated.capacity() + self.boundary_pixels.capacity())
    }
}

vectorised! {
    /// From the subject's bits those near it, and the background pixels at its edge. `subject` begins a row and a word
    /// before the first row.
    ///
    /// Bits are carried over the ends of rows too. There the margin is background, or lies beyond an open border, where
    /// nobody minds a pixel too many.
    fn dilate(subject: &[Word], words: usize, near: &mut [Word], edges: &mut [Word]) {
        let count = near.len();
        let [above, here, below] = [0, words, 2 * words].map(|start| &subject[start..start + count + 2]);
        let (near, edges) = (&mut near[..count], &mut edges[..count]);
        for k in 0..count {
            let column = |k: usize| above[k] | here[k] | below[k];
            near[k] = column(k + 1) | beside(column(k), column(k + 1), column(k + 2));
            let beside = beside(here[k], here[k + 1], here[k + 2]);
            edges[k] = !here[k + 1] & (above[k + 1] | below[k + 1] | beside);
        }
    }
}

/// The pixels left and right of those in `here`, with the words before and after.
#[inline(always)]
fn beside(before: Word, here: Word, after: Word) -> Word {
    here << 1 | before >> (WORD - 1) | here >> 1 | after << (WORD - 1)
}
