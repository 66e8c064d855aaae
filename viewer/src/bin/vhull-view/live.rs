//! `vhull-view live`: cameras, bodies and the picture from anywhere, at once.

use crate::options::parse_picture_size;
use image::RgbImage;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::{Clock, DeviceOptions};
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{Movement, VolumeOptions, parse_positive, parse_rate, parse_size};
use ode_visual_hull_viewer::live::{
    Bodies, Gravity, Live, LiveCameras, LiveOptions, LiveReport, Message, Scenery,
};
use ode_visual_hull_viewer::record::PacedMovie;
use ode_visual_hull_viewer::window::{Controls, OpenWindow, WindowOptions};
use ode_visual_hull_viewer::{Method, RendererKind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// How often messages are looked for without a window.
const TICK: Duration = Duration::from_millis(50);

/// Capture a subject, let virtual bodies collide with it, and look at both from anywhere, in one window.
///
/// Cameras are devices, streams, a recording that is played by the clock again and again, or synthetic ones. Their images
/// are segmented against the empty room, which the key l learns. World z is up, the floor at z = 0. The key ? lists the keys.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of a recording with images or videos, and the background of each camera.
    #[arg(conflicts_with_all = ["synthetic", "camera"], required_unless_present_any = ["synthetic", "camera"])]
    recording: Option<PathBuf>,
    /// So many synthetic cameras around a person who walks and waves.
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "7", value_parser = clap::value_parser!(u8).range(2..=16))]
    synthetic: Option<u8>,
    /// Calibration of the real cameras.
    #[arg(long, value_name = "FILE", requires = "camera")]
    rig: Option<PathBuf>,
    /// A real camera: its name in the rig, and its device or the address of its stream. Once for each camera of the rig.
    #[arg(long, value_name = "NAME=SOURCE", requires = "rig", value_parser = parse_camera)]
    camera: Vec<(String, String)>,
    /// Images a second [default: as the recording says, else 30].
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    rate: Option<f64>,
    /// Transfer format of the devices, such as mjpeg.
    #[arg(long, value_name = "FORMAT", requires = "camera")]
    pixels: Option<String>,
    /// Size of the synthetic images.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, default_value = "640x480", requires = "synthetic")]
    image_size: (u32, u32),

    /// The virtual bodies at first.
    #[arg(long, value_enum, default_value_t = Scenery::Stack, help_heading = "Bodies")]
    bodies: Scenery,
    /// How many.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=200), default_value_t = 6, help_heading = "Bodies")]
    count: u16,
    /// Edge of the boxes, in metres.
    #[arg(long, value_name = "METRES", value_parser = parse_positive, default_value = "0.2", help_heading = "Bodies")]
    side: f64,
    /// How the subject moves between its images.
    #[arg(long, value_enum, default_value_t = Movement::Interpolated, help_heading = "Bodies")]
    motion: Movement,
    /// Let the simulation run before all other programs (SCHED_FIFO), so that hardly a step is late; the user must be allowed to.
    #[arg(long, help_heading = "Bodies")]
    real_time: bool,
    #[command(flatten)]
    volume: VolumeOptions,

    /// How the real subject is drawn at first.
    #[arg(long, value_enum, default_value_t = Method::Blend, help_heading = "Drawing")]
    method: Method,
    /// What draws.
    #[arg(long, value_enum, default_value_t = RendererKind::Auto, help_heading = "Drawing")]
    renderer: RendererKind,
    /// Size of the window in pixels at first.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_picture_size, default_value = "640x480", help_heading = "Drawing")]
    size: (u32, u32),
    /// Leave the subject's depth at the hull's at first: faster, but images of different cameras fit less.
    #[arg(long, help_heading = "Drawing")]
    no_refinement: bool,

    /// Open no window; end with --seconds or by a signal.
    #[arg(long, help_heading = "Output")]
    headless: bool,
    /// Write what the window shows to a film; its name ends with .gif or .mp4 (by ffmpeg).
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    film: Option<PathBuf>,
    /// Record what is captured to this folder, with the states of the bodies.
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    record: Option<PathBuf>,
    /// Seconds after which it ends.
    #[arg(long, value_name = "SECONDS", value_parser = parse_positive, help_heading = "Output")]
    seconds: Option<f64>,
}

const EXAMPLES: &str = "\
Examples:
  vhull-view live --synthetic                             seven synthetic cameras, a stack of boxes
  vhull-view live my_recording --bodies rain              a recording, played as if it were live
  vhull-view live --rig rig.toml --camera left=/dev/video0 --camera right=rtsp://192.168.0.20/live
  vhull-view live --synthetic --headless --seconds 10 --film live.mp4";

