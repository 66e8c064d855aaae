//! Bodies that stick to a held hull: how far a ball drifts from the hand that carries it, and how fast it is when released.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::ode::Shape;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use ode_visual_hull_testing::edge_noise::displace_edge;
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use std::f64::consts::{FRAC_PI_2, PI};

/// Seconds of a step: 240 Hz.
const STEP: f64 = 1.0 / 240.0;

/// The radius of the ball, and by how much it is in the palm when it is grabbed, in metres.
const RADIUS: f64 = 0.04;
const SUNK: f64 = 0.003;

/// The hand is at rest for this long, in seconds. Then it moves to and fro along a cosine, and turns.
const REST: f64 = 0.3;

/// Its greatest speed, in m/s, and how far it moves, in metres.
const SPEED: f64 = 2.0;
const WAY: f64 = 0.6;

/// How far it turns on the way, in radians: 75 degrees.
const TURN: f64 = 1.309;

/// How a hand is filmed and shown.
#[derive(Debug, Clone, Copy)]
struct Run {
    name: &'static str,
    rate: f64,
    noise: f64,
    motion: Motion,
}

/// What the carrying of a ball gave.
#[derive(Debug, Clone, Copy, Default)]
struct Outcome {
    /// The largest distance of the ball from its place beside the hand, in metres.
    drift: f64,
    /// The largest angle by which it has turned against the hand, in radians.
    turn: f64,
    /// The error of its velocity when it is released at full speed, as a part of that.
    release: f64,
    /// Whether it stuck to the hand all the time.
    held: bool,
}

const CLEAN: Run = Run { name: "", rate: 30.0, noise: 0.0, motion: Motion::Interpolated };
const RUNS: [Run; 6] = [
    CLEAN,
    Run { name: "_60_hz", rate: 60.0, ..CLEAN },
    Run { name: "_noisy", noise: 1.0, ..CLEAN },
    Run { name: "_predicted", motion: Motion::Predicted, ..CLEAN },
    Run { name: "_held", motion: Motion::Held, ..CLEAN },
    Run { name: "_held_noisy", motion: Motion::Held, noise: 1.0, ..CLEAN },
];

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut figures = Vec::new();
    for run in RUNS {
        progress(&format!("a ball in a hand{}", run.name));
        let found = worst(&run);
        let name = |what: &str| format!("hold_{what}{}", run.name);
        figures.push(if run.name.is_empty() {
            Figure::bounded(&name("drift_mm"), 1e3 * found.drift, AtMost(10.0))
        } else {
            Figure::reported(&name("drift_mm"), 1e3 * found.drift)
        });
        figures.push(Figure::reported(&name("turn_deg"), found.turn.to_degrees()));
        figures.push(Figure::reported(&name("release_speed_error"), found.release));
    }
    figures
}

/// The worst outcome of several hands, cameras and seeds.
fn worst(run: &Run) -> Outcome {
    let seeds = if run.noise > 0.0 { 0..3 } else { 0..1 };
    let paths = [Way::across(), Way::upwards()];
    let rigs = [cameras(8), cameras(7)];
    let cases = seeds.flat_map(|seed| paths.iter().zip(&rigs).map(move |(way, rig)| (seed, way, rig)));
    let outcomes = cases.map(|(seed, way, rig)| carry(run, way, rig, seed));
    outcomes.fold(Outcome { held: true, ..Outcome::default() }, |worst, one| Outcome {
        // A ball that was lost has drifted without bound.
        drift: if one.held { worst.drift.max(one.drift) } else { f64::INFINITY },
        turn: worst.turn.max(one.turn),
        release: worst.release.max(one.release),
        held: worst.held && one.held,
    })
}

/// Cameras around the origin at two heights: 2.4 mm a pixel.
fn cameras(count: usize) -> Vec<Camera> {
    layout::staggered(count, 3.0, &[0.1, 1.2], ORIGIN, (640, 480), 0.5).expect("a ring")
}

/// The way of a hand.
#[derive(Debug, Clone, Copy)]
struct Way {
    along: Vector3<f64>,
    axis: Vector3<f64>,
    /// How the hand is held at first.
    first: UnitQuaternion<f64>,
}

impl Way {
    fn across() -> Self {
        let along = vector![0.8, 0.6, 0.0];
        Self { along, axis: vector![0.2, 0.3, 1.0].normalize(), first: UnitQuaternion::identity() }
    }

    fn upwards() -> Self {
        let along = vector![0.5, -0.4, 0.7].normalize();
        let first = UnitQuaternion::from_euler_angles(0.3, -0.4, 1.0);
        Self { along, axis: vector![0.7, 0.6, 0.3].normalize(), first }
    }

    /// The part of the way at a time, from 0 to 1 and back.
    fn part(time: f64) -> f64 {
        let phase = (time - REST).max(0.0) * 2.0 * SPEED / WAY;
        0.5 - 0.5 * phase.min(2.0 * PI).cos()
    }

    /// The pose of the hand at a time.
    fn at(&self, time: f64) -> Isometry3<f64> {
        let part = Self::part(time);
        let place = self.along * (WAY * (part - 0.5));
        let turn = UnitQuaternion::from_scaled_axis(self.axis * (TURN * part));
        Isometry3::from_parts(place.into(), turn * self.first)
    }

    /// The velocity of the hand's point at `place` in its frame.
    fn velocity(&self, time: f64, place: &Point3<f64>) -> Vector3<f64> {
        let dt = 1e-5;
        (self.at(time + dt) * place - self.at(time - dt) * place) / (2.0 * dt)
    }
}

/// When the hand is fastest, and when it is back, in seconds.
fn fastest() -> f64 {
    REST + 0.25 * PI * WAY / SPEED
}
fn back() -> f64 {
    REST + PI * WAY / SPEED
}

