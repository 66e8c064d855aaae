//! The files of a recording that is being written.

use super::Shot;
use super::times::TimesTable;
use super::video_writer::VideoWriter;
use crate::recording::{Recording, streams};
use crate::{Error, Result};
use std::path::Path;

/// Writes frames, on the thread that calls it.
#[derive(Debug)]
pub(super) struct Writer {
    recording: Recording,
    times: TimesTable,
    /// One per camera.
    videos: Vec<VideoWriter>,
    frames: u32,
}

impl Writer {
    /// Starts the files of `recording`, a new one in folder `dir`, with videos of `rate` images per second.
    ///
    /// # Errors
    /// A file that exists already or cannot be written; `ffmpeg` is not installed.
    pub(super) fn new(dir: &Path, recording: Recording, rate: f64) -> Result<Self> {
        let rig = recording.rig();
        let times = TimesTable::create(dir, rig)?;
        let video = |camera: &crate::camera::Camera| {
            let path = streams::video_path(dir, camera.name());
            VideoWriter::start(&path, camera.size(), rate).map_err(|e| Error::view(camera.name(), e))
        };
        let videos = rig.cameras().iter().map(video).collect::<Result<_>>()?;
        Ok(Self { recording, times, videos, frames: 0 })
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// An image or a mask of another size than its camera; a file that cannot be written.
    pub(super) fn write(&mut self, shot: &Shot) -> Result<()> {
        self.recording.check_sizes("images", shot.images.iter().map(|image| image.dimensions()))?;

        // An image without a time would make the recording unreadable, a time without an image does not.
        self.times.add(self.frames, shot.time, &shot.times)?;
        self.recording.write_packed_masks(self.frames, &shot.masks)?;
        for (camera, (video, image)) in self.videos.iter_mut().zip(&shot.images).enumerate() {
            video.write(image).map_err(|e| Error::view(self.recording.name(camera), e))?;
        }
        self.frames += 1;
        Ok(())
    }

    /// Completes the files.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn finish(mut self) -> Result<()> {
        let mut first = Ok(());
        for (camera, video) in self.videos.iter_mut().enumerate() {
            let finished = video.finish().map_err(|e| Error::view(self.recording.name(camera), e));
            first = first.and(finished);
        }
        first
    }
}
