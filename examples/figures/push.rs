//! Boxes that a moving board pushes, and boxes on a tray that is carried along.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Vector3, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{MaskFilter, Motion};
use ode_visual_hull::ode::{GeomId, Shape, Surface, World};
use ode_visual_hull::synthetic::{Subject, coverage, layout};
use ode_visual_hull_testing::edge_noise::displace_edge;
use ode_visual_hull_testing::figure::{
    Bound::{AtLeast, AtMost, Between},
    Figure,
};

/// Seconds of a step: 240 Hz.
const STEP: f64 = 1.0 / 240.0;

/// The side lengths of the board, which moves along x. It is as large as a box's side.
const BOARD: Vector3<f64> = Vector3::new(0.04, 0.3, 0.3);

/// Side length of the pushed box, in metres.
const SIDE: f64 = 0.3;

/// The near side of the box at the start.
const FIRST_TOUCH: f64 = -0.1;

/// The place of the board's centre at which the push ends.
const END: f64 = 0.25;

/// A push as cameras film it.
struct Film {
    speed: f64,
    rate: f64,
    noise: f64,
    /// The seed of the noise.
    seed: u64,
    cameras: Vec<Camera>,
    /// The masks of each frame.
    frames: Vec<Vec<GrayImage>>,
}

/// How a push is simulated.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// In the names of figures.
    name: &'static str,
    motion: Motion,
    erp: f64,
    /// The weight of a new mask against the filtered last one.
    new_weight: f64,
}

const INTERPOLATED: Run = Run { name: "", motion: Motion::Interpolated, erp: 0.05, new_weight: 1.0 };

/// The simulations of films without noise and with it.
const CLEAN_RUNS: [Run; 4] = [
    INTERPOLATED,
    Run { name: "_erp_0_2", erp: 0.2, ..INTERPOLATED },
    Run { name: "_predicted", motion: Motion::Predicted, ..INTERPOLATED },
    Run { name: "_held", motion: Motion::Held, ..INTERPOLATED },
];
const NOISY_RUNS: [Run; 4] = [
    INTERPOLATED,
    Run { name: "_erp_0_2", erp: 0.2, ..INTERPOLATED },
    Run { name: "_filter_0_5", new_weight: 0.5, ..INTERPOLATED },
    Run { name: "_filter_0_3", new_weight: 0.3, ..INTERPOLATED },
];

/// What a push gave.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    /// The box's speed at the end over the board's.
    ratio: f64,
    /// How far the board was in the box at most, by where the hull shows it, in metres.
    sink: f64,
    /// How many frames late the box began to move.
    latency: f64,
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (optics, cameras) in [("", cameras()), ("_lens", through_lenses(&cameras()))] {
        progress(&format!("pushes{optics}"));
        let runs = if optics.is_empty() { &CLEAN_RUNS[..] } else { &[INTERPOLATED] };
        let clean = all_pushes(&cameras, 0.0, runs);
        figures.extend(pushed(&clean[0], optics, 1.06, 10.0));
        if let [_, erp, predicted, held] = &clean[..] {
            figures.extend(reported(erp, "push", CLEAN_RUNS[1].name));
            figures.extend(of_prediction(predicted));
            figures.extend(reported(held, "held_push", ""));
        }

        progress(&format!("pushes with 1 px of noise{optics}"));
        let runs = if optics.is_empty() { &NOISY_RUNS[..] } else { &[INTERPOLATED] };
        let noisy = all_pushes(&cameras, 1.0, runs);
        figures.extend(pushed(&noisy[0], &format!("_noisy{optics}"), 1.10, 15.0));
        let mean = noisy[0].iter().map(|push| push.ratio).sum::<f64>() / noisy[0].len() as f64;
        figures.push(Figure::reported(&format!("push_speed_ratio_mean_noisy{optics}"), mean));
        for (run, found) in runs.iter().zip(&noisy).skip(1) {
            figures.extend(reported(found, "push", &format!("_noisy{}", run.name)));
        }
    }

    progress("a box on a tray");
    figures.push(Figure::bounded("carry_over_tray", carry(Motion::Interpolated), AtLeast(0.85)));
    figures.push(Figure::reported("carry_over_tray_held", carry(Motion::Held)));
    figures
}

