//! Bodies at rest on a hull whose cameras are lost and come back, and a stack on masks and cameras with gross errors.

mod errors;

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3, point};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::ode::{BodyId, GeomId, Shape, Surface, World};
use ode_visual_hull::synthetic::{coverage, layout};
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use std::sync::Arc;

/// Frames a second.
const RATE: f64 = 30.0;

/// Steps of the simulation in a frame: 240 Hz.
const STEPS: usize = 8;

/// Seconds of a step.
const STEP: f64 = 1.0 / (RATE * STEPS as f64);

/// Frames in which bodies come to rest: two seconds.
const SETTLE: usize = 60;

/// Frames without a camera: a second.
const LOSS: usize = 30;

/// Frames after each loss.
const BACK: usize = 15;

/// The largest age of a mask, in seconds: three frames.
const MAX_AGE: f64 = 0.1;

/// Side length of the boxes of the stack, in metres.
const SIDE: f64 = 0.15;

/// Depth in metres from which on a body is stuck in the hull.
const STUCK: f64 = 0.01;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut outcomes = Vec::new();
    for motion in [Motion::Held, Motion::Interpolated] {
        progress(&format!("cameras lost on a level ring, {motion:?}"));
        outcomes.push(level_cameras_lost(motion));
        progress(&format!("the only level camera lost, {motion:?}"));
        outcomes.push(only_level_camera_lost(motion));
    }
    let most = |value: fn(&Outcome) -> f64| outcomes.iter().map(value).fold(0.0, f64::max);
    let stuck: f64 = outcomes.iter().map(|outcome| outcome.stuck as f64).sum();
    let mut figures = vec![
        Figure::bounded("camera_loss_max_speed_m_s", most(|outcome| outcome.speed), AtMost(0.2)),
        Figure::bounded("camera_loss_max_shift_mm", most(|outcome| outcome.shift), AtMost(50.0)),
        Figure::reported("camera_loss_stuck", stuck),
    ];
    figures.extend(errors::figures(progress));
    figures
}

/// What bodies at rest do while cameras are lost.
#[derive(Debug, Default)]
struct Outcome {
    /// The largest speed of a body from the first loss on, in m/s.
    speed: f64,
    /// How far a body was from its place before the first loss at most, in millimetres.
    shift: f64,
    /// How many bodies are deep inside the hull at the end.
    stuck: usize,
}

/// A stack on the table, and boxes around it that touch the hull's sides, which grow when one of seven cameras is lost.
fn level_cameras_lost(motion: Motion) -> Outcome {
    let cameras = level_ring(TOP);
    let mut stage = Stage::new(&cameras, &cameras, motion);
    stage.add_stack();

    let floor = Shape::Plane { normal: Vector3::z(), offset: -0.5 * TABLE.z };
    let root = stage.world.root_space();
    stage.world.add_geom(root, &floor).expect("a unit normal");
    for k in 0..12 {
        stage.add_box_beside(f64::from(k) * std::f64::consts::TAU / 12.0 + 0.1);
    }
    stage.lose_cameras(0..cameras.len())
}

/// A stack and small boxes on the table, over which the hull grows when the only camera that looks along the table's top
/// is lost: six others look down on it.
fn only_level_camera_lost(motion: Motion) -> Outcome {
    let high = layout::ring(6, 3.0, 1.2, ORIGIN, (640, 480), 0.8).expect("a ring of six");
    let (eye, target) = (point![3.0, 0.4, TOP], point![0.0, 0.0, TOP - 0.1]);
    let level = Camera::look_at("level", (640, 480), 0.8, eye, target, Vector3::z()).expect("a camera");
    let cameras: Vec<Camera> = high.into_iter().chain([level]).collect();

    let mut stage = Stage::new(&cameras, &cameras, motion);
    stage.add_stack();
    for (x, y) in [(-0.18, -0.18), (-0.18, 0.18), (0.18, -0.18), (0.18, 0.18)] {
        stage.add(0.05, &at(x, y, TOP + 0.0255));
    }
    stage.lose_cameras([0, 6])
}

/// A simulation of bodies on the hull of the table.
struct Stage {
    world: World,
    hull: GeomId,
    data: Arc<HullData>,
    /// The table's masks without errors.
    clean: Vec<GrayImage>,
    bodies: Vec<(BodyId, GeomId)>,
    frames: usize,
}

impl Stage {
    /// The table as `cameras` see it, with `calibrated` as the calibration.
    fn new(cameras: &[Camera], calibrated: &[Camera], motion: Motion) -> Self {
        let data = data(calibrated);
        data.set_max_age(Some(MAX_AGE)).expect("a positive age");
        let clean = masks(cameras, &table(), coverage);
        publish(&data, &clean, 0.0);

        let mut world = world(0, 0.001);
        let root = world.root_space();
        let hull = world.add_hull(root, &data).expect("room for the class");
        world.hull_mut(hull).set_motion(motion);
        Self { world, hull, data, clean, bodies: Vec::new(), frames: 0 }
    }

