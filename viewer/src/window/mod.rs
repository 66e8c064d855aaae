//! The window of a live system.

mod controls;
mod keys;
mod screen;

pub use controls::{Action, Button, Controls, Input};
pub use keys::{KEYS, Key};

use crate::live::{Live, LiveReport, Shown};
use crate::picture::Method;
use image::RgbImage;
use ode_visual_hull::{Error, Result};
use screen::Screen;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::keyboard::{Key as WinitKey, NamedKey};
use winit::window::{Window, WindowId};

/// How often the viewpoint moves on while it flies.
const TICK: Duration = Duration::from_millis(15);

/// Pixels of the wheel that are a notch, where the system counts pixels.
const PIXELS_PER_NOTCH: f64 = 40.0;

/// How the window is opened.
#[derive(Debug, Clone)]
pub struct WindowOptions {
    /// Width and height in pixels at first.
    pub size: (u32, u32),
    /// How the subject is drawn at first.
    pub method: Method,
    /// See [`DrawOptions::refine`](crate::DrawOptions::refine).
    pub refine: bool,
    /// Seconds after which the window closes by itself.
    pub seconds: Option<f64>,
    /// Set from outside when the window has to close.
    pub is_ended: Arc<AtomicBool>,
}

/// An open window before its system runs: pictures are sent to it.
pub struct OpenWindow {
    events: EventLoop<PictureDrawn>,
    picture: Arc<Mutex<Option<RgbImage>>>,
}

/// A picture waits to be shown.
#[derive(Debug, Clone, Copy)]
struct PictureDrawn;

impl OpenWindow {
    /// Connects to the display.
    ///
    /// # Errors
    /// No display.
    pub fn new() -> Result<Self> {
        let events = EventLoop::with_user_event().build().map_err(|_| no_display())?;
        Ok(Self { events, picture: Arc::default() })
    }

    /// What takes pictures of a [`Live`] for the window.
    pub fn sink(&self) -> impl FnMut(Shown) + Send + 'static {
        let (proxy, place): (EventLoopProxy<PictureDrawn>, _) =
            (self.events.create_proxy(), self.picture.clone());
        move |shown: Shown| {
            *place.lock().unwrap_or_else(PoisonError::into_inner) = Some(shown.picture);
            // A window that has closed needs none.
            let _ = proxy.send_event(PictureDrawn);
        }
    }

    /// Shows `live` until the window is closed. `tell` gets each message.
    ///
    /// # Errors
    /// A window that cannot be opened, a display that is lost.
    pub fn run(
        self,
        live: Live,
        options: &WindowOptions,
        tell: &mut dyn FnMut(&crate::live::Message),
    ) -> Result<LiveReport> {
        let pinholes = live.pinholes().to_vec();
        let controls = Controls::new(pinholes, live.home(), options.size, options.method, options.refine);
        let mut application = Application {
            live,
            controls,
            options: options.clone(),
            picture: self.picture,
            latest: None,
            screen: None,
            last_tick: Instant::now(),
            started: Instant::now(),
            pictures_taken: 0,
            tell,
            failed: None,
        };
        application.live.request(application.controls.request());
        self.events.run_app(&mut application).map_err(|e| lost(&e))?;
        let Application { live, failed, .. } = application;
        let report = live.stop();
        failed.map_or(Ok(report), Err)
    }
}

fn no_display() -> Error {
    let set =
        ["WAYLAND_DISPLAY", "DISPLAY"].into_iter().find_map(|name| Some((name, std::env::var(name).ok()?)));
    let found = match set {
        Some((name, value)) => format!("none that answers at {name}={value}"),
        None => "none, since neither DISPLAY nor WAYLAND_DISPLAY is set".into(),
    };
    Error::argument(format!(
        "window: expected a display, found {found}; log in to a desktop, start it under xvfb-run, or use --headless"
    ))
}

fn lost(found: &dyn std::fmt::Display) -> Error {
    Error::argument(format!("window: expected a display that stays, found: {found}"))
}

struct Application<'t> {
    live: Live,
    controls: Controls,
    options: WindowOptions,
    /// The picture that waits to be shown.
    picture: Arc<Mutex<Option<RgbImage>>>,
    /// The one that is shown.
    latest: Option<RgbImage>,
    screen: Option<Screen>,
    last_tick: Instant,
    started: Instant,
    pictures_taken: u32,
    tell: &'t mut dyn FnMut(&crate::live::Message),
    failed: Option<Error>,
}

