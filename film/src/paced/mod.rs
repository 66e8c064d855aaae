//! Masks by the wall clock on one thread, and a simulation that keeps up with it on another, as in a live system.
//!
//! ```text
//!   thread of the cameras     masks of frame k, published when it was taken ──► HullData
//!   thread of the simulation  step n, collided at n / 120 s ◄──────────────────────┘
//! ```
//!

mod frames;
mod report;
mod steps;

pub use frames::PacedFrames;
pub use report::{PaceReport, Tally};
pub use steps::Steps;

use crate::simulation::Simulation;
use ode_visual_hull::hull::{Hull, HullData, Motion};
use ode_visual_hull::{Error, Result};
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

/// Rounding error of times, in seconds.
const ROUNDING: f64 = 1e-6;

/// How fast to play, and for how long.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Steps of the simulation a second.
    pub step_rate: f64,
    /// How long, in seconds.
    pub seconds: f64,
}

/// Publishes `frames` to `data` by the wall clock, and simulates by it at the same time. The simulation's time has to be 0,
/// and `data` without frames of that time or later. `watch` is called after each step with the seconds since the start.
///
/// # Errors
/// Masks that `data` refuses; a simulation that diverges. A rate that is not positive.
pub fn run_paced(
    frames: &PacedFrames,
    data: &HullData,
    simulation: &mut Simulation,
    pace: &Pace,
    watch: &mut dyn FnMut(&Simulation, f64),
) -> Result<PaceReport> {
    for (name, value) in [("steps a second", pace.step_rate), ("seconds", pace.seconds)] {
        if value.is_nan() || value <= 0.0 {
            return Err(Error::argument(format!("pace: expected {name} above 0, found {value}")));
        }
    }

    // The first frame is there when the simulation begins.
    let started = Instant::now();
    publish(frames, data, 0)?;
    let (played, simulated) = scope(|scope| {
        let played = scope.spawn(|| play_frames(frames, data, started, pace.seconds));
        let simulated = simulate(frames, simulation, started, pace, watch);
        (played.join(), simulated)
    });
    let (tally, frames_factor) =
        played.map_err(|_| Error::argument("pace: the thread of the cameras has panicked"))??;
    Ok(PaceReport { frames: tally, frames_factor, ..simulated? })
}

/// Publishes the masks of frame `k`.
fn publish(frames: &PacedFrames, data: &HullData, k: usize) -> Result<()> {
    let time = frames.time(k);
    for (view, mask) in frames.masks(k).iter().enumerate() {
        data.set_mask_at(view, mask, time)?;
    }
    data.update(time).map(|_| ())
}

/// The frames from the second on, and by how much they are faster than the clock.
fn play_frames(
    frames: &PacedFrames,
    data: &HullData,
    started: Instant,
    seconds: f64,
) -> Result<(Tally, f64)> {
    let (mut tally, mut busy, mut published) = (Tally { in_time: 1, ..Tally::default() }, 0.0, 0);
    for k in (1..).take_while(|&k| frames.time(k) + ROUNDING < seconds) {
        let (due, next) = (frames.time(k), frames.time(k + 1));
        if now(started) > next {
            tally.dropped += 1;
            continue;
        }
        let began = wait_until(started, due);
        publish(frames, data, k)?;
        let ended = now(started);
        busy += ended - began;
        published += 1;
        tally.count(ended <= next);
    }
    Ok((tally, f64::from(published) * frames.period() / busy))
}

