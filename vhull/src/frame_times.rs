//! When the frames of a recording were taken.

use ode_visual_hull::Result;
use ode_visual_hull::recording::{Recording, StreamOptions};

/// Images a second where nothing tells.
pub const ASSUMED_RATE: f64 = 30.0;

/// When each frame that has masks was taken, and how to read the images on the same clock.
#[derive(Debug, Clone)]
pub struct FrameTimes {
    /// In seconds, as [`Recording::frames`] has them.
    pub times: Vec<f64>,
    pub streaming: StreamOptions,
    /// Nothing told the rate.
    pub is_assumed: bool,
}

impl FrameTimes {
    /// As the recording tells, or with `rate` images a second where that is given.
    pub fn of(recording: &Recording, rate: Option<f64>) -> Result<Self> {
        let streaming = StreamOptions { rate, ..StreamOptions::default() };
        if let Some(times) = recording.frame_times(&streaming)? {
            return Ok(Self { times, streaming, is_assumed: false });
        }
        Ok(Self { is_assumed: true, ..Self::of(recording, Some(ASSUMED_RATE))? })
    }

    /// Within how many seconds an image is of a frame's time: half the shortest time from one frame to the next.
    pub fn bound(&self) -> f64 {
        let steps = self.times.windows(2).map(|pair| pair[1] - pair[0]);
        0.5 * steps.fold(1.0 / self.streaming.rate.unwrap_or(ASSUMED_RATE), f64::min)
    }
}
