//! Whether friction is Coulomb's: a box on balls that is pushed, boxes that slide until they stop, and boxes on slopes; on
//! ODE's own plane, plain and with friction along the slip, and on a hull.

use crate::studio::*;
use nalgebra::{Point3, Vector3, vector};
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::ode::{Amount, BodyId, Shape, Surface, World};
use ode_visual_hull::synthetic::{Subject, coverage, layout};
use ode_visual_hull_testing::figure::{
    Bound::{AtLeast, AtMost, Between},
    Figure,
};
use ode_visual_hull_testing::world::add_body_of;
use std::sync::Arc;

const GRAVITY: f64 = 9.81;

/// The rates of the rolling test, and that of the others, in steps a second.
const ROLLING_RATES: [f64; 2] = [240.0, 960.0];
const RATE: f64 = 240.0;

/// The time in which bodies settle in the contacts' surface layer, in seconds.
const SETTLING: f64 = 0.3;

/// The side lengths of the real table.
const WIDE_TABLE: Vector3<f64> = Vector3::new(1.4, 1.4, 0.3);

/// What the bodies are on. Its top is at height 0.
#[derive(Debug, Clone)]
enum Ground {
    /// ODE's plane, with friction directions that ODE chooses.
    Plain,
    /// ODE's plane, with friction along the slip.
    AlongSlip,
    /// The hull of a table.
    Hull(Arc<HullData>),
}

impl Ground {
    /// A world with this ground.
    fn world(&self) -> World {
        let mut world = world(0, 0.0005);
        let root = world.root_space();
        match self {
            Self::Hull(data) => {
                world.add_hull(root, data).expect("room for the class");
            }
            Self::Plain | Self::AlongSlip => {
                let plane = Shape::Plane { normal: Vector3::z(), offset: 0.0 };
                world.add_geom(root, &plane).expect("a unit normal");
            }
        }
        world.set_slip_friction(!matches!(self, Self::Plain));
        world
    }
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let grounds = [
        (Ground::AlongSlip, "", "on ODE's plane, along the slip"),
        (Ground::Hull(table_data()), "_hull", "on a hull"),
        (Ground::Plain, "_plain", "on ODE's plane"),
    ];
    let mut figures = Vec::new();
    for (ground, name, words) in &grounds {
        let mut add = |what: &str, value: f64, bound| {
            let name = format!("{what}{name}");
            figures.push(match ground {
                Ground::Plain => Figure::reported(&name, value),
                _ => Figure::bounded(&name, value, bound),
            });
        };
        progress(&format!("a box on 25 balls, {words}"));
        for rate in ROLLING_RATES {
            let [speed, direction, balls] = rolling(ground, rate);
            add(&format!("rolling_test_speed_ratio_{rate}_hz"), speed, Between(0.98, 1.02));
            add(&format!("rolling_test_balls_speed_ratio_{rate}_hz"), balls, Between(0.98, 1.02));
            add(&format!("rolling_test_direction_deg_{rate}_hz"), direction, Between(44.0, 46.0));
        }
        progress(&format!("boxes that stop, {words}"));
        let stops: Vec<[f64; 2]> =
            (0..16).map(|k| stop(ground, f64::from(k) * std::f64::consts::TAU / 16.0)).collect();
        let of = |k: usize| stops.iter().map(move |stop| stop[k]);
        add("coulomb_stop_ratio_min", of(0).fold(f64::INFINITY, f64::min), AtLeast(0.97));
        add("coulomb_stop_ratio_max", of(0).fold(0.0, f64::max), AtMost(1.03));
        add("coulomb_stop_direction_deg", of(1).fold(0.0, f64::max), AtMost(1.0));
        progress(&format!("boxes on slopes, {words}"));
        add("coulomb_grid_wrong_cells", wrong_cells(ground) as f64, AtMost(0.0));
    }
    figures
}

/// The hull of a table that is exactly the table, with its top at height 0.
fn table_data() -> Arc<HullData> {
    let pose = at(0.0, 0.0, -0.5 * WIDE_TABLE.z);
    let cameras = layout::face_on(WIDE_TABLE, &pose, 4.0, 0.3, (640, 480), 0.6).expect("four cameras");
    let data = HullData::new();
    data.add_views(&cameras).expect("names of their own");
    let bounds = Aabb::new(Point3::new(-1.0, -1.0, -0.5), Point3::new(1.0, 1.0, 0.5));
    data.set_bounds(bounds.expect("a volume")).expect("a volume");
    let table = Subject::new(vec![cuboid(WIDE_TABLE, pose)]);
    publish(&data, &masks(&cameras, &table, coverage), 0.0);
    Arc::new(data)
}

