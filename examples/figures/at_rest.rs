//! The jitter of a box at rest on noisy silhouettes, compared with ODE's own box, with other modes and with the paper's
//! method.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Isometry3, Vector3, vector};
use ode_visual_hull::contact::{self, Mode};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{BodyId, Shape, World};
use ode_visual_hull::sample;
use ode_visual_hull::synthetic::{flip_boundary, silhouette};
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use std::sync::Arc;

/// Seconds of settling before the measurement.
pub const SETTLE: f64 = 3.0;

/// Seconds of the measurement.
pub const MEASURE: f64 = 5.0;

/// Share of boundary pixels that are flipped once for all frames.
const CONSTANT_FLIPS: f64 = 0.37;

/// Share of boundary pixels that are flipped anew in each frame.
const LIVE_FLIPS: f64 = 0.05;

/// Frame rate of the live cameras, in frames a second.
const LIVE_HZ: f64 = 30.0;

const BOX: Vector3<f64> = Vector3::new(0.2, 0.2, 0.2);

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("a box on still, noisy masks");
    let still: Vec<f64> = SEEDS.map(|seed| on_still_masks(seed, Mode::Clustered)).collect();
    let single = median(SEEDS.map(|seed| on_still_masks(seed, Mode::Single)));
    let worst = still.iter().copied().fold(0.0, f64::max);

    progress("a box on live masks");
    let live = median(SEEDS.map(on_live_masks));

    let multi = median(still);

    vec![
        Figure::bounded("rest_rms_mm_s", multi, AtMost(0.5)),
        Figure::bounded("rest_rms_mm_s_worst_seed", worst, AtMost(10.0)),
        Figure::reported("rest_rms_mm_s_native", median(SEEDS.map(on_native))),
        Figure::bounded("rest_live_rms_mm_s", live, AtMost(2.0)),
        // A box that does not move at all counts as moving by a nanometre a second, to avoid a division by zero.
        Figure::reported("single_over_multi_jitter", single / multi.max(1e-6)),
        Figure::reported("literal_rest_rms_mm_s", median(SEEDS.map(literal))),
    ]
}

fn noisy(masks: &[GrayImage], probability: f64, seed: u64) -> Vec<GrayImage> {
    let flipped = masks.iter().enumerate().map(|(view, mask)| {
        let mut mask = mask.clone();
        flip_boundary(&mut mask, probability, 1000 * seed + view as u64).expect("a probability");
        mask
    });
    flipped.collect()
}

/// A world with the box a millimetre above the table, which is a hull or ODE's own box.
fn box_above(seed: u64, layer: f64, hull: Option<(&Arc<HullData>, Mode)>) -> (World, BodyId) {
    let mut world = world(seed, layer);
    let root = world.root_space();
    match hull {
        Some((data, mode)) => {
            let hull = world.add_hull(root, data).expect("room for the class");
            world.hull_mut(hull).set_mode(mode);
        }
        None => {
            world.add_geom(root, &Shape::Box { sides: TABLE }).expect("positive sizes");
        }
    }

    let turned = at(0.02, -0.03, TOP + 0.101) * nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4);
    let (body, _) = add_body(&mut world, &Shape::Box { sides: BOX }, &turned);
    (world, body)
}

/// RMS speed in mm/s after settling. `before` is called with the time before each step.
fn rms_speed(world: &mut World, body: BodyId, mut before: impl FnMut(f64)) -> f64 {
    let mut speeds = Vec::new();
    let steps = ((SETTLE + MEASURE) / DT) as usize;
    for k in 0..steps {
        let time = k as f64 * DT;
        before(time);
        step(world);
        if time >= SETTLE {
            speeds.push(1000.0 * speed(world, body));
        }
    }
    rms(&speeds)
}

fn on_native(seed: u64) -> f64 {
    let (mut world, body) = box_above(seed, 0.001, None);
    rms_speed(&mut world, body, |_| ())
}

fn on_still_masks(seed: u64, mode: Mode) -> f64 {
    let cameras = level_ring(TOP);
    let data = data(&cameras);
    publish(&data, &noisy(&masks(&cameras, &table(), silhouette), CONSTANT_FLIPS, seed), 0.0);
    let (mut world, body) = box_above(seed, 0.001, Some((&data, mode)));
    rms_speed(&mut world, body, |_| ())
}

/// A world with the box above a table whose masks flicker, and what shows the masks of a time.
pub fn box_on_live_masks(seed: u64) -> (World, BodyId, impl FnMut(f64)) {
    let cameras = level_ring(TOP);
    let data = data(&cameras);
    let clean = masks(&cameras, &table(), silhouette);
    publish(&data, &noisy(&clean, LIVE_FLIPS, seed), 0.0);
    let (mut world, body) = box_above(seed, 0.5 * pixel(), Some((&data, Mode::Clustered)));
    let hull = world.geoms().next().expect("the hull came first");
    world.hull_mut(hull).set_min_feature(0.015).expect("positive");

    let mut frame = 0;
    let next_masks = move |time: f64| {
        let due = (time * LIVE_HZ) as u64;
        if due > frame {
            frame = due;
            publish(&data, &noisy(&clean, LIVE_FLIPS, seed + 10_000 * frame), time);
        }
    };
    (world, body, next_masks)
}

fn on_live_masks(seed: u64) -> f64 {
    let (mut world, body, next_masks) = box_on_live_masks(seed);
    rms_speed(&mut world, body, next_masks)
}

/// RMS speed in mm/s by the paper's section 3, without a solver: the box moves by its response vector, and its velocity
/// is reflected at the tangent plane.
fn literal(seed: u64) -> f64 {
    let cameras = level_ring(TOP);
    let data = data(&cameras);
    publish(&data, &noisy(&masks(&cameras, &table(), silhouette), CONSTANT_FLIPS, seed), 0.0);
    let (_, hull) = data.latest().expect("published");

    let samples = sample::box_(BOX, 0.03).expect("positive sizes");
    let mut position = vector![0.02, -0.03, TOP + 0.101];
    let mut velocity = Vector3::zeros();
    let mut speeds = Vec::new();

    for k in 0..((SETTLE + MEASURE) / DT) as usize {
        velocity.z -= 9.81 * DT;
        position += velocity * DT;
        let pose = Isometry3::translation(position.x, position.y, position.z);
        let response = contact::body_response(&hull, &samples, &pose);
        if let Some(normal) = response.vector.try_normalize(0.0) {
            position += response.vector;
            velocity -= normal * (2.0 * velocity.dot(&normal)).min(0.0);
        }
        if k as f64 * DT >= SETTLE {
            speeds.push(1000.0 * velocity.norm());
        }
    }

    rms(&speeds)
}
