//! From a capture's first frame to its last: simulate, draw, log, and write the results.

use crate::capture::{FRAME_RATE, Frames, STEPS_PER_SECOND, Story};
use crate::compositor::Compositor;
use crate::film::Film;
use crate::log::Log;
use crate::simulation::Simulation;
use crate::subject_speed::fastest_part;
use crate::summary;
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::{Error, Result};
use std::path::Path;
use std::time::Instant;

/// The longer side of the film, in pixels.
const FILM_SIZE: u32 = 480;

/// Steps of the simulation in a frame.
const STEPS_PER_FRAME: usize = (STEPS_PER_SECOND / FRAME_RATE) as usize;

/// Length and view of a film, and where to write it.
#[derive(Debug, Clone, Copy)]
pub struct FilmOptions<'s> {
    /// Folder for the results; it is made if it does not exist.
    pub out: &'s Path,
    /// Name of the film, without an extension.
    pub name: &'s str,
    /// Number of frames to play.
    pub frames: usize,
    /// The camera whose view is drawn. Without one no film is made, which is several times faster.
    pub view: Option<usize>,
}

/// What a film was made of.
#[derive(Debug)]
pub struct FilmReport {
    /// A table of what became of each body, and a list of the files written.
    pub text: String,
    /// The states of all bodies in each frame.
    pub log: Log,
}

/// Plays `capture`, whose first frame is published to `data` already, and writes the results. `shown` is called after each frame with a short summary of it.
///
/// # Errors
/// A frame that cannot be read, or a simulation that diverges: the results of the frames before are written all the
/// same. A file that cannot be written.
pub fn run_film(
    options: &FilmOptions,
    capture: &mut (impl Frames + Story),
    data: &HullData,
    simulation: &mut Simulation,
    shown: &mut dyn FnMut(String),
) -> Result<FilmReport> {
    let FilmOptions { out, name, frames, .. } = *options;
    std::fs::create_dir_all(out)
        .map_err(|e| Error::file(out, format!("expected to make this folder, found: {e}")))?;

    let started = Instant::now();
    let (mut film, mut log) = (Film::new(FRAME_RATE), Log::new(simulation, capture.subject()));
    let played = play(options, capture, data, simulation, (&mut film, &mut log), shown);
    if log.entries.is_empty() {
        played?;
        return Ok(FilmReport { text: String::new(), log });
    }

    // What was simulated before an error is written all the same.
    let bodies = simulation.bodies_file(capture.playback());
    let written = summary::write(out, name, &film, &log, &bodies, capture)?;
    played.map_err(|e| {
        let count = log.entries.len();
        Error::argument(format!("{e}; the {count} frames before are in {}", out.display()))
    })?;

    let mut text = summary::table(&log, simulation, capture.still_until(), capture.subject());
    text += &summary::speeds(&log, simulation);
    text += &summary::summary(frames, capture.cameras().len(), started.elapsed());
    for (path, what) in written {
        text += &format!("{what:<12} {}\n", path.display());
    }
    Ok(FilmReport { text, log })
}

fn play(
    options: &FilmOptions,
    capture: &mut (impl Frames + Story),
    data: &HullData,
    simulation: &mut Simulation,
    (film, log): (&mut Film, &mut Log),
    shown: &mut dyn FnMut(String),
) -> Result<()> {
    let compositor = |view: usize| {
        Compositor::new(&capture.cameras()[view], capture.window(view), FILM_SIZE, capture.light())
    };
    let compositor = options.view.map(|view| (view, compositor(view)));

    for frame in 0..options.frames {
        for step in 0..STEPS_PER_FRAME {
            capture.publish((frame * STEPS_PER_FRAME + step) as f64 / STEPS_PER_SECOND, data)?;
            simulation.advance(1.0 / STEPS_PER_SECOND)?;
        }
        log.record(simulation, capture.real_top(), subject_speed(capture, data, simulation.time())?);

        if let Some((view, compositor)) = &compositor {
            let hull = simulation.hull();
            let picture = capture.picture(*view, hull.as_ref().map_or(0.0, |hull| hull.time()));
            let picture = picture
                .map_err(|e| Error::argument(format!("{e}; fix it, or run without a film: --no-gif")))?;
            let real = |ray: &Ray| hull.as_ref().and_then(|hull| capture.hit(ray, *view, hull));
            film.push(compositor.draw(&picture, &simulation.drawn(), &real));
        }
        shown(simulation.summary());
    }

    Ok(())
}

/// The speed of the fastest part of the subject at `time`, in m/s; `None` while it stands still. It does not depend on the
/// simulation's own hull, which has no velocities where it is held.
fn subject_speed(capture: &impl Story, data: &HullData, time: f64) -> Result<Option<f64>> {
    if time <= capture.still_until() {
        return Ok(None);
    }
    Ok(fastest_part(&*data.in_motion(Motion::Interpolated, time)?))
}
