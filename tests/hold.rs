//! Bodies that touch a held hull stick to it until it is released: the paper's button.

use image::GrayImage;
use nalgebra::{Isometry3, UnitQuaternion, Vector3, point, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData, Motion};
use ode_visual_hull::ode::{BodyId, GeomId, HullEventKind, Shape, SpaceKind, World};
use ode_visual_hull::synthetic::layout;
use ode_visual_hull_testing::hand::{PALM, PALM_LINE, hand};
use ode_visual_hull_testing::scene::{ORIGIN, at, masks_of, publish};
use ode_visual_hull_testing::world::*;
use std::sync::{Arc, LazyLock};

/// The length of a step and the time between two frames, in seconds.
const STEP: f64 = 1.0 / 120.0;
const PERIOD: f64 = 1.0 / 30.0;

/// The radius of the ball on the palm, which is 3 mm in it, in metres.
const RADIUS: f64 = 0.04;
const ON_PALM: f64 = PALM + RADIUS - 0.003;

/// The size of a pixel at the hand, in metres: 0.5 rad over 320 pixels at 2 m.
const PIXEL: f64 = 0.0032;

/// When the hand begins to move, in seconds, how fast it then is, in m/s, and how fast it turns, in rad/s.
const START: f64 = 0.2;
const VELOCITY: Vector3<f64> = Vector3::new(0.5, -0.3, 0.2);
const SPIN: Vector3<f64> = Vector3::new(0.4, 0.3, 1.2);

/// The last frame, and the time up to which it is shown by an interpolated hull, in seconds.
const LAST_FRAME: usize = 30;
const END: f64 = 1.0;

/// The time for which the hand has moved at its full speed since the start. It takes 0.2 s to get there.
fn moved_for(time: f64) -> f64 {
    let since = (time - START).max(0.0);
    if since < 0.2 { 2.5 * since * since } else { since - 0.1 }
}

/// The pose of the hand at a time.
fn pose_at(time: f64) -> Isometry3<f64> {
    let moved = moved_for(time);
    let place = vector![-0.15, 0.1, -0.1] + VELOCITY * moved;
    Isometry3::from_parts(place.into(), UnitQuaternion::from_scaled_axis(SPIN * moved))
}

fn cameras() -> Vec<Camera> {
    layout::staggered(8, 2.0, &[0.1, 0.9], ORIGIN, (320, 240), 0.5).unwrap()
}

/// The masks of each frame in each camera.
fn frames() -> &'static [Vec<GrayImage>] {
    static FRAMES: LazyLock<Vec<Vec<GrayImage>>> = LazyLock::new(|| {
        let masks = |frame: usize| masks_of(&cameras(), &hand(&pose_at(frame as f64 * PERIOD)));
        (0..=LAST_FRAME).map(masks).collect()
    });
    &FRAMES
}

/// A hull of the hand, and a ball on its palm.
struct Scene {
    data: Arc<HullData>,
    world: World,
    hull: GeomId,
    ball: BodyId,
    motion: Motion,
    time: f64,
    frame: usize,
}

impl Scene {
    fn new(motion: Motion) -> Self {
        let (data, mut world) = (data(), world(SpaceKind::default()));
        let root = world.root_space();
        let hull = world.add_hull(root, &data).unwrap();
        world.hull_mut(hull).set_motion(motion);
        let place = pose_at(0.0) * at(0.0, PALM_LINE, ON_PALM);
        let (ball, _) = add_body(&mut world, &Shape::Sphere { radius: RADIUS }, &place);
        Self { data, world, hull, ball, motion, time: 0.0, frame: 0 }
    }

    fn hold(&mut self, on: bool) {
        self.world.hull_mut(self.hull).hold(on);
    }

    fn holds(&self) -> bool {
        self.world.hull(self.hull).holds(self.ball)
    }

    /// Simulates one step. Frames that are due are published.
    fn step(&mut self) {
        while self.frame <= LAST_FRAME && self.frame as f64 * PERIOD <= self.time + 1e-9 {
            publish(&self.data, &frames()[self.frame], self.frame as f64 * PERIOD);
            self.frame += 1;
        }
        self.world.hull_mut(self.hull).set_time(self.time).unwrap();
        step(&mut self.world, STEP);
        self.time += STEP;
    }

    /// Simulates up to a time, in seconds.
    fn run_to(&mut self, end: f64) {
        while self.time < end - 1e-9 {
            self.step();
        }
    }

    /// The time that the hull will show in the next collide.
    fn shown(&self) -> f64 {
        self.time - if self.motion == Motion::Interpolated { PERIOD } else { 0.0 }
    }

    /// How far the ball is from its place on the palm, and how far it has turned against that.
    fn off(&self) -> (f64, f64) {
        let beside = pose_at(self.shown()).inverse() * self.world.body(self.ball).pose();
        let place = vector![0.0, PALM_LINE, ON_PALM];
        ((beside.translation.vector - place).norm(), beside.rotation.angle())
    }