pub fn run(options: &Options) -> Result<()> {
    let clock = Clock::new();
    let cameras = cameras(options, &clock)?;
    let live = LiveOptions {
        bodies: Bodies { scenery: options.bodies, count: options.count.into(), side: options.side },
        motion: options.motion.motion(),
        volume: options.volume,
        renderer: options.renderer,
        is_real_time: options.real_time,
        record: options.record.clone(),
    };
    let film = Film::create(options)?;
    let report = if options.headless {
        headless(options, cameras, &live, &film)?
    } else {
        windowed(options, cameras, &live, &film)?
    };
    film.finish()?;
    println!("{report}");
    Ok(())
}

/// The film of the window, if one is wanted.
#[derive(Clone)]
struct Film(Arc<Mutex<Option<PacedMovie>>>);

impl Film {
    fn create(options: &Options) -> Result<Self> {
        let movie = options.film.as_ref().map(|path| PacedMovie::create(path, options.size)).transpose()?;
        Ok(Self(Arc::new(Mutex::new(movie))))
    }

    /// Adds a picture; a film that cannot go on ends with a message.
    fn push(&self, picture: &RgbImage) {
        let mut movie = self.lock();
        let Some(Err(error)) = movie.as_mut().map(|movie| movie.push(picture)) else { return };
        eprintln!("error: film: {error}");
        *movie = None;
    }

    fn finish(&self) -> Result<()> {
        let movie = self.lock().take();
        movie.map_or(Ok(()), PacedMovie::finish)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<PacedMovie>> {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

fn cameras(options: &Options, clock: &Clock) -> Result<LiveCameras> {
    if let Some(recording) = &options.recording {
        return LiveCameras::of_recording(recording, options.rate, clock);
    }
    if let Some(count) = options.synthetic {
        return LiveCameras::synthetic(count.into(), options.image_size, options.rate.unwrap_or(30.0), clock);
    }
    let path = options.rig.clone().unwrap_or_default();
    let device =
        DeviceOptions { rate: options.rate, pixels: options.pixels.clone(), ..DeviceOptions::default() };
    LiveCameras::real(&Rig::load(&path)?, &options.camera, &device, clock)
}

fn windowed(options: &Options, cameras: LiveCameras, live: &LiveOptions, film: &Film) -> Result<LiveReport> {
    let window = OpenWindow::new()?;
    let (mut to_window, film) = (window.sink(), film.clone());
    let live = Live::start(cameras, live, move |shown| {
        film.push(&shown.picture);
        to_window(shown);
    })?;
    let shown = WindowOptions {
        size: options.size,
        method: options.method,
        refine: !options.no_refinement,
        seconds: options.seconds,
        is_ended: ended_by_signal()?,
    };
    window.run(live, &shown, &mut tell)
}

fn headless(options: &Options, cameras: LiveCameras, live: &LiveOptions, film: &Film) -> Result<LiveReport> {
    println!("no window is opened");
    let film = film.clone();
    let live = Live::start(cameras, live, move |shown| film.push(&shown.picture))?;
    let pinholes = live.pinholes().to_vec();
    let controls = Controls::new(pinholes, live.home(), options.size, options.method, !options.no_refinement);
    live.request(controls.request());
    let (started, is_ended) = (Instant::now(), ended_by_signal()?);
    let is_over = || options.seconds.is_some_and(|seconds| started.elapsed().as_secs_f64() >= seconds);
    while !is_over() && !is_ended.load(Ordering::Relaxed) {
        std::thread::sleep(TICK);
        live.take_messages().iter().for_each(tell);
    }
    Ok(live.stop())
}

/// Set when the program is interrupted or terminated, so that films and recordings are completed.
fn ended_by_signal() -> Result<Arc<AtomicBool>> {
    let is_ended = Arc::new(AtomicBool::new(false));
    let set = is_ended.clone();
    ctrlc::set_handler(move || set.store(true, Ordering::Relaxed)).map_err(|e| {
        Error::argument(format!("expected to handle the signals that end a program, found: {e}"))
    })?;
    Ok(is_ended)
}

/// Prints a message.
fn tell(message: &Message) {
    let kind = match message.gravity {
        Gravity::Note => "note",
        Gravity::Warning => "warning",
        Gravity::Error => "error",
    };
    eprintln!("{kind}: {}: {}", message.about, message.text);
}

/// Parses a camera, `NAME=SOURCE`.
fn parse_camera(text: &str) -> std::result::Result<(String, String), String> {
    let parts = text.split_once('=').filter(|(name, source)| !name.is_empty() && !source.is_empty());
    parts
        .map(|(name, source)| (name.to_owned(), source.to_owned()))
        .ok_or_else(|| format!("expected NAME=SOURCE as in left=/dev/video0, found {text}"))
}
