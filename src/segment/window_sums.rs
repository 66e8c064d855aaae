//! Sums of colours over the window around a pixel, of those pixels of the window that are on one side of an outline.
//!
//! Rows are entered and left one by one, from the top down. For each column of the window's rows a sum is kept, so that a
//! window's sum is one of a few numbers.
//!
//! ```text
//!   enters row y + 2   ─►  + + + + + + + + +
//!                          │ │ ┌───────┐ │ │    columns: sums over rows y - 2 to y + 2
//!   row y                  │ │ │   x   │ │ │
//!                          │ │ └───────┘ │ │
//!   leaves row y - 3   ─►  - - - - - - - - -
//! ```

// Loops over several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use crate::silhouette::Rect;
use crate::silhouette::bit_image::{BitImage, WORD};
use std::ops::Range;

/// Pixels from the middle of the window to its first and its last.
const REACH: usize = 2;

/// Pixels along a side of the window.
const WINDOW: usize = 2 * REACH + 1;

/// Pixels whose bits make a byte.
const BYTE: usize = 8;

/// For each byte of bits, all bits of the three bytes of each pixel that is set.
const BYTES_OF_BITS: [[u8; 3 * BYTE]; 1 << BYTE] = {
    let mut bytes = [[0; 3 * BYTE]; 1 << BYTE];
    let mut bits = 0;
    while bits < 1 << BYTE {
        let mut k = 0;
        while k < 3 * BYTE {
            bytes[bits][k] = if bits >> (k / 3) & 1 == 1 { u8::MAX } else { 0 };
            k += 1;
        }
        bits += 1;
    }
    bytes
};

/// The sums of `N` images over windows along a row, of the pixels that are set in a bit image.
#[derive(Debug, Clone)]
pub(super) struct WindowSums<const N: usize> {
    /// The columns of the images that are summed.
    x: Range<usize>,
    /// The row that enters next.
    next: usize,
    /// For each image, the sums of each byte over the rows of the window; before and after them there is room for half a window.
    columns: [Vec<u16>; N],
    /// The numbers of pixels that are set, three times for each column, as if they were colours.
    counts: Vec<u16>,
    /// For each row of the window, all bits of the bytes of the pixels that are set; row y has index y modulo their number.
    masks: [Vec<u8>; WINDOW],
    /// Those of the row that enters.
    entering: Vec<u8>,
}

impl<const N: usize> Default for WindowSums<N> {
    fn default() -> Self {
        Self {
            x: 0..0,
            next: 0,
            columns: std::array::from_fn(|_| Vec::new()),
            counts: Vec::new(),
            masks: Default::default(),
            entering: Vec::new(),
        }
    }
}

impl<const N: usize> WindowSums<N> {
    /// Begins with windows around the pixels of `rect`, which is not empty, in images of `width` pixels a row.
    pub(super) fn start(&mut self, rect: &Rect, width: usize) {
        let first = (rect.x0 as usize).saturating_sub(REACH) / BYTE * BYTE;
        let end = (rect.x1 as usize + REACH).next_multiple_of(2 * BYTE);
        self.x = first..end.min(width);
        self.next = (rect.y0 as usize).saturating_sub(REACH);
        for sums in self.columns.iter_mut().chain([&mut self.counts]) {
            sums.clear();
            sums.resize(3 * (self.x.len() + 2 * REACH), 0);
        }
        for mask in &mut self.masks {
            mask.clear();
            mask.resize(3 * self.x.len(), 0);
        }
    }

    /// Goes on to the windows around the pixels of row `y`, which is not above the last one.
    #[inline(always)]
    pub(super) fn go_to(&mut self, y: usize, images: [&[u8]; N], bits: &BitImage) {
        while self.next <= y + REACH {
            self.enter(self.next, images, bits);
            self.next += 1;
        }
    }

