//! Contact events of a hull in a world: begin and end, by body and part, while masks flicker and parts move.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, point, vector};
use ode_visual_hull::hull::Motion;
use ode_visual_hull::ode::HullEventKind::{Begin, End};
use ode_visual_hull::ode::{
    BodyId, GeomId, HullEvent, HullEventKind, Shape, SpaceKind, Surface, Swept, World, set_random_seed,
};
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_testing::scene::{self, PIXEL, TABLE, TOP, at, cuboid};
use ode_visual_hull_testing::touches::{self, BALL, BODY, Count, WAIT, centre};
use ode_visual_hull_testing::world::{add_body, cube, world};

/// Kind, body and part of events.
fn summary(events: &[HullEvent]) -> Vec<(HullEventKind, Option<BodyId>, u32)> {
    events.iter().map(|event| (event.kind, event.body, event.part)).collect()
}

/// A world with the table's hull, which records events.
fn table_world() -> (World, GeomId) {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    let hull = world.add_hull(root, &scene::table()).unwrap();
    world.hull_mut(hull).set_events(true);
    (world, hull)
}

/// Collides without attaching contacts, in steps of 5 ms, and returns the events of each.
fn collide(world: &mut World, hull: GeomId, steps: usize) -> Vec<HullEvent> {
    let mut events = Vec::new();
    for _ in 0..steps {
        world.collide(|pair| drop(pair.contacts(8))).unwrap();
        events.extend(world.hull_mut(hull).events().unwrap());
        world.quick_step(0.005).unwrap();
    }
    events
}

/// Simulates steps of 5 ms, and returns the events of each.
fn simulate(world: &mut World, hull: GeomId, steps: usize) -> Vec<HullEvent> {
    let mut events = Vec::new();
    for _ in 0..steps {
        world.default_collide(&Surface::default(), 8).unwrap();
        events.extend(world.hull_mut(hull).events().unwrap());
        world.quick_step(0.005).unwrap();
    }
    events
}

#[test]
fn scripted_touches_of_flickering_masks_begin_and_end_once_at_their_part() {
    for motion in [Motion::Held, Motion::Predicted] {
        let Count { touches, missed, doubled, misplaced } = touches::play(100, motion, WAIT, 3);
        assert!(touches >= 100);
        assert_eq!((missed, doubled, misplaced), (0, 0, 0), "{motion:?}");
    }
}

#[test]
fn without_a_wait_masks_that_flicker_double_touches() {
    let Count { missed, doubled, .. } = touches::play(60, Motion::Held, 0.0, 3);
    assert!(missed == 0 && doubled > 0, "{doubled}");
}

#[test]
fn a_part_that_turns_past_others_keeps_its_id_for_the_body_that_follows_it() {
    let cameras = touches::cameras();
    let (mut world, hull, data) = touches::world_with_events(&cameras, Motion::Held);
    let bodies = [0, 1, 2].map(|ball| (ball, touches::add_ball(&mut world)));

    // A third of a turn: each ball passes the two others in some of the images.
    let mut events = Vec::new();
    for frame in 0..130 {
        let time = f64::from(frame) / touches::RATE;
        scene::publish(&data, &touches::clean_masks(&cameras, time), time);
        for (ball, body) in bodies {
            let centre = centre(ball, time);
            let outwards = vector![centre.x, centre.y, 0.0].normalize();
            let place = centre + outwards * (BALL + BODY - 0.03);
            world.body_mut(body).set_pose(&Isometry3::from(place.coords)).unwrap();
        }
        events.extend(touches::step(&mut world, hull, time));
    }
    let mut summary = summary(&events);
    summary.sort_by_key(|(_, _, part)| *part);
    let parts: Vec<u32> = summary.iter().map(|(_, _, part)| *part).collect();
    assert_eq!(parts, [1, 2, 3]);
    assert!(summary.iter().all(|(kind, ..)| *kind == Begin));
}

