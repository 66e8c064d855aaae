//! `vhull-view film`: a film of a finished run from a moving viewpoint.

use crate::options::{DrawingOptions, warn};
use image::RgbImage;
use indicatif::ProgressBar;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::FRAME_RATE;
use ode_visual_hull_viewer::Renderer;
use ode_visual_hull_viewer::history::History;
use ode_visual_hull_viewer::orbit::Orbit;
use ode_visual_hull_viewer::record::{FinishedScenes, Movie, Tour};
use ode_visual_hull_viewer::supersample::{enlarged, reduced};
use std::path::PathBuf;

/// Film a run of `vhull run` from a moving viewpoint.
///
/// The recorded subject and the virtual bodies appear as they were in the simulation, at 30 frames a second. The viewpoint
/// follows a tour, a TOML file of keyframes, or circles the subject once.
#[derive(Debug, clap::Args)]
#[command(after_help = TOURS)]
pub struct Options {
    /// Folder of the recording that was played.
    recording: PathBuf,
    /// The states of the bodies, as `vhull run` writes them; bodies.toml has to be beside it.
    #[arg(long, value_name = "FILE", default_value = "vhull_run/states.csv")]
    states: PathBuf,
    /// The keyframes of the viewpoint [default: once around the subject].
    #[arg(long, value_name = "FILE")]
    tour: Option<PathBuf>,
    /// Where to write the film; its name ends with .gif or .mp4 (by ffmpeg).
    #[arg(long, short, value_name = "FILE", default_value = "film.gif")]
    out: PathBuf,
    /// Show the image of a real camera while the viewpoint is at its place.
    #[arg(long)]
    snap: bool,
    /// Draw each frame for itself: colours of what stands still flicker with the noise of the images.
    #[arg(long)]
    no_history: bool,
    #[command(flatten)]
    drawing: DrawingOptions,
}

const TOURS: &str = "\
A tour:
  [[key]]
  time = 0.0                  # seconds of the film
  eye = [2.5, 1.0, 1.5]       # metres
  target = [0.0, 0.0, 0.8]    # the middle of the subject where it is missing
  field_of_view = 50.0        # horizontal, in degrees
  [[key]]
  time = 4.0
  azimuth = 180.0             # or around the target: degrees counter-clockwise from +x
  elevation = 20.0
  distance = 3.0
  [[key]]
  time = 6.0
  camera = \"left\"             # or the place of a real camera";

pub fn run(options: &Options) -> Result<()> {
    let mut scenes = FinishedScenes::open(&options.recording, &options.states)?;
    let tour = tour(options, &scenes)?;
    if let Some(folder) = options.out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::file(folder, format!("expected to make this folder, found: {e}")))?;
    }

    let mut renderer = options.drawing.open()?;
    let mut movie = Movie::create(&options.out, options.drawing.size, FRAME_RATE)?;
    let mut notes = Notes::default();
    let mut frames = 0;
    let drawn = draw(options, &tour, &mut scenes, &mut renderer, &mut notes, &mut |picture| {
        movie.push(picture)?;
        frames += 1;
        Ok(())
    });

    // What was drawn before an error is kept.
    let out = options.out.display();
    let written = if frames > 0 { movie.finish() } else { Ok(()) };
    drawn.map_err(|error| match &written {
        Ok(()) if frames > 0 => Error::argument(format!("{error}; the {frames} frames before are in {out}")),
        _ => error,
    })?;
    written?;
    notes.print();
    println!("{frames} frames, drawn by {}: {out}", renderer.description());
    Ok(())
}

/// Draws all frames and hands them to `push`.
fn draw(
    options: &Options,
    tour: &Tour,
    scenes: &mut FinishedScenes,
    renderer: &mut Renderer,
    notes: &mut Notes,
    push: &mut dyn FnMut(RgbImage) -> Result<()>,
) -> Result<()> {
    let DrawingOptions { size, samples, .. } = options.drawing;
    let bar = ProgressBar::new(scenes.times().len() as u64);
    let mut history = (!options.no_history).then(History::default);
    for k in 0..scenes.times().len() {
        let viewpoint = enlarged(&tour.at(scenes.times()[k]).camera(size)?, samples)?;
        let scene = scenes.scene(k).map_err(|e| at_frame(k, &e))?;
        if k == 0 {
            warn(&scene);
        }
        notes.add(k, scene.obstacle(&viewpoint.centre()));
        let picture = renderer.draw(&scene, &viewpoint, &options.drawing.draw_options(options.snap));
        let mut picture = picture.map_err(|e| at_frame(k, &e))?;
        if let Some(history) = &mut history {
            history.steady(&mut picture, &viewpoint);
        }
        push(reduced(picture, samples))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

fn tour(options: &Options, scenes: &FinishedScenes) -> Result<Tour> {
    let subject = scenes.shown_box();
    match &options.tour {
        Some(path) => Tour::read(path, scenes.cameras().cameras(), &subject),
        None => {
            let end = scenes.times().last().copied().unwrap_or(0.0);
            let start =
                Orbit::from_eye(&scenes.cameras().cameras()[0].centre(), &subject.centre(), 1.0).azimuth;
            Ok(Tour::circle(&subject, start, end))
        }
    }
}

fn at_frame(k: usize, error: &Error) -> Error {
    Error::argument(format!("frame {}: {error}", k + 1))
}

/// Viewpoints that show little, and the frames in which that is so.
#[derive(Default)]
struct Notes(Vec<(String, usize, usize)>);

impl Notes {
    fn add(&mut self, frame: usize, why: Option<String>) {
        let Some(why) = why else { return };
        match self.0.last_mut() {
            Some((last, _, end)) if *end == frame && why.starts_with(&last[..last.len().min(20)]) => {
                *end += 1
            }
            _ => self.0.push((why, frame, frame + 1)),
        }
    }

    fn print(&self) {
        for (why, first, end) in &self.0 {
            eprintln!("note: viewpoint in frames {} to {end}: {why}", first + 1);
        }
    }
}
