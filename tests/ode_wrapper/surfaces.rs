//! Directions of friction, and surfaces that move.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::ode::{ContactGeom, JointKind, Shape, Surface, World};

use crate::{GRAVITY, add, add_ground, run, world};

const DT: f64 = 0.001;

/// Collides and steps `n` times.
fn steps(world: &mut World, surface: &Surface, n: usize) {
    for _ in 0..n {
        world.default_collide(surface, 8).unwrap();
        world.step(DT).unwrap();
    }
}

#[test]
fn a_conveyor_carries_a_box_at_the_velocity_of_its_surface() {
    // ODE reports the two geoms in the order in which they were added, or the other way.
    for belt_first in [false, true] {
        let mut world = world();
        if belt_first {
            add_ground(&mut world);
        }
        let (body, _) = add(&mut world, &Shape::cuboid(0.4, 0.4, 0.4), 2.0, [0.0, 0.0, 0.2]);
        if !belt_first {
            add_ground(&mut world);
        }
        run(&mut world, 100, DT);

        let belt = Surface {
            friction_direction: Some(Vector3::y()),
            surface_velocity: Some([0.5, 0.0]),
            ..Surface::default()
        };
        // mu g = 4.9 m/s^2: the box reaches 0.5 m/s after 0.1 s.
        steps(&mut world, &belt, 50);
        let speed = world.body(body).linear_velocity().y;
        assert!((speed - 0.5 * GRAVITY * 0.05).abs() < 0.02, "{speed}");
        steps(&mut world, &belt, 950);
        let velocity = world.body(body).linear_velocity();
        assert!((velocity - Vector3::y() * 0.5).norm() < 1e-3, "{velocity}");
    }
}

#[test]
fn friction_differs_in_its_two_directions() {
    let mut world = world();
    // The force on a slope that falls towards x and y alike.
    world.set_gravity(&Vector3::new(3.0, 3.0, -GRAVITY)).unwrap();
    add_ground(&mut world);
    // Flat, so that it does not tip over.
    let (body, _) = add(&mut world, &Shape::cuboid(0.4, 0.4, 0.04), 2.0, [0.0, 0.0, 0.02]);

    for (direction, other) in [(Vector3::x(), Vector3::y()), (Vector3::y(), Vector3::x())] {
        let ski =
            Surface { mu: 0.1, mu2: Some(1.0), friction_direction: Some(direction), ..Surface::default() };
        world.body_mut(body).set_linear_velocity(&Vector3::zeros()).unwrap();
        steps(&mut world, &ski, 1000);
        let velocity = world.body(body).linear_velocity();
        // It slides where mu is 0.1, and sticks where 1.0 > 3 / 9.81. Contacts settle in the first steps.
        assert!((velocity.dot(&direction) - (3.0 - 0.1 * GRAVITY)).abs() < 0.02, "{velocity}");
        assert!(velocity.dot(&other).abs() < 1e-3, "{velocity}");
    }
}

#[test]
fn a_surface_that_moves_along_the_normal_pushes_the_body_away() {
    let mut world = world();
    world.set_gravity(&Vector3::zeros()).unwrap();
    let (body, geom) = add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0, 0.0, 0.1]);
    let contact = ContactGeom {
        position: Point3::origin(),
        normal: Vector3::z(),
        depth: 0.0,
        time: 0.0,
        geoms: [geom, geom],
    };
    let surface = Surface { normal_velocity: Some(0.3), ..Surface::default() };
    world.add_joint([Some(body), None], &JointKind::Contact { contact, surface }).unwrap();
    world.step(DT).unwrap();
    assert!((world.body(body).linear_velocity() - Vector3::z() * 0.3).norm() < 1e-6);
}

#[test]
fn directions_off_the_surface_and_velocities_without_a_direction_are_refused() {
    let mut world = world();
    add_ground(&mut world);
    add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0, 0.0, 0.09]);
    let plain = Surface::default();
    for bad in [
        Surface { friction_direction: Some(Vector3::z()), ..plain },
        Surface { friction_direction: Some(Vector3::x() * 2.0), ..plain },
        Surface { friction_direction: Some(Vector3::zeros()), ..plain },
        Surface { friction_direction: Some(Vector3::repeat(f64::NAN)), ..plain },
        Surface { surface_velocity: Some([1.0, 0.0]), ..plain },
        Surface { friction_direction: Some(Vector3::x()), surface_velocity: Some([0.0, f64::NAN]), ..plain },
        Surface { normal_velocity: Some(f64::INFINITY), ..plain },
    ] {
        assert!(world.default_collide(&bad, 4).is_err(), "{bad:?}");
        world.step(DT).unwrap();
    }
    let good = Surface { friction_direction: Some(Vector3::x()), ..plain };
    world.default_collide(&good, 4).unwrap();
}
