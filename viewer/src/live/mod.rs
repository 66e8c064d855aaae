//! A live system: cameras are captured, bodies collide with the subject, and everything is drawn from anywhere, at once.
//!
//! ```text
//!   a thread per camera     images ──┐
//!   thread of the capture   ImageSet ─► masks ─► HullData, images (Captures)
//!   thread of the simulation             hull ─► step by the clock ─► bodies (WorldState)
//!   thread of the drawing    images, hull, bodies, Request ─► Picture ─► window or film
//! ```
//!
//! No thread waits for another one: each takes the latest that there is. What comes too late is counted. All of them follow
//! one [`Clock`], which the user can stop.

mod aim;
mod bodies;
mod cameras;
mod capture;
mod captures;
mod drawing;
mod empty_room;
mod info;
mod latencies;
mod latest;
mod marks;
mod messages;
mod panels;
mod priority;
mod recording;
mod rendered;
mod report;
mod request;
mod simulate;
mod stage;
mod stamped;
mod streams;
mod threads;

pub use bodies::{Bodies, Scenery};
pub use cameras::LiveCameras;
pub use drawing::Shown;
pub use messages::{Gravity, Message};
pub use report::LiveReport;
pub use request::{Marks, Request, Viewpoint};
pub use simulate::{Command, STEP_RATE};

use crate::orbit::Orbit;
use crate::picture::Method;
use crate::renderer::{Renderer, RendererKind};
use crate::scene::RealCameras;
use capture::{Capture, CaptureState};
use drawing::DrawingShared;
use messages::Messages;
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData, Motion};
use ode_visual_hull::source::{CancelHandle, Clock};
use ode_visual_hull_film::VolumeOptions;
use recording::LiveRecording;
use simulate::WorldShared;
use stage::Stage;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use streams::Streams;

/// A camera whose last image is this many seconds old does not decide any longer where the subject is.
const MAX_AGE: f64 = 0.5;

/// How a live system is set up.
#[derive(Debug, Clone)]
pub struct LiveOptions {
    /// The virtual bodies at first.
    pub bodies: Bodies,
    /// How the hull moves between images.
    pub motion: Motion,
    /// The work volume.
    pub volume: VolumeOptions,
    /// What draws.
    pub renderer: RendererKind,
    /// Whether the simulation runs before all other threads of the machine (`SCHED_FIFO`), which the user must be allowed. Otherwise
    /// some steps in a thousand are late where other threads fill all processors.
    pub is_real_time: bool,
    /// The folder to which everything is recorded, if it is.
    pub record: Option<PathBuf>,
}

/// A running live system. Dropping it ends its threads.
pub struct Live {
    clock: Clock,
    /// When it began, in seconds of the clock.
    started: f64,
    period: f64,
    pinholes: Vec<Camera>,
    home: Orbit,
    capture: Arc<CaptureState>,
    world: Arc<WorldShared>,
    drawing: Arc<DrawingShared>,
    messages: Arc<Messages>,
    commands: Sender<Command>,
    /// Of the cameras: they end a wait for an image.
    cancel_handles: Vec<CancelHandle>,
    threads: Vec<JoinHandle<()>>,
}

impl Live {
    /// Starts to capture, to simulate and to draw; `show` gets each picture, on the thread of the drawing, and returns when it
    /// is shown. Nothing is drawn before the first [`request`](Self::request).
    ///
    /// # Errors
    /// Cameras without a work volume, images of the empty room that do not fit, a GPU that is wanted and missing, real time
    /// that is not allowed, a system that cannot start threads.
    pub fn start(
        cameras: LiveCameras,
        options: &LiveOptions,
        show: impl FnMut(Shown) + Send + 'static,
    ) -> Result<Self> {
        if options.is_real_time {
            priority::check_real_time()?;
        }
        let LiveCameras { rig, sources, statuses, period, empty_room, clock } = cameras;
        let data = Arc::new(HullData::new());
        options.volume.prepare(&data, &rig)?;
        data.set_max_age(Some(MAX_AGE.max(3.0 * period)))?;

        let messages = Arc::new(Messages::default());
        let recording = options
            .record
            .as_deref()
            .map(|dir| LiveRecording::of_live(dir, &rig, period, empty_room.as_deref(), options, &messages));
        let state = Arc::new(CaptureState { recording: recording.transpose()?, ..CaptureState::default() });
        let capture = Capture::new(&rig, period, empty_room.as_deref(), &data, &clock, &state, &messages)?;
        let renderer = Renderer::open(options.renderer, Method::Blend)?;
        let stage = Stage::new(RealCameras::new(rig.cameras()));
        let (commands, received) = channel();
        let mut live = Self {
            started: clock.now(),
            period,
            pinholes: (0..rig.len()).map(|view| stage.cameras().pinhole(view).clone()).collect(),
            home: home(&rig.cameras()[0], &data, options.bodies),
            capture: state,
            world: Arc::default(),
            drawing: Arc::default(),
            messages,
            commands,
            cancel_handles: sources.iter().map(|source| source.cancel_handle()).collect(),
            threads: Vec::new(),
            clock,
        };
        if !live.capture.is_room_known.load(Ordering::Relaxed) {
            live.messages.warn("room", "no empty room is learnt: leave the cameras' sight, then press l");
        }

        live.start_capture(capture, &rig, sources, options.is_real_time)?;
        live.start_simulation(data, options, received)?;
        live.start_drawing(stage, renderer, &rig, Streams::new(&rig, statuses, period), show)?;
        Ok(live)
    }

