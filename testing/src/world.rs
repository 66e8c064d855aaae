//! Worlds of ODE with the table of [`scene`](crate::scene).

use crate::scene::{TOP, at};
use nalgebra::{Isometry3, vector};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{Amount, BodyId, GeomId, Mass, Ode, Shape, SpaceKind, Surface, World};
use std::sync::Arc;

/// A world with gravity, and with solver parameters that suit a hull.
pub fn world(kind: SpaceKind) -> World {
    let mut world = World::with_space(&Ode::init().unwrap(), kind).unwrap();
    world.set_gravity(&vector![0.0, 0.0, -9.81]).unwrap();
    world.set_cfm(1e-5).unwrap();
    world.set_erp(0.2).unwrap();
    world.set_contact_surface_layer(0.001).unwrap();
    world
}

/// Adds a body of 1 kg with one geom.
pub fn add_body(world: &mut World, shape: &Shape, pose: &Isometry3<f64>) -> (BodyId, GeomId) {
    add_body_of(world, shape, Amount::Total(1.0), pose)
}

/// Adds a body with one geom and the mass `amount`.
pub fn add_body_of(
    world: &mut World,
    shape: &Shape,
    amount: Amount,
    pose: &Isometry3<f64>,
) -> (BodyId, GeomId) {
    let body = world.add_body();
    let root = world.root_space();
    let geom = world.add_geom(root, shape).unwrap();
    world.geom_mut(geom).set_body(Some(body)).unwrap();
    world.body_mut(body).set_mass(&Mass::of(shape, amount).unwrap()).unwrap();
    world.body_mut(body).set_pose(pose).unwrap();
    (body, geom)
}

/// A world with `data`'s hull and a box of 0.2 m that falls 2 cm onto the table's top.
pub fn drop_box_on(data: &Arc<HullData>) -> (World, BodyId) {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, data).unwrap();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.12));
    (world, body)
}

/// Collides all geoms and advances the world by `dt` seconds.
pub fn step(world: &mut World, dt: f64) {
    world.default_collide(&Surface::default(), 8).unwrap();
    world.quick_step(dt).unwrap();
}

/// A cube with edges of `side` metres.
pub fn cube(side: f64) -> Shape {
    Shape::cuboid(side, side, side)
}

/// The z coordinate of a body's centre, in metres.
pub fn height(world: &World, body: BodyId) -> f64 {
    world.body(body).position().z
}
