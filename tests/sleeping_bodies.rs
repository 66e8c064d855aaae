//! Bodies that sleep on a hull wake when the hull at them changes, in a world of Rust.

use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{BodyId, GeomId, SpaceKind, World};
use ode_visual_hull::synthetic::{Subject, flip_boundary};
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;
use std::sync::Arc;

/// A world with a box that sleeps on the table's hull.
fn asleep(data: &Arc<HullData>) -> (World, GeomId, BodyId) {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    let hull = world.add_hull(root, data).unwrap();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.101));
    world.body_mut(body).set_auto_disable(true);
    for _ in 0..400 {
        step(&mut world, 0.005);
    }
    assert!(!world.body(body).is_enabled(), "the box sleeps");
    (world, hull, body)
}

/// Publishes the table, lifted by `lift` metres.
fn show_lifted(data: &HullData, lift: f64, time: f64) {
    let lifted = Isometry3::translation(0.0, 0.0, lift);
    show(data, &table_cameras(), &Subject::new(vec![cuboid(TABLE, lifted)]), time);
}

#[test]
fn whatever_takes_the_hull_away_wakes_what_lay_on_it() {
    type Change = fn(&mut World, GeomId);
    let changes: [(&str, Change); 7] = [
        ("removed", |world, hull| assert!(world.remove_geom(hull))),
        ("disabled", |world, hull| world.geom_mut(hull).set_enabled(false)),
        ("out of the categories", |world, hull| world.geom_mut(hull).set_category_bits(0)),
        ("colliding with nothing", |world, hull| world.geom_mut(hull).set_collide_bits(0)),
        ("moved", |world, hull| world.geom_mut(hull).set_pose(&at(5.0, 0.0, 0.0)).unwrap()),
        ("lowered", |world, hull| world.geom_mut(hull).set_pose(&at(0.0, 0.0, -0.02)).unwrap()),
        ("of other data", |world, hull| {
            let other = data_with(&table_cameras());
            show_lifted(&other, -0.1, 0.0);
            world.hull_mut(hull).set_data(&other);
        }),
    ];
    for (name, change) in changes {
        let (mut world, hull, body) = asleep(&table());
        change(&mut world, hull);
        (0..2).for_each(|_| step(&mut world, 0.005));
        assert!(world.body(body).is_enabled(), "a hull that is {name}");
    }

    // Removed together with its space.
    let data = table();
    let mut world = world(SpaceKind::default());
    let inner = world.add_space(world.root_space(), SpaceKind::Simple).unwrap();
    world.add_hull(inner, &data).unwrap();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.1));
    world.body_mut(body).set_auto_disable(true);
    (0..200).for_each(|_| step(&mut world, 0.005));
    assert!(!world.body(body).is_enabled());
    world.remove_space(inner).unwrap();
    step(&mut world, 0.005);
    assert!(world.body(body).is_enabled());
}

#[test]
fn slow_motions_of_the_hull_add_up() {
    let data = table();
    let (mut world, _, body) = asleep(&data);
    let mut woken_at = None;
    // Half a pixel at a time.
    for k in 1..5 {
        show_lifted(&data, 0.5 * PIXEL * f64::from(k), f64::from(k));
        step(&mut world, 0.005);
        if woken_at.is_none() && world.body(body).is_enabled() {
            woken_at = Some(k);
        }
    }
    // Woken once the surface has moved by 1.5 px; the coverage at the edge is good to a third of a pixel.
    assert!(woken_at.is_some_and(|k| (3..=4).contains(&k)), "{woken_at:?}");
}

#[test]
fn a_body_sleeps_on_beside_a_hull_whose_edges_flicker() {
    let data = table();
    let (mut world, _, body) = asleep(&data);
    for k in 1..25 {
        let noisy = table_masks().iter().enumerate().map(|(view, mask)| {
            let mut mask = mask.clone();
            flip_boundary(&mut mask, 0.05, 100 * k + view as u64).unwrap();
            mask
        });
        publish(&data, &noisy.collect::<Vec<_>>(), k as f64);
        step(&mut world, 0.005);
        assert!(!world.body(body).is_enabled(), "frame {k}");
    }
}

#[test]
fn a_body_that_was_put_to_sleep_by_the_program_wakes_at_the_first_touch() {
    let data = table();
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, &data).unwrap();
    // In the air above the table, where no collide has asked for it.
    let (body, _) = add_body(&mut world, &cube(0.1), &at(0.1, 0.1, TOP + 0.3));
    world.set_gravity(&Vector3::zeros()).unwrap();
    world.body_mut(body).set_enabled(false);
    (0..30).for_each(|_| step(&mut world, 0.005));
    assert!(!world.body(body).is_enabled());

    show_lifted(&data, 0.27, 1.0);
    step(&mut world, 0.005);
    assert!(world.body(body).is_enabled());
}
