//! A person among a hundred virtual boxes (the paper's figure 1): as a film, or in real time.
//!
//! ```text
//!   cameras ──► masks ──► HullData ──► World (ODE) ──► one camera's view with the boxes in it, CSV, plot, table
//!                 └─ by the wall clock ─┴─ also ─────► frames and steps in time, late and dropped, and latencies
//! ```
//!
//! `cargo run --release --example figure1 -- --help` lists the options.

mod options;
mod scene;

use clap::Parser;
use image::GrayImage;
use indicatif::{ProgressBar, ProgressStyle};
use ode_visual_hull::Result;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull::synthetic::coverage;
use ode_visual_hull_film::{
    FRAME_RATE, FilmOptions, Pace, SimulatedBody, Simulation, Story, Studio, run_film, run_paced, view_of,
};
use options::Options;
use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;

fn main() -> ExitCode {
    let options = Options::parse();
    set_random_seed(options.seed);
    let text = if options.pace { pace(&options) } else { film(&options) };
    match text {
        Ok(text) => {
            // The reader may have closed the pipe.
            let _ = std::io::stdout().write_all(text.as_bytes());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn film(options: &Options) -> Result<String> {
    let data = Arc::new(HullData::new());
    let seed = u64::from(options.seed);
    let mut studio = Studio::new(scene::Wanderer, scene::cameras()?, scene::bounds()?, seed, &data)?;
    let pixel_size = data.at(0.0)?.pixel_size(&scene::middle());
    let mut simulation = Simulation::new(&data, pixel_size, options.motion.motion())?;
    scene::add_boxes(&mut simulation)?;

    let frames = options.frames.map_or(usize::MAX, |frames| frames as usize).min(studio.frames());
    let view = view_of(&studio, options.view.as_deref())?;
    let view = (!options.no_gif).then_some(view);
    let film = FilmOptions { out: &options.out, name: "figure1", frames, view };
    let progress = progress_bar(frames, "frames");
    let text = run_film(&film, &mut studio, &data, &mut simulation, &mut |summary| {
        progress.set_message(summary);
        progress.inc(1);
    })?;
    progress.finish_and_clear();
    Ok(text)
}

fn pace(options: &Options) -> Result<String> {
    let cameras = scene::cameras()?;
    let data = Arc::new(HullData::new());
    data.add_views(&cameras)?;
    data.set_bounds(scene::bounds()?)?;

    let frames = (scene::PERIOD * FRAME_RATE).round() as usize;
    let progress = progress_bar(frames, "masks drawn");
    let masks_of = |k: usize| -> Vec<GrayImage> {
        progress.inc(1);
        let subject = scene::Wanderer::walked(k as f64 / FRAME_RATE);
        cameras.iter().map(|camera| coverage(camera, &subject)).collect()
    };
    let masks: Vec<Vec<GrayImage>> = (0..frames).map(masks_of).collect();
    progress.finish_and_clear();

    let mut simulation = Simulation::new(&data, scene::PIXEL, options.motion.motion())?;
    scene::add_boxes(&mut simulation)?;
    let pace = Pace { frame_rate: FRAME_RATE, step_rate: options.step_rate, seconds: options.seconds };
    let report = run_paced(&masks, &data, &mut simulation, &pace)?;
    let samples =
        |one: &SimulatedBody| one.shape.sample(scene::MIN_FEATURE).map(|samples| samples.points().len());
    let samples = simulation.bodies().iter().map(samples).collect::<Result<Vec<usize>>>()?;
    let (least, most) = (samples.iter().min().unwrap_or(&0), samples.iter().max().unwrap_or(&0));
    Ok(format!(
        "{} boxes of {least} to {most} samples, {} cameras, {} s\n{report}",
        scene::BOXES,
        cameras.len(),
        options.seconds
    ))
}

fn progress_bar(count: usize, what: &str) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:32} {prefix} {pos}/{len}  {elapsed} (about {eta} left)  {msg}");
    let bar = ProgressBar::new(count as u64).with_prefix(what.to_string());
    style.map_or(bar.clone(), |style| bar.with_style(style))
}
