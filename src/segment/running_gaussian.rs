//! Background subtraction against a background that is learnt continuously.

// An indexed loop over several arrays reads as one operation per lane, and compiles to vector instructions.
#![allow(clippy::needless_range_loop)]

use super::cleanup::Cleanup;
use super::coverage_matte::{Colours, CoverageMatte};
use super::difference::BackgroundBounds;
use super::shadows::Shadows;
use super::{Segmenter, check_size};
use crate::math::vectorised;
use crate::silhouette::PackedMask;
use crate::{Error, Result};
use image::RgbImage;

/// Each frame updates every eighth row at an eightfold rate, which is cheaper and as fast over several frames.
const STRIPES: usize = 8;

/// The initial variance, in squared grey levels.
const FIRST_VARIANCE: f32 = 25.0;
/// The bounds of the variance, in squared grey levels.
const VARIANCES: (f32, f32) = (16.0, 100.0);

/// How the background is learnt, and when a pixel differs from it; the names are those of OpenCV's MOG2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learning {
    /// The number of frames averaged: each moves the mean by 1/history of its difference. Default 500.
    pub history: u32,
    /// A pixel differs if the squared distance of a channel from its mean exceeds this many variances. Default 16:
    /// four standard deviations.
    pub var_threshold: f64,
    /// Whether shadows count as background. Default true.
    pub detect_shadows: bool,
}

impl Default for Learning {
    fn default() -> Self {
        Self { history: 500, var_threshold: 16.0, detect_shadows: true }
    }
}

/// A Gaussian (mean and variance) for each channel of each background pixel, which follows slow changes of the light.
///
/// The model is that of Cheung, Kanade, Bouguet and Holler, *A real time system for robust 3D voxel reconstruction of
/// human motions* (CVPR 2000): learnt from empty frames, updated where a frame shows the background. Pixels of the
/// subject and of shadows are not learnt, so that a person who sits still does not fade into the background.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use ode_visual_hull::segment::{Learning, RunningGaussian, Segmenter};
///
/// let background = RgbImage::from_pixel(64, 48, Rgb([90, 140, 100]));
/// let mut segmenter = RunningGaussian::new(Learning::default())?;
/// for _ in 0..10 {
///     segmenter.learn(&background)?;
/// }
/// let mut image = background;
/// for (x, y) in (20..30).flat_map(|x| (10..40).map(move |y| (x, y))) {
///     image.put_pixel(x, y, Rgb([200, 60, 50]));
/// }
/// let mask = segmenter.segment(&image)?;
/// assert_eq!((mask.get_pixel(25, 20).0, mask.get_pixel(5, 20).0), ([255], [0]));
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct RunningGaussian {
    learning: Learning,
    shadows: Option<Shadows>,
    cleanup: Cleanup,
    model: Model,
    matte: CoverageMatte,
}

/// Means and variances with interleaved channels, and the background derived from them.
#[derive(Debug, Clone, Default)]
struct Model {
    background: BackgroundBounds,
    mean: Vec<f32>,
    variance: Vec<f32>,
    /// The number of empty frames learnt.
    learnt: u32,
    /// The first row that the next frame updates.
    stripe: usize,
    /// Whether each channel of the current row may be learnt, 255 or 0.
    is_background: Vec<u8>,
    /// The current row of the mask.
    row_of_mask: Vec<u8>,
}

impl RunningGaussian {
    /// A model without a background; call [`learn`](Self::learn) next.
    ///
    /// # Errors
    /// A history of no frames, or a threshold that is not positive and finite.
    pub fn new(learning: Learning) -> Result<Self> {
        let Learning { history, var_threshold, detect_shadows } = learning;
        if history == 0 || !(var_threshold > 0.0 && var_threshold.is_finite()) {
            return Err(Error::argument(format!(
                "expected a history of at least one frame and a positive variance threshold, found {history} and \
                 {var_threshold}; 500 and 16 are usual"
            )));
        }
        Ok(Self {
            learning,
            shadows: detect_shadows.then(Shadows::default),
            cleanup: Cleanup::default(),
            model: Model::default(),
            matte: CoverageMatte::default(),
        })
    }

