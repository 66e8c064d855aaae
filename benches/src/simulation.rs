//! A simulation in ODE: the share of colliding in the time of a step.

use crate::session::{Session, StartTime};
use crate::timing::thread_seconds;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{Amount, BodyId, Mass, Ode, Shape, Surface, World, set_random_seed};
use ode_visual_hull_bench::scene::{BOX, Bodies, SAMPLES_400, Scene, SubjectKind, VGA};
use ode_visual_hull_testing::median;
use std::sync::Arc;

/// Step size of the simulation, in seconds.
const DT: f64 = 0.01;

/// Steps of a round, after which the boxes are put back to where they touch the person.
const STEPS_PER_ROUND: usize = 10;

pub fn run_group(session: &mut Session) {
    let scene = Scene::new(SubjectKind::Person, 7, VGA);
    let bodies = Bodies::scattered(60, SAMPLES_400);
    let (mut world, ids) = world(&scene, &bodies).expect("a world of ODE");
    set_random_seed(1);

    let (mut shares, mut steps) = (Vec::new(), Vec::new());

    for _ in 0..session.rounds() {
        put_back(&mut world, &ids, &bodies.poses);
        let (mut collide, mut total) = (0.0, 0.0);
        for _ in 0..STEPS_PER_ROUND {
            let start = thread_seconds();
            world.default_collide(&Surface::with_friction(0.8), 8).expect("a valid surface");
            collide += thread_seconds() - start;
            world.quick_step(DT).expect("finite states");
            total += thread_seconds() - start;
        }
        shares.push(collide / total);
        steps.push(total / STEPS_PER_ROUND as f64);
    }

    let what = "colliding as a part of collide and quick step, 60 boxes about a person in ODE";
    session.reported("collide_share", median(shares), StartTime::Step, what);
    session.reported(
        "step_60_ms",
        1e3 * median(steps),
        StartTime::Step,
        "collide and quick step, 60 boxes about a person",
    );
}

/// A world with the person as a hull, a floor, and the boxes.
fn world(scene: &Scene, bodies: &Bodies) -> ode_visual_hull::Result<(World, Vec<BodyId>)> {
    let data = HullData::new();
    for (camera, mask) in scene.cameras.iter().zip(&scene.masks) {
        let view = data.add_view(camera.clone())?;
        data.set_mask(view, mask)?;
    }

    data.set_bounds(scene.bounds)?;
    data.update(0.0)?;

    let mut world = World::new(&Ode::init()?)?;
    world.set_gravity(&Vector3::new(0.0, 0.0, -9.81))?;
    let root = world.root_space();
    world.add_hull(root, &Arc::new(data))?;
    world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 })?;

    let shape = Shape::Box { sides: BOX };
    let mass = Mass::of(&shape, Amount::Density(100.0))?;

    let mut ids = Vec::new();
    for _ in &bodies.poses {
        let (body, geom) = (world.add_body(), world.add_geom(root, &shape)?);
        world.body_mut(body).set_mass(&mass)?;
        world.geom_mut(geom).set_body(Some(body))?;
        ids.push(body);
    }

    Ok((world, ids))
}

fn put_back(world: &mut World, ids: &[BodyId], poses: &[Isometry3<f64>]) {
    for (id, pose) in ids.iter().zip(poses) {
        let mut body = world.body_mut(*id);
        body.set_pose(pose).expect("finite");
        body.set_linear_velocity(&Vector3::zeros()).expect("finite");
        body.set_angular_velocity(&Vector3::zeros()).expect("finite");
    }
}
