//! The threads of a live system, and what each starts with.

use super::capture::Capture;
use super::drawing::Drawing;
use super::info::Info;
use super::priority::{Work, run_in_real_time};
use super::simulate::{Command, Simulating};
use super::stage::Stage;
use super::streams::Streams;
use super::{Live, LiveOptions, Shown};
use crate::history::History;
use crate::renderer::Renderer;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::{ReadAhead, Source, Synchroniser, WhenFull};
use ode_visual_hull::{Error, Result};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Duration;

/// Images of a camera that wait for the capture.
const QUEUE: usize = 3;

/// Periods for which the images of some cameras wait for those of the others.
const PATIENCE: f64 = 1.5;

impl Live {
    /// Starts a thread for each camera, and the one that captures.
    pub(super) fn start_capture(
        &mut self,
        capture: Capture,
        rig: &Rig,
        sources: Vec<Box<dyn Source>>,
        is_real_time: bool,
    ) -> Result<()> {
        let streams = rig.cameras().iter().zip(sources);
        let streams = streams
            .map(|(camera, source)| ReadAhead::spawn(camera.name(), source, QUEUE, WhenFull::DropOldest));
        let mut sets = Synchroniser::new(streams.collect::<Result<_>>()?, 0.5 * self.period)?;
        sets.set_patience(Some(Duration::from_secs_f64(PATIENCE * self.period)));
        self.spawn("capture", move || {
            let work = if is_real_time { Work::CaptureBesideRealTime } else { Work::Capture };
            work.set_priority();
            capture.run(sets);
        })
    }

    /// Starts the thread that simulates and obeys the `commands`.
    pub(super) fn start_simulation(
        &mut self,
        data: Arc<HullData>,
        options: &LiveOptions,
        commands: Receiver<Command>,
    ) -> Result<()> {
        let simulating = Simulating {
            data,
            motion: options.motion,
            bodies: options.bodies,
            clock: self.clock.clone(),
            commands,
            captures: self.capture.clone(),
            shared: self.world.clone(),
            messages: self.messages.clone(),
        };
        let messages = self.messages.clone();
        let is_real_time = options.is_real_time;
        self.spawn("simulation", move || {
            let prepared = if is_real_time { run_in_real_time() } else { Ok(()) };
            if let Err(error) = prepared.and_then(|()| simulating.run()) {
                messages.fail("simulation", &error);
            }
        })
    }

    /// Starts the thread that draws, and those that help it.
    pub(super) fn start_drawing(
        &mut self,
        stage: Stage,
        renderer: Renderer,
        rig: &Rig,
        streams: Streams,
        mut show: impl FnMut(Shown) + Send + 'static,
    ) -> Result<()> {
        let drawing = Drawing {
            stage,
            renderer,
            capture: self.capture.clone(),
            world: self.world.clone(),
            shared: self.drawing.clone(),
            info: Info::new(rig, &self.capture, &self.world, &self.drawing),
            streams,
            messages: self.messages.clone(),
            clock: self.clock.clone(),
            history: History::default(),
        };
        let workers = rayon::ThreadPoolBuilder::new().thread_name(|k| format!("draws {k}"));
        let workers = workers.start_handler(|_| Work::Drawing.set_priority()).build();
        let workers =
            workers.map_err(|e| Error::argument(format!("expected to start threads, found: {e}")))?;
        self.spawn("drawing", move || {
            Work::Drawing.set_priority();
            workers.install(|| drawing.run(&mut show));
        })
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> Result<()> {
        let thread = std::thread::Builder::new().name(name.into()).spawn(work);
        let thread = thread.map_err(|e| {
            Error::argument(format!("expected to start the thread of the {name}, found: {e}"))
        })?;
        self.threads.push(thread);
        Ok(())
    }
}