#[test]
fn a_box_that_lies_and_falls_asleep_touches_once_until_it_is_removed() {
    let (mut world, hull) = table_world();
    let (body, geom) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.12));
    world.body_mut(body).set_auto_disable(true);
    let events = simulate(&mut world, hull, 600);
    assert!(!world.body(body).is_enabled());
    assert_eq!(summary(&events), [(Begin, Some(body), 1)]);

    // It falls 2 cm, for 64 ms, less than one step after which the contact is seen, and hits the table at 0.63 m/s.
    let HullEvent { time, position, normal, depth_rate, .. } = events[0];
    assert!((time - 0.064).abs() < 0.006 + 0.5 * PIXEL / 0.63, "{time}");
    assert!((depth_rate - 0.63).abs() < 0.05, "{depth_rate}");
    assert!((position.z - TOP).abs() < 0.63 * 0.005 + PIXEL && normal.z > 0.999);

    // Removed, it ends its touch as one that leaves, with the time of its last contact.
    let last = 600.0 * 0.005 - 0.005;
    assert!(world.remove_body_and_geoms(body));
    let (other, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.0999));
    let events = simulate(&mut world, hull, 30);
    // The other body may have the memory of the first one, and still is another.
    assert_eq!(summary(&events), [(Begin, Some(other), 1), (End, Some(body), 1)]);
    assert!((events[1].time - last).abs() < 1e-9 && events[1].geom == geom);
}

#[test]
fn a_geom_without_a_body_touches_too() {
    let (mut world, hull) = table_world();
    let root = world.root_space();
    let geom = world.add_geom(root, &cube(0.1)).unwrap();
    world.geom_mut(geom).set_pose(&at(0.0, 0.0, TOP + 0.045)).unwrap();
    let mut events = collide(&mut world, hull, 3);
    world.geom_mut(geom).set_enabled(false);
    events.extend(collide(&mut world, hull, 30));
    assert_eq!(summary(&events), [(Begin, None, 1), (End, None, 1)]);
    assert!(events.iter().all(|event| event.geom == geom && event.depth_rate == 0.0));
    assert!((events[1].time - 0.01).abs() < 1e-12);
}

#[test]
fn events_that_are_not_taken_come_with_the_next_and_none_without_recording() {
    let (mut world, hull) = table_world();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.099));
    for k in 0..60 {
        world.default_collide(&Surface::default(), 8).unwrap();
        world.quick_step(0.005).unwrap();
        if k == 20 {
            world.body_mut(body).set_pose(&at(0.0, 0.0, TOP + 0.5)).unwrap();
        }
    }
    let events: Vec<HullEvent> = world.hull_mut(hull).events().unwrap().collect();
    assert_eq!(summary(&events), [(Begin, Some(body), 1), (End, Some(body), 1)]);
    assert!(events[0].time == 0.0 && (events[1].time - 0.1).abs() < 1e-12);

    world.hull_mut(hull).set_events(false);
    let error = world.hull_mut(hull).events().unwrap_err().to_string();
    assert!(error.contains("expected them switched on"), "{error}");
    for seconds in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(world.hull_mut(hull).set_event_wait(seconds).is_err());
    }
    assert_eq!(world.hull(hull).event_wait(), 0.1);
}

#[test]
fn queries_between_collides_are_no_touches() {
    let (mut world, hull) = table_world();
    let (body, geom) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.5));
    world.collide(|_| {}).unwrap();
    world.body_mut(body).set_pose(&at(0.0, 0.0, TOP + 0.05)).unwrap();
    assert!(!world.collide_geoms(hull, geom, 8).unwrap().is_empty());
    assert_eq!(world.hull_mut(hull).events().unwrap().count(), 0);
}

#[test]
fn other_data_ends_all_touches_and_has_other_parts() {
    let (mut world, hull) = table_world();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.099));
    let mut events = simulate(&mut world, hull, 10);
    world.hull_mut(hull).set_data(&scene::table());
    events.extend(simulate(&mut world, hull, 10));
    assert_eq!(summary(&events), [(Begin, Some(body), 1), (End, Some(body), 1), (Begin, Some(body), 2)]);
}

#[test]
fn a_body_that_touches_within_the_next_step_has_begun_at_that_time() {
    let (mut world, hull) = table_world();
    world.hull_mut(hull).set_swept(Swept::On);
    let (body, _) = add_body(&mut world, &Shape::Sphere { radius: 0.02 }, &at(0.0, 0.0, TOP + 0.02 + 0.3));
    world.body_mut(body).set_linear_velocity(&vector![0.0, 0.0, -40.0]).unwrap();
    let events = simulate(&mut world, hull, 60);
    assert_eq!(summary(&events)[0], (Begin, Some(body), 1));
    // 0.3 m at 40 m/s, to half a pixel.
    assert!((events[0].time - 0.0075).abs() < 0.5 * PIXEL / 40.0, "{}", events[0].time);
    assert!((events[0].depth_rate - 40.0).abs() < 0.1);
}

