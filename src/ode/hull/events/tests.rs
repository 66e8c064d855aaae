use super::*;
use crate::hull::{Aabb, Unseen, View};
use crate::ode::arena::Arena;
use crate::silhouette::{Border, Silhouette};
use crate::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use nalgebra::{Isometry3, point};

/// The radius of the hull's balls, in metres, and their centres.
const RADIUS: f64 = 0.1;
const BALLS: [Point3<f64>; 2] = [Point3::new(0.3, 0.1, 0.0), Point3::new(-0.3, -0.2, 0.0)];

/// The length of a step, in seconds.
const STEP: f64 = 0.01;

/// The hull of balls, as a frame at `time`.
fn hull_of(balls: &[Point3<f64>], time: f64) -> Arc<Hull> {
    let ball = |centre: &Point3<f64>| {
        let pose = Isometry3::translation(centre.x, centre.y, centre.z);
        Placed::new(Solid::sphere(RADIUS).unwrap(), pose, Texture::plain([200; 3]))
    };
    let subject = Subject::new(balls.iter().map(ball).collect());
    let cameras = layout::ring(4, 3.0, 0.3, Point3::origin(), (160, 120), 0.6).unwrap();
    let view = |camera: crate::camera::Camera| {
        let silhouette = Silhouette::new(&coverage(&camera, &subject), Border::Background);
        View::new(Arc::new(camera), Arc::new(silhouette), None)
    };
    let half = Vector3::repeat(0.8);
    let bounds = Aabb::new(Point3::origin() - half, Point3::origin() + half).unwrap();
    Arc::new(Hull::new(cameras.into_iter().map(view).collect(), bounds, Unseen::Outside, time))
}

/// Events of the hull of [`BALLS`], with a wait of ten steps.
fn events() -> Events {
    let mut events = Events::new(0.1);
    events.follow(Some(&hull_of(&BALLS, 0.0)), Motion::Held);
    events
}

/// A contact of the body at address `body` with the top of a ball, at which it moves down at 1 m/s.
fn contact(body: usize, ball: usize, depth: f64) -> RecordedContact {
    let place = BALLS[ball] + Vector3::z() * (RADIUS - depth);
    RecordedContact {
        toucher: Toucher { geom: body + 1, body, ids: None },
        position: place,
        normal: Vector3::z(),
        depth,
        seconds: 0.0,
        place,
        direction: Vector3::z(),
        velocity: -Vector3::z(),
    }
}

/// Steps through times that are told, from `first` to `last` in steps of [`STEP`]; bodies have the contacts of `contacts` in
/// each. Returns the events.
fn run(
    events: &mut Events,
    (first, last): (usize, usize),
    contacts: impl Fn(usize) -> Vec<RecordedContact>,
) -> Vec<TouchEvent> {
    let (step, mut found) = (StepSize::default(), Vec::new());
    for k in first..=last {
        events.set_time(k as f64 * STEP, &step);
        events.record(contacts(k).into_iter(), &step);
        events.close_step_to_fetch(&step);
        found.extend(events.take(usize::MAX));
    }
    found
}

/// Kind, body, part and time of events, the time in steps.
fn summary(events: &[TouchEvent]) -> Vec<(HullEventKind, usize, PartId, i64)> {
    let step = |time: f64| (time / STEP).round() as i64;
    events.iter().map(|event| (event.kind, event.toucher.body, event.part, step(event.time))).collect()
}

use HullEventKind::{Begin, End};

#[test]
fn a_touch_begins_with_its_first_contact_and_ends_with_the_time_of_its_last() {
    let mut events = events();
    let found = run(&mut events, (0, 40), |k| match k {
        5..=9 => vec![contact(8, 0, 0.001 * (k - 4) as f64), contact(8, 0, 0.001)],
        _ => vec![],
    });
    assert_eq!(summary(&found), [(Begin, 8, 1, 5), (End, 8, 1, 9)]);

    // The end tells of the deepest contact of the whole touch.
    let deepest = contact(8, 0, 0.005);
    assert_eq!(
        (found[1].position, found[1].normal, found[1].depth_rate),
        (deepest.position, deepest.normal, 1.0)
    );
    assert_eq!(found[0].position, contact(8, 0, 0.001).position);
}

