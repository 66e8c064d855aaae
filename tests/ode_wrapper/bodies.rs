//! Bodies: motion, forces, sleep, and numbers that are not finite.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{Amount, Mass, REACH, Shape, Surface};

use crate::{GRAVITY, add, add_ground, run, world};

const DT: f64 = 0.01;

#[test]
fn free_fall_is_the_sum_of_the_semi_implicit_euler_steps() {
    for quick in [false, true] {
        let mut world = world();
        let body = world.add_body();
        let (mut velocity, mut height) = (0.0, 0.0);
        for n in 1..=200 {
            if quick {
                world.quick_step(DT).unwrap()
            } else {
                world.step(DT).unwrap()
            }

            velocity -= GRAVITY * DT;
            height += velocity * DT;
            let state = world.body(body);
            // ODE multiplies the force, not the acceleration, by the step, so that the last bits differ.
            assert!((state.position().z - height).abs() <= 1e-13 * f64::from(n), "step {n}");
            assert!((state.linear_velocity().z - velocity).abs() <= 1e-14 * f64::from(n), "step {n}");
        }
        // The sum of the steps equals g t^2 / 2 and half a step more.
        let t = 200.0 * DT;
        assert!((height + GRAVITY * t * (t + DT) / 2.0).abs() < 1e-10);
    }
}

#[test]
fn a_box_comes_to_rest_on_a_plane_and_falls_asleep() {
    let mut world = world();
    world.set_auto_disable(true);
    add_ground(&mut world);
    let (body, geom) = add(&mut world, &Shape::cuboid(0.2, 0.3, 0.4), 1.0, [0.0, 0.0, 0.3]);
    run(&mut world, 300, DT);
    let body = world.body(body);
    // The solver leaves a depth of cfm times the force, divided by the correction, far below this tolerance.
    assert!((body.position().z - 0.2).abs() < 1e-4, "{}", body.position());
    assert!(body.position().xy().coords.norm() < 1e-6);
    assert!(!body.is_enabled());
    let aabb = world.geom(geom).aabb();
    assert!((aabb.max.z - 0.4).abs() < 1e-3 && (aabb.min.x + 0.1).abs() < 1e-3, "{aabb:?}");
}

#[test]
fn friction_holds_a_box_below_the_critical_slope_and_not_above() {
    for (slope, slides) in [(0.4_f64, false), (0.6, true)] {
        let mut world = world();
        // Gravity is tilted instead of the ground; mu is 0.5.
        world.set_gravity(&(Vector3::new(slope, 0.0, -1.0).normalize() * GRAVITY)).unwrap();
        add_ground(&mut world);
        let (body, _) = add(&mut world, &Shape::cuboid(0.4, 0.4, 0.1), 1.0, [0.0, 0.0, 0.05]);
        run(&mut world, 100, DT);
        assert_eq!(
            world.body(body).position().x > 0.05,
            slides,
            "slope {slope}: {}",
            world.body(body).position()
        );
    }
}

#[test]
fn a_ball_bounces_by_its_restitution() {
    let mut world = world();
    add_ground(&mut world);
    let (body, _) = add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0, 0.0, 1.1]);
    let surface = Surface { bounce: Some(0.5), bounce_velocity: 0.1, ..Surface::default() };
    let (mut down, mut up) = (0.0_f64, 0.0_f64);

    for _ in 0..600 {
        world.default_collide(&surface, 4).unwrap();
        world.step(0.001).unwrap();
        let speed = world.body(body).linear_velocity().z;
        if up == 0.0 {
            down = down.min(speed);
            up = up.max(speed);
        }
    }
    // Gravity changes either speed by up to one step.
    assert!((up / -down - 0.5).abs() < 0.01, "{down} {up}");
}

#[test]
fn forces_and_torques_accelerate_by_mass_and_inertia() {
    let mut world = world();
    let body = world.add_body();
    let mass = Mass::of(&Shape::cuboid(1.0, 2.0, 3.0), Amount::Total(6.0)).unwrap();
    let mut body_mut = world.body_mut(body);
    body_mut.set_mass(&mass).unwrap();
    body_mut.set_gravity(false);
    body_mut.add_force_at(&Vector3::new(0.0, 12.0, 0.0), &Point3::new(1.0, 0.0, 0.0)).unwrap();
    body_mut.add_force(&Vector3::new(0.0, 6.0, 0.0)).unwrap();
    body_mut.add_torque(&Vector3::new(0.0, 0.0, 8.0)).unwrap();

    assert_eq!(world.body(body).force(), Vector3::new(0.0, 18.0, 0.0));
    assert_eq!(world.body(body).torque(), Vector3::new(0.0, 0.0, 20.0));

    world.step(DT).unwrap();
    let body = world.body(body);

    assert!((body.linear_velocity() - Vector3::new(0.0, 0.03, 0.0)).norm() < 1e-12);
    // Inertia about z: 6 (1 + 4) / 12.
    assert!((body.angular_velocity() - Vector3::new(0.0, 0.0, 20.0 / 2.5 * DT)).norm() < 1e-12);
    assert_eq!(body.force(), Vector3::zeros());

    let at_corner = body.velocity_at(&(body.position() + Vector3::x()));
    assert!((at_corner - Vector3::new(0.0, 0.03 + 0.08, 0.0)).norm() < 1e-12);
}