/// A hand with its palm up: a palm, four fingers, a thumb and a forearm of capsules.
fn hand(pose: &Isometry3<f64>) -> Subject {
    let capsule = |radius: f64, length: f64, place: Isometry3<f64>| {
        Placed::new(Solid::capsule(radius, length).expect("sizes"), pose * place, Texture::plain([220, 170, 140]))
    };
    let along_x = UnitQuaternion::from_euler_angles(0.0, FRAC_PI_2, 0.0);
    let lies = |x: f64, y: f64| Isometry3::from_parts(vector![x, y, 0.0].into(), along_x);
    let across = [-0.033, -0.011, 0.011, 0.033];
    let mut parts: Vec<_> = across.iter().map(|&y| capsule(0.014, 0.07, lies(-0.02, y))).collect();
    parts.extend(across.iter().map(|&y| capsule(0.009, 0.06, lies(0.05, 1.3 * y))));
    let aside = UnitQuaternion::from_euler_angles(FRAC_PI_2 + 0.5, 0.0, 0.0);
    parts.push(capsule(0.011, 0.05, Isometry3::from_parts(vector![-0.03, 0.06, 0.01].into(), aside)));
    parts.push(capsule(0.035, 0.2, lies(-0.18, 0.0)));
    Subject::new(parts)
}

/// The masks of a frame.
fn film(run: &Run, way: &Way, cameras: &[Camera], frame: usize, seed: u64) -> Vec<GrayImage> {
    let clean = masks(cameras, &hand(&way.at(frame as f64 / run.rate)), coverage);
    if run.noise == 0.0 {
        return clean;
    }
    let noisy = |(view, mask): (usize, &GrayImage)| {
        displace_edge(mask, run.noise, seed << 32 | (frame << 8 | view) as u64)
    };
    clean.iter().enumerate().map(noisy).collect()
}

/// Carries a ball to and fro, and another time until it is released where the hand is fastest.
fn carry(run: &Run, way: &Way, cameras: &[Camera], seed: u64) -> Outcome {
    let late = if run.motion == Motion::Interpolated { 1.0 / run.rate } else { 0.0 };
    let end = back() + 0.1 + late;
    let frames: Vec<_> =
        (0..=(end * run.rate) as usize + 1).map(|frame| film(run, way, cameras, frame, seed)).collect();

    let mut outcome = simulate(run, way, cameras, &frames, seed, end, None);
    outcome.release = simulate(run, way, cameras, &frames, seed, end, Some(fastest() + late)).release;
    outcome
}

/// Simulates until `end`, or until the step after the release.
fn simulate(
    run: &Run,
    way: &Way,
    cameras: &[Camera],
    frames: &[Vec<GrayImage>],
    seed: u64,
    end: f64,
    release: Option<f64>,
) -> Outcome {
    let data = data(cameras);
    let mut world = world(seed, 0.001);
    world.set_erp(0.05).expect("in range");
    let root = world.root_space();
    let hull = world.add_hull(root, &data).expect("room for the class");
    world.hull_mut(hull).set_motion(run.motion);
    // On the palm, which is as high as its capsules are thick.
    let place = Point3::new(0.0, 0.011, 0.014 + RADIUS - SUNK);
    let (ball, _) = add_body(&mut world, &Shape::Sphere { radius: RADIUS }, &(way.at(0.0) * at(place.x, place.y, place.z)));

    let late = if run.motion == Motion::Interpolated { 1.0 / run.rate } else { 0.0 };
    let (mut frame, mut grabbed, mut outcome) = (0, None, Outcome { held: true, ..Outcome::default() });
    world.hull_mut(hull).hold(true);
    for step in 0.. {
        let time = step as f64 * STEP;
        if time > end {
            break;
        }
        while frame as f64 / run.rate <= time + 1e-9 {
            publish(&data, &frames[frame], frame as f64 / run.rate);
            frame += 1;
        }
        world.hull_mut(hull).set_time(time).expect("times that grow");
        let is_released = release.is_some_and(|release| time >= release);
        if is_released {
            world.hull_mut(hull).hold(false);
        }

        // The hull shows the hand as it was at its own time.
        let hand = way.at(time - late);
        let beside = hand.inverse() * world.body(ball).pose();
        let first: Isometry3<f64> = *grabbed.get_or_insert(beside);
        outcome.drift =
            outcome.drift.max((beside.translation.vector - first.translation.vector).norm());
        outcome.turn = outcome.turn.max(beside.rotation.angle_to(&first.rotation));
        if std::env::var_os("HOLD_TRACE").is_some() {
            println!("{time:.4} off {:?} turned {:.4} v {:?}", (hand.rotation * (beside.translation.vector - first.translation.vector) * 1e3).data.0[0].map(|x| x.round()), beside.rotation.angle_to(&first.rotation), world.body(ball).linear_velocity().data.0[0].map(|x| (x * 100.0).round() / 100.0));
        }
        collide_and_step(&mut world);
        if is_released {
            let expected = way.velocity(time - late, &first.translation.vector.into());
            // Gravity has acted for a step.
            let found = world.body(ball).linear_velocity() + Vector3::z() * (9.81 * STEP);
            outcome.release = (found - expected).norm() / expected.norm();
            break;
        }
        outcome.held &= world.hull(hull).holds(ball);
        if let Some(error) = world.hull(hull).take_left_out().or(world.hull(hull).take_error()) {
            eprintln!("{time:.3} s: {error}");
        }
    }
    outcome
}

fn collide_and_step(world: &mut ode_visual_hull::ode::World) {
    world
        .default_collide(&ode_visual_hull::ode::Surface::with_friction(0.8), 8)
        .expect("a valid surface");
    world.quick_step(STEP).expect("finite states");
}
