//! Coverage along the outline: the share of a pixel that the subject covers.
//!
//! ```text
//!   backgr. backgr. | .3  | subject    the colour of a pixel that the outline crosses lies between the
//!   backgr. | .1    | .8  | subject    background's and the subject's, in proportion to the coverage
//! ```

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::cleanup::{Cleaner, Cleanup};
use super::morphology::StructuringElement;
use crate::math::lanes::set_bits;
use crate::math::vectorised;
use crate::silhouette::bit_image::{BitImage, WORD};
use crate::silhouette::{PackedMask, SUBJECT};

/// The smallest squared distance between background and subject, in grey levels, at which a colour between them gives
/// a coverage.
const LEAST_CONTRAST: f32 = 30.0 * 30.0;

/// Bounds of the light at the outline relative to the learnt background, as a ratio.
const LIGHT: (f32, f32) = (0.4, 1.5);

/// Computes a mask with coverage from segmented bits, in reused buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct CoverageMatte {
    /// The pixels that differ from the background; each segmenter writes them.
    pub(super) raw: BitImage,
    /// The pixels of the subject after the clean-up.
    pub(super) subject: BitImage,
    cleaner: Cleaner,
    /// The subject's pixels away from the outline.
    core: BitImage,
    /// The background's pixels away from the outline.
    outside: BitImage,
    /// The pixels along the outline, whose coverage is computed.
    outline: BitImage,
    /// Those of them whose coverage is known.
    covered: Vec<Covered>,
}

/// A pixel along the outline.
#[derive(Debug, Clone, Copy)]
struct Covered {
    x: usize,
    y: usize,
    /// Its coverage, from 0 to 255.
    byte: u8,
}

/// An image and, where known, the background's colours, 3 bytes per pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Colours<'a> {
    pub(super) image: &'a [u8],
    pub(super) background: Option<&'a [u8]>,
}

impl CoverageMatte {
    /// Computes the mask of `raw`: cleaned up, 255 inside, 0 outside, coverage along the outline.
    pub(super) fn compute(&mut self, colours: Colours, cleanup: &Cleanup, mask: &mut PackedMask) {
        self.subject.copy(&self.raw);
        self.cleaner.clean(cleanup, &mut self.subject);
        self.find_outline();

        let Self { subject, core, outside, outline, covered, .. } = self;
        covered.clear();
        cover_outline(&colours, core, outside, outline, covered);
        mask.take_bits(subject, |cover| {
            for &Covered { x, y, byte } in &*covered {
                cover(x, y, if subject.get(x, y) { byte } else { byte.min(SUBJECT - 1) });
            }
        });
    }

    /// Finds the pixels on both sides of the outline, and those away from it inside (`core`) and outside.
    fn find_outline(&mut self) {
        let Self { raw, subject, cleaner, core, outside, outline, .. } = self;
        let morphology = &mut cleaner.morphology;
        morphology.step_into(subject, StructuringElement::Square, true, core);
        morphology.step_into(subject, StructuringElement::Square, false, outline);

        outside.copy(outline);
        let last = outside.last_word();
        let stride = outside.stride().max(1);
        for (k, word) in outside.words_mut().iter_mut().enumerate() {
            *word = !*word & if k % stride + 1 == stride { last } else { u64::MAX };
        }

        // Keep both sides of the outline, except pixels that the clean-up has changed: their colour is misleading.
        for (k, word) in outline.words_mut().iter_mut().enumerate() {
            *word &= !core.words()[k] & !(raw.words()[k] ^ subject.words()[k]);
        }
    }
}

vectorised! {
    /// Lists the coverage of the pixels of `outline`, row by row.
    fn cover_outline(colours: &Colours, core: &BitImage, outside: &BitImage, outline: &BitImage, covered: &mut Vec<Covered>) {
        for y in 0..outline.height() {
            for (k, &word) in outline.row(y).iter().enumerate() {
                for bit in set_bits(word) {
                    let x = WORD * k + bit;
                    if let Some(share) = coverage(colours, core, outside, x, y) {
                        covered.push(Covered { x, y, byte: (255.0 * share + 0.5) as u8 });
                    }
                }
            }
        }
    }
}

