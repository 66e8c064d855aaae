//! Hulls that collide with what they will meet within the next step, so that nothing passes through between two collides.

use nalgebra::{Point3, Vector3, vector};
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::ode::{BodyId, ContactGeom, GeomId, Shape, SpaceKind, Surface, Swept, World};
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;
use std::sync::Arc;

/// The length of a step, in seconds.
const STEP: f64 = 1.0 / 120.0;

/// The length of a step in which a board passes a ball, in seconds.
const LONG_STEP: f64 = 1.0 / 60.0;

/// The time between two frames, in seconds.
const PERIOD: f64 = 1.0 / 30.0;

/// A world without gravity that has been stepped once, and a hull geom of `data` in it.
fn world_with(data: &Arc<HullData>, swept: Swept) -> (World, GeomId) {
    let mut world = world(SpaceKind::default());
    world.set_gravity(&Vector3::zeros()).unwrap();
    let root = world.root_space();
    let hull = world.add_hull(root, data).unwrap();
    world.hull_mut(hull).set_swept(swept);
    step(&mut world, STEP);
    (world, hull)
}

/// A ball of 2 cm above the table's top that falls at `speed` m/s.
fn falling_ball(world: &mut World, height: f64, speed: f64) -> (BodyId, GeomId) {
    let ball = add_body(world, &Shape::Sphere { radius: 0.02 }, &at(0.01, 0.02, TOP + 0.02 + height));
    world.body_mut(ball.0).set_linear_velocity(&vector![0.0, 0.0, -speed]).unwrap();
    ball
}

/// All contacts of a collide, and how many pairs it has visited.
fn contacts(world: &mut World) -> (Vec<ContactGeom>, usize) {
    let (mut found, mut pairs) = (Vec::new(), 0);
    world
        .collide(|pair| {
            pairs += 1;
            found.extend(pair.contacts(8).iter().copied());
        })
        .unwrap();
    (found, pairs)
}

fn height(world: &World, ball: BodyId) -> f64 {
    let position: Point3<f64> = world.body(ball).position();
    position.z - 0.02 - TOP
}

#[test]
fn a_fast_ball_stops_on_the_surface_that_it_would_have_passed() {
    for speed in [5.0, 40.0, 90.0] {
        for swept in [Swept::Off, Swept::On] {
            let (mut world, _) = world_with(&table(), swept);
            let (ball, _) = falling_ball(&mut world, 0.1, speed);
            (0..12).for_each(|_| step(&mut world, STEP));
            let height = height(&world, ball);
            match swept {
                // The edge of a mask lies within a pixel.
                Swept::On => assert!(height.abs() < PIXEL, "{speed} m/s: {height} m above the table"),
                _ => assert!(
                    speed < 40.0 || height < -0.02,
                    "{speed} m/s: {height} m above the table, without a sweep"
                ),
            }
        }
    }
}

#[test]
fn a_body_that_lands_fast_on_a_flat_side_does_not_turn() {
    let (height, radius) = (0.1, 0.05);
    let lying = nalgebra::Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
    let cases = [
        (cube(height), nalgebra::Isometry3::identity(), 0.5 * height),
        (Shape::Cylinder { radius, length: height }, nalgebra::Isometry3::identity(), 0.5 * height),
        (Shape::Cylinder { radius, length: height }, lying, radius),
        (Shape::Capsule { radius, length: height }, lying, radius),
    ];
    for (shape, turn, half) in cases {
        let (mut world, _) = world_with(&table(), Swept::On);
        let (body, _) = add_body(&mut world, &shape, &(at(0.01, 0.02, TOP + half + 0.1) * turn));
        world.body_mut(body).set_linear_velocity(&vector![0.0, 0.0, -30.0]).unwrap();
        (0..12).for_each(|_| step(&mut world, STEP));
        let (position, turning): (Point3<f64>, Vector3<f64>) =
            (world.body(body).position(), world.body(body).angular_velocity());
        assert!((position.z - half - TOP).abs() < PIXEL, "{shape:?}: {position}");
        assert!(turning.norm() < 0.02 * 30.0, "{shape:?} turns at {} rad/s", turning.norm());
    }
}

#[test]
fn a_contact_tells_when_it_begins_and_lies_on_the_body_as_it_is_now() {
    let (mut world, hull) = world_with(&table(), Swept::On);
    let (_, ball) = falling_ball(&mut world, 0.1, 30.0);
    let (found, _) = contacts(&mut world);
    let [ContactGeom { position, normal, depth, time, geoms }] = found[..] else { panic!("{found:?}") };
    assert_eq!(depth, 0.0);
    assert!((time * 30.0 - 0.1).abs() < PIXEL, "{time} s");
    assert!((position - Point3::new(0.01, 0.02, TOP + 0.1)).norm() < 1e-3, "{position}");
    let into_ball = if geoms == [hull, ball] { -normal } else { normal };
    assert!(into_ball.z > 0.999, "{normal}");

    // It is the same contact with the geoms in the other order, and none where nothing will be met within the step.
    let both = [[hull, ball], [ball, hull]].map(|[a, b]| world.collide_geoms(a, b, 8).unwrap());
    assert!(both.iter().flatten().all(|contact| contact.time == time), "{both:?}");
    world.hull_mut(hull).set_swept(Swept::Off);
    assert!(world.collide_geoms(hull, ball, 8).unwrap().is_empty());
}

