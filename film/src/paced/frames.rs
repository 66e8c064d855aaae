//! Masks that are played again and again by the wall clock.

use super::ROUNDING;
use image::GrayImage;
use ode_visual_hull::{Error, Result};

/// Frames with their times, repeated without an end.
#[derive(Debug, Clone)]
pub struct PacedFrames {
    masks: Vec<Vec<GrayImage>>,
    /// Which masks each frame of a round shows, and when in it, in seconds.
    round: Vec<(usize, f64)>,
    /// How long a round is, in seconds.
    length: f64,
}

impl PacedFrames {
    /// The `masks` of one frame after the other, `rate` of them a second, and then from the first on again.
    ///
    /// # Errors
    /// No masks; a rate that is not positive.
    pub fn in_a_loop(masks: Vec<Vec<GrayImage>>, rate: f64) -> Result<Self> {
        if rate.is_nan() || rate <= 0.0 {
            return Err(Error::argument(format!("pace: expected frames a second above 0, found {rate}")));
        }
        let round = (0..masks.len()).map(|k| (k, k as f64 / rate)).collect();
        let length = masks.len() as f64 / rate;
        Self { masks, round, length }.checked()
    }

    /// The `masks` of frames taken at `times`, in seconds, up to the last one and back to the first one, so that a subject
    /// does not jump from where it was last to where it was first.
    ///
    /// # Errors
    /// Fewer than two frames; times that do not increase, or of another number.
    pub fn to_and_fro(masks: Vec<Vec<GrayImage>>, times: &[f64]) -> Result<Self> {
        let count = masks.len();
        if count != times.len() || count < 2 {
            let found = format!("{count} frames with {} times", times.len());
            return Err(Error::argument(format!(
                "pace: expected two frames at least, with times, found {found}"
            )));
        }
        if let Some(k) = times.windows(2).position(|pair| pair[0].is_nan() || pair[0] >= pair[1]) {
            let found = format!("{} s after {} s", times[k + 1], times[k]);
            return Err(Error::argument(format!("pace: expected times that increase, found {found}")));
        }
        let length = 2.0 * (times[count - 1] - times[0]);
        let forth = (0..count).map(|k| (k, times[k] - times[0]));
        let back = (1..count - 1).rev().map(|k| (k, length - (times[k] - times[0])));
        Self { round: forth.chain(back).collect(), masks, length }.checked()
    }

    fn checked(self) -> Result<Self> {
        if self.round.is_empty() {
            return Err(Error::argument("pace: expected frames with masks, found none"));
        }
        if !self.length.is_finite() {
            return Err(Error::argument(format!("pace: expected finite times, found {} s", self.length)));
        }
        Ok(self)
    }

    /// The masks of frame number `k`, in the order of the views.
    pub fn masks(&self, k: usize) -> &[GrayImage] {
        &self.masks[self.round[k % self.round.len()].0]
    }

    /// When frame number `k` was taken, in seconds after the first one.
    pub fn time(&self, k: usize) -> f64 {
        let count = self.round.len();
        (k / count) as f64 * self.length + self.round[k % count].1
    }

    /// The time from a frame to the next one on average, in seconds.
    pub fn period(&self) -> f64 {
        self.length / self.round.len() as f64
    }

    /// The number of the last frame that was taken at `time` or before.
    pub fn last_at(&self, time: f64) -> usize {
        let rounds = ((time + ROUNDING) / self.length).floor().max(0.0);
        let within = time - rounds * self.length + ROUNDING;
        let before = self.round.partition_point(|&(_, start)| start <= within).max(1) - 1;
        rounds as usize * self.round.len() + before
    }

    /// The number of the first frame that was taken at `time` or after.
    pub fn first_at(&self, time: f64) -> usize {
        let last = self.last_at(time);
        if self.time(last) + ROUNDING < time { last + 1 } else { last }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn masks(count: usize) -> Vec<Vec<GrayImage>> {
        (0..count).map(|k| vec![GrayImage::new(k as u32 + 1, 1)]).collect()
    }

    fn shown(frames: &PacedFrames, count: usize) -> Vec<(u32, f64)> {
        (0..count).map(|k| (frames.masks(k)[0].width() - 1, frames.time(k))).collect()
    }

    #[test]
    fn frames_repeat_from_the_first_one_or_back_from_the_last_one() {
        let frames = PacedFrames::in_a_loop(masks(2), 4.0).unwrap();
        assert_eq!(shown(&frames, 5), [(0, 0.0), (1, 0.25), (0, 0.5), (1, 0.75), (0, 1.0)]);
        let frames = PacedFrames::to_and_fro(masks(3), &[5.0, 5.5, 6.5]).unwrap();
        let expected = [(0, 0.0), (1, 0.5), (2, 1.5), (1, 2.5), (0, 3.0), (1, 3.5), (2, 4.5)];
        assert_eq!(shown(&frames, 7), expected);
        assert_eq!(frames.period(), 0.75);
    }

    #[test]
    fn the_frames_around_a_time_are_those_whose_times_are_nearest_to_it() {
        let frames = PacedFrames::to_and_fro(masks(3), &[5.0, 5.5, 6.5]).unwrap();
        for k in 0..20 {
            let time = frames.time(k);
            assert_eq!((frames.last_at(time), frames.first_at(time)), (k, k));
            let between = 0.5 * (time + frames.time(k + 1));
            assert_eq!((frames.last_at(between), frames.first_at(between)), (k, k + 1));
        }
        assert_eq!(frames.last_at(-1.0), 0);
    }

    #[test]
    fn frames_without_times_or_at_no_rate_are_refused() {
        let loop_error = |count, rate| PacedFrames::in_a_loop(masks(count), rate).unwrap_err().to_string();
        assert!(loop_error(0, 30.0).contains("found none"));
        assert!(loop_error(2, 0.0).contains("frames a second above 0"));
        let error = |times: &[f64]| PacedFrames::to_and_fro(masks(2), times).unwrap_err().to_string();
        assert!(error(&[0.0]).contains("2 frames with 1 times"));
        assert!(error(&[1.0, 1.0]).contains("1 s after 1 s"));
        assert!(error(&[0.0, f64::INFINITY]).contains("finite"));
    }
}
