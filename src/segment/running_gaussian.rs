//! Background subtraction against a room that is learnt, and goes on being learnt.

// A loop over the lanes of several arrays says what happens to lane k, and becomes vector instructions as a whole.
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

/// Every so manyth row is learnt from a frame, so many times as fast: cheaper, and no slower over the frames.
const STRIPES: usize = 8;

/// Variances in squared grey levels: what is assumed at first, and the bounds.
const FIRST_VARIANCE: f32 = 25.0;
const VARIANCES: (f32, f32) = (16.0, 100.0);

/// How a room is learnt, and when a pixel is not the room's; the names are those of OpenCV's MOG2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learning {
    /// About how many frames the room remembers: each moves the mean by one part of so many. Default 500.
    pub history: u32,
    /// A pixel differs when one of its channels is farther from the mean than the square root of this many
    /// variances. Default 16: four deviations.
    pub var_threshold: f64,
    /// Whether the room in a shadow is still the room. Default true.
    pub detect_shadows: bool,
}

impl Default for Learning {
    fn default() -> Self {
        Self { history: 500, var_threshold: 16.0, detect_shadows: true }
    }
}

/// Each channel of each pixel of the room as a Gaussian, mean and variance, that follows slow changes of the light.
///
/// It is the model of Cheung, Kanade, Bouguet and Holler, *A real time system for robust 3D voxel reconstruction of
/// human motions* (CVPR 2000): learnt from empty frames, updated where a frame shows the room. What belongs to the
/// subject, and what a shadow darkens, is not learnt, so that somebody who sits still does not fade.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use ode_visual_hull::segment::{Learning, RunningGaussian, Segmenter};
///
/// let room = RgbImage::from_pixel(64, 48, Rgb([90, 140, 100]));
/// let mut segmenter = RunningGaussian::new(Learning::default())?;
/// for _ in 0..10 {
///     segmenter.learn(&room)?;
/// }
/// let mut image = room;
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
    outline: CoverageMatte,
}

/// Means and variances, channels side by side, and the room that follows from them.
#[derive(Debug, Clone, Default)]
struct Model {
    room: BackgroundBounds,
    mean: Vec<f32>,
    variance: Vec<f32>,
    /// Empty frames learnt.
    learnt: u32,
    /// The stripe of rows whose turn it is.
    stripe: usize,
    /// Whether each channel of a row may be learnt.
    is_room: Vec<u8>,
    /// The mask's bytes in a row.
    row_of_mask: Vec<u8>,
}

impl RunningGaussian {
    /// A model that has seen nothing yet: [`learn`](Self::learn) comes next.
    ///
    /// # Errors
    /// A history of no frames, a threshold that is not positive and finite.
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
            outline: CoverageMatte::default(),
        })
    }

    /// Learns from a frame of the empty room: the first ones count alike, up to the history.
    ///
    /// # Errors
    /// A frame of another size than those before, or without pixels.
    pub fn learn(&mut self, empty: &RgbImage) -> Result<()> {
        if empty.is_empty() {
            return Err(Error::argument("expected a frame of the empty room, found an image without pixels"));
        }
        if self.model.learnt == 0 {
            self.model.start_from(empty);
        } else {
            check_size(self.model.room.size, empty.dimensions())?;
        }
        let rate = 1.0 / (self.model.learnt + 1).min(self.learning.history) as f32;
        for y in 0..empty.height() as usize {
            self.model.learn_row(empty, None, y, rate, self.learning.var_threshold as f32);
        }
        self.model.learnt = self.model.learnt.saturating_add(1);
        Ok(())
    }

    /// Sets what counts as a shadow; `None`: a shadow counts as the subject.
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
    /// As the trait says; and learns from what it takes for the room.
    fn segment_packed(&mut self, image: &RgbImage, mask: &mut PackedMask) -> Result<()> {
        let Self { learning, shadows, cleanup, model, outline } = self;
        if model.learnt == 0 {
            return Err(Error::argument(
                "expected to have learnt from at least one frame of the empty room, found none; call learn first",
            ));
        }
        check_size(model.room.size, image.dimensions())?;
        model.room.differences(image, shadows.as_ref(), &mut outline.raw);
        let colours = Colours { image: image.as_raw(), background: Some(&model.room.colour) };
        outline.compute(colours, cleanup, mask);
        let rate = (STRIPES as f32 / learning.history as f32).min(1.0);
        for y in (model.stripe..image.height() as usize).step_by(STRIPES) {
            model.learn_row(image, Some(mask), y, rate, learning.var_threshold as f32);
        }
        model.stripe = (model.stripe + 1) % STRIPES;
        Ok(())
    }
}

impl Model {
    fn start_from(&mut self, empty: &RgbImage) {
        self.room = BackgroundBounds::new(empty.dimensions());
        // Everything is within the bounds.
        self.room.greatest.fill(255);
        self.mean = empty.iter().map(|&value| f32::from(value)).collect();
        self.variance = vec![FIRST_VARIANCE; self.mean.len()];
        self.is_room = vec![255; 3 * empty.width() as usize];
        self.row_of_mask = vec![0; empty.width() as usize];
    }

    /// Row `y` of `image`, where `mask`, if any, and the bounds say that it shows the room.
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
        let Self { room, mean, variance, is_room, row_of_mask, .. } = self;
        let (colour, mean) = (&mut room.colour[row.clone()], &mut mean[row.clone()]);
        let (least, greatest) = (&mut room.least[row.clone()], &mut room.greatest[row.clone()]);
        let (variance, image) = (&mut variance[row.clone()], &image.as_raw()[row]);
        match mask {
            None => is_room.fill(255),
            Some(mask) => {
                mask.write_row(y, row_of_mask);
                shows_room(image, row_of_mask, least, greatest, is_room);
            }
        }
        learn(image, is_room, mean, variance, rate);
        bound(mean, variance, threshold, colour, least, greatest);
    }
}

vectorised! {
    /// Writes 255 where a channel is within its bounds and the mask of its pixel empty, else 0.
    fn shows_room(image: &[u8], mask: &[u8], least: &[u8], greatest: &[u8], is_room: &mut [u8]) {
        for (channels, &subject) in is_room.as_chunks_mut::<3>().0.iter_mut().zip(mask) {
            *channels = [if subject == 0 { 255 } else { 0 }; 3];
        }
        let n = is_room.len();
        let (image, least, greatest) = (&image[..n], &least[..n], &greatest[..n]);
        for k in 0..n {
            is_room[k] &= if least[k] <= image[k] && image[k] <= greatest[k] { 255 } else { 0 };
        }
    }
}

vectorised! {
    /// Moves means and variances by `rate` towards what `image` shows.
    fn learn(image: &[u8], is_room: &[u8], mean: &mut [f32], variance: &mut [f32], rate: f32) {
        let n = image.len();
        let (is_room, mean, variance) = (&is_room[..n], &mut mean[..n], &mut variance[..n]);
        for k in 0..n {
            let rate = if is_room[k] != 0 { rate } else { 0.0 };
            let off = f32::from(image[k]) - mean[k];
            mean[k] += rate * off;
            variance[k] = (variance[k] + rate * (off * off - variance[k])).clamp(VARIANCES.0, VARIANCES.1);
        }
    }
}

vectorised! {
    /// Colours and bounds that follow from means and variances.
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
