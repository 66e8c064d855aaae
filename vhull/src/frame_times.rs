//! When the frames of a recording were taken.

use ode_visual_hull::Result;
use ode_visual_hull::recording::{Recording, StreamOptions};

/// Images a second where the recording does not state a rate.
pub const ASSUMED_RATE: f64 = 30.0;

/// The time of each frame that has masks, and the options to read the images with the same times.
#[derive(Debug, Clone)]
pub struct FrameTimes {
    /// In seconds, in the order of [`Recording::frames`].
    pub times: Vec<f64>,
    pub streaming: StreamOptions,
    /// Whether the times follow from [`ASSUMED_RATE`].
    pub is_assumed: bool,
}

impl FrameTimes {
    /// The times that the recording states, or those of `rate` images a second where that is given.
    pub fn of(recording: &Recording, rate: Option<f64>) -> Result<Self> {
        let streaming = StreamOptions { rate, ..StreamOptions::default() };
        if let Some(times) = recording.frame_times(&streaming)? {
            return Ok(Self { times, streaming, is_assumed: false });
        }
        Ok(Self { is_assumed: true, ..Self::of(recording, Some(ASSUMED_RATE))? })
    }

    /// Largest difference in seconds between an image and a frame that belong together: half the shortest time between
    /// two frames.
    pub fn bound(&self) -> f64 {
        let steps = self.times.windows(2).map(|pair| pair[1] - pair[0]);
        0.5 * steps.fold(1.0 / self.streaming.rate.unwrap_or(ASSUMED_RATE), f64::min)
    }
}