    /// Lets row `y` enter the window, and the one above the window leave it.
    #[inline(always)]
    fn enter(&mut self, y: usize, images: [&[u8]; N], bits: &BitImage) {
        let row = if y < bits.height() { bits.row(y) } else { &[] };
        read_mask(row, &self.x, &mut self.entering);
        let leaving = &mut self.masks[y % WINDOW];

        // Rows beyond the image have no pixel that is set.
        let at = |y: usize| 3 * (y.min(bits.height() - 1) * bits.width() + self.x.start);
        let (first, first_leaving) = (at(y), at(y.saturating_sub(WINDOW)));
        let count = leaving.len();
        let (mask, leaving_mask) = (&self.entering[..count], &leaving[..count]);
        for n in 0..N {
            let sums = &mut self.columns[n][3 * REACH..][..count];
            let (bytes, leaving) = (&images[n][first..][..count], &images[n][first_leaving..][..count]);
            for k in 0..count {
                sums[k] += u16::from(bytes[k] & mask[k]);
                sums[k] -= u16::from(leaving[k] & leaving_mask[k]);
            }
        }
        let counts = &mut self.counts[3 * REACH..][..count];
        for k in 0..count {
            counts[k] += u16::from(mask[k] & 1);
            counts[k] -= u16::from(leaving_mask[k] & 1);
        }
        std::mem::swap(leaving, &mut self.entering);
    }

    /// The number of pixels that are set in the window around column `x`.
    #[inline(always)]
    pub(super) fn count(&self, x: usize) -> u32 {
        let first = 3 * (x - self.x.start);
        let counts: &[u16; 3 * WINDOW] = self.counts[first..].first_chunk().unwrap();
        (0..WINDOW).map(|k| u32::from(counts[3 * k])).sum()
    }

    /// The sums of their colours, for each image.
    #[inline(always)]
    pub(super) fn colours(&self, x: usize) -> [[u32; 3]; N] {
        let first = 3 * (x - self.x.start);
        let mut colours = [[0; 3]; N];
        for n in 0..N {
            let sums: &[u16; 3 * WINDOW] = self.columns[n][first..].first_chunk().unwrap();
            for k in 0..3 * WINDOW {
                colours[n][k % 3] += u32::from(sums[k]);
            }
        }
        colours
    }
}

/// Reads the bits of columns `x` of a row, which are unset if it is empty.
#[inline(always)]
fn read_mask(row: &[u64], x: &Range<usize>, mask: &mut Vec<u8>) {
    mask.clear();
    if !row.is_empty() {
        for first in x.clone().step_by(BYTE) {
            let bits = row[first / WORD] >> (first % WORD) & 0xff;
            mask.extend_from_slice(&BYTES_OF_BITS[bits as usize]);
        }
    }
    mask.resize(3 * x.len(), 0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use ode_visual_hull_random::Random;

    #[test]
    fn sums_are_those_of_the_pixels_of_the_window_that_are_set() {
        let mut random = Random(5);
        let mut sums = WindowSums::<2>::default();
        for (width, height) in [(1, 1), (7, 9), (64, 5), (83, 40)] {
            let mut image = || (0..3 * width * height).map(|_| random.below(256) as u8).collect::<Vec<_>>();
            let images = [image(), image()];
            let mut bits = BitImage::default();
            bits.resize(width, height);
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                bits.set(x, y, random.below(3) > 0);
            }
            let [x0, y0] = [width, height].map(|size| random.below(size));
            let rect = Rect { x0: x0 as i32, y0: y0 as i32, x1: width as i32, y1: height as i32 };

            sums.start(&rect, width);
            for y in y0..height {
                sums.go_to(y, [&images[0], &images[1]], &bits);
                for x in x0..width {
                    let expected = one_by_one(&images, &bits, x, y);
                    assert_eq!(
                        (sums.count(x), sums.colours(x)),
                        expected,
                        "({x}, {y}) of {width} x {height}"
                    );
                }
            }
        }
    }

    fn one_by_one(images: &[Vec<u8>; 2], bits: &BitImage, x: usize, y: usize) -> (u32, [[u32; 3]; 2]) {
        let (mut count, mut colours) = (0, [[0; 3]; 2]);
        for j in y.saturating_sub(2)..(y + 3).min(bits.height()) {
            for i in x.saturating_sub(2)..(x + 3).min(bits.width()) {
                if bits.get(i, j) {
                    count += 1;
                    for (n, c) in (0..2).flat_map(|n| (0..3).map(move |c| (n, c))) {
                        colours[n][c] += u32::from(images[n][3 * (j * bits.width() + i) + c]);
                    }
                }
            }
        }
        (count, colours)
    }
}
