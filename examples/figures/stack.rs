//! The creep of the top box of a stack of five on the table, and how long a stack of ten stands, compared with ODE's own
//! table.

use crate::studio::*;
use nalgebra::{Vector2, vector};
use ode_visual_hull::ode::{BodyId, Shape, World};
use ode_visual_hull::synthetic::coverage;
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};

const SIDE: f64 = 0.15;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("five boxes on the table");
    let native = median(SEEDS.map(|seed| creep(seed, false)));
    let hull = median(SEEDS.map(|seed| creep(seed, true)));
    progress("ten boxes on the table");
    vec![
        Figure::reported("stack10_stands_s", stands(true)),
        Figure::reported("stack10_stands_s_native", stands(false)),
        Figure::bounded("stack5_creep_over_native", hull / native, AtMost(1.5)),
        Figure::reported("stack5_creep_mm", hull),
        Figure::reported("stack5_creep_mm_native", native),
    ]
}

/// A world with a stack of boxes on the table.
fn stacked(seed: u64, on_hull: bool, count: u32) -> (World, Vec<BodyId>) {
    let mut world = world(seed, 0.001);
    let root = world.root_space();
    if on_hull {
        let cameras = level_ring(TOP);
        let data = data(&cameras);
        publish(&data, &masks(&cameras, &table(), coverage), 0.0);
        world.add_hull(root, &data).expect("room for the class");
    } else {
        world.add_geom(root, &Shape::Box { sides: TABLE }).expect("positive sizes");
    }

    let cube = Shape::Box { sides: vector![SIDE, SIDE, SIDE] };
    let boxes = (0..count)
        .map(|k| add_body(&mut world, &cube, &at(0.0, 0.0, TOP + SIDE * (f64::from(k) + 0.5) + 0.0005)).0)
        .collect();
    (world, boxes)
}

/// How long the top box of a stack of ten stays within half a side of its height, in seconds, at most 60.
fn stands(on_hull: bool) -> f64 {
    const SECONDS: f64 = 60.0;
    let (mut world, boxes) = stacked(0, on_hull, 10);
    let start = world.body(boxes[9]).position().z;
    let steps = (SECONDS / DT) as usize;
    let falls = (0..steps).find(|_| {
        step(&mut world);
        world.body(boxes[9]).position().z < start - 0.5 * SIDE
    });
    falls.map_or(SECONDS, |k| k as f64 * DT)
}

/// Horizontal motion of the top box from 5 to 30 s, in millimetres.
fn creep(seed: u64, on_hull: bool) -> f64 {
    let (mut world, boxes) = stacked(seed, on_hull, 5);

    let horizontal = |world: &World| {
        let p = world.body(boxes[4]).position();
        Vector2::new(p.x, p.y)
    };

    let mut at_five = Vector2::zeros();
    for k in 0..(30.0 / DT) as usize {
        step(&mut world);
        if k == (5.0 / DT) as usize {
            at_five = horizontal(&world);
        }
    }
    1000.0 * (horizontal(&world) - at_five).norm()
}