    /// Whether the ball has contacts with the hull.
    fn has_contacts(&mut self) -> bool {
        let (mut found, hull) = (false, self.hull);
        let visit = |pair: &ode_visual_hull::ode::Pair<'_>| {
            found |= pair.geoms().contains(&hull) && !pair.contacts(8).is_empty();
        };
        self.world.collide(visit).unwrap();
        found
    }
}

/// Data with the cameras, without masks.
fn data() -> Arc<HullData> {
    let data = HullData::new();
    cameras().into_iter().for_each(|camera| assert!(data.add_view(camera).is_ok()));
    data.set_bounds(Aabb::new(point![-0.8, -0.8, -0.8], point![0.8, 0.8, 0.8]).unwrap()).unwrap();
    Arc::new(data)
}

#[test]
fn a_body_moves_and_turns_with_the_hand_that_it_touches() {
    for motion in [Motion::Interpolated, Motion::Predicted, Motion::Held] {
        let mut scene = Scene::new(motion);
        scene.hold(true);
        while scene.time < END - 1e-9 {
            scene.step();
            assert!(scene.holds(), "{motion:?} at {} s", scene.time);
            let (distance, turn) = scene.off();
            // The rim is known to half a pixel, in each of the four times that it is seen anew at most. A hand that begins to
            // move is behind by the change of its speed in a frame, 0.1 m/s, times a frame.
            let late = if motion == Motion::Interpolated { 0.001 } else { 0.1 * PERIOD };
            assert!(distance < 2.0 * PIXEL + late, "{motion:?} at {} s: {distance} m", scene.time);
            assert!(turn < 2.0 * PIXEL / 0.08, "{motion:?} at {} s: {turn} rad", scene.time);
            assert!(scene.world.body(scene.ball).is_enabled());
        }
        assert!(!scene.has_contacts());
        let turned = pose_at(scene.shown()).rotation.angle();
        assert!(turned > 0.7, "the hand has turned by {turned} rad");
        assert!(scene.world.hull(scene.hull).take_error().is_none());
        assert!(scene.world.hull(scene.hull).take_left_out().is_none());
    }
}

#[test]
fn a_released_body_has_the_velocity_of_the_hand_and_contacts_again() {
    let mut scene = Scene::new(Motion::Interpolated);
    scene.hold(true);
    scene.run_to(END - 2.0 * STEP);
    scene.hold(false);
    assert!(!scene.holds());
    assert!(scene.has_contacts());

    let (before, after) = (pose_at(scene.shown() - 1e-4), pose_at(scene.shown() + 1e-4));
    let place = point![0.0, PALM_LINE, ON_PALM];
    let expected = (after * place - before * place) / 2e-4;
    let ball = scene.world.body(scene.ball);
    // Half a pixel over the tenth of a second to which the velocity is fitted.
    let most = 0.5 * PIXEL / 0.1;
    assert!((ball.linear_velocity() - expected).norm() < 2.0 * most, "{} {expected}", ball.linear_velocity());
    assert!((ball.angular_velocity() - SPIN).norm() < 2.0 * most / 0.08, "{}", ball.angular_velocity());
}

#[test]
fn a_body_in_a_hand_at_rest_neither_falls_nor_sleeps() {
    let mut scene = Scene::new(Motion::Held);
    publish(&scene.data, &frames()[0], 0.0);
    scene.frame = LAST_FRAME + 1;
    scene.world.body_mut(scene.ball).set_auto_disable(true);
    scene.hold(true);
    scene.run_to(1.5);
    let place = pose_at(0.0) * point![0.0, PALM_LINE, ON_PALM];
    let fallen = (scene.world.body(scene.ball).position() - place).norm();
    // Gravity is made up for, and so is what else moves it.
    assert!(fallen < 1e-4, "{fallen}");
    assert!(scene.world.body(scene.ball).is_enabled());
    scene.world.body_mut(scene.ball).set_enabled(false);
    scene.step();
    assert!(scene.world.body(scene.ball).is_enabled(), "put to sleep by the program");
}

#[test]
fn two_geoms_of_one_body_stick_as_one() {
    let mut scene = Scene::new(Motion::Interpolated);
    let root = scene.world.root_space();
    let second = scene.world.add_geom(root, &Shape::Sphere { radius: RADIUS }).unwrap();
    scene.world.geom_mut(second).set_body(Some(scene.ball)).unwrap();
    scene.hold(true);
    scene.run_to(0.8);
    assert!(scene.holds());
    assert!(scene.off().0 < 2.0 * PIXEL, "{:?}", scene.off());
}

#[test]
fn kinematic_bodies_and_geoms_without_a_body_do_not_stick() {
    let mut scene = Scene::new(Motion::Held);
    scene.world.body_mut(scene.ball).set_kinematic(true);
    let root = scene.world.root_space();
    let probe = scene.world.add_geom(root, &Shape::Sphere { radius: RADIUS }).unwrap();
    let place = pose_at(0.0) * at(0.0, PALM_LINE, ON_PALM);
    scene.world.geom_mut(probe).set_pose(&place).unwrap();
    scene.hold(true);
    (0..3).for_each(|_| scene.step());
    assert!(!scene.holds());
    assert!(!scene.world.collide_geoms(scene.hull, probe, 8).unwrap().is_empty());
}

