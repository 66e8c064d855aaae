//! How far apart boxes come to rest that fall on a real table as noisy masks show it, and on a table of ODE's whose place is
//! as uncertain.

use crate::studio::*;
use nalgebra::{Isometry3, Vector3, point, vector};
use ode_visual_hull::ode::{Shape, World};
use ode_visual_hull::synthetic::coverage;
use ode_visual_hull_testing::edge_noise::displace_edge;
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use ode_visual_hull_testing::random::Random;

/// Boxes that fall on each table.
const RUNS: u64 = 100;

/// The side of the box, which falls on an edge from 5 cm and comes to rest within the time, in metres and seconds.
const SIDE: f64 = 0.12;
const SECONDS: f64 = 3.0;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("boxes on a table seen by noisy masks");
    let on_hull = spread((0..RUNS).map(on_hull));
    progress("boxes on a table whose place is uncertain");
    let on_native = spread((0..RUNS).map(on_native));
    vec![
        Figure::bounded("predictability", on_hull / on_native, AtMost(2.0)),
        Figure::reported("predictability_spread_mm", 1e3 * on_hull),
        Figure::reported("predictability_spread_mm_native", 1e3 * on_native),
    ]
}

/// The root mean square distance of the boxes' corners from where they are in the mean, in metres.
fn spread(poses: impl Iterator<Item = Isometry3<f64>>) -> f64 {
    let corners: Vec<Vec<Vector3<f64>>> = poses.map(|pose| corners_of(&pose)).collect();
    let mean = |k: usize| corners.iter().map(|of_box| of_box[k]).sum::<Vector3<f64>>() / RUNS as f64;
    let means: Vec<_> = (0..8).map(mean).collect();
    let distances = corners.iter().flat_map(|of_box| of_box.iter().zip(&means).map(|(a, b)| (a - b).norm()));
    rms(&distances.collect::<Vec<_>>())
}

/// The corners of a box.
fn corners_of(pose: &Isometry3<f64>) -> Vec<Vector3<f64>> {
    let sign = |k: usize, bit: usize| if k >> bit & 1 == 0 { -0.5 * SIDE } else { 0.5 * SIDE };
    let corner = |k: usize| (pose * point![sign(k, 0), sign(k, 1), sign(k, 2)]).coords;
    (0..8).map(corner).collect()
}

/// Where a box comes to rest on the table as masks with a pixel of noise show it.
fn on_hull(seed: u64) -> Isometry3<f64> {
    let cameras = level_ring(TOP);
    let data = data(&cameras);
    let clean = masks(&cameras, &table(), coverage);
    let noisy =
        clean.iter().enumerate().map(|(view, mask)| displace_edge(mask, 1.0, seed << 8 | view as u64));
    publish(&data, &noisy.collect::<Vec<_>>(), 0.0);
    let mut world = world(0, 0.5 * pixel());
    let root = world.root_space();
    world.add_hull(root, &data).expect("room for the class");
    fall(world)
}

/// Where a box comes to rest on a table of ODE's, of which each coordinate is off by a pixel's size (one standard deviation).
fn on_native(seed: u64) -> Isometry3<f64> {
    let mut random = Random(seed);
    // The sum of twelve numbers between -0.5 and 0.5 has a deviation of 1.
    let mut deviate = || pixel() * (0..12).map(|_| random.between(-0.5, 0.5)).sum::<f64>();
    let place = vector![deviate(), deviate(), deviate()];
    let mut world = world(0, 0.5 * pixel());
    let root = world.root_space();
    let native = world.add_geom(root, &Shape::Box { sides: TABLE }).expect("positive sizes");
    world.geom_mut(native).set_pose(&at(place.x, place.y, place.z)).expect("finite");
    fall(world)
}

fn fall(mut world: World) -> Isometry3<f64> {
    let tilt = Isometry3::rotation(vector![0.5, 0.1, 0.3]);
    let (body, _) = add_body(&mut world, &Shape::cube(SIDE), &(at(0.0, 0.0, TOP + SIDE + 0.05) * tilt));
    for _ in 0..(SECONDS / DT) as usize {
        step(&mut world);
    }
    world.body(body).pose()
}
