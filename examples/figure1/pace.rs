//! The scene by the wall clock: masks on a thread of their own, and the simulation on another.

use super::options::Options;
use super::scene;
use super::shared::progress_bar;
use image::GrayImage;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::synthetic::coverage;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{
    FRAME_RATE, FrameTimes, Pace, PacedFrames, SimulatedBody, Simulation, check_subject, run_paced,
};
use std::path::Path;
use std::sync::Arc;

/// The most masks that are kept in memory, in bytes.
const MOST_BYTES: u64 = 2 << 30;

/// Runs the scene, and returns the text that tells how it kept up.
pub fn pace(options: &Options) -> Result<String> {
    set_random_seed(options.film.seed);
    let data = Arc::new(HullData::new());
    let (frames, mut simulation) = match &options.recording.recording {
        Some(dir) => {
            let frames = recorded(dir, options, &data)?;
            let simulation = among_recorded(dir, &frames, &data, options)?;
            (frames, simulation)
        }
        None => {
            let frames = walk(&data)?;
            let mut simulation = Simulation::new(&data, scene::PIXEL, options.motion.motion())?;
            scene::add_boxes(&mut simulation)?;
            (frames, simulation)
        }
    };

    let pace = Pace { step_rate: options.step_rate, seconds: options.seconds };
    let report = run_paced(&frames, &data, &mut simulation, &pace, &mut |_, _| ())?;
    let samples = |one: &SimulatedBody| {
        one.parts[0].shape.sample(scene::MIN_FEATURE).map(|samples| samples.points().len())
    };
    let samples = simulation.bodies().iter().map(samples).collect::<Result<Vec<usize>>>()?;
    let (least, most) = (samples.iter().min().unwrap_or(&0), samples.iter().max().unwrap_or(&0));
    Ok(format!(
        "{} boxes of {least} to {most} samples, {} cameras at {:.0} images a second, {} s\n{report}",
        scene::BOXES,
        frames.masks(0).len(),
        1.0 / frames.period(),
        options.seconds
    ))
}

/// The masks of the synthetic person, whose cameras are added to `data`.
fn walk(data: &HullData) -> Result<PacedFrames> {
    let cameras = scene::cameras()?;
    data.add_views(&cameras)?;
    data.set_bounds(scene::bounds()?)?;
    let count = (scene::PERIOD * FRAME_RATE).round() as usize;
    let progress = progress_bar(count, "masks drawn");
    let masks_of = |k: usize| -> Vec<GrayImage> {
        progress.inc(1);
        let subject = scene::Wanderer::walked(k as f64 / FRAME_RATE);
        cameras.iter().map(|camera| coverage(camera, &subject)).collect()
    };
    let masks = (0..count).map(masks_of).collect();
    progress.finish_and_clear();
    PacedFrames::in_a_loop(masks, FRAME_RATE)
}

/// The masks of the recording in folder `dir`, to and fro at their own times, whose cameras are added to `data`.
///
/// # Errors
/// Frames without times, which the wall clock needs.
fn recorded(dir: &Path, options: &Options, data: &HullData) -> Result<PacedFrames> {
    let arguments = &options.recording;
    let recording = Recording::open(dir)?;
    arguments.volume.prepare(data, recording.rig())?;
    let times = FrameTimes::of(&recording, arguments.rate)?;
    if times.is_assumed {
        let problem =
            "expected the frames' times for --pace, found none; list them in frames.csv, or give --rate";
        return Err(Error::file(dir, problem));
    }

    let frames = &recording.frames()[..recording.frames().len().min(options.film.most_frames())];
    let pixels = |size: (u32, u32)| u64::from(size.0) * u64::from(size.1);
    let of_frame: u64 = recording.rig().cameras().iter().map(|camera| pixels(camera.size())).sum();
    if of_frame * frames.len() as u64 > MOST_BYTES {
        let fewer = MOST_BYTES / of_frame;
        let problem =
            format!("expected at most 2 GiB of masks, found {} frames; play --frames {fewer}", frames.len());
        return Err(Error::file(dir, problem));
    }
    let progress = progress_bar(frames.len(), "masks read");
    let masks_of = |&frame: &u32| {
        progress.inc(1);
        recording.masks(frame)
    };
    let masks = frames.iter().map(masks_of).collect::<Result<Vec<_>>>()?;
    progress.finish_and_clear();
    PacedFrames::to_and_fro(masks, &times.times[..frames.len()])
}

/// The boxes around the subject of the first of `frames`.
fn among_recorded(
    dir: &Path,
    frames: &PacedFrames,
    data: &Arc<HullData>,
    options: &Options,
) -> Result<Simulation> {
    // A time before that of the first frame, which is published by the wall clock.
    let hull = publish_masks(data, frames.masks(0), -frames.period())?;
    check_subject(dir, 0, &hull)?;
    let pixel_size = hull.pixel_size(&hull.aabb().centre());
    let mut simulation = Simulation::new(data, pixel_size, options.motion.motion())?;
    scene::add_boxes_around(&mut simulation, &hull)?;
    Ok(simulation)
}