#[test]
fn another_body_sticks_after_one_was_destroyed_in_the_hand() {
    let mut scene = Scene::new(Motion::Held);
    scene.hold(true);
    (0..3).for_each(|_| scene.step());
    assert!(scene.holds());
    let gone = scene.ball;
    assert!(scene.world.remove_body_and_geoms(gone));
    (0..30).for_each(|_| scene.step());
    assert!(!scene.holds());

    let place = pose_at(scene.time - PERIOD) * at(0.0, PALM_LINE, ON_PALM);
    scene.ball = add_body(&mut scene.world, &Shape::Sphere { radius: RADIUS }, &place).0;
    (0..10).for_each(|_| scene.step());
    assert!(scene.holds());
}

#[test]
fn the_first_of_two_held_hulls_keeps_a_body_and_the_second_says_so() {
    let mut scene = Scene::new(Motion::Held);
    let root = scene.world.root_space();
    let second = scene.world.add_hull(root, &scene.data).unwrap();
    scene.hold(true);
    (0..3).for_each(|_| scene.step());
    scene.world.hull_mut(second).hold(true);
    (0..3).for_each(|_| scene.step());
    assert!(scene.holds());
    assert!(!scene.world.hull(second).holds(scene.ball));
    let error = scene.world.hull(second).take_error().unwrap().to_string();
    assert!(error.contains("sticks to another hull, which keeps it"), "{error}");
    assert!(scene.world.hull(scene.hull).take_error().is_none());
}

#[test]
fn other_data_release_the_hull() {
    let mut scene = Scene::new(Motion::Held);
    scene.hold(true);
    (0..3).for_each(|_| scene.step());
    let other = data();
    publish(&other, &frames()[0], 0.0);
    scene.world.hull_mut(scene.hull).set_data(&other);
    assert!(!scene.world.hull(scene.hull).is_held());
    assert!(!scene.holds());
    assert!(scene.has_contacts());
}

#[test]
fn a_body_that_the_program_moves_away_is_forgotten_and_said() {
    let mut scene = Scene::new(Motion::Held);
    scene.hold(true);
    (0..3).for_each(|_| scene.step());
    // Above the forearm, where it does not touch.
    let away = pose_at(0.0) * at(-0.15, PALM_LINE, ON_PALM + 0.05);
    scene.world.body_mut(scene.ball).set_pose(&away).unwrap();
    scene.step();
    assert!(!scene.holds());
    let said = scene.world.hull(scene.hull).take_left_out().unwrap().to_string();
    assert!(said.contains("it was moved, or is another body"), "{said}");
}

#[test]
fn a_body_that_something_holds_back_is_released_and_said() {
    let mut scene = Scene::new(Motion::Interpolated);
    scene.hold(true);
    let place = pose_at(0.0) * at(0.0, PALM_LINE, ON_PALM);
    let mut released = None;
    while scene.time < END && released.is_none() {
        scene.step();
        // As a wall would.
        scene.world.body_mut(scene.ball).set_pose(&place).unwrap();
        released = (!scene.holds()).then(|| pose_at(scene.shown()));
    }
    let hand = released.expect("a release");
    let belongs = hand * point![0.0, PALM_LINE, ON_PALM];
    assert!((belongs.coords - place.translation.vector).norm() > 0.15);
    let said = scene.world.hull(scene.hull).take_left_out().unwrap().to_string();
    assert!(said.contains("held back by more than 0.15 m"), "{said}");
}

#[test]
fn a_hull_without_a_frame_may_be_held_and_twice() {
    let mut scene = Scene::new(Motion::Held);
    scene.world.set_gravity(&Vector3::zeros()).unwrap();
    scene.hold(true);
    scene.hold(true);
    (0..3).for_each(|_| step(&mut scene.world, STEP));
    assert!(!scene.holds());
    (0..3).for_each(|_| scene.step());
    assert!(scene.holds());
    assert!(scene.world.hull(scene.hull).is_held());
    scene.hold(false);
    scene.hold(false);
    scene.step();
    assert!(!scene.holds());
}

#[test]
fn what_sticks_moves_by_the_same_bits_in_each_run() {
    let run = || {
        let mut scene = Scene::new(Motion::Interpolated);
        scene.hold(true);
        scene.run_to(0.5);
        scene.world.body(scene.ball).pose()
    };
    assert_eq!(run(), run());
}

#[test]
fn a_body_that_sticks_goes_on_touching_until_it_leaves() {
    let mut scene = Scene::new(Motion::Interpolated);
    scene.world.hull_mut(scene.hull).set_events(true);
    scene.hold(true);
    let mut kinds = Vec::new();
    while scene.time < END {
        scene.step();
        kinds.extend(scene.world.hull_mut(scene.hull).events().unwrap().map(|event| event.kind));
    }
    assert!(scene.holds());
    assert_eq!(kinds, [HullEventKind::Begin]);
}