impl Application<'_> {
    fn take(&mut self, input: Input, events: &ActiveEventLoop) {
        let is_move = matches!(input, Input::Move(..));
        if is_move {
            self.controls.holds_body(self.live.is_body_held());
        }
        let before = self.controls.request();
        if let Some(action) = self.controls.take(input) {
            self.act(action, events);
        }
        if self.controls.request() != before {
            self.live.request(self.controls.request());
        }
    }

    fn act(&mut self, action: Action, events: &ActiveEventLoop) {
        match action {
            Action::Command(command) => self.live.command(command),
            Action::Freeze => self.live.freeze(!self.live.is_frozen()),
            Action::Step => self.live.step_frame(),
            Action::Learn => self.live.learn_room(),
            Action::TakePicture => self.take_picture(),
            Action::Quit => events.exit(),
        }
    }

    /// Writes the picture that is shown into the current folder.
    fn take_picture(&mut self) {
        let Some(picture) = &self.latest else { return };
        let path = (self.pictures_taken..).map(|k| PathBuf::from(format!("picture_{k:03}.png")));
        let Some(path) = path.into_iter().find(|path| !path.exists()) else { return };
        match picture.save(&path) {
            Ok(()) => self.live.tell("picture", path.display()),
            Err(e) => {
                self.live.tell("picture", format!("{}: expected to write it, found: {e}", path.display()))
            }
        }
        self.pictures_taken += 1;
    }

    fn show(&mut self, events: &ActiveEventLoop) {
        let waiting = self.picture.lock().unwrap_or_else(PoisonError::into_inner).take();
        if waiting.is_some() {
            self.latest = waiting;
        }
        let (Some(screen), Some(picture)) = (&mut self.screen, &self.latest) else { return };
        if let Err(error) = screen.show(picture) {
            self.failed = Some(error);
            events.exit();
        }
    }

    fn open(&self, events: &ActiveEventLoop) -> Result<Screen> {
        let (width, height) = self.options.size;
        let attributes = Window::default_attributes()
            .with_title("vhull-view")
            .with_inner_size(PhysicalSize::new(width, height));
        let window = events.create_window(attributes).map_err(|e| lost(&e))?;
        Screen::new(Arc::new(window))
    }
}

impl ApplicationHandler<PictureDrawn> for Application<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        match self.open(events) {
            Ok(screen) => self.screen = Some(screen),
            Err(error) => {
                self.failed = Some(error);
                events.exit();
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: PictureDrawn) {
        if let Some(screen) = &self.screen {
            screen.window().request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if matches!(event, WindowEvent::RedrawRequested) {
            return self.show(events);
        }
        if matches!(event, WindowEvent::CloseRequested) {
            return events.exit();
        }
        if let Some(input) = input_of(&event) {
            self.take(input, events);
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let now = Instant::now();
        let passed = now.duration_since(self.last_tick);
        if passed >= TICK {
            self.last_tick = now;
            if self.controls.is_moving() {
                self.controls.advance(passed.as_secs_f64().min(0.1));
                self.live.request(self.controls.request());
            }
            self.live.take_messages().iter().for_each(|message| (self.tell)(message));
        }
        let is_over = |seconds| self.started.elapsed().as_secs_f64() >= seconds;
        if self.options.is_ended.load(Ordering::Relaxed) || self.options.seconds.is_some_and(is_over) {
            events.exit();
        }
        events.set_control_flow(ControlFlow::WaitUntil(now + TICK));
    }
}

/// What an event of the window means to the controls.
fn input_of(event: &WindowEvent) -> Option<Input> {
    match event {
        WindowEvent::KeyboardInput { event, .. } if !event.repeat => {
            let key = match &event.logical_key {
                WinitKey::Named(NamedKey::Escape) => Key::Escape,
                WinitKey::Named(NamedKey::Space) => Key::Char(' '),
                WinitKey::Character(text) => Key::Char(text.chars().next()?.to_ascii_lowercase()),
                _ => return None,
            };
            Some(if event.state == ElementState::Pressed { Input::Press(key) } else { Input::Release(key) })
        }
        WindowEvent::CursorMoved { position, .. } => Some(Input::Move(position.x, position.y)),
        WindowEvent::MouseInput { state, button, .. } => {
            let button = match button {
                MouseButton::Left => Button::Left,
                MouseButton::Right | MouseButton::Middle => Button::Right,
                _ => return None,
            };
            let is_down = *state == ElementState::Pressed;
            Some(if is_down { Input::ButtonDown(button) } else { Input::ButtonUp(button) })
        }
        WindowEvent::MouseWheel { delta, .. } => Some(Input::Wheel(match delta {
            MouseScrollDelta::LineDelta(_, notches) => f64::from(*notches),
            MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_NOTCH,
        })),
        WindowEvent::Resized(size) => Some(Input::Resize(size.width, size.height)),
        WindowEvent::Focused(false) => Some(Input::FocusLost),
        _ => None,
    }
}