#[test]
fn the_box_of_a_hull_grows_by_the_way_of_the_fastest_body_and_the_broad_phase_alone_makes_no_contacts() {
    for (swept, pairs, count) in [(Swept::Off, 0, 0), (Swept::BroadPhase, 1, 0), (Swept::On, 1, 1)] {
        let (mut world, _) = world_with(&table(), swept);
        falling_ball(&mut world, 0.2, 30.0);
        let (found, visited) = contacts(&mut world);
        assert_eq!((visited, found.len()), (pairs, count), "{swept:?}");
    }
}

#[test]
fn a_ball_that_bounces_keeps_its_restitution_at_any_speed() {
    for speed in [3.0, 20.0, 40.0] {
        let (mut world, _) = world_with(&table(), Swept::On);
        let (ball, _) = falling_ball(&mut world, 0.21, speed);
        let surface = Surface { bounce: Some(0.5), ..Surface::with_friction(0.0) };
        for _ in 0..24 {
            world.default_collide(&surface, 8).unwrap();
            world.quick_step(STEP).unwrap();
        }
        let upwards = world.body(ball).linear_velocity().z;
        assert!((upwards / (0.5 * speed) - 1.0).abs() < 0.01, "{speed} m/s: {upwards} m/s");
    }
}

/// Frames of a board that moves along x at `speed` m/s through the origin's height above the table's cameras' target.
fn show_board(data: &HullData, speed: f64, frame: u32) {
    let x = -0.4 + speed * f64::from(frame) * PERIOD;
    let board = Subject::new(vec![cuboid(vector![0.03, 0.3, 0.3], at(x, 0.0, 0.0))]);
    show(data, &table_cameras(), &board, f64::from(frame) * PERIOD);
}

/// The speed along x of a ball at rest at the origin after a board has passed at `speed` m/s.
fn struck(motion: Motion, swept: Swept, speed: f64, is_asleep: bool) -> f64 {
    let data = data_with(&table_cameras());
    show_board(&data, speed, 0);
    let (mut world, hull) = world_with(&data, swept);
    world.hull_mut(hull).set_motion(motion);
    let (ball, _) = add_body(&mut world, &Shape::Sphere { radius: 0.02 }, &at(0.0, 0.01, 0.0));
    if is_asleep {
        world.body_mut(ball).set_enabled(false);
    }
    let mut frame = 0;
    for k in 1..40 {
        let time = f64::from(k) * LONG_STEP;
        if time + 1e-9 >= f64::from(frame + 1) * PERIOD && -0.4 + speed * f64::from(frame) * PERIOD < 0.4 {
            frame += 1;
            show_board(&data, speed, frame);
        }
        world.hull_mut(hull).set_time(time).unwrap();
        step(&mut world, LONG_STEP);
    }
    world.body(ball).linear_velocity().x
}

#[test]
fn a_board_that_passes_a_ball_between_two_collides_strikes_it_also_if_it_sleeps() {
    // 45 pixels from frame to frame, and 5 cm from step to step.
    let speed = 3.0;
    for motion in [Motion::Interpolated, Motion::Predicted] {
        for is_asleep in [false, true] {
            let swept = struck(motion, Swept::On, speed, is_asleep);
            // The velocity of the surface is known to a tenth where it is this fast.
            assert!((swept / speed - 1.0).abs() < 0.1, "{motion:?}, asleep {is_asleep}: {swept} m/s");
        }
    }
}

#[test]
fn a_body_at_rest_on_a_swept_hull_stays_where_it_is() {
    let rest = |swept: Swept| {
        let (mut world, hull) = world_with(&table(), swept);
        world.set_gravity(&vector![0.0, 0.0, -9.81]).unwrap();
        let (body, _) = add_body(&mut world, &cube(0.1), &at(0.0, 0.0, TOP + 0.052));
        for k in 0..240 {
            world.hull_mut(hull).set_time(f64::from(k) * STEP).unwrap();
            step(&mut world, STEP);
        }
        let (position, velocity): (Point3<f64>, Vector3<f64>) =
            (world.body(body).position(), world.body(body).linear_velocity());
        assert!(velocity.norm() < 1e-3, "{velocity}");
        position
    };
    let (off, on) = (rest(Swept::Off), rest(Swept::On));
    assert!((off - on).norm() < 2e-3, "{off} without, {on} with a sweep");
}

#[test]
fn what_a_sweep_leaves_out_is_told() {
    // The length of a step is not known before the first.
    let mut early = world(SpaceKind::default());
    let root = early.root_space();
    let hull = early.add_hull(root, &table()).unwrap();
    early.hull_mut(hull).set_swept(Swept::On);
    falling_ball(&mut early, 0.001, 30.0);
    contacts(&mut early);
    let message = early.hull(hull).take_left_out().unwrap().to_string();
    assert!(message.contains("length of a step"), "{message}");

    let (mut world, hull) = world_with(&table(), Swept::On);
    falling_ball(&mut world, 0.3, 1000.0);
    contacts(&mut world);
    let message = world.hull(hull).take_left_out().unwrap().to_string();
    assert!(message.contains("8.333 m"), "{message}");

    // A gap of more than half a second, and masks that follow one another again.
    let data = data_with(&table_cameras());
    show_board(&data, 1.0, 0);
    let (mut world, hull) = world_with(&data, Swept::On);
    world.hull_mut(hull).set_motion(Motion::Interpolated);
    let mut told_at = |frame: u32| {
        show_board(&data, 0.1, frame);
        world.hull_mut(hull).set_time(f64::from(frame) * PERIOD).unwrap();
        world.hull(hull).take_left_out().map(|error| error.to_string())
    };
    assert_eq!(told_at(1), None);
    assert_eq!(told_at(2), None);
    let message = told_at(30).unwrap();
    assert!(message.contains("stand still in the sweep"), "{message}");
    assert_eq!(told_at(31), None);
    assert_eq!(told_at(32), None);
}
