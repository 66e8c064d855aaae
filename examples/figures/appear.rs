//! Shapes that appear inside bodies at rest and beside them: how fast the bodies leave.

use crate::studio::*;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::ode::{BodyId, Shape, Surface, World};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage};
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use ode_visual_hull_testing::random::Random;

/// Random subjects, each of which appears among as many bodies.
const SUBJECTS: usize = 200;
const BODIES: usize = 50;

/// Seconds for which bodies are watched after a subject has appeared.
const WATCHED: f64 = 0.15;

/// What happens to the hull.
#[derive(Debug, Clone, Copy)]
enum Event {
    /// The subject was not there.
    Appears,
    /// The masks showed another subject.
    Jumps,
    /// A view is lost, and comes back.
    LosesView,
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let cameras = level_ring(0.0);
    let mut figures = Vec::new();
    let mut worst = 0.0_f64;
    for rate in [120.0, 240.0, 1000.0] {
        progress(&format!("subjects that appear, at {rate} Hz"));
        let mut random = Random(1);
        let mut speeds: Vec<f64> =
            (0..SUBJECTS).flat_map(|k| speeds(&cameras, &mut random, k, 1.0 / rate)).collect();
        speeds.sort_by(f64::total_cmp);
        worst = worst.max(speeds[speeds.len() - 1]);
        let touched = &speeds[speeds.partition_point(|speed| *speed < 1e-3)..];
        figures.push(Figure::reported(&format!("appear_speed_m_s_worst_{rate}"), speeds[speeds.len() - 1]));
        figures
            .push(Figure::reported(&format!("appear_speed_m_s_median_{rate}"), touched[touched.len() / 2]));
    }
    figures.push(Figure::bounded("appear_speed_m_s", worst, AtMost(1.5)));
    figures
}

/// The largest speeds of bodies at rest among which a random subject appears.
fn speeds(cameras: &[Camera], random: &mut Random, number: usize, step: f64) -> Vec<f64> {
    let event = [Event::Appears, Event::Jumps, Event::LosesView][number % 3];
    let data = data(cameras);
    let mut world = world(number as u64, 0.001);
    world.set_gravity(&Vector3::zeros()).expect("finite");
    let root = world.root_space();
    world.add_hull(root, &data).expect("room for the class");

    let [before, after] = [0, 1].map(|_| masks(cameras, &subject(random), coverage));
    let empty = masks(cameras, &Subject::new(Vec::new()), coverage);
    let bodies: Vec<BodyId> = (0..BODIES).map(|_| add_random_body(&mut world, random)).collect();
    publish(&data, if matches!(event, Event::Jumps) { &before } else { &empty }, 0.0);
    if matches!(event, Event::LosesView) {
        publish(&data, &after, 0.0);
    }

    // The bodies of the first subject come to rest.
    advance(&mut world, step, if matches!(event, Event::Jumps) { 3.0 * WATCHED } else { 2.0 * step });
    for &body in &bodies {
        world.body_mut(body).set_linear_velocity(&Vector3::zeros()).expect("finite");
        world.body_mut(body).set_angular_velocity(&Vector3::zeros()).expect("finite");
    }
    publish(&data, &after, 1.0);
    let mut fastest = vec![0.0_f64; BODIES];
    watch(&mut world, &bodies, step, &mut fastest);
    if matches!(event, Event::LosesView) {
        let lost = random.below(cameras.len());
        for enabled in [false, true] {
            data.set_view_enabled(lost, enabled).expect("a view");
            data.update(2.0).expect("masks");
            watch(&mut world, &bodies, step, &mut fastest);
        }
    }
    fastest
}

fn advance(world: &mut World, step: f64, seconds: f64) {
    for _ in 0..(seconds / step).ceil() as usize {
        world.default_collide(&Surface::with_friction(0.5), 8).expect("a valid surface");
        world.quick_step(step).expect("finite states");
    }
}

fn watch(world: &mut World, bodies: &[BodyId], step: f64, fastest: &mut [f64]) {
    for _ in 0..(WATCHED / step).ceil() as usize {
        advance(world, step, step);
        for (fastest, &body) in fastest.iter_mut().zip(bodies) {
            *fastest = fastest.max(speed(world, body));
        }
    }
}

/// One to three solids near the origin.
fn subject(random: &mut Random) -> Subject {
    let count = random.below(3) + 1;
    let solids = (0..count).map(|_: usize| {
        let solid = match random.below(3_usize) {
            0 => Solid::sphere(random.between(0.03, 0.2)),
            1 => Solid::capsule(random.between(0.02, 0.08), random.between(0.1, 0.5)),
            _ => Solid::cuboid(Vector3::from_fn(|_, _| random.between(0.05, 0.4))),
        };
        Placed::new(solid.expect("positive sizes"), pose(random, 0.2), Texture::plain([200; 3]))
    });
    Subject::new(solids.collect())
}

fn pose(random: &mut Random, reach: f64) -> Isometry3<f64> {
    let place = Vector3::from_fn(|_, _| random.between(-reach, reach));
    Isometry3::from_parts(place.into(), random.rotation())
}

/// A body of a random shape, which collides with the hull alone.
fn add_random_body(world: &mut World, random: &mut Random) -> BodyId {
    let shape = match random.below(4_usize) {
        0 => Shape::Sphere { radius: random.between(0.03, 0.12) },
        1 => Shape::Capsule { radius: random.between(0.02, 0.06), length: random.between(0.05, 0.3) },
        2 => Shape::Cylinder { radius: random.between(0.03, 0.1), length: random.between(0.05, 0.3) },
        _ => Shape::Box { sides: Vector3::from_fn(|_, _| random.between(0.05, 0.25)) },
    };
    let (body, geom) = add_body(world, &shape, &pose(random, 0.25));
    let mut geom = world.geom_mut(geom);
    geom.set_category_bits(2);
    geom.set_collide_bits(1);
    body
}