/// The coverage of a pixel, 0 to 1: the position of its colour between the nearby colours of background and subject.
/// `None` if one of these is unknown or they are too similar.
#[inline(always)]
fn coverage(colours: &Colours, core: &BitImage, outside: &BitImage, x: usize, y: usize) -> Option<f32> {
    let [subject] = Sum::around([colours.image], core, x, y);
    let subject = subject.mean()?;

    let at = 3 * (y * core.width() + x);
    let mut behind = [0.0; 3];
    match colours.background {
        None => behind = Sum::around([colours.image], outside, x, y)[0].mean()?,
        Some(plate) => {
            // The light may have changed since the background was learnt, above all in the subject's shadow.
            let [background, learnt] = Sum::around([colours.image, plate], outside, x, y);
            for c in 0..3 {
                let light = (background.sum[c] as f32 + 1.0) / (learnt.sum[c] as f32 + 1.0);
                behind[c] = f32::from(plate[at + c]) * light.clamp(LIGHT.0, LIGHT.1);
            }
        }
    }

    let (mut along, mut square) = (0.0, 0.0);
    for c in 0..3 {
        let step = subject[c] - behind[c];
        along += (f32::from(colours.image[at + c]) - behind[c]) * step;
        square += step * step;
    }

    (square >= LEAST_CONTRAST).then(|| (along / square).clamp(0.0, 1.0))
}

/// Pixels along a side of the window whose colours are summed.
const WINDOW: usize = 5;

/// The bytes of a row of the window, and one more: as many as a vector has.
const LANES: usize = 16;

/// For each set of pixels of a row of the window, all bits of their bytes.
const LANES_OF_BITS: [[u16; LANES]; 1 << WINDOW] = {
    let mut lanes = [[0; LANES]; 1 << WINDOW];
    let mut bits = 0;
    while bits < 1 << WINDOW {
        let mut k = 0;
        while k < 3 * WINDOW {
            lanes[bits][k] = if bits >> (k / 3) & 1 == 1 { u16::MAX } else { 0 };
            k += 1;
        }
        bits += 1;
    }
    lanes
};

/// The bytes of the pixels two to the left to two to the right of the one whose first byte has index `at`; zeros beyond the
/// image.
#[inline(always)]
fn row_of_window(image: &[u8], at: usize) -> [u8; LANES] {
    let before = 3 * (WINDOW / 2);
    if let Some(bytes) = at.checked_sub(before).and_then(|first| image[first..].first_chunk()) {
        return *bytes;
    }
    let mut bytes = [0; LANES];
    for k in 0..LANES {
        bytes[k] = (at + k).checked_sub(before).and_then(|k| image.get(k)).copied().unwrap_or(0);
    }
    bytes
}

/// A sum of colours.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    sum: [u32; 3],
    /// The number of pixels added.
    count: u32,
}

impl Sum {
    /// The sums, one for each of these images, over the pixels in the 5x5 window around (x, y) that are set in `bits`.
    #[inline(always)]
    fn around<const N: usize>(images: [&[u8]; N], bits: &BitImage, x: usize, y: usize) -> [Self; N] {
        let (mut lanes, mut count) = ([[0u16; LANES]; N], 0);
        for j in y.saturating_sub(2)..(y + 3).min(bits.height()) {
            let row = bits.five(x, j);
            count += row.count_ones();
            let (mask, first) = (&LANES_OF_BITS[row as usize], 3 * (j * bits.width() + x));
            for n in 0..N {
                let bytes = row_of_window(images[n], first);
                for k in 0..LANES {
                    lanes[n][k] += u16::from(bytes[k]) & mask[k];
                }
            }
        }

        let mut sums = [Self { sum: [0; 3], count }; N];
        for n in 0..N {
            for k in 0..WINDOW {
                for c in 0..3 {
                    sums[n].sum[c] += u32::from(lanes[n][3 * k + c]);
                }
            }
        }
        sums
    }

    #[inline(always)]
    fn mean(&self) -> Option<[f32; 3]> {
        (self.count > 0).then(|| self.sum.map(|sum| sum as f32 / self.count as f32))
    }
}
