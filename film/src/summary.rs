//! The results of a run: files, and a table for the terminal.

use crate::bodies_file::BodiesFile;
use crate::body_shape;
use crate::capture::Story;
use crate::film::Film;
use crate::log::{Entry, Log};
use crate::plot;
use crate::simulated_body::{AT_REST, State, Support};
use crate::simulation::{Simulation, lean_deg};
use crate::states::States;
use crate::subject_speed::quantile;
use ode_visual_hull::Result;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The part of the frames in which the subject's fastest part is slower than its speed in the summary, so that no single
/// frame decides.
const SLOWER_FRAMES: f64 = 0.95;

/// Duration before the subject moves over which stillness is measured, in seconds.
const STILLNESS_SECONDS: f64 = 0.8;

/// Writes all files to `dir`, film and stills as `name`; returns their paths and descriptions.
pub(crate) fn write(
    dir: &Path,
    name: &str,
    film: &Film,
    log: &Log,
    bodies: &BodiesFile,
    story: &impl Story,
) -> Result<Vec<(PathBuf, &'static str)>> {
    let mut written = Vec::new();
    if !film.is_empty() {
        let (path, strip) = (dir.join(format!("{name}.gif")), dir.join(format!("{name}.png")));
        film.write(&path)?;
        film.write_strip(&story.moments(), &strip)?;
        written.extend([(path, "film"), (strip, "three stills")]);
    }

    let (states, heights) = (dir.join(States::NAME), dir.join("heights.svg"));
    let of_bodies = dir.join(BodiesFile::NAME);
    log.write_csv(&states)?;
    bodies.write(&of_bodies)?;
    plot::write(&heights, log, story.still_until())?;
    written.extend([(states, "states"), (of_bodies, "bodies"), (heights, "heights")]);

    Ok(written)
}

/// A table of the bodies: how still each was before the subject moved, and where it ended.
pub(crate) fn table(log: &Log, simulation: &Simulation, still_until: f64, subject: &str) -> String {
    let mut text = format!(
        "                   while the {subject} stands still               whole run             at the end\n\
         body    size (cm)  on         rms mm/s  creep mm  lean deg  max m/s  deepest mm  on         x, y, z (m)          mm/s\n"
    );
    let still: Vec<&Entry> = log.between(still_until - STILLNESS_SECONDS, still_until + 1e-6).collect();
    for (i, one) in simulation.bodies().iter().enumerate() {
        let size = body_shape::lengths(&one.parts) * 100.0;
        let _ = write!(text, "{:>7} {:>2.0}x{:>2.0}x{:>2.0} ", log.bodies[i].0, size.x, size.y, size.z);
        let _ = match Stillness::of(&still, i) {
            Some(s) => {
                let on = place(s.on, s.speed, subject);
                write!(text, "  {on:<9}  {:>8.2}  {:>8.2}  {:>8.2}", 1e3 * s.rms, 1e3 * s.creep, s.lean_deg)
            }
            None => write!(text, "  {:<9}  {:>8}  {:>8}  {:>8}", "-", "-", "-", "-"),
        };
        let _ = write!(text, "  {:>7.2}  {:>10.1}", one.fastest_after_contact, 1e3 * one.deepest);
        if let Some(last) = log.entries.last() {
            let p = last.states[i].pose.translation.vector;
            let speed = last.states[i].linear_velocity.norm();
            let on = place(last.supports[i], speed, subject);
            let _ = write!(text, "  {on:<9}  {:>5.2}, {:>5.2}, {:>5.2}  {:>6.1}", p.x, p.y, p.z, 1e3 * speed);
        }
        text.push('\n');
    }

    text
}

/// What a body rests on, or a word for its motion.
fn place(support: Support, speed: f64, subject: &str) -> &str {
    match support {
        Support::Nothing => "in flight",
        _ if speed > AT_REST => "moving",
        Support::Subject => subject,
        Support::Floor => "floor",
    }
}

/// A line that compares the fastest body with the fastest part of the subject, whose speed is the 95th percentile of
/// [`Entry::subject_speed`] over the frames in which it moves.
pub(crate) fn speeds(log: &Log, simulation: &Simulation) -> String {
    let moving = log.entries.iter().filter_map(|entry| entry.subject_speed).filter(|&speed| speed > 0.0);
    let subject = &log.subject;
    let Some(of_subject) = quantile(moving.collect(), SLOWER_FRAMES) else {
        return format!("speed: the {subject} does not move\n");
    };

    let of_body = simulation.bodies().iter().map(|one| one.fastest_without_fall).fold(0.0, f64::max);
    let ratio = of_body / of_subject;
    format!(
        "speed: fastest part of the {subject} {of_subject:.2} m/s; fastest body {of_body:.2} m/s without falling, \
         {ratio:.2} of it\n"
    )
}

/// A line on the number of frames and the time they took.
pub(crate) fn summary(frames: usize, cameras: usize, took: Duration) -> String {
    let seconds = took.as_secs_f64();
    let each = 1e3 * seconds / frames.max(1) as f64;
    format!("{frames} frames of {cameras} cameras in {seconds:.1} s ({each:.0} ms a frame)\n\n")
}

/// How still a body was over some frames; metres and metres a second.
struct Stillness {
    on: Support,
    speed: f64,
    rms: f64,
    creep: f64,
    lean_deg: f64,
}

impl Stillness {
    /// The stillness of body `i`; `None` without entries.
    fn of(entries: &[&Entry], i: usize) -> Option<Self> {
        let (first, last) = (entries.first()?, entries.last()?);
        let state = |entry: &Entry| -> State { entry.states[i] };
        let squares: f64 = entries.iter().map(|entry| state(entry).linear_velocity.norm_squared()).sum();
        let crept = state(last).pose.translation.vector - state(first).pose.translation.vector;
        Some(Self {
            on: last.supports[i],
            speed: state(last).linear_velocity.norm(),
            rms: (squares / entries.len() as f64).sqrt(),
            creep: crept.norm(),
            lean_deg: lean_deg(&state(last).pose.rotation),
        })
    }
}
