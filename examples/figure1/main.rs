//! A person among a hundred virtual boxes (the paper's figure 1): as a film, or in real time.
//!
//! ```text
//!   cameras ──► masks ──► HullData ──► World (ODE) ──► one camera's view with the boxes in it, CSV, plot, table
//!                 └─ by the wall clock ─┴─ also ─────► frames and steps in time, late and dropped, and latencies
//! ```
//!
//! `cargo run --release --example figure1 -- --help` lists the options.

mod options;
mod pace;
#[path = "../shared/recording.rs"]
mod recording;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use clap::Parser;
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull_film::Simulation;
use options::Options;
use shared::{Filmed, tell};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Seconds for which the first frame of a recording is held, so that the boxes fall.
const WAIT: f64 = 1.2;

/// The name of the film, and the folder for it.
const NAMES: (&str, &str) = ("figure1", "target/figure1");

fn main() -> ExitCode {
    let options = Options::parse();
    tell(match (&options.recording.recording, options.pace) {
        (None, false) => film(&options),
        (Some(dir), false) => film_recording(&options, dir),
        (_, true) => pace::pace(&options),
    })
}

fn film(options: &Options) -> Result<String> {
    let (name, out) = NAMES;
    let filmed = Filmed {
        scenario: scene::Wanderer,
        cameras: scene::cameras()?,
        bounds: scene::bounds()?,
        place: scene::middle(),
        motion: options.motion.motion(),
        name,
        out,
    };
    Ok(shared::film(filmed, &options.film, scene::add_boxes)?.text)
}

fn film_recording(options: &Options, dir: &Path) -> Result<String> {
    set_random_seed(options.film.seed);
    let data = Arc::new(HullData::new());
    let mut playback = options.recording.playback(dir, WAIT, &data)?;
    let mut simulation = Simulation::new(&data, playback.pixel_size(), options.motion.motion())?;
    let farthest = scene::add_boxes_around(&mut simulation, playback.first())?;
    let middle = playback.first().aabb().centre();
    playback.show(&Point3::new(middle.x, middle.y, 0.0), farthest, 0.0);
    Ok(shared::film_of(&mut playback, &data, &mut simulation, NAMES, &options.film)?.text)
}
