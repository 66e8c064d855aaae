//! ODE through the safe wrapper: bodies move as in ODE, and safe code cannot access removed objects.

mod bodies;
mod failed_steps;
mod feedback;
mod geom_with_space;
mod geoms;
mod heightfields;
mod hostile_pairs;
mod ids;
mod invalid_joints;
mod joint_kinds;
mod joints;
mod motors;
mod pairs;
mod random_hulls;
mod random_joints;
mod random_meshes;
mod raw_objects;
mod surface_motion;
mod surfaces;

use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::ode::{Amount, BodyId, GeomId, Mass, Ode, Shape, Surface, World};

/// Gravity of the tests, m/s^2.
const GRAVITY: f64 = 9.81;

/// A world with gravity along -z.
fn world() -> World {
    let mut world = World::new(&Ode::init().unwrap()).unwrap();
    world.set_gravity(&Vector3::new(0.0, 0.0, -GRAVITY)).unwrap();
    world
}

/// Adds a body of this shape and mass, with its geom in the root space.
fn add(world: &mut World, shape: &Shape, mass: f64, at: [f64; 3]) -> (BodyId, GeomId) {
    let body = world.add_body();
    world.body_mut(body).set_mass(&Mass::of(shape, Amount::Total(mass)).unwrap()).unwrap();
    world.body_mut(body).set_pose(&Isometry3::translation(at[0], at[1], at[2])).unwrap();
    let geom = world.add_geom(world.root_space(), shape).unwrap();
    world.geom_mut(geom).set_body(Some(body)).unwrap();
    (body, geom)
}

/// Adds the ground plane z = 0.
fn add_ground(world: &mut World) -> GeomId {
    let ground = Shape::Plane { normal: Vector3::z(), offset: 0.0 };
    world.add_geom(world.root_space(), &ground).unwrap()
}

/// Collides and advances the world by `dt` seconds, `n` times.
fn run(world: &mut World, n: usize, dt: f64) {
    for _ in 0..n {
        world.default_collide(&Surface::default(), 8).unwrap();
        world.step(dt).unwrap();
    }
}