/// SimBenchmark's rolling test in small: a box of 10 kg, on which 25 balls of 1 kg lie, is pushed along its diagonal by 150 N.
/// The speeds of the box and of the balls over the analytic ones, and the direction of the box in degrees.
fn rolling(ground: &Ground, rate: f64) -> [f64; 3] {
    const FORCE: f64 = 150.0;
    const BOX: f64 = 10.0;
    const BALLS: f64 = 25.0;
    const MU_OF_GROUND: f64 = 0.4;
    const MU_OF_BALLS: f64 = 0.8;
    // Longer, and the first balls would roll off the box.
    const SECONDS: f64 = 0.5;
    let mut world = ground.world();
    let sides = vector![0.6, 0.6, 0.1];
    let pose = at(0.0, 0.0, 0.5 * sides.z);
    let (body, _) = add_body_of(&mut world, &Shape::Box { sides }, Amount::Total(BOX), &pose);
    let (radius, place) = (0.03, |k: i32| 0.1 * f64::from(k - 2));
    let ball = |k: i32| {
        let pose = at(place(k % 5), place(k / 5), sides.z + radius);
        add_body_of(&mut world, &Shape::Sphere { radius }, Amount::Total(1.0), &pose).0
    };
    let balls: Vec<BodyId> = (0..25).map(ball).collect();

    let force = vector![1.0, 1.0, 0.0].normalize() * FORCE;
    let steps = |seconds: f64| (seconds * rate) as usize;
    for step in 0..steps(SETTLING + SECONDS) {
        if step >= steps(SETTLING) {
            world.body_mut(body).add_force(&force).expect("finite");
        }
        let along_slip = world.slip_friction();
        let collided = world.collide(|pair| {
            let is_on_ground = pair.bodies().contains(&None);
            let mu = if is_on_ground { MU_OF_GROUND } else { MU_OF_BALLS };
            for contact in pair.contacts(8).iter() {
                let direction = along_slip.then(|| pair.slip_direction(contact, 1.0 / rate)).flatten();
                pair.attach(
                    contact,
                    &Surface { friction_direction: direction, ..Surface::with_friction(mu) },
                );
            }
        });
        collided.expect("valid contacts");
        world.step(1.0 / rate).expect("finite states");
    }

    // The box slides; the balls roll on it without slip, at two sevenths of its acceleration.
    let friction = MU_OF_GROUND * (BOX + BALLS) * GRAVITY;
    let expected = (FORCE - friction) / (BOX + BALLS * 2.0 / 7.0) * SECONDS;
    let moved = world.body(body).position();
    let of_balls: f64 = balls.iter().map(|&ball| speed(&world, ball)).sum::<f64>() / BALLS;
    [speed(&world, body) / expected, moved.y.atan2(moved.x).to_degrees(), of_balls / (expected * 2.0 / 7.0)]
}

/// How far a box slides at 1 m/s in a direction until it stops, over Coulomb's v^2 / (2 mu g), and by how many degrees it leaves
/// its course.
fn stop(ground: &Ground, azimuth: f64) -> [f64; 2] {
    const SPEED: f64 = 1.0;
    const MU: f64 = 0.2;
    let (mut world, body) = box_at_rest(ground);
    let start = world.body(body).position();
    let direction = vector![azimuth.cos(), azimuth.sin(), 0.0];
    world.body_mut(body).set_linear_velocity(&(direction * SPEED)).expect("finite");
    simulate(&mut world, MU, 1.0);
    let moved = (world.body(body).position() - start).xy();
    let aside = direction.xy().perp(&moved).atan2(direction.xy().dot(&moved));
    [moved.norm() / (SPEED * SPEED / (2.0 * MU * GRAVITY)), aside.to_degrees().abs()]
}

/// Of ten coefficients of friction and 14 slopes, how many let a box rest that has to slide, or slide that has to rest. The
/// three degrees around the angle of friction do not count.
fn wrong_cells(ground: &Ground) -> usize {
    let is_wrong = |mu: f64, slope: f64| {
        let over = slope - mu.atan().to_degrees();
        if over.abs() < 3.0 {
            return false;
        }
        // The gravity is tilted in place of the ground, between ODE's friction directions.
        let (azimuth, slope) = (0.5_f64, slope.to_radians());
        let down = vector![slope.sin() * azimuth.cos(), slope.sin() * azimuth.sin(), -slope.cos()];
        let (mut world, body) = box_at_rest(ground);
        let start = world.body(body).position();
        world.set_gravity(&(down * GRAVITY)).expect("finite");
        simulate(&mut world, mu, 0.5);
        let slides = (world.body(body).position() - start).norm() > 0.02;
        slides != (over > 0.0)
    };
    let cells =
        (1..=10).flat_map(|mu| (1..=14).map(move |slope| (0.1 * f64::from(mu), 5.0 * f64::from(slope))));
    cells.filter(|&(mu, slope)| is_wrong(mu, slope)).count()
}

/// A flat box that has settled in the middle of the ground.
fn box_at_rest(ground: &Ground) -> (World, BodyId) {
    let mut world = ground.world();
    let sides = vector![0.16, 0.16, 0.04];
    let (body, _) = add_body(&mut world, &Shape::Box { sides }, &at(0.0, 0.0, 0.5 * sides.z));
    simulate(&mut world, 1.0, SETTLING);
    (world, body)
}

fn simulate(world: &mut World, mu: f64, seconds: f64) {
    for _ in 0..(seconds * RATE) as usize {
        world.default_collide(&Surface::with_friction(mu), 8).expect("a valid surface");
        world.step(1.0 / RATE).expect("finite states");
    }
}
