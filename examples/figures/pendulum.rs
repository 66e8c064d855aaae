//! How late a virtual body follows a real one, found from outside: a plate that swings carries a box, by the wall clock, and
//! the phases of the two are compared. And whether any hull is made of frames that do not belong together.

use crate::studio::*;
use nalgebra::{DMatrix, DVector, Isometry3, Point3, Vector3, vector};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{Hull, Motion};
use ode_visual_hull::ode::Shape;
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::synthetic::{Subject, coverage};
use ode_visual_hull_film::{FRAME_RATE, Pace, PaceReport, PacedFrames, Simulation, run_paced};
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};

/// How far the plate swings to either side, in metres, and for how long, in seconds: a quarter of the gravity at its ends,
/// so that the box neither slides nor leaves it.
const SWING: f64 = 0.06;
const PERIOD: f64 = 1.0;

/// How long it swings, in seconds. The first second, in which the box settles, does not count.
const SECONDS: f64 = 8.0;

/// The height of the plate's top where it rests, above the simulation's floor, and the side of the box on it.
const HEIGHT: f64 = 0.5;
const SIDE: f64 = 0.12;

/// Steps of the simulation a second.
const STEP_RATE: f64 = 240.0;

/// Number of the short runs, how long each is, in seconds, and how fast the plate rises in them, in m/s: by 4 cm in a frame.
const RUNS: usize = 200;
const SHORT: f64 = 0.25;
const RISE: f64 = 1.2;

/// What was seen after a step.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// The wall clock, in seconds.
    at: f64,
    /// The time of the hull, in seconds.
    hull: f64,
    /// Where the box is.
    place: Vector3<f64>,
    /// The height of the hull below it, in metres.
    top: f64,
}

/// The latency of the box behind the plate, in milliseconds.
struct Latency {
    /// From the sines of the two.
    by_phase: f64,
    /// From the times of the hulls.
    by_stamps: f64,
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let cameras = level_ring(HEIGHT);
    let mut figures = Vec::new();
    for (direction, name) in [(Vector3::x(), "carried"), (Vector3::z(), "lifted")] {
        progress(&format!("a box is {name} by a plate that swings"));
        let Latency { by_phase, by_stamps } = latency(&cameras, &direction);
        // Lifted, the box takes on the speed of the surface over some depth, and that speed is the mean of the last tenth of a
        // second: it lags behind the surface that its stamps tell.
        let is_bounded = direction == Vector3::x();
        let difference = (by_phase - by_stamps).abs();
        figures.push(match is_bounded {
            true => Figure::bounded("pendulum_phase_off_stamps_ms", difference, AtMost(2.0)),
            false => Figure::reported(&format!("pendulum_phase_off_stamps_ms_{name}"), difference),
        });
        figures.push(Figure::reported(&format!("pendulum_latency_by_phase_ms_{name}"), by_phase));
        figures.push(Figure::reported(&format!("pendulum_latency_by_stamps_ms_{name}"), by_stamps));
    }

    progress(&format!("{RUNS} runs of a plate that rises"));
    figures.push(Figure::bounded("wrong_frames_in_200_runs", wrong_runs(&cameras) as f64, AtMost(0.0)));
    figures
}

/// The plate, moved away from where it rests.
fn plate(moved: &Vector3<f64>) -> Subject {
    let thickness = 0.06;
    let centre = moved + Vector3::z() * (HEIGHT - 0.5 * thickness);
    Subject::new(vec![cuboid(
        vector![0.3, 0.3, thickness],
        Isometry3::translation(centre.x, centre.y, centre.z),
    )])
}

/// The frames of a plate that is moved by `ways`.
fn film(cameras: &[Camera], ways: impl Iterator<Item = Vector3<f64>>) -> PacedFrames {
    let masks = ways.map(|moved| masks(cameras, &plate(&moved), coverage)).collect();
    PacedFrames::in_a_loop(masks, FRAME_RATE).expect("frames")
}

