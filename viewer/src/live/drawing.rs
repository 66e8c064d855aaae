//! The thread that draws: the latest scene from where the window asks for it.

use super::capture::CaptureState;
use super::info::Info;
use super::latencies::Latencies;
use super::latest::Latest;
use super::messages::Messages;
use super::request::Request;
use super::simulate::{WorldShared, WorldState};
use super::stage::Stage;
use super::streams::Streams;
use super::{marks, panels};
use crate::history::History;
use crate::picture::Picture;
use crate::renderer::Renderer;
use image::RgbImage;
use image::imageops::{FilterType, resize};
use ode_visual_hull::Result;
use ode_visual_hull::source::Clock;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// How long the thread waits for something new before it looks again.
const PATIENCE: Duration = Duration::from_millis(20);

/// What the thread shares with others.
#[derive(Debug, Default)]
pub struct DrawingShared {
    /// The picture that is asked for.
    pub request: Latest<Request>,
    /// From the time of the images to the picture that shows them.
    pub to_pixel: Latencies,
    /// The time from picture to picture, in seconds.
    pub intervals: Latencies,
    /// Pictures of a scene so far.
    pub pictures: AtomicU64,
}

/// A picture for the window.
#[derive(Debug, Clone)]
pub struct Shown {
    /// Its colours, in the size that was asked for.
    pub picture: RgbImage,
    /// When its images were taken, in seconds of the clock; `None` before the first.
    pub captured: Option<f64>,
}

/// The thread's own.
pub struct Drawing {
    pub(super) stage: Stage,
    pub(super) renderer: Renderer,
    pub(super) capture: Arc<CaptureState>,
    pub(super) world: Arc<WorldShared>,
    pub(super) shared: Arc<DrawingShared>,
    pub(super) info: Info,
    pub(super) streams: Streams,
    pub(super) messages: Arc<Messages>,
    pub(super) clock: Clock,
    pub(super) history: History,
}

impl Drawing {
    /// Draws until the clock is closed, and hands each picture to `show`, which returns when it is shown.
    pub fn run(mut self, show: &mut dyn FnMut(Shown)) {
        let (mut last, mut last_end) = (None, None);
        while !self.clock.is_closed() {
            let (request_number, request) = self.shared.request.get();
            let (step, world) = self.world.latest.get();
            let Some(request) = request else {
                self.shared.request.wait_for_other(request_number, PATIENCE);
                continue;
            };
            let is_drawn = last == Some((request_number, step)) && self.clock.is_paused();
            // A window that is minimised may have no pixels.
            if is_drawn || request.size.0 == 0 || request.size.1 == 0 {
                self.shared.request.wait_for_other(request_number, PATIENCE);
                continue;
            }
            last = Some((request_number, step));
            self.streams.tell_changes(&self.messages);

            match self.picture(&request, world.as_deref()) {
                Ok(shown) => {
                    let captured = shown.captured;
                    show(shown);
                    match captured {
                        Some(captured) => self.count(captured, &mut last_end),
                        // There is nothing to see yet.
                        None => self.shared.request.wait_for_other(request_number, PATIENCE),
                    }
                }
                Err(error) => {
                    self.messages.warn("picture", &error);
                    self.shared.request.wait_for_other(request_number, PATIENCE);
                }
            }
        }
    }

    fn count(&self, captured: f64, last_end: &mut Option<f64>) {
        let now = self.clock.now();
        self.shared.pictures.fetch_add(1, Ordering::Relaxed);
        if self.clock.is_paused() {
            *last_end = None;
            return;
        }
        self.shared.to_pixel.add(now - captured);
        if let Some(last) = last_end.replace(now) {
            self.shared.intervals.add(now - last);
        }
    }

    fn picture(&mut self, request: &Request, world: Option<&WorldState>) -> Result<Shown> {
        self.stage.show(&self.capture.captures, world)?;
        let camera = request.camera(|view| self.stage.cameras().pinhole(view))?;
        let Some((captured, scene)) = self.stage.shown() else {
            let mut picture = RgbImage::new(request.size.0, request.size.1);
            panels::draw(&mut picture, request, &self.info.lines(None), &self.messages.shown());
            return Ok(Shown { picture, captured: None });
        };

        let options = request.draw_options();
        let drawn = self.renderer.draw(scene, &camera, &options);
        let mut picture = match drawn {
            Err(error) if !matches!(self.renderer, Renderer::Cpu) => {
                self.messages.fail("GPU", format!("{error}; drawn by the processor from now on"));
                self.renderer = Renderer::Cpu;
                self.renderer.draw(scene, &camera, &options)?
            }
            drawn => drawn?,
        };
        // While time stands still the images have the noise of one moment.
        if !self.clock.is_paused() {
            self.history.steady(&mut picture, &camera);
        }
        marks::draw(&mut picture, &camera, request, scene, world, self.stage.cameras());
        let time = captured.images.time;
        let mut picture = enlarged(picture, request);
        panels::draw(&mut picture, request, &self.info.lines(Some(scene)), &self.messages.shown());
        Ok(Shown { picture, captured: Some(time) })
    }
}

/// The picture in the size that was asked for.
fn enlarged(picture: Picture, request: &Request) -> RgbImage {
    if picture.colour.dimensions() == request.size {
        return picture.colour;
    }
    let (width, height) = request.size;
    resize(&picture.colour, width, height, FilterType::Nearest)
}
