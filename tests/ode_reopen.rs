//! ODE closes with its last reference, and opens again. This test has a process of its own, because other tests would
//! hold ODE open.

mod foreign_class;

use nalgebra::Vector3;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{Ode, Shape, Surface, World, random_seed, set_random_seed};
use ode_visual_hull_testing::scene::{TOP, table};
use ode_visual_hull_testing::world::{drop_box_on, height, step};
use std::sync::Arc;

fn simulate(ode: &Ode) -> f64 {
    let mut world = World::new(ode).unwrap();
    world.set_gravity(&Vector3::new(0.0, 0.0, -9.81)).unwrap();
    let root = world.root_space();
    world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: -0.1 }).unwrap();

    let (body, geom) = (world.add_body(), world.add_geom(root, &Shape::Sphere { radius: 0.1 }).unwrap());
    world.geom_mut(geom).set_body(Some(body)).unwrap();

    for _ in 0..50 {
        world.default_collide(&Surface::default(), 4).unwrap();
        world.quick_step(0.01).unwrap();
    }
    world.body(body).position().z
}

/// The height at which a box comes to rest on the hull of `data`, whose class is registered after `others` other
/// classes.
fn rest_on_hull(data: &Arc<HullData>, others: usize) -> f64 {
    let _ode = Ode::init().unwrap();
    for _ in 0..others {
        foreign_class::register();
    }
    let (mut world, body) = drop_box_on(data);
    (0..200).for_each(|_| step(&mut world, 0.005));
    let root = world.root_space();
    let second = world.add_hull(root, data).unwrap();
    assert!(world.hull(second).frame().is_none(), "adopts its frame with the next collide");
    height(&world, body)
}

#[test]
fn ode_closes_with_its_last_reference_and_opens_again() {
    for _ in 0..3 {
        let ode = Ode::init().unwrap();
        let first = foreign_class::register();

        let clone = ode.clone();
        drop(ode);
        assert_eq!(foreign_class::register(), first + 1, "a clone holds ODE open");

        let world = World::new(&clone).unwrap();
        drop(clone);
        assert_eq!(foreign_class::register(), first + 2, "a world holds ODE open");
        drop(world);

        let again = Ode::init().unwrap();
        assert_eq!(
            foreign_class::register(),
            first,
            "ODE was closed in between, and has forgotten the classes"
        );
        let here = simulate(&again);
        // Another thread enters the reopened ODE too.
        let there = std::thread::spawn(move || simulate(&again)).join().unwrap();
        assert_eq!(here, there);
    }

    // Hulls register their class anew, under another number each time, and have contacts again.
    let data = table();
    for others in [0, 1, 0, 3, 2, 0] {
        let above = rest_on_hull(&data, others) - TOP - 0.1;
        assert!(above.abs() < 0.002, "{others} other classes: rests {above} m off the top");
    }

    set_random_seed(1234);
    assert_eq!(random_seed(), 1234);
}