    fn add(&mut self, side: f64, pose: &Isometry3<f64>) {
        self.bodies.push(add_body(&mut self.world, &Shape::cube(side), pose));
    }

    fn add_stack(&mut self) {
        for k in 0..5 {
            self.add(SIDE, &at(0.0, 0.0, TOP + SIDE * (f64::from(k) + 0.5) + 0.0005));
        }
    }

    /// Adds a box on the floor that touches the hull's side in a direction.
    fn add_box_beside(&mut self, angle: f64) {
        let (_, frame) = self.data.latest().expect("published");
        let direction = Vector3::new(angle.cos(), angle.sin(), 0.0);
        let height = Vector3::z() * 0.5 * (SIDE - TABLE.z);
        let is_inside = |mm: &i32| frame.inside(&Point3::from(direction * 1e-3 * f64::from(*mm) + height));
        let edge = 1e-3 * f64::from((0..1000).rev().find(is_inside).expect("the table"));

        let place = direction * (edge + 0.5 * SIDE + 0.001) + height;
        self.add(
            SIDE,
            &(at(place.x, place.y, place.z) * nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.0, angle)),
        );
    }

    fn places(&self) -> Vec<Point3<f64>> {
        self.bodies.iter().map(|(body, _)| self.world.body(*body).position()).collect()
    }

    /// How far each body is from a place, in millimetres; infinite where that is not a number.
    fn shifts(&self, from: &[Point3<f64>]) -> Vec<f64> {
        let shift = |(now, before): (Point3<f64>, &Point3<f64>)| 1e3 * (now - before).norm();
        let finite = |shift: f64| if shift.is_finite() { shift } else { f64::INFINITY };
        self.places().into_iter().zip(from).map(shift).map(finite).collect()
    }

    /// Simulates a number of frames. `mask` returns the mask of a view in a frame, if it has one. Returns the largest
    /// speed of a body, in m/s.
    fn play(&mut self, frames: usize, mut mask: impl FnMut(usize, &GrayImage) -> Option<GrayImage>) -> f64 {
        let mut fastest = 0.0_f64;
        for _ in 0..frames {
            let time = self.frames as f64 / RATE;
            for (view, clean) in self.clean.iter().enumerate() {
                if let Some(mask) = mask(view, clean) {
                    self.data.set_mask_at(view, &mask, time).expect("a mask of the camera's size");
                }
            }
            self.data.update(time).expect("times that grow");
            for step in 0..STEPS {
                self.step(time + step as f64 * STEP);
                let speeds = self.bodies.iter().map(|(body, _)| speed(&self.world, *body));
                fastest = speeds.fold(fastest, f64::max);
            }
            self.frames += 1;
        }
        fastest
    }

    fn step(&mut self, time: f64) {
        self.world.hull_mut(self.hull).set_time(time).expect("times that grow");
        self.world.default_collide(&Surface::with_friction(0.8), 8).expect("a valid surface");
        self.world.quick_step(STEP).expect("finite states");
    }

    /// Loses each of some cameras in turn for a second, once because it is disabled and once because it is late.
    fn lose_cameras(&mut self, cameras: impl IntoIterator<Item = usize>) -> Outcome {
        let all = |_: usize, clean: &GrayImage| Some(clean.clone());
        self.play(SETTLE, all);
        let start = self.places();

        let mut outcome = Outcome::default();
        for camera in cameras {
            for is_late in [false, true] {
                self.data.set_view_enabled(camera, is_late).expect("a view");
                let lost = self.play(LOSS, |view, clean| (view != camera || !is_late).then(|| clean.clone()));
                let shift = self.shifts(&start);
                self.data.set_view_enabled(camera, true).expect("a view");
                let back = self.play(BACK, all);

                outcome.speed = outcome.speed.max(lost).max(back);
                outcome.shift = shift.into_iter().chain(self.shifts(&start)).fold(outcome.shift, f64::max);
            }
        }
        outcome.stuck = self.stuck();
        outcome
    }

    /// The number of bodies that are deep inside the hull.
    fn stuck(&mut self) -> usize {
        let Self { world, hull, bodies, .. } = self;
        let depths = bodies.iter().map(|(_, geom)| {
            let contacts = world.collide_geoms(*hull, *geom, 8).expect("geoms of this world");
            contacts.iter().map(|contact| contact.depth).fold(0.0, f64::max)
        });
        depths.filter(|depth| *depth > STUCK).count()
    }
}
