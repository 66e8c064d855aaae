//! The background's colours and their noise, from images of the empty scene.

use super::difference::BackgroundBounds;
use crate::{Error, Result};
use image::RgbImage;

/// The thresholds above which a pixel counts as the subject: it must exceed all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholds {
    /// The difference of a channel from the clean plate, in grey levels.
    ///
    /// Default 20: more than four standard deviations of the difference of two images with noise of 3 grey levels
    /// each.
    pub difference: f64,
    /// The difference of a channel in standard deviations of the pixel's noise, which several images of the empty
    /// scene give. Default 4.
    pub deviations: f64,
    /// The displacement of edges in the clean plate, in pixels, whose difference is tolerated: compression, or a
    /// shaking camera. Default 0.1.
    pub edge_shift_px: f64,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self { difference: 20.0, deviations: 4.0, edge_shift_px: 0.1 }
    }
}

impl Thresholds {
    pub(super) fn check(&self) -> Result<()> {
        let Self { difference, deviations, edge_shift_px } = *self;
        let is_valid = |value: f64| value >= 0.0 && value.is_finite();
        if [difference, deviations, edge_shift_px].into_iter().all(is_valid) {
            return Ok(());
        }
        Err(Error::argument(format!(
            "expected thresholds of 0 or more, found a difference of {difference}, {deviations} deviations and an edge \
             shift of {edge_shift_px} px"
        )))
    }
}

/// The share of frames that must agree on a pixel's colour to replace the plate's.
const AGREE_SHARE: f64 = 0.9;
/// The largest distance of a channel from the median in frames that agree, in grey levels.
const AGREE_LEVELS: u8 = 12;

/// Colour and noise of each pixel of the empty scene.
#[derive(Debug, Clone)]
pub(super) struct Plate {
    size: (u32, u32),
    /// The mean of each channel.
    colours: Vec<[u8; 3]>,
    /// The standard deviation of the noisiest channel, in grey levels; zero if there is only one image.
    noise: Vec<f32>,
}

impl Plate {
    /// The mean of `frames`, which have one size; there is at least one.
    pub(super) fn mean(frames: &[RgbImage]) -> Self {
        let size = frames[0].dimensions();
        let n = frames.len() as f64;
        let pixels = 0..size.0 as usize * size.1 as usize;

        let mean_and_noise = |pixel: usize| {
            let mut noise = 0.0f64;
            let colour = [0, 1, 2].map(|c| {
                let values = frames.iter().map(|frame| f64::from(frame.as_raw()[3 * pixel + c]));
                let mean = values.clone().sum::<f64>() / n;
                let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
                noise = noise.max((squares / (n - 1.0).max(1.0)).sqrt());
                mean.round() as u8
            });
            (colour, noise as f32)
        };

        let (colours, noise) = pixels.map(mean_and_noise).unzip();
        Self { size, colours, noise }
    }

    /// Replaces the colours of pixels on which nearly all of `frames` agree by their median.
    pub(super) fn refine_with(&mut self, frames: &[RgbImage]) {
        let enough = (AGREE_SHARE * frames.len() as f64).ceil() as usize;
        let mut values = vec![0; frames.len()];
        for (pixel, colour) in self.colours.iter_mut().enumerate() {
            let median = [0, 1, 2].map(|c| {
                for (value, frame) in values.iter_mut().zip(frames) {
                    *value = frame.as_raw()[3 * pixel + c];
                }
                *values.select_nth_unstable(frames.len() / 2).1
            });

            let agrees = |frame: &&RgbImage| {
                let own = &frame.as_raw()[3 * pixel..];
                (0..3).all(|c| own[c].abs_diff(median[c]) <= AGREE_LEVELS)
            };

            if frames.iter().filter(agrees).count() >= enough {
                *colour = median;
            }
        }
    }

    /// The background, with a tolerance for each pixel.
    pub(super) fn background(&self, thresholds: &Thresholds) -> BackgroundBounds {
        let mut background = BackgroundBounds::new(self.size);
        for (pixel, (&colour, &noise)) in self.colours.iter().zip(&self.noise).enumerate() {
            let edge = thresholds.edge_shift_px * f64::from(self.steepest(pixel));
            let noise = thresholds.deviations * f64::from(noise);
            let tolerance = thresholds.difference.max(noise) + edge;
            background.set(pixel, colour, tolerance.round().min(255.0) as u8);
        }
        background
    }

    /// The largest step of a channel from a pixel to one of its four neighbours.
    fn steepest(&self, pixel: usize) -> u8 {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let (x, y) = (pixel % width, pixel / width);
        let around = [
            (x.saturating_sub(1), y),
            ((x + 1).min(width - 1), y),
            (x, y.saturating_sub(1)),
            (x, (y + 1).min(height - 1)),
        ];

        let own = self.colours[pixel];
        let steps = around.into_iter().flat_map(|(i, j)| {
            let other = self.colours[j * width + i];
            [0, 1, 2].map(|c| other[c].abs_diff(own[c]))
        });
        steps.max().unwrap_or(0)
    }
}
