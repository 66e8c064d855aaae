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
#[path = "../shared/mod.rs"]
mod shared;

use clap::Parser;
use image::GrayImage;
use ode_visual_hull::Result;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull::synthetic::coverage;
use ode_visual_hull_film::{FRAME_RATE, Pace, SimulatedBody, Simulation, run_paced};
use options::Options;
use shared::{Filmed, progress_bar, tell};
use std::process::ExitCode;
use std::sync::Arc;

fn main() -> ExitCode {
    let options = Options::parse();
    tell(if options.pace { pace(&options) } else { film(&options) })
}

fn film(options: &Options) -> Result<String> {
    let filmed = Filmed {
        scenario: scene::Wanderer,
        cameras: scene::cameras()?,
        bounds: scene::bounds()?,
        place: scene::middle(),
        motion: options.motion.motion(),
        name: "figure1",
        out: "target/figure1",
    };
    shared::film(filmed, &options.film, scene::add_boxes)
}

fn pace(options: &Options) -> Result<String> {
    set_random_seed(options.film.seed);
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
