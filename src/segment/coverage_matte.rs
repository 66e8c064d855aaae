//! Coverage along the outline: the share of a pixel that the subject covers.
//!
//! ```text
//!   backgr. backgr. | .3  | subject    the colour of a pixel that the outline crosses lies between the
//!   backgr. | .1    | .8  | subject    background's and the subject's, in proportion to the coverage
//! ```

use super::cleanup::{Cleaner, Cleanup};
use super::morphology::StructuringElement;
use crate::silhouette::bit_image::BitImage;
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

        let Self { subject, core, outside, outline, .. } = self;
        mask.take_bits(subject, |cover| {
            outline.for_each(|x, y| {
                let Some(covered) = coverage(&colours, core, outside, x, y) else { return };
                let byte = (255.0 * covered + 0.5) as u8;
                cover(x, y, if subject.get(x, y) { byte } else { byte.min(SUBJECT - 1) });
            });
        });
    }

    /// Finds the pixels on both sides of the outline, and those away from it inside (`core`) and outside.
    fn find_outline(&mut self) {
        let Self { raw, subject, cleaner, core, outside, outline } = self;
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

/// The coverage of a pixel, 0 to 1: the position of its colour between the nearby colours of background and subject.
/// `None` if one of these is unknown or they are too similar.
#[inline]
fn coverage(colours: &Colours, core: &BitImage, outside: &BitImage, x: usize, y: usize) -> Option<f32> {
    let subject = Sum::around(colours.image, core, x, y);
    let background = Sum::around(colours.image, outside, x, y);

    let at = 3 * (y * core.width() + x);
    let pixel = |bytes: &[u8]| [0, 1, 2].map(|c| f32::from(bytes[at + c]));
    let subject = subject.mean()?;

    let behind = match colours.background {
        None => background.mean()?,
        Some(plate) => {
            // The light may have changed since the background was learnt, above all in the subject's shadow.
            let learnt = Sum::around(plate, outside, x, y);
            let colour = pixel(plate);
            [0, 1, 2].map(|c| {
                let light = (background.sum[c] as f32 + 1.0) / (learnt.sum[c] as f32 + 1.0);
                colour[c] * light.clamp(LIGHT.0, LIGHT.1)
            })
        }
    };

    let own = pixel(colours.image);
    let (mut along, mut square) = (0.0, 0.0);
    for c in 0..3 {
        let step = subject[c] - behind[c];
        along += (own[c] - behind[c]) * step;
        square += step * step;
    }

    (square >= LEAST_CONTRAST).then(|| (along / square).clamp(0.0, 1.0))
}

/// A sum of colours.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    sum: [u32; 3],
    /// The number of pixels added.
    count: u32,
}

impl Sum {
    /// The sum over the pixels in the 5x5 window around (x, y) that are set in `bits`.
    #[inline]
    fn around(colours: &[u8], bits: &BitImage, x: usize, y: usize) -> Self {
        let mut sum = Self::default();
        for j in y.saturating_sub(2)..(y + 3).min(bits.height()) {
            let mut row = bits.five(x, j);
            while row != 0 {
                // Pixel x - 2 is the lowest bit.
                let i = x + row.trailing_zeros() as usize - 2;
                let at = 3 * (j * bits.width() + i);
                for c in 0..3 {
                    sum.sum[c] += u32::from(colours[at + c]);
                }
                sum.count += 1;
                row &= row - 1;
            }
        }
        sum
    }

    #[inline]
    fn mean(&self) -> Option<[f32; 3]> {
        (self.count > 0).then(|| self.sum.map(|sum| sum as f32 / self.count as f32))
    }
}
