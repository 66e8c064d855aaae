//! Masks by the wall clock on one thread, and a simulation that keeps up with it on another, as in a live system.
//!
//! ```text
//!   thread of the cameras     masks of frame k, published at k / 30 s ──► HullData
//!   thread of the simulation  step n, collided at n / 120 s ◄──────────────┘
//! ```
//!
//! A frame that comes more than a period late is dropped, as a camera would. A simulation that is behind by more than
//! [`MOST_BEHIND`] steps drops those that are due, so that it is never late silently. Both are counted.

use crate::simulation::Simulation;
use image::GrayImage;
use ode_visual_hull::hull::{Hull, HullData, Motion};
use ode_visual_hull::{Error, Result};
use std::fmt;
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

/// Steps by which the simulation may be behind the wall clock before it drops some.
pub const MOST_BEHIND: f64 = 4.0;

/// Rounding error of times, as a part of a frame.
const ROUNDING: f64 = 1e-6;

/// How fast to play, and for how long.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Frames a second.
    pub frame_rate: f64,
    /// Steps of the simulation a second.
    pub step_rate: f64,
    /// How long, in seconds.
    pub seconds: f64,
}

/// How many frames or steps were due, and what became of them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Done before the next one was due.
    pub in_time: usize,
    /// Done after that.
    pub late: usize,
    /// Not done.
    pub dropped: usize,
}

/// What a paced run has shown.
#[derive(Debug, Clone, Default)]
pub struct PaceReport {
    /// The frames.
    pub frames: Tally,
    /// The steps.
    pub steps: Tally,
    /// From a mask's time stamp to the end of the first collide with a hull that is made of it, for each frame at which a body
    /// touched the hull then, in seconds, sorted.
    pub latencies: Vec<f64>,
    /// Simulated seconds over the seconds that the simulation has worked, and recorded ones over those in which frames were
    /// published.
    pub simulation_factor: f64,
    /// As [`Self::simulation_factor`], of the thread of the cameras.
    pub frames_factor: f64,
    /// Hulls whose views are of different times, but for lost ones.
    pub mixed: usize,
}

impl Tally {
    fn count(&mut self, is_in_time: bool) {
        let place = if is_in_time { &mut self.in_time } else { &mut self.late };
        *place += 1;
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in time, {} late, {} dropped", self.in_time, self.late, self.dropped)
    }
}

impl PaceReport {
    /// The latency that a part of the frames, from 0 to 1, do not exceed, in seconds; `None` without any.
    pub fn latency(&self, part: f64) -> Option<f64> {
        let last = self.latencies.len().checked_sub(1)?;
        self.latencies.get((part * last as f64).ceil() as usize).copied()
    }

    /// By how much the slower of the two threads is faster than the wall clock.
    pub fn realtime_factor(&self) -> f64 {
        self.simulation_factor.min(self.frames_factor)
    }
}

impl fmt::Display for PaceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "frames       {}; {:.1} times as fast as the clock", self.frames, self.frames_factor)?;
        writeln!(f, "steps        {}; {:.1} times as fast as the clock", self.steps, self.simulation_factor)?;
        let latency = |part: f64| self.latency(part).map_or("none".into(), |s| format!("{:.2} ms", 1e3 * s));
        writeln!(
            f,
            "latency      median {}, 99 % {}, worst {}, from a mask's time stamp to its first contact, {} frames",
            latency(0.5),
            latency(0.99),
            latency(1.0),
            self.latencies.len()
        )?;
        if self.frames.dropped + self.steps.dropped > 0 {
            writeln!(
                f,
                "note: the machine is too slow for this pace: {} frames were not shown and {} steps not simulated; use fewer \
                 bodies, views or pixels, or fewer steps a second",
                self.frames.dropped, self.steps.dropped
            )?;
        }
        Ok(())
    }
}

/// Publishes `masks`, those of one frame after the other and then from the first one on again, to `data` by the wall clock,
/// and simulates by it at the same time. The simulation's time has to be 0, and `data` without frames.
///
/// # Errors
/// No masks; masks that `data` refuses; a simulation that diverges. A rate that is not positive.
pub fn run_paced(
    masks: &[Vec<GrayImage>],
    data: &HullData,
    simulation: &mut Simulation,
    pace: &Pace,
) -> Result<PaceReport> {
    let Pace { frame_rate, step_rate, seconds } = *pace;
    if masks.is_empty() {
        return Err(Error::argument("pace: expected frames with masks, found none"));
    }
    for (name, value) in
        [("frames a second", frame_rate), ("steps a second", step_rate), ("seconds", seconds)]
    {
        if value.is_nan() || value <= 0.0 {
            return Err(Error::argument(format!("pace: expected {name} above 0, found {value}")));
        }
    }

    // The first frame is there when the simulation begins.
    let started = Instant::now();
    publish(masks, data, 0, frame_rate)?;
    let (frames, simulated) = scope(|scope| {
        let frames = scope.spawn(|| play_frames(masks, data, started, pace));
        let simulated = simulate(simulation, started, pace);
        (frames.join(), simulated)
    });
    let (frames, frames_factor) =
        frames.map_err(|_| Error::argument("pace: the thread of the cameras has panicked"))??;
    Ok(PaceReport { frames, frames_factor, ..simulated? })
}

/// Publishes the masks of frame `k`.
fn publish(masks: &[Vec<GrayImage>], data: &HullData, k: usize, frame_rate: f64) -> Result<()> {
    let time = k as f64 / frame_rate;
    for (view, mask) in masks[k % masks.len()].iter().enumerate() {
        data.set_mask_at(view, mask, time)?;
    }
    data.update(time).map(|_| ())
}

