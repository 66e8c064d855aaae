//! The thread that captures: groups the images of the cameras, segments them and publishes the hull.

use super::captures::Captures;
use super::empty_room::EmptyRoom;
use super::messages::Messages;
use super::recording::LiveRecording;
use image::{GrayImage, RgbImage};
use ode_visual_hull::Result;
use ode_visual_hull::hull::{Hull, HullData};
use ode_visual_hull::pipeline::{Captured, Pipeline};
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::{Clock, ImageSet, Synchroniser};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// A set of images this many periods old is dropped, so that the next ones are not late too.
const OLDEST: f64 = 2.0;

/// What became of the images so far.
#[derive(Debug, Default)]
pub struct CaptureTally {
    /// Sets of images whose hull was published.
    pub published: AtomicU64,
    /// Of these, sets without the image of some camera.
    pub incomplete: AtomicU64,
    /// Sets that came too late to be segmented, or after a later one.
    pub dropped: AtomicU64,
}

/// What the thread shares with others.
#[derive(Default)]
pub struct CaptureState {
    /// The captures of the last moments.
    pub captures: Captures,
    /// What became of the images.
    pub tally: CaptureTally,
    /// Set by a key: the room is empty now, and is learnt.
    pub is_learning_asked: AtomicBool,
    /// Whether the empty room is known.
    pub is_room_known: AtomicBool,
    /// Ends the simulation's wait for its next step: there is a new hull, or a state is asked for while time stands still.
    pub wakes_simulation: AtomicBool,
    /// The recording of what is captured, if there is one.
    pub recording: Option<LiveRecording>,
}

/// The capture of a rig of cameras.
pub struct Capture {
    rig: Rig,
    period: f64,
    data: Arc<HullData>,
    clock: Clock,
    state: Arc<CaptureState>,
    messages: Arc<Messages>,
    room: EmptyRoom,
    /// The time of the last set.
    last_time: f64,
    /// `None` until the empty room is known.
    pipeline: Option<Pipeline>,
}

impl Capture {
    /// A capture of the cameras of `rig`, which `data` has as its views. The room is learnt where it is `None`.
    ///
    /// # Errors
    /// Images of the empty room of another size than the cameras'.
    pub fn new(
        rig: &Rig,
        period: f64,
        empty_room: Option<&[Vec<RgbImage>]>,
        data: &Arc<HullData>,
        clock: &Clock,
        state: &Arc<CaptureState>,
        messages: &Arc<Messages>,
    ) -> Result<Self> {
        let mut capture = Self {
            rig: rig.clone(),
            period,
            data: data.clone(),
            clock: clock.clone(),
            state: state.clone(),
            messages: messages.clone(),
            room: EmptyRoom::default(),
            last_time: 0.0,
            pipeline: None,
        };
        capture.publish_nothing(0.0)?;
        if let Some(images) = empty_room {
            capture.segment_against(images)?;
        }
        Ok(capture)
    }

    /// Captures until the clock is closed.
    pub fn run(mut self, sets: Synchroniser) {
        for set in sets {
            if self.clock.is_closed() {
                return;
            }
            match set.and_then(|set| self.take(set)) {
                Ok(()) => {}
                Err(error) => self.messages.warn("capture", &error),
            }
        }
        if !self.clock.is_closed() {
            self.messages.warn("capture", "all cameras have ended");
        }
    }

    fn take(&mut self, set: ImageSet) -> Result<()> {
        let is_old = self.clock.now() - set.time > OLDEST * self.period && !self.room.is_learning();
        // Images that arrive in bursts make sets of a few cameras, whose mean time may be before that of the last set.
        if is_old || set.time < self.last_time {
            self.state.tally.dropped.fetch_add(1, Ordering::Relaxed);
            return Ok(());
        }
        if self.state.is_learning_asked.swap(false, Ordering::Relaxed) {
            self.room.start();
            self.messages.tell("room", "learning the empty room: stay out of the cameras' sight");
        }

        self.last_time = set.time;
        let incomplete = u64::from(!set.is_complete());
        let captured = self.captured(set)?;
        if !self.clock.is_paused() {
            self.clock.stop(&self.state.wakes_simulation);
        }
        let tally = &self.state.tally;
        tally.published.fetch_add(1, Ordering::Relaxed);
        tally.incomplete.fetch_add(incomplete, Ordering::Relaxed);
        if let Some(recording) = &self.state.recording {
            recording.write(&captured);
        }
        self.state.captures.push(Arc::new(captured));
        Ok(())
    }

    fn captured(&mut self, set: ImageSet) -> Result<Captured> {
        if self.room.is_learning() {
            if let Some(images) = self.room.add(&set) {
                self.segment_against(&images)?;
                self.messages.tell("room", "the empty room is learnt");
            }
        } else if let Some(pipeline) = &mut self.pipeline {
            return pipeline.publish(set);
        }
        let hull = self.publish_nothing(set.time)?;
        Ok(Captured { masks: vec![None; set.images.len()], images: set, hull })
    }

    /// Segments against these images of the empty room from now on.
    fn segment_against(&mut self, images: &[Vec<RgbImage>]) -> Result<()> {
        let segmenters = super::empty_room::segmenters(&self.rig, images)?;
        self.pipeline = Some(Pipeline::new(segmenters, self.data.clone())?);
        self.state.is_room_known.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// Publishes a hull without a subject.
    fn publish_nothing(&self, time: f64) -> Result<Arc<Hull>> {
        for (view, camera) in self.rig.cameras().iter().enumerate() {
            let (width, height) = camera.size();
            self.data.set_mask_at(view, &GrayImage::new(width, height), time)?;
        }
        self.data.update(time)
    }
}
