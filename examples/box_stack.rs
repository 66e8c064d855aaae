//! A stack of virtual boxes on a real box (the paper's figure 5), or boxes that fall on a recorded person.
//!
//! ```text
//!   cameras ──► masks ──► HullData ──► World (ODE) ──► one camera's view with the boxes in it, CSV, plot, table
//! ```
//!
//! `cargo run --release --example box_stack -- --help` tells the options.

#[path = "box_stack/capture.rs"]
mod capture;
#[path = "box_stack/easel.rs"]
mod easel;
#[path = "box_stack/film.rs"]
mod film;
#[path = "box_stack/landing.rs"]
mod landing;
#[path = "box_stack/log.rs"]
mod log;
#[path = "box_stack/options.rs"]
mod options;
#[path = "box_stack/playback.rs"]
mod playback;
#[path = "box_stack/plot.rs"]
mod plot;
#[path = "box_stack/report.rs"]
mod report;
#[path = "box_stack/sensor.rs"]
mod sensor;
#[path = "box_stack/simulation.rs"]
mod simulation;
#[path = "box_stack/studio.rs"]
mod studio;

use capture::{Capture, FRAME_RATE};
use clap::Parser;
use easel::Easel;
use film::Film;
use indicatif::{ProgressBar, ProgressStyle};
use log::Log;
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull::{Error, Result};
use options::Options;
use playback::Playback;
use simulation::Simulation;
use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use studio::Studio;

/// The longer side of the film, in pixels.
const FILM_SIZE: u32 = 480;

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<()> {
    std::fs::create_dir_all(&options.out)
        .map_err(|e| Error::file(&options.out, format!("expected to make this folder, found: {e}")))?;
    set_random_seed(options.seed);
    let data = Arc::new(HullData::new());
    match &options.recording {
        None => {
            let mut studio = Studio::new(options.seed, &data)?;
            let mut simulation = Simulation::new(&data, studio.pixel_size(&data)?)?;
            studio::stack(&mut simulation)?;
            play(options, &mut studio, &data, &mut simulation)
        }
        Some(dir) => {
            let mut playback = Playback::open(dir, options, &data)?;
            let mut simulation = Simulation::new(&data, playback.pixel_size(&data)?)?;
            playback.drop_boxes(options.boxes, &data, &mut simulation)?;
            play(options, &mut playback, &data, &mut simulation)
        }
    }
}

/// Runs the whole of `capture` and writes the results.
fn play(
    options: &Options,
    capture: &mut dyn Capture,
    data: &HullData,
    simulation: &mut Simulation,
) -> Result<()> {
    let started = Instant::now();
    let frames = options.frames.map_or(usize::MAX, |frames| frames as usize).min(capture.frames());
    let view = options.view_of(capture, data)?;
    let easel = Easel::new(&capture.cameras()[view], capture.window(view, data), FILM_SIZE, capture.lamp());
    let mut film = Film::new(FRAME_RATE);
    let mut log = Log::new(simulation);
    let progress = progress_bar(frames);
    for frame in 0..frames {
        capture.publish(frame, data)?;
        simulation.advance(1.0 / FRAME_RATE)?;
        log.record(simulation, capture.real_top(frame));
        if !options.no_gif {
            let picture = capture.picture(frame, view)?;
            let hull = data.latest().map(|(_, hull)| hull);
            let real = |ray: &Ray| hull.as_ref().and_then(|hull| capture.hit(ray, view, hull));
            film.push(easel.paint(&picture, &simulation.drawn(), &real));
        }
        progress.set_message(simulation.summary());
        progress.inc(1);
    }
    progress.finish_and_clear();
    let still_until = capture.still_until();
    let written = report::write(&options.out, &film, &log, still_until, &capture.moments())?;
    let mut text = report::table(&log, simulation, still_until, capture.subject());
    text += &report::summary(frames, capture.cameras().len(), started.elapsed());
    for (path, what) in written {
        text += &format!("{what:<12} {}\n", path.display());
    }
    // A reader who has seen enough may close the pipe.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(())
}

fn progress_bar(frames: usize) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:32} frame {pos}/{len}  {elapsed} (about {eta} left)  {msg}");
    let bar = ProgressBar::new(frames as u64);
    style.map_or(bar.clone(), |style| bar.with_style(style))
}