/// Plays `frames` by the wall clock, with a box on the plate.
fn play(cameras: &[Camera], frames: &PacedFrames, motion: Motion, seconds: f64) -> (Vec<Seen>, PaceReport) {
    let data = data(cameras);
    let mut simulation = Simulation::new(&data, pixel(), motion).expect("ODE");
    simulation.add(&Shape::cube(SIDE), &at(0.0, 0.0, HEIGHT + 0.5 * SIDE), [0; 3]).expect("a box");

    let mut seen = Vec::new();
    let mut watch = |simulation: &Simulation, at: f64| {
        let Some(hull) = simulation.hull() else { return };
        let place = simulation.states()[0].pose.translation.vector;
        seen.push(Seen { at, hull: hull.time(), place, top: top_of(&hull) });
    };
    let pace = Pace { step_rate: STEP_RATE, seconds };
    let report = run_paced(frames, &data, &mut simulation, &pace, &mut watch).expect("masks of the cameras");
    (seen, report)
}

/// The height of the hull at the origin; infinite where there is none.
fn top_of(hull: &Hull) -> f64 {
    let above = 0.95;
    let ray = Ray { origin: Point3::new(0.0, 0.0, above), direction: -Vector3::z() };
    let entry = hull.ray_cast(&ray).and_then(|(entry, _)| entry);
    entry.map_or(f64::INFINITY, |entry| above - entry.t)
}

fn latency(cameras: &[Camera], direction: &Vector3<f64>) -> Latency {
    let count = (PERIOD * FRAME_RATE) as usize;
    let phase = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
    let frames = film(cameras, (0..count).map(|k| direction * (SWING * phase(k).sin())));
    let (mut seen, _) = play(cameras, &frames, Motion::Interpolated, SECONDS);
    seen.retain(|one| one.at > PERIOD);

    let age = |one: &Seen| one.at - one.hull;
    let by_stamps = seen.iter().map(age).sum::<f64>() / seen.len() as f64;
    Latency { by_phase: 1e3 * lag_of_sine(&seen, direction), by_stamps: 1e3 * by_stamps }
}

/// By how many seconds the box lags behind the sine of the plate: the phase of a sine, fitted by least squares together with
/// a place and a drift.
fn lag_of_sine(seen: &[Seen], direction: &Vector3<f64>) -> f64 {
    let angle = |k: usize| std::f64::consts::TAU * seen[k].at / PERIOD;
    let rows = DMatrix::from_fn(seen.len(), 4, |k, column| match column {
        0 => angle(k).sin(),
        1 => angle(k).cos(),
        2 => 1.0,
        _ => seen[k].at,
    });
    let places = DVector::from_iterator(seen.len(), seen.iter().map(|one| one.place.dot(direction)));
    let fit = rows.svd(true, true).solve(&places, 1e-12).expect("both factors");
    (-fit[1]).atan2(fit[0]) * PERIOD / std::f64::consts::TAU
}

/// In how many runs a hull was not where the frames of its own time are: by more than a quarter of the way between two.
fn wrong_runs(cameras: &[Camera]) -> usize {
    let count = (SHORT * FRAME_RATE).ceil() as usize + 1;
    let frames = film(cameras, (0..count).map(|k| Vector3::z() * (RISE * k as f64 / FRAME_RATE)));
    let data = data(cameras);
    let tops: Vec<f64> = (0..count)
        .map(|k| top_of(&publish_masks(&data, frames.masks(k), k as f64).expect("masks of the cameras")))
        .collect();
    let top_at = |time: f64| {
        let (before, after) = (frames.last_at(time), frames.first_at(time));
        let part = (time * FRAME_RATE - before as f64).max(0.0);
        tops[before] + part * (tops[after] - tops[before])
    };

    let is_wrong = |run: usize| {
        let motion = [Motion::Held, Motion::Interpolated][run % 2];
        let (seen, report) = play(cameras, &frames, motion, SHORT);
        let is_off = |one: &Seen| (one.top - top_at(one.hull)).abs() > 0.25 * RISE / FRAME_RATE;
        report.mixed > 0 || seen.is_empty() || seen.iter().any(is_off)
    };
    (0..RUNS).filter(|&run| is_wrong(run)).count()
}
