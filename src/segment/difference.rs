//! Finds the pixels of an image that differ from the background by more than noise and shadows.

// An indexed loop over several arrays reads as one operation per lane, and compiles to vector instructions.
#![allow(clippy::needless_range_loop)]

use super::shadows::{Limits, Shadows};
use crate::math::vectorised;
use crate::silhouette::bit_image::{BitImage, WORD, pack};
use image::RgbImage;

/// The background of one camera: a colour for each pixel, and bounds for each channel. Channels are interleaved as in
/// an image.
#[derive(Debug, Clone, Default)]
pub(super) struct BackgroundBounds {
    pub(super) size: (u32, u32),
    pub(super) colour: Vec<u8>,
    /// The least and the greatest value of each channel that still count as background.
    pub(super) least: Vec<u8>,
    pub(super) greatest: Vec<u8>,
}

impl BackgroundBounds {
    /// A background of zeros, to be filled by [`set`](Self::set).
    pub(super) fn new(size: (u32, u32)) -> Self {
        let channels = 3 * size.0 as usize * size.1 as usize;
        let zeros = || vec![0; channels];
        Self { size, colour: zeros(), least: zeros(), greatest: zeros() }
    }

    /// Sets one pixel's colour and the tolerance of its channels, in grey levels.
    pub(super) fn set(&mut self, pixel: usize, colour: [u8; 3], tolerance: u8) {
        for (c, value) in colour.into_iter().enumerate() {
            let at = 3 * pixel + c;
            self.colour[at] = value;
            self.least[at] = value.saturating_sub(tolerance);
            self.greatest[at] = value.saturating_add(tolerance);
        }
    }

    /// Sets the bits of the pixels of `image` that are neither within the background's tolerances nor in its shadows.
    /// The image has the background's size.
    pub(super) fn differences(&self, image: &RgbImage, shadows: Option<&Shadows>, bits: &mut BitImage) {
        let width = self.size.0 as usize;
        bits.resize(width, self.size.1 as usize);
        let stride = bits.stride();
        if stride == 0 {
            return;
        }

        let limits = shadows.map(Shadows::limits);
        let rows = bits.words_mut().chunks_exact_mut(stride).zip(image.as_raw().chunks_exact(3 * width));
        for (y, (bits, image)) in rows.enumerate() {
            let row = 3 * width * y..3 * width * (y + 1);
            differ(image, &self.least[row.clone()], &self.greatest[row.clone()], bits);
            if let Some(limits) = &limits {
                shade(image, &self.colour[row], limits, bits);
            }
        }
    }
}

vectorised! {
    /// Sets the bits of the pixels of a row with any channel outside its bounds.
    fn differ(image: &[u8], least: &[u8], greatest: &[u8], bits: &mut [u64]) {
        for (k, bits) in bits.iter_mut().enumerate() {
            let start = 3 * WORD * k;
            let end = (start + 3 * WORD).min(image.len());
            let (image, least, greatest) = (&image[start..end], &least[start..end], &greatest[start..end]);

            *bits = match (full_word(image), full_word(least), full_word(greatest)) {
                (Some(image), Some(least), Some(greatest)) => differ_word(image, least, greatest),
                _ => differ_word(&padded(image), &padded(least), &padded(greatest)),
            };
        }
    }
}

/// The bytes of one word's pixels.
pub(super) const BYTES: usize = 3 * WORD;

/// The bytes as a full word's pixels; `None` at the end of a row.
/// The bytes of a row's last pixels, filled up with zeros to a full word.
#[inline(always)]
pub(super) fn full_word(bytes: &[u8]) -> Option<&[u8; BYTES]> {
    bytes.try_into().ok()
}

#[inline(always)]
pub(super) fn padded(bytes: &[u8]) -> [u8; BYTES] {
    let mut all = [0; BYTES];
    all[..bytes.len()].copy_from_slice(bytes);
    all
}

#[inline(always)]
fn differ_word(image: &[u8; BYTES], least: &[u8; BYTES], greatest: &[u8; BYTES]) -> u64 {
    let (mut outside, mut any) = ([[0u8; WORD]; 3], 0);
    let bytes = outside.as_flattened_mut();
    for k in 0..BYTES {
        // Without a short circuit, which would keep the loop from becoming vector instructions.
        bytes[k] = if (image[k] < least[k]) | (image[k] > greatest[k]) { 255 } else { 0 };
        any |= bytes[k];
    }
    // Most of an image is background.
    if any == 0 {
        return 0;
    }
    any_of_three(pack(&outside))
}

/// Bit k tells whether any of the bits 3k, 3k + 1 and 3k + 2 is set.
#[inline(always)]
fn any_of_three([low, middle, high]: [u64; 3]) -> u64 {
    let any = |word: u64, next: u64| word | (word >> 1 | next << 63) | (word >> 2 | next << 62);
    // The first bits of pixels are 0, 3, .. 63 of the first word, 2, 5, .. 62 of the second and 1, 4, .. 61 of the third.
    let [low, middle, high] = [any(low, middle), any(middle, high) >> 2, any(high, 0) >> 1];
    every_third(low) | every_third(middle) << 22 | every_third(high) << 43
}

/// The bits 0, 3, .. 63 next to one another, as of a Morton code.
#[inline(always)]
fn every_third(bits: u64) -> u64 {
    let ones = bits & 0x9249_2492_4924_9249;
    let twos = (ones | ones >> 2) & 0x30c3_0c30_c30c_30c3;
    let fours = (twos | twos >> 4) & 0xf00f_00f0_0f00_f00f;
    let eights = (fours | fours >> 8) & 0x00ff_0000_ff00_00ff;
    let sixteens = (eights | eights >> 16) & 0xffff_0000_0000_ffff;
    (sixteens | sixteens >> 32) & 0x3f_ffff
}

vectorised! {
    /// Clears the bits of the pixels of a row that are background in a shadow or in slightly more light.
    fn shade(image: &[u8], background: &[u8], limits: &Limits, bits: &mut [u64]) {
        for (k, bits) in bits.iter_mut().enumerate() {
            if *bits == 0 {
                continue;
            }

            let start = BYTES * k;
            let end = (start + BYTES).min(image.len());
            let (image, background) = (&image[start..end], &background[start..end]);

            let shaded = match (full_word(image), full_word(background)) {
                (Some(image), Some(background)) => shaded_word(image, background, limits),
                _ => shaded_word(&padded(image), &padded(background), limits),
            };
            *bits &= !shaded;
        }
    }
}

/// The bits of the pixels that are the background's colour times an admissible ratio, with a small remainder.
#[inline(always)]
fn shaded_word(image: &[u8; BYTES], background: &[u8; BYTES], limits: &Limits) -> u64 {
    let mut shaded = [0u8; WORD];
    for k in 0..WORD {
        let channel = |bytes: &[u8; BYTES], c: usize| f32::from(bytes[3 * k + c]);
        let p = [channel(image, 0), channel(image, 1), channel(image, 2)];
        let b = [channel(background, 0), channel(background, 1), channel(background, 2)];

        let product = p[0] * b[0] + p[1] * b[1] + p[2] * b[2];
        let square = b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
        let own = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];

        // The ratio is product / square, the squared remainder |p - ratio b|^2 = own - product^2 / square.
        let is_dimmed = product >= limits.darkest * square && product <= limits.brightest * square;
        let is_alike = (own - limits.chroma_squared) * square <= product * product;
        shaded[k] = if is_dimmed & is_alike { 255 } else { 0 };
    }

    let [bits] = pack(&[shaded]);
    bits
}
