//! Dilation and erosion of binary images, one pixel at a time.
//!
//! ```text
//!   cross   .#.    square   ###    alternating cross and square gives an octagon, which is nearly a disc
//!           ###             ###
//!           .#.             ###
//! ```

use crate::math::vectorised;
use crate::silhouette::bit_image::{BitImage, WORD};

/// The neighbours of a pixel that count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StructuringElement {
    Cross,
    Square,
}

/// Buffers for dilation and erosion.
#[derive(Debug, Clone, Default)]
pub(super) struct Morphology {
    other: BitImage,
    zeros: Vec<u64>,
}

impl Morphology {
    /// Sets all pixels within `radius` of a set one; pixels beyond the image count as unset.
    pub(super) fn grow(&mut self, bits: &mut BitImage, radius: u32) {
        for k in 0..radius {
            self.step(bits, shape(k), false);
        }
    }

    /// Clears all pixels within `radius` of an unset one; pixels beyond the image count as set.
    pub(super) fn shrink(&mut self, bits: &mut BitImage, radius: u32) {
        for k in 0..radius {
            self.step(bits, shape(k), true);
        }
    }

    /// Dilates by one pixel in place, or erodes if `inverted`.
    pub(super) fn step(&mut self, bits: &mut BitImage, shape: StructuringElement, inverted: bool) {
        let mut other = std::mem::take(&mut self.other);
        self.step_into(bits, shape, inverted, &mut other);
        std::mem::swap(bits, &mut other);
        self.other = other;
    }

    /// Dilates `from` by one pixel into `to`, or erodes it if `inverted` (a dilation of the unset pixels).
    pub(super) fn step_into(
        &mut self,
        from: &BitImage,
        shape: StructuringElement,
        inverted: bool,
        to: &mut BitImage,
    ) {
        to.resize(from.width(), from.height());
        let stride = from.stride();
        self.zeros.clear();
        self.zeros.resize(stride, if inverted { u64::MAX } else { 0 });

        let last = from.last_word();
        for (y, out) in to.words_mut().chunks_exact_mut(stride.max(1)).enumerate() {
            let above = if y > 0 { from.row(y - 1) } else { &self.zeros };
            let below = if y + 1 < from.height() { from.row(y + 1) } else { &self.zeros };
            let rows = [above, from.row(y), below];
            grow_row(
                rows,
                shape == StructuringElement::Square,
                if inverted { u64::MAX } else { 0 },
                last,
                out,
            );
        }
    }
}

/// The element of step `k`: alternating, for an octagon.
fn shape(k: u32) -> StructuringElement {
    if k.is_multiple_of(2) { StructuringElement::Cross } else { StructuringElement::Square }
}

vectorised! {
    /// Dilates a row by its neighbours in the rows above and below and to the left and right; input and output are
    /// inverted by `invert`.
    fn grow_row(rows: [&[u64]; 3], square: bool, invert: u64, last: u64, out: &mut [u64]) {
        let n = out.len();
        if n == 0 {
            return;
        }
        let rows = rows.map(|row| &row[..n]);

        let row_of = |k: usize| {
            // Bits beyond the end of a row are unset, inverted or not.
            let within = if k + 1 == n { last } else { u64::MAX };
            let [above, row, below] = rows.map(|row| (row[k] ^ invert) & within);
            (if square { above | row | below } else { row }, above | row | below)
        };

        for (k, out) in out.iter_mut().enumerate() {
            let (wide, all) = row_of(k);
            let before = if k > 0 { row_of(k - 1).0 >> (WORD - 1) } else { 0 };
            let after = if k + 1 < n { row_of(k + 1).0 << (WORD - 1) } else { 0 };
            let within = if k + 1 == n { last } else { u64::MAX };
            *out = ((all | wide << 1 | before | wide >> 1 | after) ^ invert) & within;
        }
    }
}
