//! Hulls of the frames of a recording.

use crate::arguments::VolumeOptions;
use ode_visual_hull::hull::{Hull, HullData};
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// A recording with masks, and a [`HullData`] with its cameras that builds the hulls.
pub struct RecordedHulls {
    /// The recording.
    pub recording: Recording,
    data: HullData,
}

impl RecordedHulls {
    /// Prepares to build hulls of `recording`, which was opened in folder `dir`.
    ///
    /// # Errors
    /// No frame with masks; an invalid work volume.
    pub fn new(recording: Recording, dir: &Path, volume: &VolumeOptions) -> Result<Self> {
        if recording.frames().is_empty() {
            let problem = format!(
                "expected masks, found images alone; make them first: vhull segment {}",
                dir.display()
            );
            return Err(Error::file(dir, problem));
        }
        let data = HullData::new();
        volume.prepare(&data, recording.rig())?;
        Ok(Self { recording, data })
    }

    /// Reads the masks of `frame` and builds their hull.
    ///
    /// # Errors
    /// No such frame, or masks that cannot be read.
    pub fn hull(&self, frame: u32) -> Result<Arc<Hull>> {
        // Frames may be requested in any order: all get time 0, so that each replaces the one before.
        publish_masks(&self.data, &self.recording.masks(frame)?, 0.0)
    }

    /// Checks that `frame`, from `--frame`, has masks.
    ///
    /// # Errors
    /// It has none; the error names the frames that do.
    pub fn check_has(&self, frame: u32) -> Result<()> {
        let frames = self.recording.frames();
        if frames.contains(&frame) {
            return Ok(());
        }
        let (first, last) = (frames[0], frames[frames.len() - 1]);
        Err(Error::argument(format!(
            "--frame: expected one of the {} frames with masks from {first} to {last}, found {frame}",
            frames.len()
        )))
    }

    /// At most `max_count` frames, evenly spread from the first to the last.
    pub fn spread_frames(&self, max_count: usize) -> Vec<u32> {
        let frames = self.recording.frames();
        evenly_spaced(frames.len(), max_count).map(|k| frames[k]).collect()
    }
}

/// At most `max_count` of the indices below `count`, evenly spread from the first to the last.
pub(super) fn evenly_spaced(count: usize, max_count: usize) -> impl Iterator<Item = usize> {
    let chosen = count.min(max_count);
    (0..chosen).map(move |k| k * (count - 1) / (chosen - 1).max(1))
}