/// The figures of pushes by an interpolated hull.
fn pushed(found: &[Outcome], name: &str, most: f64, deepest: f64) -> [Figure; 3] {
    let (min, max) = (least(found, |push| push.ratio), most_of(found, |push| push.ratio));
    let sink = 1e3 * most_of(found, |push| push.sink);
    [
        Figure::bounded(&format!("push_speed_ratio_min{name}"), min, AtLeast(0.99)),
        Figure::bounded(&format!("push_speed_ratio_max{name}"), max, AtMost(most)),
        Figure::bounded(&format!("push_sink_mm_max{name}"), sink, AtMost(deepest)),
    ]
}

fn reported(found: &[Outcome], what: &str, name: &str) -> [Figure; 2] {
    let (min, max) = (least(found, |push| push.ratio), most_of(found, |push| push.ratio));
    [("min", min), ("max", max)]
        .map(|(bound, ratio)| Figure::reported(&format!("{what}_speed_ratio_{bound}{name}"), ratio))
}

/// The figures of pushes by a predicted hull.
fn of_prediction(found: &[Outcome]) -> [Figure; 3] {
    let (min, max) = (least(found, |push| push.ratio), most_of(found, |push| push.ratio));
    let latency = most_of(found, |push| push.latency);
    [
        Figure::bounded("predicted_push_ratio_min", min, AtLeast(0.95)),
        Figure::bounded("predicted_push_ratio_max", max, AtMost(1.15)),
        Figure::bounded("predicted_latency_frames", latency, Between(-1.0, 0.25)),
    ]
}

fn least(pushes: &[Outcome], value: impl Fn(&Outcome) -> f64) -> f64 {
    pushes.iter().map(value).fold(f64::INFINITY, f64::min)
}

fn most_of(pushes: &[Outcome], value: impl Fn(&Outcome) -> f64) -> f64 {
    pushes.iter().map(value).fold(f64::NEG_INFINITY, f64::max)
}

/// Pushes at three speeds, filmed at two rates: the outcomes of each of `runs`.
fn all_pushes(cameras: &[Camera], noise: f64, runs: &[Run]) -> Vec<Vec<Outcome>> {
    let seeds = if noise > 0.0 { 0..5 } else { 0..1 };
    let mut found = vec![Vec::new(); runs.len()];
    for seed in seeds {
        for speed in [0.5, 1.0, 2.0] {
            for rate in [10.0, 30.0] {
                let film = Film::new(cameras, speed, rate, noise, seed);
                for (run, found) in runs.iter().zip(&mut found) {
                    found.push(film.simulate(run));
                }
            }
        }
    }
    found
}

/// Eight cameras on a level ring, two of which look along the board.
fn cameras() -> Vec<Camera> {
    layout::ring(8, 5.0, 0.0, ORIGIN, (640, 480), 0.5).expect("a ring")
}

impl Film {
    /// Films a push until it has ended, as an interpolated hull shows it.
    fn new(cameras: &[Camera], speed: f64, rate: f64, noise: f64, seed: u64) -> Self {
        let (cameras, frames) = (cameras.to_vec(), Vec::new());
        let mut film = Self { speed, rate, noise, seed, cameras, frames };
        let last = (film.end(1.0 / rate) * rate) as usize + 1;
        film.frames = (0..=last).map(|frame| film.masks(frame)).collect();
        film
    }

    /// The first time at which the board touches the box.
    fn touch(&self) -> f64 {
        // Four frames, so that its motion is known.
        4.0 / self.rate
    }

    /// When a push ends, as a hull shows it that is late by `latency` seconds.
    fn end(&self, latency: f64) -> f64 {
        self.touch() + (END + 0.5 * BOARD.x - FIRST_TOUCH) / self.speed + latency
    }

    /// The place of the board's centre at a time.
    fn board(&self, time: f64) -> f64 {
        FIRST_TOUCH - 0.5 * BOARD.x + self.speed * (time - self.touch())
    }

    fn masks(&self, frame: usize) -> Vec<GrayImage> {
        let time = frame as f64 / self.rate;
        let subject = Subject::new(vec![cuboid(BOARD, at(self.board(time), 0.0, 0.0))]);
        let clean = masks(&self.cameras, &subject, coverage);
        if self.noise == 0.0 {
            return clean;
        }
        let noisy = |(view, mask): (usize, &GrayImage)| {
            displace_edge(mask, self.noise, self.seed << 32 | (frame << 8 | view) as u64)
        };
        clean.iter().enumerate().map(noisy).collect()
    }

