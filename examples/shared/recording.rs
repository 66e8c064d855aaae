//! A recording of a real subject in place of the synthetic person.

use clap::Args;
use ode_visual_hull::Result;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::recording::Recording;
use ode_visual_hull_film::{ASSUMED_RATE, Playback, PlaybackOptions, VolumeOptions, parse_rate};
use std::path::{Path, PathBuf};

/// Seconds for which the last frame of a film is held.
const LINGER: f64 = 1.0;

/// The options of a recording.
#[derive(Debug, Args)]
#[command(next_help_heading = "Recording")]
pub struct RecordingArguments {
    /// Folder of a recording with masks, whose subject takes the place of the synthetic person.
    #[arg(long, value_name = "DIR", conflicts_with = "record")]
    pub recording: Option<PathBuf>,
    /// Recorded images a second [default: as frames.csv or the videos say; of a film, else 30].
    #[arg(long, value_name = "RATE", value_parser = parse_rate, requires = "recording")]
    pub rate: Option<f64>,
    #[command(flatten)]
    pub volume: VolumeOptions,
}

impl RecordingArguments {
    /// The recording in folder `dir` as a capture whose first frame is shown for `wait` seconds.
    pub fn playback(&self, dir: &Path, wait: f64, data: &HullData) -> Result<Playback> {
        let options = PlaybackOptions {
            rate: self.rate,
            wait,
            linger: LINGER,
            volume: self.volume,
            ..PlaybackOptions::default()
        };
        let playback = Playback::new(Recording::open(dir)?, dir, &options, data)?;
        if playback.is_rate_assumed() && playback.pace().0 > 1 {
            eprintln!(
                "note: the recording states no times; {ASSUMED_RATE} images a second are assumed, else give --rate"
            );
        }
        Ok(playback)
    }
}