#[test]
fn a_kinematic_body_keeps_its_velocity_and_pushes_others() {
    let mut world = world();
    add_ground(&mut world);
    let (pusher, _) = add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [-0.3, 0.0, 0.11]);
    let (pushed, _) = add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 100.0, [0.0, 0.0, 0.1]);

    world.body_mut(pusher).set_kinematic(true);
    world.body_mut(pusher).set_linear_velocity(&Vector3::x()).unwrap();
    assert!(world.body(pusher).is_kinematic());

    run(&mut world, 100, DT);
    assert!((world.body(pusher).position().x - 0.7).abs() < 1e-9);
    assert!((world.body(pushed).position().x - 0.9).abs() < 0.01, "{}", world.body(pushed).position());

    world.body_mut(pusher).set_kinematic(false);
    assert!(!world.body(pusher).is_kinematic());
}

#[test]
fn a_sleeping_body_does_not_move_until_it_is_woken() {
    let mut world = world();
    let body = world.add_body();
    world.body_mut(body).set_enabled(false);
    world.step(DT).unwrap();
    assert_eq!(world.body(body).position(), Point3::origin());
    world.body_mut(body).set_enabled(true);
    world.step(DT).unwrap();
    assert!(world.body(body).position().z < 0.0);
}

#[test]
fn a_pose_comes_back_as_it_was_set() {
    let mut world = world();
    let body = world.add_body();
    let pose = Isometry3::from_parts(
        Translation3::new(1.0, 2.0, 3.0),
        UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
    );
    world.body_mut(body).set_pose(&pose).unwrap();
    let back = world.body(body).pose();
    assert_eq!(back.translation, pose.translation);
    assert!(back.rotation.angle_to(&pose.rotation) < 1e-7);
}

#[test]
fn numbers_that_are_not_finite_never_reach_ode() {
    let mut world = world();
    let (body, _) = add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0; 3]);
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
        let vector = Vector3::new(0.0, bad, 0.0);
        let mut body_mut = world.body_mut(body);
        assert!(body_mut.set_pose(&Isometry3::translation(0.0, bad, 0.0)).is_err());
        assert!(body_mut.set_linear_velocity(&vector).is_err());
        assert!(body_mut.set_angular_velocity(&vector).is_err());
        assert!(body_mut.add_force(&vector).is_err());
        assert!(body_mut.add_force_at(&vector, &Point3::origin()).is_err());
        assert!(body_mut.add_force_at(&Vector3::x(), &vector.into()).is_err());
        assert!(body_mut.add_torque(&vector).is_err());
        assert!(body_mut.set_max_angular_speed(-1.0).is_err());
        assert!(world.set_gravity(&vector).is_err());
        assert!(world.step(bad).is_err() && world.quick_step(bad).is_err());
    }

    let broken = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    assert!(world.body_mut(body).set_pose(&Isometry3::from_parts(Translation3::identity(), broken)).is_err());

    for bad in [0.0, -0.01, 1e-300] {
        assert!(world.step(bad).is_err() && world.quick_step(bad).is_err());
    }

    world.step(DT).unwrap();
    assert!(world.body(body).pose().translation.vector.iter().all(|x| x.is_finite()));
}

#[test]
fn a_body_that_leaves_the_world_is_stopped_and_others_move_on() {
    let mut world = world();
    let (fast, _) = add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [REACH - 1.0, 0.0, 0.0]);
    let (slow, _) = add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0; 3]);
    world.body_mut(fast).set_linear_velocity(&Vector3::new(1e9, 0.0, 0.0)).unwrap();

    let message = world.quick_step(DT).unwrap_err().to_string();

    assert!(message.contains("left the world"), "{message}");
    assert_eq!(world.stopped_bodies(), [fast]);

    let stopped = world.body(fast);
    assert_eq!(stopped.position(), Point3::new(REACH - 1.0, 0.0, 0.0));
    assert!(!stopped.is_enabled() && stopped.linear_velocity() == Vector3::zeros());

    world.default_collide(&Surface::default(), 4).unwrap();
    world.quick_step(DT).unwrap();

    assert!(world.stopped_bodies().is_empty());
    // The other body has fallen for two steps.
    assert!((world.body(slow).position().z + 3.0 * GRAVITY * DT * DT).abs() < 1e-12);
}

#[test]
fn an_explosion_ends_in_an_error_and_not_in_an_abort() {
    let mut world = world();
    let shape = Shape::Sphere { radius: 0.1 };
    let bodies = [0.0, 0.1, 0.2].map(|x| add(&mut world, &shape, 1e-20, [x, 0.0, 0.0]).0);
    for body in bodies {
        world.body_mut(body).set_angular_velocity(&Vector3::new(1e29, -1e29, 1e28)).unwrap();
        world.body_mut(body).add_force(&Vector3::new(1e29, 0.0, 0.0)).unwrap();
    }

    world.default_collide(&Surface::default(), 4).unwrap();
    assert!(world.step(DT).is_err());

    for _ in 0..5 {
        world.default_collide(&Surface::default(), 4).unwrap();
        let _ = world.step(DT);
    }

    for body in bodies {
        assert!(world.body(body).pose().translation.vector.iter().all(|x| x.abs() <= REACH));
    }
}
