//! A stack of virtual boxes on a real box (the paper's figure 5).
//!
//! ```text
//!   cameras ──► masks ──► HullData ──► World (ODE) ──► one camera's view with the boxes in it, CSV, plot, table
//! ```
//!
//! `cargo run --release --example box_stack -- --help` lists the options. `vhull run` does the same with recordings of
//! real cameras.

mod options;
mod scene;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use ode_visual_hull::Result;
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull_film::{FilmOptions, Simulation, Story, Studio, run_film, view_of};
use options::Options;
use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;

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
    set_random_seed(options.seed);
    let data = Arc::new(HullData::new());
    let seed = u64::from(options.seed);
    let mut studio = Studio::new(scene::LiftedBox, scene::cameras()?, scene::bounds()?, seed, &data)?;
    let pixel_size = data.at(0.0)?.pixel_size(&scene::top());
    let mut simulation = Simulation::new(&data, pixel_size, Motion::Held)?;
    scene::stack(&mut simulation)?;
    let frames = options.frames.map_or(usize::MAX, |frames| frames as usize).min(studio.frames());
    let view = view_of(&studio, options.view.as_deref())?;
    let film =
        FilmOptions { out: &options.out, name: "box_stack", frames, view: (!options.no_gif).then_some(view) };
    let progress = progress_bar(frames);
    let text = run_film(&film, &mut studio, &data, &mut simulation, &mut |summary| {
        progress.set_message(summary);
        progress.inc(1);
    })?;
    progress.finish_and_clear();

    // The reader may have closed the pipe.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(())
}

fn progress_bar(frames: usize) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:32} frame {pos}/{len}  {elapsed} (about {eta} left)  {msg}");
    let bar = ProgressBar::new(frames as u64);
    style.map_or(bar.clone(), |style| bar.with_style(style))
}
