//! Bodies that sleep on a hull: whether they wake when the hull at them moves, and sleep on while it only flickers.

use crate::at_rest::{MEASURE, SETTLE, box_on_live_masks};
use crate::studio::*;
use image::GrayImage;
use nalgebra::Isometry3;
use ode_visual_hull::ode::{BodyId, Shape};
use ode_visual_hull::synthetic::{Subject, coverage};
use ode_visual_hull_testing::figure::{
    Bound::{AtLeast, AtMost},
    Figure,
};

/// Bodies that sleep on the table, along each side of it.
const SIDE: usize = 71;

/// Half the edge of such a body, in metres.
const HALF: f64 = 0.002;

/// How far the table sinks, in metres.
const SINK: f64 = 0.05;

/// Steps after a change of the hull.
const STEPS: usize = 30;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("bodies asleep on a table that sinks");
    let hang = many_on_a_table_that_sinks();
    progress("a table that rises under a sleeping box");
    let wakes = SEEDS.filter(|&seed| first_touch_wakes(seed)).count() as f64 / SEEDS.count() as f64;
    progress("a box asleep on a table that moves or vanishes");
    let latencies =
        SEEDS.flat_map(|seed| [Some(-SINK), Some(SINK), None].map(|lift| wake_latency(seed, lift)));
    let latency = latencies.max().unwrap_or(usize::MAX);
    progress("a box asleep on live masks");
    let asleep = median(SEEDS.map(asleep_share_on_live_masks));

    vec![
        Figure::bounded("sleepers_that_hang", hang as f64, AtMost(0.0)),
        Figure::bounded("wake_on_first_touch", wakes, AtLeast(1.0)),
        Figure::bounded("wake_latency_steps", latency as f64, AtMost(1.0)),
        Figure::reported("asleep_share_live", asleep),
    ]
}

/// The table's masks, lifted by `lift` metres.
fn lifted(lift: f64) -> Vec<GrayImage> {
    let table = Subject::new(vec![cuboid(TABLE, Isometry3::translation(0.0, 0.0, lift))]);
    masks(&level_ring(TOP), &table, coverage)
}

/// How many of 5041 bodies, all asleep on the table, are still at its top after it has sunk.
fn many_on_a_table_that_sinks() -> usize {
    let data = data(&level_ring(TOP));
    publish(&data, &lifted(0.0), 0.0);
    let mut world = world(0, 0.001);
    let root = world.root_space();
    world.add_hull(root, &data).expect("room for the class");

    let pitch = 0.46 / SIDE as f64;
    let along = |k: usize| pitch * (k as f64 + 0.5) - 0.23;
    let cube = Shape::cuboid(2.0 * HALF, 2.0 * HALF, 2.0 * HALF);
    let place = |k: usize| at(along(k % SIDE), along(k / SIDE), TOP + HALF);
    let bodies: Vec<BodyId> = (0..SIDE * SIDE).map(|k| add_body(&mut world, &cube, &place(k)).0).collect();

    // They settle for a while, and those that still roll about are put to sleep where they are.
    (0..15).for_each(|_| step(&mut world));
    for &body in &bodies {
        world.body_mut(body).set_enabled(false);
    }
    (0..3).for_each(|_| step(&mut world));

    publish(&data, &lifted(-SINK), 1.0);
    (0..STEPS).for_each(|_| step(&mut world));
    let hangs = |body: &&BodyId| {
        let body = world.body(**body);
        !body.is_enabled() && body.position().z > TOP - 0.5 * SINK
    };
    bodies.iter().filter(hangs).count()
}

/// Whether a box that sleeps on a shelf beside the table wakes when the table rises under it in one frame.
fn first_touch_wakes(seed: u64) -> bool {
    let data = data(&level_ring(TOP));
    publish(&data, &lifted(0.0), 0.0);
    let mut world = world(seed, 0.001);
    let root = world.root_space();
    world.add_hull(root, &data).expect("room for the class");
    let shelf = world.add_geom(root, &Shape::cuboid(0.3, 0.6, 0.02)).expect("positive sizes");
    world.geom_mut(shelf).set_pose(&at(0.4, 0.0, 0.45)).expect("finite");
    let (body, _) = add_body(&mut world, &Shape::cuboid(0.2, 0.1, 0.1), &at(0.28, 0.0, 0.511));
    world.body_mut(body).set_auto_disable(true);

    (0..400).for_each(|_| step(&mut world));
    assert!(!world.body(body).is_enabled(), "the box sleeps on the shelf");
    publish(&data, &lifted(0.3), 1.0);
    (0..2).for_each(|_| step(&mut world));
    world.body(body).is_enabled()
}

/// In how many steps a box that sleeps on the table wakes after that was lifted by `lift` metres, or has vanished.
fn wake_latency(seed: u64, lift: Option<f64>) -> usize {
    let data = data(&level_ring(TOP));
    publish(&data, &lifted(0.0), 0.0);
    let mut world = world(seed, 0.001);
    let root = world.root_space();
    world.add_hull(root, &data).expect("room for the class");
    let (body, _) = add_body(&mut world, &Shape::cube(0.2), &at(0.02, 0.01, TOP + 0.1));
    world.body_mut(body).set_auto_disable(true);
    (0..400).for_each(|_| step(&mut world));
    assert!(!world.body(body).is_enabled(), "the box sleeps on the table");

    let vanished = || masks(&level_ring(TOP), &Subject::default(), coverage);
    publish(&data, &lift.map_or_else(vanished, lifted), 1.0);
    let is_awake_after_step = |_: &usize| {
        step(&mut world);
        world.body(body).is_enabled()
    };
    (1..STEPS).find(is_awake_after_step).unwrap_or(STEPS)
}

/// The share of the steps of the measurement in which a box at rest on flickering masks is asleep.
fn asleep_share_on_live_masks(seed: u64) -> f64 {
    let (mut world, body, mut next_masks) = box_on_live_masks(seed);
    world.body_mut(body).set_auto_disable(true);
    let (mut asleep, mut measured) = (0, 0);
    for k in 0..((SETTLE + MEASURE) / DT) as usize {
        let time = k as f64 * DT;
        next_masks(time);
        step(&mut world);
        if time >= SETTLE {
            measured += 1;
            asleep += usize::from(!world.body(body).is_enabled());
        }
    }
    asleep as f64 / measured as f64
}
