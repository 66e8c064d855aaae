//! The recording of a live system: images, masks, and the states of the bodies.

use super::LiveOptions;
use super::messages::Messages;
use super::simulate::all_bodies;
use image::RgbImage;
use ode_visual_hull::pipeline::Captured;
use ode_visual_hull::recording::{Recorder, RecorderOptions, RecordingSummary};
use ode_visual_hull::rig::Rig;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{
    BodiesFile, PlaybackOptions, PlayedRecording, State, States, StatesWriter, VolumeOptions,
};
use std::path::Path;
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
    /// Begins a recording of the cameras of `rig` in folder `dir`, with what is needed to draw it again.
    ///
    /// # Errors
    /// As [`Recorder::create`].
    pub fn of_live(
        dir: &Path,
        rig: &Rig,
        period: f64,
        empty_room: Option<&[Vec<RgbImage>]>,
        options: &LiveOptions,
        messages: &Arc<Messages>,
    ) -> Result<Self> {
        let first =
            |room: &[Vec<RgbImage>]| room.iter().filter_map(|images| images.first().cloned()).collect();
        let backgrounds = empty_room.map(first);
        let recorder = Recorder::create(dir, rig, RecorderOptions { rate: 1.0 / period, backgrounds })?;
        let states = StatesWriter::create(dir.join(States::NAME))?;
        bodies_file(rig, options)?.write(dir.join(BodiesFile::NAME))?;
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

/// What the bodies look like, and how the recording is played so that each was where its state says.
fn bodies_file(rig: &Rig, options: &LiveOptions) -> Result<BodiesFile> {
    let volume = VolumeOptions { bounds: Some(options.volume.of(rig)?), ..options.volume };
    let played = PlaybackOptions { volume, ..PlaybackOptions::default() };
    Ok(BodiesFile {
        bodies: all_bodies(&options.bodies).into_iter().map(|part| vec![part]).collect(),
        fixed: Vec::new(),
        playback: Some(PlayedRecording { options: played, motion: options.motion }),
    })
}