    fn simulate(&self, run: &Run) -> Outcome {
        let data = data(&self.cameras);
        let filter = MaskFilter { new_weight: run.new_weight, ..MaskFilter::default() };
        data.set_mask_filter(filter).expect("a weight from 0 to 1");
        // The surface layer: about half a pixel for masks with noise.
        let mut world = world(self.seed, if self.noise > 0.0 { 0.002 } else { 0.001 });
        world.set_erp(run.erp).expect("in range");
        let root = world.root_space();
        let hull = world.add_hull(root, &data).expect("room for the class");
        world.hull_mut(hull).set_motion(run.motion);
        let floor = Shape::Plane { normal: Vector3::z(), offset: -0.5 * SIDE };
        world.add_geom(root, &floor).expect("a unit normal");
        let pose = at(FIRST_TOUCH + 0.5 * SIDE, 0.0, 0.0);
        let (body, _) = add_body(&mut world, &Shape::cube(SIDE), &pose);

        let latency = if run.motion == Motion::Interpolated { 1.0 / self.rate } else { 0.0 };
        let end = self.end(latency);
        let (mut frame, mut sink, mut began) = (0, 0.0_f64, None);
        for step in 0.. {
            let time = step as f64 * STEP;
            if time > end {
                break;
            }
            while frame as f64 / self.rate <= time + 1e-9 {
                publish(&data, &self.frames[frame], frame as f64 / self.rate);
                frame += 1;
            }
            world.hull_mut(hull).set_time(time).expect("times that grow");
            let front = self.board(time - latency) + 0.5 * BOARD.x;
            sink = sink.max(front - (world.body(body).position().x - 0.5 * SIDE));
            collide(&mut world, hull);
            world.quick_step(STEP).expect("finite states");
            if began.is_none() && world.body(body).linear_velocity().x > 0.1 * self.speed {
                began = Some(time);
            }
        }
        let ratio = world.body(body).linear_velocity().x / self.speed;
        let latency = (began.unwrap_or(end) - self.touch()) * self.rate;
        Outcome { ratio, sink, latency }
    }
}

/// Attaches contacts that move as the board does; the floor has no friction.
fn collide(world: &mut World, hull: GeomId) {
    let found = world.collide(|pair| {
        let is_board = pair.geoms().contains(&hull);
        let surface = Surface::with_friction(if is_board { 0.5 } else { 0.0 });
        for contact in pair.contacts(8).iter() {
            match pair.surface_motion(contact, STEP) {
                Some(motion) => pair.attach(contact, &surface.with_motion(&motion)),
                None => pair.attach(contact, &surface),
            }
        }
    });
    found.expect("valid contacts");
}

/// How far a box is carried by a tray, over how far the tray moves: 0.7 m along x, filmed at 30 Hz.
fn carry(motion: Motion) -> f64 {
    const WAY: f64 = 0.7;
    const SECONDS: f64 = 1.4;
    const RATE: f64 = 30.0;
    // A tray at rest, that starts and stops smoothly.
    let tray = |time: f64| {
        let part = ((time - 0.3) / SECONDS).clamp(0.0, 1.0);
        WAY * (part * part * (3.0 - 2.0 * part) - 0.5)
    };
    let sides = vector![0.5, 0.5, 0.06];
    let cameras = layout::ring(8, 5.0, 0.5 * sides.z, ORIGIN, (640, 480), 0.5).expect("a ring");
    let data = data(&cameras);

    let mut world = world(0, 0.001);
    world.set_erp(if motion == Motion::Held { 0.2 } else { 0.05 }).expect("in range");
    let root = world.root_space();
    let hull = world.add_hull(root, &data).expect("room for the class");
    world.hull_mut(hull).set_motion(motion);
    let (body, _) = add_body(&mut world, &Shape::cube(0.15), &at(tray(0.0), 0.0, 0.5 * sides.z + 0.076));

    let mut frame = 0;
    for step in 0..(2.2 / STEP) as usize {
        let time = step as f64 * STEP;
        while f64::from(frame) / RATE <= time + 1e-9 {
            let place = tray(f64::from(frame) / RATE);
            let subject = Subject::new(vec![cuboid(sides, at(place, 0.0, 0.0))]);
            publish(&data, &masks(&cameras, &subject, coverage), f64::from(frame) / RATE);
            frame += 1;
        }
        world.hull_mut(hull).set_time(time).expect("times that grow");
        world.default_collide(&Surface::with_friction(0.5), 8).expect("a valid surface");
        world.quick_step(STEP).expect("finite states");
    }
    // A box that fell off was not carried.
    let position = world.body(body).position();
    if position.z < 0.0 { 0.0 } else { (position.x - tray(0.0)) / WAY }
}
