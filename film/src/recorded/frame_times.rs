//! Capture times of a recording's frames.

use ode_visual_hull::Result;
use ode_visual_hull::recording::{Recording, StreamOptions};

/// Images per second, assumed where neither the recording nor an option gives a rate.
pub const ASSUMED_RATE: f64 = 30.0;

/// Capture times of the frames with masks, and the options with which images get times on the same clock.
#[derive(Debug, Clone)]
pub struct FrameTimes {
    /// In seconds, one for each of [`Recording::frames`].
    pub times: Vec<f64>,
    /// Options to open the recording's images with.
    pub streaming: StreamOptions,
    /// Whether the times rest on [`ASSUMED_RATE`].
    pub is_assumed: bool,
}

impl FrameTimes {
    /// Reads the times of the recording; a given `rate`, in images per second, takes precedence.
    ///
    /// # Errors
    /// Times that cannot be read, or a camera's video that cannot be opened.
    pub fn of(recording: &Recording, rate: Option<f64>) -> Result<Self> {
        let streaming = StreamOptions { rate, ..StreamOptions::default() };
        if let Some(times) = recording.frame_times(&streaming)? {
            return Ok(Self { times, streaming, is_assumed: false });
        }
        Ok(Self { is_assumed: true, ..Self::of(recording, Some(ASSUMED_RATE))? })
    }

    /// Greatest difference in seconds between an image and its frame: half the shortest step between frames.
    pub fn bound(&self) -> f64 {
        let steps = self.times.windows(2).map(|pair| pair[1] - pair[0]);
        0.5 * steps.fold(1.0 / self.streaming.rate.unwrap_or(ASSUMED_RATE), f64::min)
    }
}
