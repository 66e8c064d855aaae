//! Bodies that stick to a held hull: how far a ball drifts from the hand that carries it, and how fast it is when released.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::ode::{Shape, Surface};
use ode_visual_hull::synthetic::{coverage, layout};
use ode_visual_hull_testing::edge_noise::displace_edge;
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use ode_visual_hull_testing::hand::{PALM, PALM_LINE, hand};
use std::f64::consts::PI;

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

/// How long it is watched after it has come to rest, in seconds.
const AFTERWARDS: f64 = 0.1;

/// How far it turns on the way, in radians: 75 degrees.
const TURN: f64 = 1.309;

/// How hands are filmed.
#[derive(Debug, Clone, Copy)]
struct Film {
    name: &'static str,
    rate: f64,
    noise: f64,
    /// How the hull moves between frames, with the names of the figures.
    motions: &'static [(&'static str, Motion)],
}

const FILMS: [Film; 3] = [
    Film {
        name: "",
        rate: 30.0,
        noise: 0.0,
        motions: &[("", Motion::Interpolated), ("_predicted", Motion::Predicted), ("_held", Motion::Held)],
    },
    Film { name: "_60_hz", rate: 60.0, noise: 0.0, motions: &[("", Motion::Interpolated)] },
    Film {
        name: "_noisy",
        rate: 30.0,
        noise: 1.0,
        motions: &[("", Motion::Interpolated), ("_held", Motion::Held)],
    },
];

/// What the carrying of a ball gave.
#[derive(Debug, Clone, Copy, Default)]
struct Outcome {
    /// The largest distance of the ball from its place beside the hand, in metres; infinite where it did not stick all the
    /// time.
    drift: f64,
    /// The largest angle by which it has turned against the hand, in radians.
    turn: f64,
    /// The error of its velocity when it is released at full speed, as a part of that.
    release: f64,
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut figures = Vec::new();
    for film in FILMS {
        progress(&format!("a ball in a hand{}", film.name));
        for ((name, _), found) in film.motions.iter().zip(worst(&film)) {
            let name = |what: &str| format!("hold_{what}{}{name}", film.name);
            let drift = 1e3 * found.drift;
            figures.push(match name("") == "hold_" {
                true => Figure::bounded(&name("drift_mm"), drift, AtMost(10.0)),
                false => Figure::reported(&name("drift_mm"), drift),
            });
            figures.push(Figure::reported(&name("turn_deg"), found.turn.to_degrees()));
            figures.push(Figure::reported(&name("release_speed_error"), found.release));
        }
    }
    figures
}

/// The worst outcomes of several hands, cameras and seeds, for each motion of the hull.
fn worst(film: &Film) -> Vec<Outcome> {
    let mut worst = vec![Outcome::default(); film.motions.len()];
    for seed in if film.noise > 0.0 { 0..2 } else { 0..1 } {
        for (way, cameras) in [(Way::across(), cameras(8)), (Way::upwards(), cameras(7))] {
            let late = 1.0 / film.rate;
            let last = ((back() + AFTERWARDS + late) * film.rate) as usize + 1;
            let frames: Vec<_> = (0..=last).map(|frame| shoot(film, &way, &cameras, frame, seed)).collect();
            for ((_, motion), worst) in film.motions.iter().zip(&mut worst) {
                let carried =
                    Carrying { rate: film.rate, motion: *motion, way, cameras: &cameras, frames: &frames };
                let (whole, released) = (carried.simulate(seed, false), carried.simulate(seed, true));
                worst.drift = worst.drift.max(whole.drift);
                worst.turn = worst.turn.max(whole.turn);
                worst.release = worst.release.max(released.release);
            }
        }
    }
    worst
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

/// The masks of a frame.
fn shoot(film: &Film, way: &Way, cameras: &[Camera], frame: usize, seed: u64) -> Vec<GrayImage> {
    let clean = masks(cameras, &hand(&way.at(frame as f64 / film.rate)), coverage);
    if film.noise == 0.0 {
        return clean;
    }
    let noisy = |(view, mask): (usize, &GrayImage)| {
        displace_edge(mask, film.noise, seed << 32 | (frame << 8 | view) as u64)
    };
    clean.iter().enumerate().map(noisy).collect()
}

/// A ball that a filmed hand carries.
struct Carrying<'f> {
    rate: f64,
    motion: Motion,
    way: Way,
    cameras: &'f [Camera],
    frames: &'f [Vec<GrayImage>],
}

impl Carrying<'_> {
    /// Carries the ball to and fro, or until the step after it is released where the hand is fastest. It is compared with the
    /// hand at the hull's own time.
    fn simulate(&self, seed: u64, is_released: bool) -> Outcome {
        let late = if self.motion == Motion::Interpolated { 1.0 / self.rate } else { 0.0 };
        let end = late + if is_released { fastest() } else { back() + AFTERWARDS };
        let data = data(self.cameras);
        let mut world = world(seed, 0.001);
        let root = world.root_space();
        let hull = world.add_hull(root, &data).expect("room for the class");
        world.hull_mut(hull).set_motion(self.motion);
        let on_palm = at(0.0, PALM_LINE, PALM + RADIUS - SUNK);
        let ball = Shape::Sphere { radius: RADIUS };
        let (ball, _) = add_body(&mut world, &ball, &(self.way.at(0.0) * on_palm));

        let (mut frame, mut outcome, last) = (0, Outcome::default(), (end / STEP) as usize);
        for step in 0..=last {
            let time = step as f64 * STEP;
            while frame as f64 / self.rate <= time + 1e-9 {
                publish(&data, &self.frames[frame], frame as f64 / self.rate);
                frame += 1;
            }
            world.hull_mut(hull).set_time(time).expect("times that grow");
            let beside = self.way.at(time - late).inverse() * world.body(ball).pose();
            outcome.drift =
                outcome.drift.max((beside.translation.vector - on_palm.translation.vector).norm());
            outcome.turn = outcome.turn.max(beside.rotation.angle());

            let is_last = is_released && step == last;
            world.hull_mut(hull).hold(!is_last);
            world.default_collide(&Surface::with_friction(0.8), 8).expect("a valid surface");
            world.quick_step(STEP).expect("finite states");
            if is_last {
                let expected = self.way.velocity(time - late, &on_palm.translation.vector.into());
                // Gravity has acted for a step.
                let found = world.body(ball).linear_velocity() + Vector3::z() * (9.81 * STEP);
                outcome.release = (found - expected).norm() / expected.norm();
            } else if !world.hull(hull).holds(ball) {
                outcome.drift = f64::INFINITY;
            }
        }
        outcome
    }
}
