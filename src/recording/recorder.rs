//! Writes a live capture as a recording, without slowing it.

mod times;
mod video_writer;
mod writer;

use super::Recording;
use crate::lock::lock;
use crate::pipeline::Captured;
use crate::rig::Rig;
use crate::silhouette::PackedMask;
use crate::source::{ImageSet, Times};
use crate::{Error, Result};
use image::RgbImage;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use writer::Writer;

/// The largest number of frames that wait to be written: a third of a second at 30 Hz, 29 MB for four cameras of
/// 640 x 480 pixels.
const DEPTH: usize = 8;

/// How a [`Recorder`] writes.
#[derive(Debug, Clone, PartialEq)]
pub struct RecorderOptions {
    /// Images per second that the videos' headers tell; the true times are in `frames.csv`. Default: 30.
    pub rate: f64,
    /// The images of the scene without the subject, one per camera. Default: none are written.
    pub backgrounds: Option<Vec<RgbImage>>,
}

impl Default for RecorderOptions {
    fn default() -> Self {
        Self { rate: 30.0, backgrounds: None }
    }
}

/// Writes what a [`Pipeline`](crate::pipeline::Pipeline) captures as a [`Recording`]: a video of each camera, the masks
/// as run lengths, and the times of the images.
///
/// A thread of its own writes. If it is slower than the capture, frames are left out and counted; the capture never
/// waits. Frames are numbered from 0 in the order in which they are written. A frame counts only with an image and a
/// mask of every camera, as everywhere in a recording: images of a video have no numbers but their positions, so that
/// a camera cannot lack one.
///
/// The recording is readable at every moment: if the program is killed, at most the last images are missing. An
/// [`error`](Self::error), such as a full disk, ends the recording; what was written before stays.
///
/// ```no_run
/// use ode_visual_hull::pipeline::Pipeline;
/// use ode_visual_hull::recording::{Recorder, RecorderOptions};
/// use ode_visual_hull::rig::Rig;
/// use ode_visual_hull::source::Synchroniser;
///
/// # fn record(rig: &Rig, sets: Synchroniser, mut pipeline: Pipeline) -> ode_visual_hull::Result<()> {
/// let mut recorder = Recorder::create("recording", rig, RecorderOptions::default())?;
/// for set in sets {
///     let captured = pipeline.publish(set?)?;
///     recorder.write(&captured);
/// }
/// let summary = recorder.finish()?;
/// println!("{} frames, {} left out", summary.frames, summary.left_out);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Recorder {
    dir: PathBuf,
    /// `None` after [`finish`](Self::finish).
    queue: Option<Sender<Shot>>,
    thread: Option<JoinHandle<()>>,
    shared: Arc<Shared>,
    left_out: u64,
    incomplete: u64,
    /// The times of the last frame's images.
    last_times: Vec<f64>,
}

/// What a finished [`Recorder`] has written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingSummary {
    /// The folder of the recording.
    pub dir: PathBuf,
    /// How many frames were written.
    pub frames: u32,
    /// How many frames were left out since writing was too slow, see [`Recorder::left_out`].
    pub left_out: u64,
    /// How many frames were left out since they lacked a camera, see [`Recorder::incomplete`].
    pub incomplete: u64,
}

/// What the writing thread tells.
#[derive(Debug, Default)]
struct Shared {
    error: Mutex<Option<Error>>,
    waiting: AtomicUsize,
    written: AtomicU32,
}

/// One frame of all cameras: a time, an image and a mask of each.
struct Shot {
    time: f64,
    times: Vec<f64>,
    images: Vec<Arc<RgbImage>>,
    masks: Vec<PackedMask>,
}

