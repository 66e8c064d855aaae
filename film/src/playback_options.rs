//! How a recording is played.

use crate::arguments::VolumeOptions;
use std::ops::Range;

/// What of a recording is played, and how.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlaybackOptions {
    /// The numbers of the frames; all by default.
    pub frames: Option<Range<u32>>,
    /// Images a second; by default as the recording says, else [`ASSUMED_RATE`](crate::ASSUMED_RATE).
    pub rate: Option<f64>,
    /// Seconds for which the first frame is held.
    pub wait: f64,
    /// Seconds for which the last frame is held.
    pub linger: f64,
    /// Where the subject is.
    pub volume: VolumeOptions,
}