    /// Learns from a frame of the empty scene; the first frames, up to the history, have equal weight.
    ///
    /// # Errors
    /// A frame of another size than those before, or without pixels.
    pub fn learn(&mut self, empty: &RgbImage) -> Result<()> {
        if empty.is_empty() {
            return Err(Error::argument(
                "expected a frame of the empty scene, found an image without pixels",
            ));
        }
        if self.model.learnt == 0 {
            self.model.start_from(empty);
        } else {
            check_size(self.model.background.size, empty.dimensions())?;
        }

        let rate = 1.0 / (self.model.learnt + 1).min(self.learning.history) as f32;
        for y in 0..empty.height() as usize {
            self.model.learn_row(empty, None, y, rate, self.learning.var_threshold as f32);
        }
        self.model.learnt = self.model.learnt.saturating_add(1);
        Ok(())
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

impl Segmenter for RunningGaussian {
    /// Segments an image, then learns from its background pixels.
    fn segment_packed(&mut self, image: &RgbImage, mask: &mut PackedMask) -> Result<()> {
        let Self { learning, shadows, cleanup, model, matte } = self;
        if model.learnt == 0 {
            return Err(Error::argument(
                "expected to have learnt from at least one frame of the empty scene, found none; call learn first",
            ));
        }

        check_size(model.background.size, image.dimensions())?;
        model.background.differences(image, shadows.as_ref(), &mut matte.raw);
        let colours = Colours { image: image.as_raw(), background: Some(&model.background.colour) };
        matte.compute(colours, cleanup, mask);

        let rate = (STRIPES as f32 / learning.history as f32).min(1.0);
        for y in (model.stripe..image.height() as usize).step_by(STRIPES) {
            model.learn_row(image, Some(mask), y, rate, learning.var_threshold as f32);
        }
        model.stripe = (model.stripe + 1) % STRIPES;
        Ok(())
    }
}

impl Model {
    /// Starts the means from a first frame.
    fn start_from(&mut self, empty: &RgbImage) {
        self.background = BackgroundBounds::new(empty.dimensions());
        // With these bounds every colour is within.
        self.background.greatest.fill(255);
        self.mean = empty.iter().map(|&value| f32::from(value)).collect();
        self.variance = vec![FIRST_VARIANCE; self.mean.len()];
        self.is_background = vec![255; 3 * empty.width() as usize];
        self.row_of_mask = vec![0; empty.width() as usize];
    }

    /// Learns row `y` of `image` where `mask`, if any, and the bounds classify it as background.
    fn learn_row(
        &mut self,
        image: &RgbImage,
        mask: Option<&PackedMask>,
        y: usize,
        rate: f32,
        threshold: f32,
    ) {
        let width = image.width() as usize;

        let row = 3 * width * y..3 * width * (y + 1);
        let Self { background, mean, variance, is_background, row_of_mask, .. } = self;
        let (colour, mean) = (&mut background.colour[row.clone()], &mut mean[row.clone()]);
        let (least, greatest) = (&mut background.least[row.clone()], &mut background.greatest[row.clone()]);
        let (variance, image) = (&mut variance[row.clone()], &image.as_raw()[row]);

        match mask {
            None => is_background.fill(255),
            Some(mask) => {
                mask.write_row(y, row_of_mask);
                shows_background(image, row_of_mask, least, greatest, is_background);
            }
        }

        learn(image, is_background, mean, variance, rate);
        bound(mean, variance, threshold, colour, least, greatest);
    }
}

vectorised! {
    /// Writes 255 where a channel is within its bounds and its pixel's mask is 0, else 0.
    fn shows_background(image: &[u8], mask: &[u8], least: &[u8], greatest: &[u8], is_background: &mut [u8]) {
        for (channels, &subject) in is_background.as_chunks_mut::<3>().0.iter_mut().zip(mask) {
            *channels = [if subject == 0 { 255 } else { 0 }; 3];
        }
        let n = is_background.len();
        let (image, least, greatest) = (&image[..n], &least[..n], &greatest[..n]);
        for k in 0..n {
            is_background[k] &= if least[k] <= image[k] && image[k] <= greatest[k] { 255 } else { 0 };
        }
    }
}

vectorised! {
    /// Moves means and variances by `rate` towards the values of `image`.
    fn learn(image: &[u8], is_background: &[u8], mean: &mut [f32], variance: &mut [f32], rate: f32) {
        let n = image.len();
        let (is_background, mean, variance) = (&is_background[..n], &mut mean[..n], &mut variance[..n]);
        for k in 0..n {
            let rate = if is_background[k] != 0 { rate } else { 0.0 };
            let deviation = f32::from(image[k]) - mean[k];
            mean[k] += rate * deviation;
            variance[k] = (variance[k] + rate * (deviation * deviation - variance[k])).clamp(VARIANCES.0, VARIANCES.1);
        }
    }
}

vectorised! {
    /// Computes colours and bounds from means and variances.
    fn bound(
        mean: &[f32],
        variance: &[f32],
        threshold: f32,
        colour: &mut [u8],
        least: &mut [u8],
        greatest: &mut [u8],
    ) {
        let n = mean.len();
        let (variance, colour) = (&variance[..n], &mut colour[..n]);
        let (least, greatest) = (&mut least[..n], &mut greatest[..n]);
        for k in 0..n {
            let tolerance = (threshold * variance[k]).sqrt();
            colour[k] = (mean[k] + 0.5) as u8;
            least[k] = (mean[k] - tolerance + 0.5) as u8;
            greatest[k] = (mean[k] + tolerance + 0.5) as u8;
        }
    }
}

#[cfg(test)]
mod tests;