/// The steps and latencies, in a report without frames.
fn simulate(
    frames: &PacedFrames,
    simulation: &mut Simulation,
    started: Instant,
    pace: &Pace,
    watch: &mut dyn FnMut(&Simulation, f64),
) -> Result<PaceReport> {
    let mut steps = Steps::new(pace.step_rate, 0.0);
    let mut report = PaceReport::default();
    let (mut busy, mut last_used) = (0.0, 0);
    while steps.due() < pace.seconds {
        simulation.skip(steps.drop_if_behind(now(started)));
        let began = wait_until(started, steps.due());
        simulation.step(steps.dt())?;
        let ended = now(started);
        busy += ended - began;
        steps.count(ended);
        watch(simulation, ended);

        if let Some(hull) = simulation.hull() {
            report.mixed += usize::from(is_mixed(&hull));
            let used = latest_used(&hull, simulation.motion(), frames);
            if used > last_used && simulation.touches_hull() {
                let collided = (simulation.collided_at() - started).as_secs_f64();
                report.latencies.push(collided - frames.time(used));
            }
            last_used = used;
        }
    }
    report.latencies.sort_by(f64::total_cmp);
    report.steps = steps.tally();
    let done = (report.steps.in_time + report.steps.late) as f64;
    report.simulation_factor = done * steps.dt() / busy;
    Ok(report)
}

/// The number of the latest frame of which a hull is made.
fn latest_used(hull: &Hull, motion: Motion, frames: &PacedFrames) -> usize {
    match motion {
        // Between two frames it is made of both.
        Motion::Interpolated => frames.first_at(hull.time()),
        Motion::Held | Motion::Predicted => frames.last_at(hull.time()),
    }
}

/// Whether the views of a hull show different times.
fn is_mixed(hull: &Hull) -> bool {
    let mut times = hull.views().iter().filter(|view| view.is_enabled()).filter_map(|view| view.time());
    let Some(first) = times.next() else { return false };
    times.any(|time| (time - first).abs() > ROUNDING)
}

fn now(started: Instant) -> f64 {
    started.elapsed().as_secs_f64()
}

/// Sleeps until a time, and returns when it has woken.
fn wait_until(started: Instant, due: f64) -> f64 {
    let left = due - now(started);
    if left > 0.0 {
        sleep(Duration::from_secs_f64(left));
    }
    now(started)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::GrayImage;
    use nalgebra::{Point3, Vector3};
    use ode_visual_hull::camera::Camera;
    use ode_visual_hull::hull::Aabb;
    use std::sync::Arc;

    const PACE: Pace = Pace { step_rate: 100.0, seconds: 0.3 };

    fn run(mask: GrayImage, pace: &Pace, watch: &mut dyn FnMut(&Simulation, f64)) -> Result<PaceReport> {
        let data = Arc::new(HullData::new());
        let eye = Point3::new(3.0, 0.0, 1.0);
        let camera = Camera::look_at("one", (64, 48), 0.8, eye, Point3::origin(), Vector3::z())?;
        data.add_view(camera)?;
        data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0))?)?;
        let mut simulation = Simulation::new(&data, 0.01, Motion::Held)?;
        let frames = PacedFrames::in_a_loop(vec![vec![mask]; 2], 30.0)?;
        run_paced(&frames, &data, &mut simulation, pace, watch)
    }

    #[test]
    fn every_frame_and_step_that_was_due_is_counted_once() {
        let mut ends = Vec::new();
        let report = run(GrayImage::new(64, 48), &PACE, &mut |_, end| ends.push(end)).unwrap();
        let sum = |tally: Tally| tally.in_time + tally.late + tally.dropped;
        assert_eq!(sum(report.frames), 9);
        // On a machine that is busy, the steps that are dropped last may be due after the end.
        assert!(sum(report.steps) >= 30, "{}", report.steps);
        assert_eq!(ends.len(), report.steps.in_time + report.steps.late);
        assert!(ends.is_sorted());
        assert_eq!((report.mixed, report.latency(1.0)), (0, None));
        assert!(report.to_string().contains("none"));
    }

    #[test]
    fn nothing_is_played_at_no_rate_for_no_time_or_with_masks_of_another_size() {
        let refused = |mask: GrayImage, pace: Pace| run(mask, &pace, &mut |_, _| ()).unwrap_err().to_string();
        let mask = || GrayImage::new(64, 48);
        assert!(refused(mask(), Pace { step_rate: f64::NAN, ..PACE }).contains("steps a second above 0"));
        assert!(refused(mask(), Pace { seconds: -1.0, ..PACE }).contains("seconds above 0"));
        assert!(refused(GrayImage::new(10, 10), PACE).contains("one"));
    }
}