    /// Asks for pictures of this kind from now on.
    pub fn request(&self, request: Request) {
        let were_asked = self.world.are_samples_asked.swap(request.marks.samples, Ordering::Relaxed);
        if were_asked != request.marks.samples {
            self.clock.stop(&self.capture.wakes_simulation);
        }
        self.drawing.request.put(request);
    }

    /// Does something with the bodies, at the next step.
    pub fn command(&self, command: Command) {
        // The simulation has ended if this fails, which is told already.
        let _ = self.commands.send(command);
    }

    /// Stops time, or lets it go on. Cameras that are real go on meanwhile, unseen.
    pub fn freeze(&self, frozen: bool) {
        if frozen { self.clock.pause() } else { self.clock.resume() }
    }

    /// Whether time stands still.
    pub fn is_frozen(&self) -> bool {
        self.clock.is_paused()
    }

    /// Goes on by the time from one image to the next, while time stands still.
    pub fn step_frame(&self) {
        if self.clock.is_paused() {
            self.clock.advance(self.period);
        }
    }

    /// Learns the empty room from the next images.
    pub fn learn_room(&self) {
        self.capture.is_learning_asked.store(true, Ordering::Relaxed);
    }

    /// Whether the mouse holds a body.
    pub fn is_body_held(&self) -> bool {
        self.world.is_body_held.load(Ordering::Relaxed)
    }

    /// The real cameras as pinholes.
    pub fn pinholes(&self) -> &[Camera] {
        &self.pinholes
    }

    /// A viewpoint that shows the work volume.
    pub fn home(&self) -> Orbit {
        self.home
    }

    /// The messages that are new since the last call.
    pub fn take_messages(&self) -> Vec<Message> {
        self.messages.take_new()
    }

    /// Tells something in the window and on the terminal.
    pub fn tell(&self, about: &str, text: impl std::fmt::Display) {
        self.messages.tell(about, text);
    }

    /// How fast everything was so far.
    pub fn report(&self) -> LiveReport {
        LiveReport::of(self)
    }

    /// Ends all threads; how fast everything was.
    pub fn stop(mut self) -> LiveReport {
        let report = self.report();
        self.end();
        let recording = self.capture.recording.as_ref().and_then(LiveRecording::finish);
        LiveReport { recording, ..report }
    }

    fn end(&mut self) {
        self.clock.close();
        self.cancel_handles.drain(..).for_each(|camera| camera.stop());
        for thread in self.threads.drain(..) {
            // A panic of a thread has been printed by it.
            let _ = thread.join();
        }
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.end();
    }
}

/// A viewpoint that shows a person in the middle of the work volume and the bodies beside it, from the side of the first camera.
fn home(camera: &Camera, data: &HullData, bodies: Bodies) -> Orbit {
    let middle = data.bounds().map_or_else(Point3::origin, |bounds| bounds.centre());
    let person = Aabb {
        min: Point3::new(middle.x - 0.5, middle.y - 0.5, 0.0),
        max: Point3::new(middle.x + 0.5, middle.y + 0.5, 1.8),
    };
    let azimuth = Orbit::from_eye(&camera.centre(), &middle, 1.0).azimuth;
    Orbit::around(&person.union(&bodies.extent(&person)), azimuth + 0.3)
}
