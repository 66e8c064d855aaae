//! Segmentation of colour images into silhouettes.
//!
//! | camera and scene | segmenter |
//! |---|---|
//! | fixed, with images of the empty scene | [`CleanPlate`] |
//! | fixed, with a video of the empty scene, and light that changes slowly | [`RunningGaussian`] |
//! | fixed or moving, in front of cloth or walls of one colour | [`ChromaKey`] |
//! | in the dark, with an illuminated subject | a [`CleanPlate`] of black, without [`Shadows`] |
//!
//! Each is a [`Segmenter`]: it turns an image into a mask, 255 inside and 0 outside, or packed for the hull. Along the
//! outline the mask holds coverage: the position of a pixel's colour between the nearby colours of background and
//! subject. A [`Cleanup`] closes gaps and drops specks. The camera's exposure and white balance must be fixed in all
//! cases.
//!
//! Existing masks, or cut-out images with an alpha channel, need no segmentation: the hull takes any
//! [`image::GrayImage`] that is at least 128 on the subject; [`silhouette::load_mask`](crate::silhouette::load_mask)
//! reads such a file and [`recording`](crate::recording) a folder of them.

mod chroma_key;
mod clean_plate;
mod cleanup;
mod coverage_matte;
mod difference;
mod morphology;
mod plate;
mod running_gaussian;
mod shadows;
#[cfg(test)]
mod testing;
mod window_sums;

pub use chroma_key::{ChromaKey, Key};
pub use clean_plate::CleanPlate;
pub use cleanup::Cleanup;
pub use plate::Thresholds;
pub use running_gaussian::{Learning, RunningGaussian};
pub use shadows::Shadows;

use crate::silhouette::PackedMask;
use crate::{Error, Result};
use image::{GrayImage, RgbImage};

/// Segments the colour images of one fixed camera into silhouettes.
pub trait Segmenter: Send + Sync {
    /// Writes the silhouette in `image` into `mask`, which is resized to the image: subject, background, and coverage
    /// along the outline.
    ///
    /// # Errors
    /// An image of another size than this camera's.
    fn segment_packed(&mut self, image: &RgbImage, mask: &mut PackedMask) -> Result<()>;

    /// Writes the silhouette in `image` into `mask`, which is resized to the image: 255 subject, 0 background,
    /// coverage along the outline.
    ///
    /// # Errors
    /// All errors of [`segment_packed`](Self::segment_packed).
    fn segment_into(&mut self, image: &RgbImage, mask: &mut GrayImage) -> Result<()> {
        let mut packed = PackedMask::default();
        self.segment_packed(image, &mut packed)?;
        packed.write_to(mask);
        Ok(())
    }

    /// The silhouette in `image`, one byte per pixel.
    ///
    /// # Errors
    /// All errors of [`segment_packed`](Self::segment_packed).
    fn segment(&mut self, image: &RgbImage) -> Result<GrayImage> {
        let mut mask = GrayImage::default();
        self.segment_into(image, &mut mask)?;
        Ok(mask)
    }
}

/// Refuses an image of another size than the background's.
fn check_size(expected: (u32, u32), found: (u32, u32)) -> Result<()> {
    if expected == found {
        return Ok(());
    }
    Err(Error::argument(format!(
        "expected an image of {} x {} pixels, the size of the background's, found {} x {}; take both with the same \
         camera and settings",
        expected.0, expected.1, found.0, found.1
    )))
}
