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
use super::window_sums::WindowSums;
use crate::math::lanes::set_bits;
use crate::math::vectorised;
use crate::silhouette::bit_image::{BitImage, WORD};
use crate::silhouette::{PackedMask, Rect, SUBJECT};

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
    sides: Sides,
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

        let Self { subject, core, outside, outline, sides, covered, .. } = self;
        covered.clear();
        cover_outline(&colours, core, outside, outline, sides, covered);
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
    fn cover_outline(colours: &Colours, core: &BitImage, outside: &BitImage, outline: &BitImage, sides: &mut Sides, covered: &mut Vec<Covered>) {
        let rect = outline.rect();
        if rect.is_empty() {
            return;
        }
        sides.start(&rect, outline.width());
        for y in rect.y0 as usize..rect.y1 as usize {
            sides.go_to(y, colours, core, outside);
            for (k, &word) in outline.row(y).iter().enumerate() {
                for bit in set_bits(word) {
                    let x = WORD * k + bit;
                    if let Some(share) = coverage(colours, sides, x, y * outline.width() + x) {
                        covered.push(Covered { x, y, byte: (255.0 * share + 0.5) as u8 });
                    }
                }
            }
        }
    }
}

/// The colours on both sides of the outline.
#[derive(Debug, Clone, Default)]
struct Sides {
    /// The image's inside.
    subject: WindowSums<1>,
    /// The image's and the learnt background's outside.
    background: WindowSums<2>,
}

impl Sides {
    fn start(&mut self, rect: &Rect, width: usize) {
        self.subject.start(rect, width);
        self.background.start(rect, width);
    }

    #[inline(always)]
    fn go_to(&mut self, y: usize, colours: &Colours, core: &BitImage, outside: &BitImage) {
        let Colours { image, background } = *colours;
        self.subject.go_to(y, [image], core);
        self.background.go_to(y, [image, background.unwrap_or(image)], outside);
    }
}

/// The coverage of a pixel in column `x`, 0 to 1: the position of its colour between the nearby colours of background and subject.
/// `None` if one of these is unknown or they are too similar.
#[inline(always)]
fn coverage(colours: &Colours, sides: &Sides, x: usize, pixel: usize) -> Option<f32> {
    let [subject] = sides.subject.colours(x);
    let subject = mean(subject, sides.subject.count(x))?;

    let at = 3 * pixel;
    let mut behind = [0.0; 3];
    let [background, learnt] = sides.background.colours(x);
    match colours.background {
        None => behind = mean(background, sides.background.count(x))?,
        Some(plate) => {
            // The light may have changed since the background was learnt, above all in the subject's shadow.
            for c in 0..3 {
                let light = (background[c] as f32 + 1.0) / (learnt[c] as f32 + 1.0);
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

/// The mean of `count` colours.
#[inline(always)]
fn mean(sum: [u32; 3], count: u32) -> Option<[f32; 3]> {
    (count > 0).then(|| sum.map(|sum| sum as f32 / count as f32))
}