#[test]
fn parts_and_bodies_have_touches_of_their_own() {
    let mut events = events();
    let found = run(&mut events, (0, 40), |k| {
        let first = (k < 10).then(|| contact(8, 0, 0.001));
        let others = (k < 20).then(|| [contact(8, 1, 0.001), contact(16, 0, 0.002)]);
        first.into_iter().chain(others.into_iter().flatten()).collect()
    });
    let mut found = summary(&found);
    // Those of one step are in the order of their places.
    found[..3].sort_by_key(|event| (event.1, event.2));
    let part = |ball: usize| found.iter().find(|event| event.3 == [9, 19][ball]).unwrap().2;
    let (first, second) = (part(0), 3 - part(0));
    let mut begins = [(Begin, 8, first, 0), (Begin, 8, second, 0), (Begin, 16, first, 0)];
    begins.sort_by_key(|event| (event.1, event.2));
    assert_eq!(found[..3], begins);
    assert_eq!(found[3], (End, 8, first, 9));
    assert!(found[4..].contains(&(End, 8, second, 19)) && found[4..].contains(&(End, 16, first, 19)));
    assert_eq!(found.len(), 6);
}

#[test]
fn a_touch_goes_on_over_gaps_up_to_the_wait_and_ends_over_longer_ones() {
    // The wait is of ten steps.
    let mut events = events();
    let found =
        run(
            &mut events,
            (0, 100),
            |k| if k.is_multiple_of(10) { vec![contact(8, 0, 0.001)] } else { vec![] },
        );
    assert_eq!(summary(&found), [(Begin, 8, 1, 0)]);
    let found = run(&mut events, (101, 130), |_| vec![]);
    assert_eq!(summary(&found), [(End, 8, 1, 100)]);

    let found =
        run(
            &mut events,
            (131, 200),
            |k| if k.is_multiple_of(12) { vec![contact(8, 0, 0.001)] } else { vec![] },
        );
    let (begins, ends): (Vec<_>, Vec<_>) = summary(&found).into_iter().partition(|event| event.0 == Begin);
    assert_eq!([begins.len(), ends.len()], [6, 5]);

    events.set_wait(0.0);
    let found =
        run(
            &mut events,
            (201, 204),
            |k| if k.is_multiple_of(2) { vec![contact(8, 1, 0.001)] } else { vec![] },
        );
    assert_eq!(summary(&found)[1..], [(Begin, 8, 2, 202), (End, 8, 2, 202), (Begin, 8, 2, 204)]);
}

#[test]
fn events_do_not_depend_on_the_order_in_which_threads_record() {
    let contacts = |k: usize| -> Vec<RecordedContact> {
        (0..20)
            .filter(|body| !(k / 12 + body).is_multiple_of(3))
            .map(|body| contact(8 * body + 8, (body + k) % 2, 0.001 + 1e-4 * body as f64))
            .collect()
    };
    let mut forwards = events();
    let mut backwards = events();
    let a = run(&mut forwards, (0, 100), contacts);
    let b = run(&mut backwards, (0, 100), |k| contacts(k).into_iter().rev().collect());
    assert!(a.len() > 100);
    assert_eq!(a, b);
}

#[test]
fn events_that_find_the_queue_full_are_counted() {
    let (mut events, step) = (events(), StepSize::default());
    let many = MAX_QUEUED + 10;
    events.record((1..=many).map(|body| contact(8 * body, 0, 0.001)), &step);
    events.close_step_to_fetch(&step);
    assert_eq!((events.queued(), events.take_dropped(), events.take_dropped()), (MAX_QUEUED, 10, 0));

    // Those that are not taken remain, the earliest first.
    let first: Vec<usize> = events.take(3).map(|event| event.toucher.body).collect();
    assert_eq!((first, events.queued()), (vec![8, 16, 24], MAX_QUEUED - 3));
}

#[test]
fn a_body_that_sleeps_goes_on_touching_and_begins_no_touch() {
    let (mut events, step) = (events(), StepSize::default());
    let found = run(&mut events, (0, 5), |_| vec![contact(8, 0, 0.001)]);
    assert_eq!(summary(&found), [(Begin, 8, 1, 0)]);
    for k in 6..60 {
        events.set_time(k as f64 * STEP, &step);
        for body in [8, 16] {
            events.record_resting(Toucher { geom: body + 1, body, ids: None }, &step);
        }
        events.close_step_to_fetch(&step);
        assert_eq!(events.take(usize::MAX).count(), 0);
    }
    assert_eq!(summary(&run(&mut events, (60, 90), |_| vec![])), [(End, 8, 1, 59)]);
}

