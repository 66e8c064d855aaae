//! Segmentation against a background of one colour.

// An indexed loop over several arrays reads as one operation per lane, and compiles to vector instructions.
#![allow(clippy::needless_range_loop)]

use super::Segmenter;
use super::cleanup::Cleanup;
use super::coverage_matte::{Colours, CoverageMatte};
use super::difference::{BYTES, full_word, padded};
use crate::math::vectorised;
use crate::silhouette::PackedMask;
use crate::silhouette::bit_image::{WORD, pack};
use crate::{Error, Result};
use image::RgbImage;

/// The colour of the background and its tolerances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Red, green, blue of the cloth or paint in bright light. It must not be grey.
    pub colour: [u8; 3],
    /// The largest angle between a pixel's hue and the key's, in radians, above 0 and below pi/2. Default 0.5.
    pub hue_tolerance: f64,
    /// The smallest chroma of the background as a share of the key's, above 0 and below 1. Default 0.25: cloth in a
    /// quarter of the light is still background.
    pub least_chroma: f64,
}

impl Key {
    /// A key with the default tolerances.
    pub fn new(colour: [u8; 3]) -> Self {
        Self { colour, hue_tolerance: 0.5, least_chroma: 0.25 }
    }
}

/// A background of one colour, green or any other, recognised by its hue in any light.
///
/// It needs no image of the empty scene, the camera may move, and shadows count as background, since they keep its
/// hue. But everything behind the subject must have that colour, and no part of the subject may.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use ode_visual_hull::segment::{ChromaKey, Key, Segmenter};
///
/// // Green cloth, darker to the right.
/// let cloth = |x: u32| Rgb([60, 160, 80].map(|c| (c * (96 - x) / 96) as u8));
/// let mut image = RgbImage::from_fn(64, 48, |x, _| cloth(x));
/// for (x, y) in (20..30).flat_map(|x| (10..40).map(move |y| (x, y))) {
///     image.put_pixel(x, y, Rgb([200, 60, 50]));
/// }
/// let mask = ChromaKey::new(Key::new([60, 160, 80]))?.segment(&image)?;
/// assert_eq!((mask.get_pixel(25, 20).0, mask.get_pixel(60, 20).0), ([255], [0]));
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ChromaKey {
    test: HueTest,
    cleanup: Cleanup,
    matte: CoverageMatte,
}

/// The key's direction in the plane of blue and red chroma, and the cone around it.
#[derive(Debug, Clone, Copy)]
struct HueTest {
    direction: [f32; 2],
    least: f32,
    slope: f32,
}

/// A key with less chroma than this, in grey levels, counts as grey.
const GREY: f64 = 24.0;

impl ChromaKey {
    /// A segmenter for this key.
    ///
    /// # Errors
    /// A key that is nearly grey, or a tolerance out of its range.
    pub fn new(key: Key) -> Result<Self> {
        let Key { colour, hue_tolerance, least_chroma } = key;
        let [blue, red] = chroma(colour.map(f32::from)).map(f64::from);
        let strength = blue.hypot(red);
        if strength < GREY {
            return Err(Error::argument(format!(
                "expected a colourful key, found the nearly grey {colour:?}; use a clean plate for a grey room"
            )));
        }

        let is_between = |value: f64, most: f64| value > 0.0 && value < most;
        if !is_between(hue_tolerance, std::f64::consts::FRAC_PI_2) || !is_between(least_chroma, 1.0) {
            return Err(Error::argument(format!(
                "expected a key's hue tolerance above 0 and below a quarter turn in radians, and its least chroma between \
                 0 and 1, found {hue_tolerance} and {least_chroma}"
            )));
        }

        let test = HueTest {
            direction: [blue / strength, red / strength].map(|c| c as f32),
            least: (least_chroma * strength) as f32,
            slope: hue_tolerance.tan() as f32,
        };
        Ok(Self { test, cleanup: Cleanup::default(), matte: CoverageMatte::default() })
    }

    /// Sets how masks are cleaned up.
    ///
    /// # Errors
    /// A number out of its range.
    pub fn with_cleanup(self, cleanup: Cleanup) -> Result<Self> {
        cleanup.check()?;
        Ok(Self { cleanup, ..self })
    }
}

impl Segmenter for ChromaKey {
    /// Segments an image of any size.
    fn segment_packed(&mut self, image: &RgbImage, mask: &mut PackedMask) -> Result<()> {
        let bits = &mut self.matte.raw;
        bits.resize(image.width() as usize, image.height() as usize);
        let (stride, row) = (bits.stride().max(1), 3 * image.width().max(1) as usize);
        for (bits, image) in bits.words_mut().chunks_exact_mut(stride).zip(image.as_raw().chunks_exact(row)) {
            key_row(image, &self.test, bits);
        }
        let colours = Colours { image: image.as_raw(), background: None };
        self.matte.compute(colours, &self.cleanup, mask);
        Ok(())
    }
}

/// The chroma: how much bluer and redder a colour is than the grey of the same luma (with weights of a quarter, a half
/// and a quarter).
#[inline(always)]
fn chroma([red, green, blue]: [f32; 3]) -> [f32; 2] {
    let luma = 0.25 * red + 0.5 * green + 0.25 * blue;
    [blue - luma, red - luma]
}

vectorised! {
    /// Sets the bits of a row's pixels that are not of the key's hue.
    fn key_row(image: &[u8], test: &HueTest, bits: &mut [u64]) {
        let width = image.len() / 3;
        for (k, bits) in bits.iter_mut().enumerate() {
            let image = &image[BYTES * k..image.len().min(BYTES * (k + 1))];
            let word = match full_word(image) {
                Some(image) => key_word(image, test),
                None => key_word(&padded(image), test),
            };
            *bits = word & u64::MAX >> (WORD - (width - WORD * k).min(WORD));
        }
    }
}

#[inline(always)]
fn key_word(image: &[u8; BYTES], test: &HueTest) -> u64 {
    let mut is_subject = [0u8; WORD];
    for k in 0..WORD {
        let channel = |c: usize| f32::from(image[3 * k + c]);
        let [blue, red] = chroma([channel(0), channel(1), channel(2)]);
        let along = blue * test.direction[0] + red * test.direction[1];
        let across = red * test.direction[0] - blue * test.direction[1];
        let is_background = (along >= test.least) & (across.abs() <= test.slope * along);
        is_subject[k] = if is_background { 0 } else { 255 };
    }
    let [bits] = pack(&[is_subject]);
    bits
}

#[cfg(test)]
mod tests;