impl Recorder {
    /// Starts a recording of `rig` in folder `dir`, which is created if necessary.
    ///
    /// # Errors
    /// All errors of [`Recording::create`]; backgrounds of another number or size than the cameras; a rate that is not
    /// positive; a file that cannot be written; `ffmpeg` is not installed.
    pub fn create(dir: impl AsRef<Path>, rig: &Rig, options: RecorderOptions) -> Result<Self> {
        let dir = dir.as_ref();
        Times::Rate(options.rate).check()?;
        let recording = Recording::create(dir, rig)?;
        if let Some(backgrounds) = &options.backgrounds {
            recording.write_backgrounds(backgrounds)?;
        }

        let shared = Arc::<Shared>::default();
        let writer = Writer::new(dir, recording, options.rate)?;
        let (queue, frames) = channel();
        let thread = {
            let shared = Arc::clone(&shared);
            std::thread::Builder::new().name("writes a recording".into()).spawn(move || {
                shared.write_all(writer, &frames);
            })
        };
        let thread =
            thread.map_err(|e| Error::file(dir, format!("expected to start a thread, found: {e}")))?;

        Ok(Self {
            dir: dir.to_owned(),
            queue: Some(queue),
            thread: Some(thread),
            shared,
            left_out: 0,
            incomplete: 0,
            last_times: vec![f64::NEG_INFINITY; rig.len()],
        })
    }

    /// Writes a frame, for which it does not wait: the frame is copied, or else left out and counted.
    pub fn write(&mut self, captured: &Captured) {
        self.write_frame(&captured.images, &captured.masks);
    }

    /// As [`write`](Self::write), for images and masks that have no hull.
    pub fn write_frame(&mut self, images: &ImageSet, masks: &[Option<PackedMask>]) {
        let Some(times) = self.times_of(images, masks) else {
            self.incomplete += 1;
            return;
        };
        if self.shared.waiting.load(Ordering::Acquire) >= DEPTH || self.error().is_some() {
            self.left_out += 1;
            return;
        }

        self.last_times.clone_from(&times);
        let shot = Shot {
            time: images.time,
            times,
            images: images.images.iter().flatten().map(|frame| frame.image.clone()).collect(),
            masks: masks.iter().flatten().cloned().collect(),
        };
        self.shared.waiting.fetch_add(1, Ordering::AcqRel);
        let is_sent = self.queue.as_ref().is_some_and(|queue| queue.send(shot).is_ok());
        self.left_out += u64::from(!is_sent);
    }

    /// The times of a frame's images, if every camera has an image and a mask and its time increases.
    fn times_of(&self, images: &ImageSet, masks: &[Option<PackedMask>]) -> Option<Vec<f64>> {
        let cameras = self.last_times.len();
        if images.images.len() != cameras || masks.len() != cameras || masks.iter().any(Option::is_none) {
            return None;
        }
        let later = images.images.iter().zip(&self.last_times).map(|(frame, last)| {
            frame.as_ref().map(|frame| frame.time).filter(|time| time.is_finite() && time > last)
        });
        later.collect()
    }

    /// How many frames were left out because too many waited to be written, or writing has failed.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// How many frames were left out because they lacked a camera's image or mask, or an image's time did not
    /// increase.
    pub fn incomplete(&self) -> u64 {
        self.incomplete
    }

    /// How many frames have been written so far.
    pub fn written(&self) -> u32 {
        self.shared.written.load(Ordering::Acquire)
    }

    /// The error that has ended the recording, if any; the frames before it are kept.
    pub fn error(&self) -> Option<Error> {
        lock(&self.shared.error).clone()
    }

    /// Writes the frames that wait, and completes the files.
    ///
    /// # Errors
    /// The error that has ended the recording. The frames before it are kept.
    pub fn finish(mut self) -> Result<RecordingSummary> {
        self.close();
        match self.error() {
            Some(error) => Err(error),
            None => Ok(RecordingSummary {
                dir: std::mem::take(&mut self.dir),
                frames: self.written(),
                left_out: self.left_out,
                incomplete: self.incomplete,
            }),
        }
    }

    fn close(&mut self) {
        self.queue = None;
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            let problem = "expected to write a recording, found that its thread panicked; report this";
            lock(&self.shared.error).get_or_insert(Error::file(&self.dir, problem));
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.close();
    }
}

impl Shared {
    /// Writes the frames of the queue until it is closed or a frame cannot be written.
    fn write_all(&self, mut writer: Writer, frames: &Receiver<Shot>) {
        for shot in frames {
            let written = writer.write(&shot);
            self.waiting.fetch_sub(1, Ordering::AcqRel);
            if let Err(e) = written {
                *lock(&self.error) = Some(e);
                break;
            }
            self.written.fetch_add(1, Ordering::AcqRel);
        }

        // The files are completed in any case; the first error is the one to report.
        if let Err(e) = writer.finish() {
            lock(&self.error).get_or_insert(e);
        }
    }
}

#[cfg(test)]
mod tests;
