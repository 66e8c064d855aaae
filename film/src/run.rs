//! From a capture's first frame to its last: simulate, draw, note, and write the results.

use crate::capture::{Capture, FRAME_RATE};
use crate::compositor::Compositor;
use crate::film::Film;
use crate::log::Log;
use crate::simulation::{STEPS_PER_SECOND, Simulation};
use crate::summary;
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::{Error, Result};
use std::path::Path;
use std::time::Instant;

/// The longer side of the film, in pixels.
const FILM_SIZE: u32 = 480;

/// Steps of the simulation in a frame.
const STEPS_PER_FRAME: usize = (STEPS_PER_SECOND / FRAME_RATE) as usize;

/// What to run, and where to put it.
#[derive(Debug, Clone, Copy)]
pub struct FilmOptions<'s> {
    /// Folder for the results; made if need be.
    pub out: &'s Path,
    /// Name of the film, without an extension.
    pub name: &'s str,
    /// Frames to play.
    pub frames: usize,
    /// The camera whose view is drawn; none: no film, which is several times faster.
    pub view: Option<usize>,
}

/// Plays `capture`, whose first frame is published to `data` already, and writes the results. The text tells what
/// became of each body, and which files there are. `shown` is called after each frame, with a few words.
///
/// # Errors
/// A frame that cannot be had, a simulation that diverges: the results of the frames before are written all the same.
/// A file that cannot be written.
pub fn run_film(
    options: &FilmOptions,
    capture: &mut dyn Capture,
    data: &HullData,
    simulation: &mut Simulation,
    shown: &mut dyn FnMut(String),
) -> Result<String> {
    let FilmOptions { out, name, frames, .. } = *options;
    std::fs::create_dir_all(out)
        .map_err(|e| Error::file(out, format!("expected to make this folder, found: {e}")))?;
    let started = Instant::now();
    let (mut film, mut log) = (Film::new(FRAME_RATE), Log::new(simulation, capture.subject()));
    let played = play(options, capture, data, simulation, (&mut film, &mut log), shown);
    if log.entries.is_empty() {
        played?;
        return Ok(String::new());
    }
    let still_until = capture.still_until();
    let written = summary::write(out, name, &film, &log, still_until, &capture.moments())?;
    played.map_err(|e| {
        let count = log.entries.len();
        Error::argument(format!("{e}; the {count} frames before are in {}", out.display()))
    })?;
    let mut text = summary::table(&log, simulation, still_until, capture.subject());
    text += &summary::summary(frames, capture.cameras().len(), started.elapsed());
    for (path, what) in written {
        text += &format!("{what:<12} {}\n", path.display());
    }
    Ok(text)
}

fn play(
    options: &FilmOptions,
    capture: &mut dyn Capture,
    data: &HullData,
    simulation: &mut Simulation,
    (film, log): (&mut Film, &mut Log),
    shown: &mut dyn FnMut(String),
) -> Result<()> {
    let easel = |view: usize| {
        Compositor::new(&capture.cameras()[view], capture.window(view, data), FILM_SIZE, capture.light())
    };
    let easel = options.view.map(|view| (view, easel(view)));
    for frame in 0..options.frames {
        for step in 0..STEPS_PER_FRAME {
            capture.publish((frame * STEPS_PER_FRAME + step) as f64 / STEPS_PER_SECOND, data)?;
            simulation.advance(1.0 / STEPS_PER_SECOND)?;
        }
        log.record(simulation, capture.real_top());
        if let Some((view, easel)) = &easel {
            let picture = capture.picture(*view)?;
            let hull = data.latest().map(|(_, hull)| hull);
            let real = |ray: &Ray| hull.as_ref().and_then(|hull| capture.hit(ray, *view, hull));
            film.push(easel.draw(&picture, &simulation.drawn(), &real));
        }
        shown(simulation.summary());
    }
    Ok(())
}