#[test]
fn the_depth_rate_is_the_speed_of_the_surface_against_a_body_at_rest() {
    let cameras = scene::table_cameras();
    let data = scene::data_with(&cameras);
    let mut world = world(SpaceKind::default());
    world.set_gravity(&Vector3::zeros()).unwrap();
    let root = world.root_space();
    let hull = world.add_hull(root, &data).unwrap();
    world.hull_mut(hull).set_motion(Motion::Interpolated);
    world.hull_mut(hull).set_events(true);
    let (body, _) = add_body(&mut world, &cube(0.1), &at(0.0, 0.0, TOP + 0.09));

    // The table rises at 0.6 m/s, and reaches the body after 67 ms.
    let mut events = Vec::new();
    for frame in 0..9 {
        let time = f64::from(frame) / 30.0;
        let table = Subject::new(vec![cuboid(TABLE, at(0.0, 0.0, 0.6 * time))]);
        scene::show(&data, &cameras, &table, time);
        for step in 0..8 {
            world.hull_mut(hull).set_time(time + f64::from(step) / 240.0).unwrap();
            world.default_collide(&Surface::default(), 8).unwrap();
            events.extend(world.hull_mut(hull).events().unwrap());
            world.quick_step(1.0 / 240.0).unwrap();
        }
    }
    assert_eq!(summary(&events), [(Begin, Some(body), 1)]);
    // The hull is a frame late. Velocities from masks without noise are wrong by less than a tenth.
    assert!(
        (events[0].time - 0.04 / 0.6 - 1.0 / 30.0).abs() < 1.0 / 240.0 + PIXEL / 0.6,
        "{}",
        events[0].time
    );
    assert!((events[0].depth_rate - 0.6).abs() < 0.06, "{}", events[0].depth_rate);
}

/// All events, with all numbers, of boxes and balls that fall on the table and off it.
fn events_of_a_fall(first: usize) -> Vec<HullEvent> {
    let (mut world, hull) = table_world();
    set_random_seed(7);
    for k in 0..12 {
        // The order in which bodies are made is that in which they are collided.
        let k = (first + k) % 12;
        let place = point![0.2 * (k as f64).cos(), 0.2 * (k as f64).sin(), TOP + 0.1 + 0.12 * k as f64];
        let pose =
            at(place.x, place.y, place.z) * UnitQuaternion::from_euler_angles(0.3 * k as f64, 0.4, 0.5);
        let shape = if k.is_multiple_of(2) { cube(0.1) } else { Shape::Sphere { radius: 0.05 } };
        add_body(&mut world, &shape, &pose);
    }
    simulate(&mut world, hull, 300)
}

#[test]
fn events_have_the_same_bits_in_each_run() {
    let numbers = |events: &[HullEvent]| -> Vec<_> {
        let bits = |event: &HullEvent| {
            let vectors = [event.position.coords, event.normal];
            let numbers =
                vectors.iter().flat_map(|v| v.iter().copied()).chain([event.time, event.depth_rate]);
            (event.kind, event.part, numbers.map(f64::to_bits).collect::<Vec<_>>())
        };
        events.iter().map(bits).collect()
    };
    let events = numbers(&events_of_a_fall(0));
    assert!(events.len() > 12);
    assert_eq!(numbers(&events_of_a_fall(0)), events);
}

#[test]
fn events_do_not_depend_on_the_order_in_which_bodies_are_collided() {
    let run = |order: [usize; 4]| -> Vec<(HullEventKind, u32, Point3<f64>, u64)> {
        let (mut world, hull) = table_world();
        world.set_gravity(&Vector3::zeros()).unwrap();
        let mut bodies = [None; 4];
        for k in order {
            let (x, y) = ([-0.15, 0.15][k % 2], [-0.15, 0.15][k / 2]);
            bodies[k] = Some(add_body(&mut world, &cube(0.1), &at(x, y, TOP + 0.049 - 0.002 * k as f64)).0);
        }
        let mut events = collide(&mut world, hull, 5);
        for body in bodies.into_iter().flatten().skip(1) {
            world.body_mut(body).set_pose(&at(0.0, 0.0, TOP + 5.0)).unwrap();
        }
        events.extend(collide(&mut world, hull, 60));
        events.iter().map(|event| (event.kind, event.part, event.position, event.time.to_bits())).collect()
    };
    let events = run([0, 1, 2, 3]);
    assert_eq!(events.len(), 7);
    assert_eq!(run([3, 1, 0, 2]), events);
    assert_eq!(run([2, 3, 1, 0]), events);
}
