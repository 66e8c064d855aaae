//! Colour images to silhouettes.
//!
//! | where the camera stands | what to take |
//! |---|---|
//! | fixed, and the room was photographed empty | [`CleanPlate`] |
//! | fixed, a while is filmed empty, and the light changes slowly | [`RunningGaussian`] |
//! | anywhere, before cloth or walls of one colour | [`ChromaKey`] |
//! | in the dark, with a subject that is lit | a [`CleanPlate`] of black, without [`Shadows`] |
//!
//! Each is a [`Segmenter`]: an image in, a mask out, 255 inside and 0 outside, or packed on its way into the hull. Along
//! the outline the mask holds coverage: how far a pixel's colour has gone from the room's to the subject's near by. A [`Cleanup`] closes gaps and drops specks.
//! The camera's exposure and white balance must be fixed, whatever is taken.
//!
//! Whoever has masks, cut-out images with an alpha channel, or a folder of either needs none of this: the hull takes
//! any [`image::GrayImage`] that is at least 128 on the subject, [`silhouette::load_mask`](crate::silhouette::load_mask) and
//! [`recording`](crate::recording) read them.

mod chroma_key;
mod clean_plate;
mod cleanup;
mod coverage_matte;
mod difference;
mod morphology;
mod plate;
mod regions;
mod running_gaussian;
mod shadows;
#[cfg(test)]
mod testing;

pub use chroma_key::{ChromaKey, Key};
pub use clean_plate::CleanPlate;
pub use cleanup::Cleanup;
pub use plate::Thresholds;
pub use running_gaussian::{Learning, RunningGaussian};
pub use shadows::Shadows;

use crate::silhouette::PackedMask;
use crate::{Error, Result};
use image::{GrayImage, RgbImage};

/// A way from the colour images of one fixed camera to silhouettes.
pub trait Segmenter: Send + Sync {
    /// Writes the silhouette in `image` into `mask`, which takes the image's size: subject and background, and coverage
    /// along the outline.
    ///
    /// # Errors
    /// An image of another size than this camera's.
    fn segment_packed(&mut self, image: &RgbImage, mask: &mut PackedMask) -> Result<()>;

    /// Writes the silhouette in `image` into `mask`, which takes the image's size: 255 subject, 0 background, coverage
    /// along the outline.
    ///
    /// # Errors
    /// As [`segment_packed`](Self::segment_packed).
    fn segment_into(&mut self, image: &RgbImage, mask: &mut GrayImage) -> Result<()> {
        let mut packed = PackedMask::default();
        self.segment_packed(image, &mut packed)?;
        packed.write_to(mask);
        Ok(())
    }

    /// The silhouette in `image`, a byte a pixel.
    ///
    /// # Errors
    /// As [`segment_packed`](Self::segment_packed).
    fn segment(&mut self, image: &RgbImage) -> Result<GrayImage> {
        let mut mask = GrayImage::default();
        self.segment_into(image, &mut mask)?;
        Ok(mask)
    }
}

/// Refuses an image of another size than the room's.
fn check_size(expected: (u32, u32), found: (u32, u32)) -> Result<()> {
    if expected == found {
        return Ok(());
    }
    Err(Error::argument(format!(
        "expected an image of {} x {} pixels, the size of the empty room's, found {} x {}; take both with the same \
         camera and settings",
        expected.0, expected.1, found.0, found.1
    )))
}
