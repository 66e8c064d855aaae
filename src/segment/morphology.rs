//! Growing and shrinking of binary images, a pixel at a time.
//!
//! ```text
//!   cross   .#.    square   ###    cross, square, cross, ... make an octagon, which is nearly a disc
//!           ###             ###
//!           .#.             ###
//! ```

use crate::math::vectorised;
use crate::silhouette::bit_image::{BitImage, WORD};

/// Which neighbours of a pixel count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StructuringElement {
    Cross,
    Square,
}

/// Two images to work in.
#[derive(Debug, Clone, Default)]
pub(super) struct Morphology {
    other: BitImage,
    zeros: Vec<u64>,
}

impl Morphology {
    /// Adds all pixels within `radius` of a set one; none beyond the image is set.
    pub(super) fn grow(&mut self, bits: &mut BitImage, radius: u32) {
        for k in 0..radius {
            self.step(bits, shape(k), false);
        }
    }

    /// Takes away all pixels within `radius` of one that is not set; those beyond the image count as set.
    pub(super) fn shrink(&mut self, bits: &mut BitImage, radius: u32) {
        for k in 0..radius {
            self.step(bits, shape(k), true);
        }
    }

    /// One pixel, in place.
    pub(super) fn step(&mut self, bits: &mut BitImage, shape: StructuringElement, inverted: bool) {
        let mut other = std::mem::take(&mut self.other);
        self.step_into(bits, shape, inverted, &mut other);
        std::mem::swap(bits, &mut other);
        self.other = other;
    }

    /// One pixel: what is set grows, or where `inverted` what is not.
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

fn shape(k: u32) -> StructuringElement {
    if k.is_multiple_of(2) { StructuringElement::Cross } else { StructuringElement::Square }
}

vectorised! {
    /// What is set in a row, its neighbours above and below, and left and right; all inverted where `invert` is.
    fn grow_row(rows: [&[u64]; 3], square: bool, invert: u64, last: u64, out: &mut [u64]) {
        let n = out.len();
        if n == 0 {
            return;
        }
        let rows = rows.map(|row| &row[..n]);
        let row_of = |k: usize| {
            // Beyond the end of a row nothing is set, inverted or not.
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
