//! What the examples with a synthetic studio share: the options of a film, and how it is made.

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData, Motion};
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull_film::{
    FilmOptions, FilmReport, Frames, Scenario, Simulation, Story, Studio, run_film, view_of,
};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// The options of a film.
#[derive(Debug, Args)]
#[command(next_help_heading = "Film")]
pub struct FilmArguments {
    /// Folder for the film, the table of states and the plot; it is made if it is missing [default: under target].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Camera whose view is drawn, by number from 0 or by name [default: the one that shows most].
    #[arg(long, value_name = "CAMERA")]
    pub view: Option<String>,
    /// Stop after so many frames, at 30 a second [default: all].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: Option<u32>,
    /// Seed of the sensor noise and of ODE's solver: the same seed gives the same run.
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// Write states and plot only, without a film: several times faster.
    #[arg(long)]
    pub no_gif: bool,
    /// Folder for a recording of the synthetic cameras: the masks that the bodies meet, and images without noise.
    #[arg(long, value_name = "DIR")]
    pub record: Option<PathBuf>,
}

impl FilmArguments {
    /// The most frames to play.
    pub fn most_frames(&self) -> usize {
        self.frames.map_or(usize::MAX, |frames| frames as usize)
    }
}

/// What a film shows, and from where.
pub struct Filmed<S> {
    pub scenario: S,
    pub cameras: Vec<Camera>,
    pub bounds: Aabb,
    /// A place at the subject, whose pixels' size decides how soft contacts are.
    pub place: Point3<f64>,
    pub motion: Motion,
    /// The name of the film, without an extension, and the folder for it unless another is given.
    pub name: &'static str,
    pub out: &'static str,
}

/// Makes the film of bodies that `add_bodies` adds.
pub fn film<S: Scenario>(
    filmed: Filmed<S>,
    arguments: &FilmArguments,
    add_bodies: impl FnOnce(&mut Simulation) -> Result<()>,
) -> Result<FilmReport> {
    set_random_seed(arguments.seed);
    let Filmed { scenario, cameras, bounds, place, motion, name, out } = filmed;
    let data = Arc::new(HullData::new());
    let mut studio = Studio::new(scenario, cameras, bounds, u64::from(arguments.seed), &data)?;
    if let Some(dir) = &arguments.record {
        studio.record(dir)?;
    }
    let pixel_size = data.at(0.0)?.pixel_size(&place);
    let mut simulation = Simulation::new(&data, pixel_size, motion)?;
    add_bodies(&mut simulation)?;
    film_of(&mut studio, &data, &mut simulation, (name, out), arguments)
}

/// Makes the film of `capture`, whose first frame `data` has published, with the bodies of `simulation`.
pub fn film_of(
    capture: &mut (impl Frames + Story),
    data: &HullData,
    simulation: &mut Simulation,
    (name, out): (&str, &str),
    arguments: &FilmArguments,
) -> Result<FilmReport> {
    let frames = arguments.most_frames().min(capture.frames());
    let view = view_of(capture, arguments.view.as_deref())?;
    let view = (!arguments.no_gif).then_some(view);
    let out = arguments.out.clone().unwrap_or_else(|| out.into());
    let options = FilmOptions { out: &out, name, frames, view };
    let progress = progress_bar(frames, "frame");
    let report = run_film(&options, capture, data, simulation, &mut |summary| {
        progress.set_message(summary);
        progress.inc(1);
    })?;
    progress.finish_and_clear();
    Ok(report)
}

/// Prints the text, or the error.
pub fn tell(text: Result<String>) -> ExitCode {
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

/// A progress bar that counts up to `count`.
pub fn progress_bar(count: usize, what: &str) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:32} {prefix} {pos}/{len}  {elapsed} (about {eta} left)  {msg}");
    let bar = ProgressBar::new(count as u64).with_prefix(what.to_string());
    style.map_or(bar.clone(), |style| bar.with_style(style))
}
