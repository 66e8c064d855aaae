//! Background subtraction against images of the empty scene.

use super::cleanup::Cleanup;
use super::coverage_matte::{Colours, CoverageMatte};
use super::difference::BackgroundBounds;
use super::plate::{Plate, Thresholds};
use super::shadows::Shadows;
use super::{Segmenter, check_size};
use crate::silhouette::PackedMask;
use crate::{Error, Result};
use image::RgbImage;

/// Background subtraction for one fixed camera, against an image of the scene without the subject (a clean plate).
///
/// ```
/// use image::{Rgb, RgbImage};
/// use ode_visual_hull::segment::{CleanPlate, Segmenter, Thresholds};
///
/// let background = RgbImage::from_pixel(64, 48, Rgb([90, 140, 100]));
/// let mut image = background.clone();
/// for (x, y) in (20..30).flat_map(|x| (10..40).map(move |y| (x, y))) {
///     image.put_pixel(x, y, Rgb([200, 60, 50]));
/// }
/// let mask = CleanPlate::new(&background, Thresholds::default())?.segment(&image)?;
/// assert_eq!((mask.get_pixel(25, 20).0, mask.get_pixel(5, 20).0), ([255], [0]));
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CleanPlate {
    plate: Plate,
    thresholds: Thresholds,
    background: BackgroundBounds,
    shadows: Option<Shadows>,
    cleanup: Cleanup,
    matte: CoverageMatte,
}

impl CleanPlate {
    /// A segmenter from one image of the empty scene.
    ///
    /// # Errors
    /// A threshold that is negative or not finite.
    pub fn new(plate: &RgbImage, thresholds: Thresholds) -> Result<Self> {
        Self::from_empty(std::slice::from_ref(plate), thresholds)
    }

    /// A segmenter from several images of the empty scene: their mean has less noise than one image, and each pixel's
    /// noise is measured.
    ///
    /// # Errors
    /// No image, images of several sizes, a threshold that is negative or not finite.
    pub fn from_empty(frames: &[RgbImage], thresholds: Thresholds) -> Result<Self> {
        let Some(first) = frames.first() else {
            return Err(Error::argument("expected at least one image of the empty scene, found none"));
        };
        thresholds.check()?;
        frames.iter().try_for_each(|frame| check_size(first.dimensions(), frame.dimensions()))?;

        let plate = Plate::mean(frames);
        Ok(Self {
            background: plate.background(&thresholds),
            plate,
            thresholds,
            shadows: Some(Shadows::default()),
            cleanup: Cleanup::default(),
            matte: CoverageMatte::default(),
        })
    }

    /// Updates the plate by `frames` of the recording itself, taken at times far apart: where nine tenths of them
    /// agree to a few grey levels, their median replaces the plate's colour.
    ///
    /// This handles a plate that is older than the recording or shows a person. It is for subjects that move about:
    /// one that stays in place would become background.
    ///
    /// # Errors
    /// Fewer than five frames, or one of another size than the plate.
    pub fn refined_with(mut self, frames: &[RgbImage]) -> Result<Self> {
        if frames.len() < 5 {
            return Err(Error::argument(format!(
                "expected at least 5 frames to refine a clean plate, found {}; take them from moments far apart",
                frames.len()
            )));
        }

        frames.iter().try_for_each(|frame| check_size(self.background.size, frame.dimensions()))?;
        self.plate.refine_with(frames);
        self.background = self.plate.background(&self.thresholds);
        Ok(self)
    }

    /// Sets the model of shadows; with `None` a shadow counts as the subject.
    ///
    /// # Errors
    /// A number out of its range.
    pub fn with_shadows(self, shadows: impl Into<Option<Shadows>>) -> Result<Self> {
        let shadows = shadows.into();
        shadows.iter().try_for_each(Shadows::check)?;
        Ok(Self { shadows, ..self })
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

impl Segmenter for CleanPlate {
    fn segment_packed(&mut self, image: &RgbImage, mask: &mut PackedMask) -> Result<()> {
        check_size(self.background.size, image.dimensions())?;
        self.background.differences(image, self.shadows.as_ref(), &mut self.matte.raw);
        let colours = Colours { image: image.as_raw(), background: Some(&self.background.colour) };
        self.matte.compute(colours, &self.cleanup, mask);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
