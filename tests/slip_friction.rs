//! Friction along the slip: Coulomb's law in all directions, where ODE has a pyramid whose axes it chooses itself.

use nalgebra::{Vector3, vector};
use ode_visual_hull::ode::{BodyId, Shape, SpaceKind, Surface, World};
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;

const STEP: f64 = 1.0 / 240.0;

const MU: f64 = 0.3;

const GRAVITY: f64 = 9.81;

/// The thickness of the boxes that slide, in metres.
const THICKNESS: f64 = 0.04;

/// A flat box that has settled on what the world has at height `top`.
fn settled_box(world: &mut World, top: f64) -> BodyId {
    let shape = Shape::cuboid(0.12, 0.12, THICKNESS);
    let (body, _) = add_body(world, &shape, &at(0.0, 0.0, top + 0.5 * THICKNESS));
    slide(world, 60, &Surface::with_friction(MU));
    body
}

fn slide(world: &mut World, steps: usize, surface: &Surface) {
    for _ in 0..steps {
        world.default_collide(surface, 8).unwrap();
        world.step(STEP).unwrap();
    }
}

fn on_plane() -> World {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 }).unwrap();
    world
}

fn on_hull() -> World {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, &table()).unwrap();
    world
}

/// How far a box slides at 0.8 m/s, along its way and across it, over the way of Coulomb's law, at eight directions.
fn ways(make: impl Fn() -> World, top: f64, surface: &Surface) -> Vec<[f64; 2]> {
    let speed = 0.8;
    let way = |k: u8| {
        let mut world = make();
        let body = settled_box(&mut world, top);
        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 8.0 + 0.3).sin_cos();
        let (along, across) = (vector![cos, sin, 0.0], vector![-sin, cos, 0.0]);
        let start = world.body(body).position();
        world.body_mut(body).set_linear_velocity(&(along * speed)).unwrap();
        slide(&mut world, 120, surface);
        let moved = world.body(body).position() - start;
        let expected = speed * speed / (2.0 * MU * GRAVITY);
        [along.dot(&moved) / expected, across.dot(&moved).abs() / expected]
    };
    (0..8).map(way).collect()
}

#[test]
fn a_box_slides_over_a_hull_as_far_as_coulombs_law_says_in_all_directions() {
    for [along, across] in ways(on_hull, TOP, &Surface::with_friction(MU)) {
        // The first step takes away its part of the speed before the box moves: mu g dt / v is 0.015.
        assert!((0.97..1.01).contains(&along), "{along}");
        // The table's edges are off by up to a fiftieth of a pixel, which tilts it by some thousandths.
        assert!(across < 0.01, "{across}");
    }
}

#[test]
fn friction_along_the_slip_is_an_option_for_odes_own_geoms() {
    let along_slip = || {
        let mut world = on_plane();
        assert!(!world.slip_friction());
        world.set_slip_friction(true);
        world
    };
    let surface = Surface::with_friction(MU);
    for [along, across] in ways(along_slip, 0.0, &surface) {
        assert!((0.97..1.01).contains(&along) && across < 1e-3, "{along}, {across}");
    }
    // Without it, a box that slides between ODE's directions stops after two thirds of the way, and leaves its course.
    let plain = ways(on_plane, 0.0, &surface);
    assert!(plain.iter().any(|[along, _]| *along < 0.8), "{plain:?}");
    assert!(plain.iter().any(|[_, across]| *across > 0.05), "{plain:?}");
}

#[test]
fn a_friction_direction_of_the_surface_is_kept() {
    // Without friction across x, a box that moves along y is not braked.
    let surface =
        Surface { mu2: Some(0.0), friction_direction: Some(Vector3::x()), ..Surface::with_friction(MU) };
    for (mut world, top) in [(on_hull(), TOP), (on_plane(), 0.0)] {
        world.set_slip_friction(true);
        let body = settled_box(&mut world, top);
        world.body_mut(body).set_linear_velocity(&vector![0.3, 0.3, 0.0]).unwrap();
        slide(&mut world, 60, &surface);
        let velocity = world.body(body).linear_velocity();
        assert!(velocity.x.abs() < 1e-3 && (velocity.y - 0.3).abs() < 0.01, "{velocity}");
    }
}

#[test]
fn a_push_between_odes_directions_moves_a_box_if_it_exceeds_coulombs_limit() {
    // 1.2 times the friction: along the diagonal each of ODE's directions would hold 1.2 / 1.41 of its limit.
    let push = vector![1.0, 1.0, 0.0].normalize() * (1.2 * MU * GRAVITY);
    for (slip_friction, moves) in [(false, false), (true, true)] {
        let mut world = on_plane();
        world.set_slip_friction(slip_friction);
        let body = settled_box(&mut world, 0.0);
        for _ in 0..60 {
            world.body_mut(body).add_force(&push).unwrap();
            slide(&mut world, 1, &Surface::with_friction(MU));
        }
        // 0.2 mu g over a quarter of a second.
        let speed = world.body(body).linear_velocity().norm();
        let expected = if moves { 0.2 * MU * GRAVITY * 0.25 } else { 0.0 };
        assert!((speed - expected).abs() < 0.02 * 0.15, "{speed} m/s, expected {expected}");
    }
}

#[test]
fn what_does_not_slip_has_no_direction_and_a_kinematic_body_is_not_accelerated() {
    let mut world = on_plane();
    let body = settled_box(&mut world, 0.0);
    let slips = |world: &mut World| {
        let mut found = Vec::new();
        world
            .collide(|pair| {
                let contacts = pair.contacts(8);
                found.extend(contacts.iter().map(|contact| pair.slip_direction(contact, STEP)));
            })
            .unwrap();
        found
    };
    world.body_mut(body).set_linear_velocity(&Vector3::zeros()).unwrap();
    world.body_mut(body).set_angular_velocity(&Vector3::zeros()).unwrap();
    let resting = slips(&mut world);
    assert!(!resting.is_empty() && resting.iter().all(Option::is_none), "{resting:?}");

    // Gravity along the plane makes it slip in the next step, but not a body that no force moves.
    world.set_gravity(&vector![GRAVITY, 0.0, -GRAVITY]).unwrap();
    let pulled = slips(&mut world);
    assert!(pulled.iter().flatten().all(|direction| direction.x.abs() > 0.999), "{pulled:?}");
    assert_eq!(pulled.iter().flatten().count(), pulled.len());
    world.body_mut(body).set_kinematic(true);
    assert!(slips(&mut world).iter().all(Option::is_none));
}
