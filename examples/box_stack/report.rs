//! The results: files, and a table for the terminal.

use super::film::Film;
use super::log::{Entry, Log};
use super::plot;
use super::simulation::{Simulation, State, Support, lean_deg};
use ode_visual_hull::Result;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Below this speed, in m/s, a box rests.
const AT_REST: f64 = 0.02;

/// Before the subject moves, this long is looked at for rest, in seconds.
const WATCHED: f64 = 0.8;

/// Writes all files into `dir`; returns each with what it is.
pub fn write(
    dir: &Path,
    film: &Film,
    log: &Log,
    still_until: f64,
    moments: &[f64; 3],
) -> Result<Vec<(PathBuf, &'static str)>> {
    let mut written = Vec::new();
    if !film.is_empty() {
        let (path, strip) = (dir.join("box_stack.gif"), dir.join("box_stack.png"));
        film.write(&path)?;
        film.write_strip(moments, &strip)?;
        written.extend([(path, "film"), (strip, "three stills")]);
    }
    let (states, heights) = (dir.join("states.csv"), dir.join("heights.svg"));
    log.write_csv(&states)?;
    plot::write(&heights, log, still_until)?;
    written.extend([(states, "states"), (heights, "heights")]);
    Ok(written)
}

/// One line per box: how still it was before the subject moved, and where it ended.
pub fn table(log: &Log, simulation: &Simulation, still_until: f64, subject: &str) -> String {
    let mut text = format!(
        "                while the {subject} stands still        whole run                at the end\n\
         box   size (cm)   rms mm/s  creep mm  lean deg   max m/s  deepest mm   x, y, z (m)           mm/s  rests on\n"
    );
    let still: Vec<&Entry> = log.between(still_until - WATCHED, still_until).collect();
    let last = log.entries.last();
    for (i, (one, support)) in simulation.boxes().iter().zip(simulation.supports()).enumerate() {
        let size = one.sides * 100.0;
        let _ = write!(text, "{:>3}   {:>2.0}x{:>2.0}x{:>2.0}", i + 1, size.x, size.y, size.z);
        let _ = match Stillness::of(&still, i) {
            Some(s) => write!(text, "   {:>8.2}  {:>8.2}  {:>8.2}", s.rms_mm_s, s.creep_mm, s.lean_deg),
            None => write!(text, "   {:>8}  {:>8}  {:>8}", "-", "-", "-"),
        };
        let _ = write!(text, "   {:>7.2}  {:>10.1}", one.fastest_after_contact, 1e3 * one.deepest);
        if let Some(state) = last.map(|entry| &entry.states[i]) {
            let p = state.pose.translation.vector;
            let speed = state.linear_velocity.norm();
            let rests = match support {
                Support::Nothing => "in the air".into(),
                _ if speed > AT_REST => "still moving".into(),
                Support::Subject => subject.to_owned(),
                Support::Floor => "floor".into(),
            };
            let _ =
                writeln!(text, "   {:>5.2}, {:>5.2}, {:>5.2}   {:>7.1}  {rests}", p.x, p.y, p.z, 1e3 * speed);
        }
    }
    text
}

/// One line on the amount of work.
pub fn summary(frames: usize, cameras: usize, took: Duration) -> String {
    let seconds = took.as_secs_f64();
    let each = 1e3 * seconds / frames.max(1) as f64;
    format!("{frames} frames of {cameras} cameras in {seconds:.1} s ({each:.0} ms a frame)\n\n")
}

/// How a box kept still.
struct Stillness {
    rms_mm_s: f64,
    creep_mm: f64,
    lean_deg: f64,
}

impl Stillness {
    fn of(entries: &[&Entry], i: usize) -> Option<Self> {
        let (first, last) = (entries.first()?, entries.last()?);
        let state = |entry: &Entry| -> State { entry.states[i] };
        let squares: f64 = entries.iter().map(|entry| state(entry).linear_velocity.norm_squared()).sum();
        let crept = state(last).pose.translation.vector - state(first).pose.translation.vector;
        Some(Self {
            rms_mm_s: 1e3 * (squares / entries.len() as f64).sqrt(),
            creep_mm: 1e3 * crept.norm(),
            lean_deg: lean_deg(&state(last).pose.rotation),
        })
    }
}
