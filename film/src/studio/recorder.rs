//! Writes what the cameras of a studio see as a recording.

use crate::arguments::VolumeOptions;
use crate::playback_options::PlaybackOptions;
use crate::recorded::FramesCsv;
use image::RgbImage;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::silhouette::PackedMask;
use ode_visual_hull::{Error, Result};
use std::ops::Range;
use std::path::Path;

/// A recording that is being written.
pub(super) struct Recorder {
    recording: Recording,
    times: FramesCsv,
    bounds: Aabb,
    /// The numbers of the frames so far.
    frames: Range<u32>,
}

impl Recorder {
    /// Begins a recording in folder `dir`, with the images of the empty room.
    pub(super) fn new(dir: &Path, cameras: &[Camera], plates: &[RgbImage], bounds: Aabb) -> Result<Self> {
        let recording = Recording::create(dir, &Rig::new(cameras.to_vec())?)?;
        recording.write_backgrounds(plates)?;
        let times = FramesCsv::open(dir, None)?.ok_or_else(|| {
            Error::file(dir, "expected no frames.csv of another recording, found one; choose another folder")
        })?;
        Ok(Self { recording, times, bounds, frames: 0..0 })
    }

    /// Adds frame number `frame`, which follows the one before, taken at `time` seconds.
    pub(super) fn add(
        &mut self,
        frame: u32,
        time: f64,
        images: &[RgbImage],
        masks: &[PackedMask],
    ) -> Result<()> {
        self.recording.write_images(frame, images)?;
        self.recording.write_packed_masks(frame, masks)?;
        self.times.add(frame, time)?;
        let first = if self.frames.is_empty() { frame } else { self.frames.start };
        self.frames = first..frame + 1;
        Ok(())
    }

    /// How to play it so that each frame is shown when it was in the studio.
    pub(super) fn playback(&self) -> PlaybackOptions {
        PlaybackOptions {
            frames: Some(self.frames.clone()),
            volume: VolumeOptions { bounds: Some(self.bounds), ..VolumeOptions::default() },
            ..PlaybackOptions::default()
        }
    }
}
