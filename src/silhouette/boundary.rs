//! Two bit masks of the pixels at a silhouette's boundary: the subject dilated by one pixel, and the background pixels
//! at its edge.

use super::mask_crop::{MaskCrop, WORD, Word};
use crate::math::vectorised;

/// Bits over a crop, row-major, with as many words per row as its subject bits.
#[derive(Debug, Default)]
pub(super) struct Boundary {
    /// Subject pixels and the eight pixels around each.
    dilated: Vec<Word>,
    /// Background pixels with a subject pixel to the left, right, above or below.
    boundary_pixels: Vec<Word>,
}

impl Boundary {
    /// Computes the bits of `crop`.
    pub(super) fn fill(&mut self, crop: &MaskCrop) {
        let count = crop.subject().len();
        self.dilated.resize(count, 0);
        self.boundary_pixels.resize(count, 0);
        if count > 0 {
            dilate(crop.subject_and_around(), crop.words(), &mut self.dilated, &mut self.boundary_pixels);
        }
    }

    /// Subject pixels and the eight pixels around each.
    pub(super) fn dilated(&self) -> &[Word] {
        &self.dilated
    }

    /// Background pixels with a subject pixel to the left, right, above or below. Pixels along an unknown border may be
    /// set too.
    pub(super) fn boundary_pixels(&self) -> &[Word] {
        &self.boundary_pixels
    }

    /// Bytes of memory of the bits.
    pub(super) fn working_memory(&self) -> usize {
        4 * (self.dilated.capacity() + self.boundary_pixels.capacity())
    }
}

vectorised! {
    /// Computes both masks. `subject` begins a row and a word before the crop's first row.
    ///
    /// Bits are shifted across the ends of rows. That sets no wrong bit where the margin is background. Beyond an
    /// unknown border it may set extra bits; the callers ignore or filter them.
    fn dilate(subject: &[Word], words: usize, dilated: &mut [Word], edges: &mut [Word]) {
        let count = dilated.len();
        let [above, here, below] = [0, words, 2 * words].map(|start| &subject[start..start + count + 2]);
        let (dilated, edges) = (&mut dilated[..count], &mut edges[..count]);
        for k in 0..count {
            let column = |k: usize| above[k] | here[k] | below[k];
            dilated[k] = column(k + 1) | beside(column(k), column(k + 1), column(k + 2));
            let beside = beside(here[k], here[k + 1], here[k + 2]);
            edges[k] = !here[k + 1] & (above[k + 1] | below[k + 1] | beside);
        }
    }
}

/// The pixels to the left and right of those set in `here`, given the words before and after it.
#[inline(always)]
fn beside(before: Word, here: Word, after: Word) -> Word {
    here << 1 | before >> (WORD - 1) | here >> 1 | after << (WORD - 1)
}
