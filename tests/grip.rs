//! Bodies between two sides of a hull, as between two hands, are held, and not pressed by thousands of times their weight.

use nalgebra::{point, vector};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{BodyId, Shape, SpaceKind, Surface, World};
use ode_visual_hull::synthetic::{Subject, layout};
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;
use std::sync::Arc;

const STEP: f64 = 0.01;

/// The box is 0.2 m wide, and has so much too little room between the hands, in metres.
const SQUEEZE: f64 = 0.012;

/// Two real blocks as hands, seen by eight cameras, two of which look through the gap between them.
fn hands() -> Arc<HullData> {
    let middle = 0.1 + 0.04 - 0.5 * SQUEEZE;
    let hand = |side: f64| cuboid(vector![0.08, 0.12, 0.16], at(side * middle, 0.0, 0.0));
    let cameras = layout::staggered(8, 3.0, &[0.0, 1.0], point![0.0, 0.0, 0.0], (640, 480), 0.5).unwrap();
    let data = data_with(&cameras);
    show(&data, &cameras, &Subject::new(vec![hand(-1.0), hand(1.0)]), 0.0);
    data
}

/// A box of 1 kg between the hands, after two seconds.
fn held_box(surface: &Surface) -> (World, BodyId) {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, &hands()).unwrap();
    let (body, _) = add_body(&mut world, &Shape::cuboid(0.2, 0.15, 0.15), &at(0.0, 0.0, 0.0));
    for _ in 0..200 {
        world.default_collide(surface, 8).unwrap();
        // The direct solver, so that no part of the outcome is a matter of iterations.
        world.step(STEP).unwrap();
    }
    (world, body)
}

#[test]
fn a_box_between_two_sides_with_too_little_room_is_held() {
    let (world, body) = held_box(&Surface::with_friction(0.8));
    let moved = world.body(body).position().coords.norm();
    // Half the squeeze, since it may be nearer to one side. With contacts as stiff as others it has moved by 0.1 m.
    assert!(moved < 0.5 * SQUEEZE, "{moved} m");
}

#[test]
fn a_box_between_two_sides_is_pressed_by_some_times_its_weight() {
    let (mut world, body) = held_box(&Surface::with_friction(0.8));
    world
        .collide(|pair| {
            for contact in pair.contacts(8).iter() {
                let surface = pair.surface_at(contact, &Surface::with_friction(0.8), STEP);
                pair.attach_measured(contact, &surface);
            }
        })
        .unwrap();
    world.step(STEP).unwrap();
    let pressing: f64 = world
        .contact_feedback()
        .iter()
        .map(|(_, of_joint)| (of_joint.forces[0] + of_joint.forces[1]).x.abs())
        .sum();
    let weight = 9.81 * world.body(body).mass().total();
    // Both sides, 6 mm of depth at eight contacts of 140^2 N/m a kilogram: 96 times the weight at most. With contacts as
    // stiff as others it is some ten thousand times.
    assert!(pressing > weight && pressing < 100.0 * weight, "{} times its weight", pressing / weight);
}

#[test]
fn a_softness_that_the_surface_states_is_kept() {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, &hands()).unwrap();
    add_body(&mut world, &Shape::cuboid(0.2, 0.15, 0.15), &at(0.0, 0.0, 0.0));
    let stated = Surface { soft_cfm: Some(1e-4), ..Surface::default() };
    let mut found = Vec::new();
    world
        .collide(|pair| {
            for contact in pair.contacts(8).iter() {
                found.push(
                    [Surface::default(), stated].map(|surface| pair.surface_at(contact, &surface, STEP)),
                );
            }
        })
        .unwrap();
    assert!(!found.is_empty());
    for [default, stated] in found {
        assert!(default.soft_erp.is_some() && default.soft_cfm.is_some());
        assert_eq!((stated.soft_erp, stated.soft_cfm), (None, Some(1e-4)));
    }
}