/// The frames from the second on, and by how much they are faster than the clock.
fn play_frames(
    masks: &[Vec<GrayImage>],
    data: &HullData,
    started: Instant,
    pace: &Pace,
) -> Result<(Tally, f64)> {
    let period = 1.0 / pace.frame_rate;
    let (mut tally, mut busy, mut published) = (Tally { in_time: 1, ..Tally::default() }, 0.0, 0);
    for k in 1..(pace.seconds * pace.frame_rate) as usize {
        let due = k as f64 * period;
        if now(started) > due + period {
            tally.dropped += 1;
            continue;
        }
        let began = wait_until(started, due);
        publish(masks, data, k, pace.frame_rate)?;
        let ended = now(started);
        busy += ended - began;
        published += 1;
        tally.count(ended <= due + period);
    }
    Ok((tally, f64::from(published) * period / busy))
}

/// The steps and latencies, in a report without frames.
fn simulate(simulation: &mut Simulation, started: Instant, pace: &Pace) -> Result<PaceReport> {
    let dt = 1.0 / pace.step_rate;
    let mut report = PaceReport::default();
    let (mut busy, mut last_used, mut n) = (0.0, 0, 0_u32);
    while f64::from(n) * dt < pace.seconds {
        let behind = (now(started) / dt - f64::from(n)).floor();
        if behind > MOST_BEHIND {
            report.steps.dropped += behind as usize;
            n += behind as u32;
            simulation.skip(behind * dt);
        }
        let due = f64::from(n) * dt;
        let began = wait_until(started, due);
        simulation.step(dt)?;
        let ended = now(started);
        busy += ended - began;
        report.steps.count(ended <= due + dt);
        n += 1;

        if let Some(hull) = simulation.hull() {
            report.mixed += usize::from(is_mixed(&hull));
            let used = latest_used(&hull, simulation.motion(), pace.frame_rate);
            if used > last_used && simulation.touches_hull() {
                let collided = (simulation.collided_at() - started).as_secs_f64();
                report.latencies.push(collided - used as f64 / pace.frame_rate);
            }
            last_used = used;
        }
    }
    report.latencies.sort_by(f64::total_cmp);
    let done = (report.steps.in_time + report.steps.late) as f64;
    report.simulation_factor = done * dt / busy;
    Ok(report)
}

/// The number of the latest frame of which a hull is made.
fn latest_used(hull: &Hull, motion: Motion, frame_rate: f64) -> usize {
    let frame = hull.time() * frame_rate;
    match motion {
        // Between two frames it is made of both.
        Motion::Interpolated => (frame - ROUNDING).ceil().max(0.0) as usize,
        Motion::Held | Motion::Predicted => (frame + ROUNDING).floor().max(0.0) as usize,
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
    use nalgebra::{Point3, Vector3};
    use ode_visual_hull::camera::Camera;
    use ode_visual_hull::hull::Aabb;
    use std::sync::Arc;

    const PACE: Pace = Pace { frame_rate: 30.0, step_rate: 100.0, seconds: 0.3 };

    fn run(masks: &[Vec<GrayImage>], pace: &Pace) -> Result<PaceReport> {
        let data = Arc::new(HullData::new());
        let eye = Point3::new(3.0, 0.0, 1.0);
        let camera = Camera::look_at("one", (64, 48), 0.8, eye, Point3::origin(), Vector3::z())?;
        data.add_view(camera)?;
        data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0))?)?;
        let mut simulation = Simulation::new(&data, 0.01, Motion::Held)?;
        run_paced(masks, &data, &mut simulation, pace)
    }

    #[test]
    fn every_frame_and_step_that_was_due_is_counted_once() {
        let masks = vec![vec![GrayImage::new(64, 48)]; 2];
        let report = run(&masks, &PACE).unwrap();
        let sum = |tally: Tally| tally.in_time + tally.late + tally.dropped;
        assert_eq!(sum(report.frames), 9);
        // On a machine that is busy, the steps that are dropped last may be due after the end.
        assert!(sum(report.steps) >= 30, "{}", report.steps);
        assert_eq!((report.mixed, report.latency(1.0)), (0, None));
        assert!(report.to_string().contains("none"));
    }

    #[test]
    fn nothing_is_played_without_masks_or_at_no_rate() {
        let refused = |masks: &[Vec<GrayImage>], pace: Pace| run(masks, &pace).unwrap_err().to_string();
        let masks = [vec![GrayImage::new(64, 48)]];
        assert!(refused(&[], PACE).contains("found none"));
        assert!(refused(&masks, Pace { frame_rate: 0.0, ..PACE }).contains("frames a second above 0"));
        assert!(refused(&masks, Pace { step_rate: f64::NAN, ..PACE }).contains("steps a second above 0"));
        assert!(refused(&masks, Pace { seconds: -1.0, ..PACE }).contains("seconds above 0"));
        let wrong = [vec![GrayImage::new(10, 10)]];
        assert!(refused(&wrong, PACE).contains("one"));
    }

    #[test]
    fn a_run_that_drops_says_what_was_left_out_and_what_to_do() {
        let slow = Tally { in_time: 3, late: 2, dropped: 5 };
        let report =
            PaceReport { steps: slow, latencies: vec![0.001, 0.002, 0.010], ..PaceReport::default() };
        let text = report.to_string();
        assert!(text.contains("5 steps not simulated; use fewer bodies"), "{text}");
        assert_eq!((report.latency(0.5), report.latency(0.99)), (Some(0.002), Some(0.010)));
    }
}
