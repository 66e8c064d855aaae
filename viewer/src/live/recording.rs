//! The recording of a live system: images, masks, and the states of the bodies.

use super::messages::Messages;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::pipeline::Captured;
use ode_visual_hull::recording::{Recorder, RecorderOptions, RecordingSummary};
use ode_visual_hull::rig::Rig;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{
    BodiesFile, DrawnPart, PlaybackOptions, PlayedRecording, State, States, StatesWriter, VolumeOptions,
};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Entries of the states a second.
const STATES_RATE: f64 = 30.0;

/// Writes what is captured, and the bodies at the same times. An error ends it and is told; what was written before stays.
pub struct LiveRecording {
    messages: Arc<Messages>,
    writing: Mutex<Option<Writing>>,
}

struct Writing {
    recorder: Recorder,
    states: StatesWriter,
    /// The time of the first frame, in seconds of the clock: that of the recording begins there.
    start: Option<f64>,
    /// When the states are written next.
    next: f64,
}

impl LiveRecording {
    /// Begins a recording in folder `dir`.
    ///
    /// # Errors
    /// As [`Recorder::create`].
    pub fn create(dir: &Path, rig: &Rig, options: RecorderOptions, messages: &Arc<Messages>) -> Result<Self> {
        let recorder = Recorder::create(dir, rig, options)?;
        let states = StatesWriter::create(dir.join(States::NAME))?;
        let writing = Writing { recorder, states, start: None, next: f64::NEG_INFINITY };
        Ok(Self { messages: messages.clone(), writing: Mutex::new(Some(writing)) })
    }

    /// Writes a capture, without waiting for the disk.
    pub fn write(&self, captured: &Captured) {
        let mut writing = self.lock();
        let Some(open) = writing.as_mut() else { return };
        // Before the empty room is learnt there are no masks.
        if captured.masks.iter().all(Option::is_none) {
            return;
        }
        open.recorder.write(captured);
        open.start.get_or_insert(captured.images.time);
        let failed = open.recorder.error();
        self.end_if_failed(writing, failed);
    }

    /// Writes the states of the bodies at `time`, in seconds of the clock, if that is due.
    pub fn write_states(&self, time: f64, states: impl FnOnce() -> Vec<State>) {
        let mut writing = self.lock();
        let Some(open) = writing.as_mut() else { return };
        let Some(start) = open.start.filter(|start| time > start + 1.0 / STATES_RATE && time >= open.next)
        else {
            return;
        };
        open.next = time + 0.99 / STATES_RATE;
        let failed = open.states.add(time - start, &states()).err();
        self.end_if_failed(writing, failed);
    }

    /// Ends the recording; what was written. `None` if it has failed before, which was told then.
    pub fn finish(&self) -> Option<RecordingSummary> {
        let writing = self.lock().take()?;
        match writing.recorder.finish() {
            Ok(summary) => Some(summary),
            Err(error) => {
                self.messages.fail("recording", &error);
                None
            }
        }
    }

    fn end_if_failed(&self, mut writing: MutexGuard<'_, Option<Writing>>, failed: Option<Error>) {
        let Some(error) = failed else { return };
        let frames = writing.take().map_or(0, |open| open.recorder.written());
        self.messages
            .fail("recording", format!("{error}; it has ended, and its first {frames} frames are kept"));
    }

    fn lock(&self) -> MutexGuard<'_, Option<Writing>> {
        self.writing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Writes what the bodies of a recording in folder `dir` look like, and how it is played so that each was where its state says.
///
/// # Errors
/// A file that cannot be written.
pub fn write_bodies(
    dir: &Path,
    parts: Vec<DrawnPart>,
    volume: VolumeOptions,
    motion: Motion,
) -> Result<PathBuf> {
    let options = PlaybackOptions { volume, ..PlaybackOptions::default() };
    let file = BodiesFile {
        bodies: parts.into_iter().map(|part| vec![part]).collect(),
        fixed: Vec::new(),
        playback: Some(PlayedRecording { options, motion }),
    };
    let path = dir.join(BodiesFile::NAME);
    file.write(&path)?;
    Ok(path)
}
