//! Coverage at the outline: how much of a pixel shows the subject.
//!
//! ```text
//!   room  room  | .3  | subject       the colour of a pixel that the outline crosses lies between the room's and
//!   room  | .1  | .8  | subject       the subject's: as far along as the subject covers it
//! ```

use super::cleanup::{Cleaner, Cleanup};
use super::morphology::StructuringElement;
use crate::silhouette::bit_image::BitImage;
use crate::silhouette::{PackedMask, SUBJECT};

/// Squared grey levels between room and subject, below which a colour between them tells nothing.
const LEAST_CONTRAST: f32 = 30.0 * 30.0;

/// How far light at the outline may be from the room's as it was learnt, as ratios.
const LIGHT: (f32, f32) = (0.4, 1.5);

/// From bits to a mask, in memory that is used again.
#[derive(Debug, Clone, Default)]
pub(super) struct CoverageMatte {
    /// The pixels that look like the subject: written by whoever segments.
    pub(super) raw: BitImage,
    /// The same, cleaned up.
    pub(super) subject: BitImage,
    cleaner: Cleaner,
    /// The subject without its outline, and the room without its own.
    core: BitImage,
    outside: BitImage,
    /// The pixels whose coverage is asked.
    grown: BitImage,
}

/// An image, and the room behind the subject where it is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Colours<'a> {
    pub(super) image: &'a [u8],
    pub(super) background: Option<&'a [u8]>,
}

impl CoverageMatte {
    /// The mask of `raw`: cleaned up, 255 inside, 0 outside, coverage along the outline.
    pub(super) fn compute(&mut self, colours: Colours, cleanup: &Cleanup, mask: &mut PackedMask) {
        self.subject.copy(&self.raw);
        self.cleaner.clean(cleanup, &mut self.subject);
        self.find_outline();
        let Self { subject, core, outside, grown, .. } = self;
        mask.take_bits(subject, |cover| {
            grown.for_each(|x, y| {
                let Some(covered) = coverage(&colours, core, outside, x, y) else { return };
                let byte = (255.0 * covered + 0.5) as u8;
                cover(x, y, if subject.get(x, y) { byte } else { byte.min(SUBJECT - 1) });
            });
        });
    }

    /// Finds the pixels on both sides of the outline, `grown`, and those well within and well outside the subject.
    fn find_outline(&mut self) {
        let Self { raw, subject, cleaner, core, outside, grown } = self;
        let morphology = &mut cleaner.morphology;
        morphology.step_into(subject, StructuringElement::Square, true, core);
        morphology.step_into(subject, StructuringElement::Square, false, grown);
        outside.copy(grown);
        let last = outside.last_word();
        let stride = outside.stride().max(1);
        for (k, word) in outside.words_mut().iter_mut().enumerate() {
            *word = !*word & if k % stride + 1 == stride { last } else { u64::MAX };
        }
        // On both sides of the outline; where the clean-up has decided against the colour, the colour tells nothing.
        for (k, word) in grown.words_mut().iter_mut().enumerate() {
            *word &= !core.words()[k] & !(raw.words()[k] ^ subject.words()[k]);
        }
    }
}

/// How far the colour of a pixel has gone from the room's to the subject's near by, 0 to 1; `None` where these are
/// not to be had, or too much alike.
#[inline]
fn coverage(colours: &Colours, core: &BitImage, outside: &BitImage, x: usize, y: usize) -> Option<f32> {
    let subject = Sum::around(colours.image, core, x, y);
    let here = Sum::around(colours.image, outside, x, y);
    let at = 3 * (y * core.width() + x);
    let pixel = |bytes: &[u8]| [0, 1, 2].map(|c| f32::from(bytes[at + c]));
    let subject = subject.mean()?;
    let room = match colours.background {
        None => here.mean()?,
        Some(room) => {
            // The light on it may have changed, most of all in the subject's shadow.
            let learnt = Sum::around(room, outside, x, y);
            let colour = pixel(room);
            [0, 1, 2].map(|c| {
                let light = (here.sum[c] as f32 + 1.0) / (learnt.sum[c] as f32 + 1.0);
                colour[c] * light.clamp(LIGHT.0, LIGHT.1)
            })
        }
    };
    let own = pixel(colours.image);
    let (mut along, mut square) = (0.0, 0.0);
    for c in 0..3 {
        let way = subject[c] - room[c];
        along += (own[c] - room[c]) * way;
        square += way * way;
    }
    (square >= LEAST_CONTRAST).then(|| (along / square).clamp(0.0, 1.0))
}

/// Colours added up.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    sum: [u32; 3],
    count: u32,
}

impl Sum {
    /// Of the pixels in a 5x5 window that are set in `bits`.
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
