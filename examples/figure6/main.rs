//! A person walks up and topples a stack of virtual boxes (the paper's figure 6).
//!
//! ```text
//!   cameras ──► masks ──► HullData ──► World (ODE) ──► one camera's view with the boxes in it, CSV, plot, table
//! ```
//!
//! `cargo run --release --example figure6 -- --help` lists the options.

#[path = "../shared/recording.rs"]
mod recording;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use clap::Parser;
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::ode::{Swept, set_random_seed};
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{Simulation, in_the_way};
use recording::RecordingArguments;
use shared::{FilmArguments, Filmed, tell};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Seconds for which the first frame of a recording is held, so that the boxes settle.
const WAIT: f64 = 1.0;

/// Sizes of the stack that are tried in the way of a recorded subject, as parts of its own.
const SCALES: [f64; 4] = [1.0, 0.8, 0.6, 0.4];

/// The name of the film, and the folder for it.
const NAMES: (&str, &str) = ("figure6", "target/figure6");

/// A person walks up and topples a stack of virtual boxes.
///
/// Eight synthetic cameras watch a person of capsules, who walks through a stack of five virtual boxes. Each frame goes
/// through all steps: colour images with sensor noise, segmentation, silhouettes, visual hull, physics. With --recording a
/// real person takes the place of the synthetic one, and the stack stands in their way.
#[derive(Debug, Parser)]
#[command(name = "figure6", version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    film: FilmArguments,
    #[command(flatten)]
    recording: RecordingArguments,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release --example figure6
  cargo run --release --example figure6 -- --view 1 --out target/from_the_side
  cargo run --release --example figure6 -- --recording my_recording --rate 60";

fn main() -> ExitCode {
    let options = Options::parse();
    tell(match &options.recording.recording {
        Some(dir) => film_recording(&options, dir),
        None => film(&options),
    })
}

fn film(options: &Options) -> Result<String> {
    let (name, out) = NAMES;
    let filmed = Filmed {
        scenario: scene::Walker,
        cameras: scene::cameras()?,
        bounds: scene::bounds()?,
        place: scene::foot(),
        motion: Motion::Interpolated,
        name,
        out,
    };
    let report = shared::film(filmed, &options.film, |simulation| {
        simulation.set_swept(Swept::On);
        scene::stack(simulation, &scene::foot(), 1.0)
    })?;
    Ok(report.text)
}

fn film_recording(options: &Options, dir: &Path) -> Result<String> {
    set_random_seed(options.film.seed);
    let data = Arc::new(HullData::new());
    let mut playback = options.recording.playback(dir, WAIT, &data)?;
    let (width, height) = scene::extent();
    let places = SCALES.into_iter().map(|scale| {
        let foot = in_the_way(playback.sampled_hulls(), scale * width, scale * height)?;
        Some((foot, scale))
    });
    let (foot, scale) = places.flatten().next().ok_or_else(|| {
        let problem = "expected a subject that comes to a place where it was not at first, found none; take a recording of one \
                       who walks, or place a stack with vhull run --stack --at";
        Error::file(dir, problem)
    })?;
    playback.show(&foot, scale * width, scale * height);

    let mut simulation = Simulation::new(&data, playback.pixel_size(), Motion::Interpolated)?;
    simulation.set_swept(Swept::On);
    scene::stack(&mut simulation, &foot, scale)?;
    let text = shared::film_of(&mut playback, &data, &mut simulation, NAMES, &options.film)?.text;
    Ok(format!("the stack, {scale} times its size, stands at ({:.2}, {:.2}) m\n{text}", foot.x, foot.y))
}
