//! The hulls of a recording, frame by frame.

use crate::arguments::VolumeOptions;
use ode_visual_hull::hull::{Hull, HullData};
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// A recording with masks, and the data object that makes hulls of them.
pub struct RecordedHulls {
    pub recording: Recording,
    data: HullData,
}

impl RecordedHulls {
    /// Prepares to make hulls of a recording, whose folder is `dir`.
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

    /// The hull of a frame.
    pub fn hull(&self, frame: u32) -> Result<Arc<Hull>> {
        // Frames may be requested in any order, so all get the same time.
        publish_masks(&self.data, &self.recording.masks(frame)?, 0.0)
    }

    /// Checks that the frame given by `--frame` has masks.
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

    /// At most `most` of the frames, evenly spread, the first and the last among them.
    pub fn spread_frames(&self, most: usize) -> Vec<u32> {
        let frames = self.recording.frames();
        evenly_spaced(frames.len(), most).map(|k| frames[k]).collect()
    }
}

/// At most `most` of `count` positions, evenly spread, the first and the last among them.
pub fn evenly_spaced(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let chosen = count.min(most);
    (0..chosen).map(move |k| k * (count - 1) / (chosen - 1).max(1))
}