#[test]
fn other_data_ends_all_touches_and_has_parts_of_its_own() {
    let mut events = events();
    let touching = |_| vec![contact(8, 0, 0.001)];
    assert_eq!(summary(&run(&mut events, (0, 3), touching)), [(Begin, 8, 1, 0)]);

    // Its clock begins again.
    events.begin_anew();
    events.follow(Some(&hull_of(&BALLS, 0.0)), Motion::Held);
    assert_eq!(summary(&run(&mut events, (0, 3), touching)), [(End, 8, 1, 3), (Begin, 8, 2, 0)]);
}

#[test]
fn another_body_at_the_address_of_one_that_is_gone_has_touches_of_its_own() {
    let (mut events, mut bodies, mut geoms) = (events(), Arena::new(1), Arena::new(1));
    let mut ids = || (GeomId(geoms.insert(())), Some(BodyId(bodies.insert(()))));
    let (first, second) = (ids(), ids());
    let found = run(&mut events, (0, 30), |k| {
        let ids = Some(if k < 5 { first } else { second });
        let toucher = Toucher { geom: 9, body: 8, ids };
        if k < 10 { vec![RecordedContact { toucher, ..contact(8, 0, 0.001) }] } else { vec![] }
    });
    assert_eq!(summary(&found), [(Begin, 8, 1, 0), (Begin, 8, 1, 5), (End, 8, 1, 4), (End, 8, 1, 9)]);
    assert_eq!(
        found.iter().map(|event| event.toucher.ids.unwrap()).collect::<Vec<_>>(),
        [first, second, first, second]
    );
}

#[test]
fn without_a_time_that_is_told_steps_are_counted_by_their_length_or_by_frames() {
    // Steps of a known length.
    let (mut events, step) = (events(), StepSize::default());
    step.tell(0.02);
    let mut found = Vec::new();
    for k in 0..20 {
        events.begin_step(&step);
        events.record((k == 3).then(|| contact(8, 0, 0.001)).into_iter(), &step);
        events.close_step_to_fetch(&step);
        found.extend(events.take(usize::MAX));
    }
    assert_eq!(summary(&found), [(Begin, 8, 1, 6), (End, 8, 1, 6)]);

    // Steps of unknown length, and frames a thirtieth of a second apart.
    let (mut events, step) = (self::events(), StepSize::default());
    let mut found = Vec::new();
    for k in 0..20 {
        events.follow(Some(&hull_of(&BALLS, f64::from(k) / 30.0)), Motion::Held);
        events.record((k < 3).then(|| contact(8, 0, 0.001)).into_iter(), &step);
        events.close_step_to_fetch(&step);
        found.extend(events.take(usize::MAX));
    }
    assert_eq!(found.len(), 2);
    assert!(found[0].time == 0.0 && (found[1].time - 2.0 / 30.0).abs() < 1e-12);
    assert!(!events.waits_in_vain());
}

#[test]
fn it_is_told_that_no_touch_can_end_while_no_time_passes() {
    let (mut events, step) = (events(), StepSize::default());
    events.record(std::iter::once(contact(8, 0, 0.001)), &step);
    for _ in 0..PATIENCE {
        events.close_step_to_fetch(&step);
        assert!(!events.waits_in_vain());
        events.take(usize::MAX).for_each(drop);
    }
    events.close_step_to_fetch(&step);
    events.close_step_to_fetch(&step);
    assert!(events.waits_in_vain());
}

#[test]
fn a_contact_that_has_not_begun_counts_at_its_time() {
    let mut events = events();
    // A body 8 cm above a ball, which falls at 20 m/s.
    let falling =
        RecordedContact { seconds: 0.004, depth: 0.0, velocity: Vector3::z() * -20.0, ..contact(8, 1, 0.0) };
    let found = run(&mut events, (10, 40), |k| if k == 10 { vec![falling] } else { vec![] });
    let times: Vec<f64> = found.iter().map(|event| event.time).collect();
    assert!(times.iter().all(|time| (time - 0.104).abs() < 1e-12) && times.len() == 2);
    assert_eq!(found[0].depth_rate, 20.0);
    // Where the surface is that is near by.
    assert_eq!(events.parts.part_at(&hull_of(&BALLS, 0.0), &point![-0.3, -0.2, 0.1], AT_SURFACE), Some(1));
}
