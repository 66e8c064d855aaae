//! A table whose hull is the table, and worlds on it: what the tests of the collision class share.
#![allow(dead_code, reason = "each test binary uses a part")]

use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3, point, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::ode::{Amount, BodyId, GeomId, Mass, Ode, Shape, SpaceKind, Surface, World};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use std::sync::{Arc, LazyLock};

/// The table's full side lengths; its centre is the origin.
pub const TABLE: Vector3<f64> = Vector3::new(0.5, 0.5, 0.4);

/// The height of the table's top.
pub const TOP: f64 = 0.2;

/// What one pixel of the table's rig covers at the table, in metres: 0.45 rad over 640 pixels at about 3 m.
pub const PIXEL: f64 = 0.0022;

pub fn cuboid(lengths: Vector3<f64>, pose: Isometry3<f64>) -> Placed {
    Placed::new(Solid::cuboid(lengths).unwrap(), pose, Texture::plain([200, 60, 40]))
}

/// Four cameras that each look along the table's top and one of its sides.
pub fn table_cameras() -> Vec<Camera> {
    layout::face_on(TABLE, &Isometry3::identity(), 2.8, 0.2, (640, 480), 0.45).unwrap()
}

pub fn bounds() -> Aabb {
    Aabb::new(point![-0.6, -0.6, -0.3], point![0.6, 0.6, 0.8]).unwrap()
}

/// Data with `cameras` as views, and no mask yet.
pub fn data_with(cameras: &[Camera]) -> Arc<HullData> {
    let data = HullData::new();
    for camera in cameras {
        data.add_view(camera.clone()).unwrap();
    }
    data.set_bounds(bounds()).unwrap();
    Arc::new(data)
}

/// What each camera sees of `subject`, with coverage.
pub fn masks_of(cameras: &[Camera], subject: &Subject) -> Vec<GrayImage> {
    cameras.iter().map(|camera| coverage(camera, subject)).collect()
}

/// Shows `subject` to all views and publishes it.
pub fn show(data: &HullData, cameras: &[Camera], subject: &Subject, time: f64) {
    publish(data, &masks_of(cameras, subject), time);
}

/// Publishes a mask for each view as the frame of `time`.
pub fn publish(data: &HullData, masks: &[GrayImage], time: f64) {
    for (view, mask) in masks.iter().enumerate() {
        data.set_mask(view, mask).unwrap();
    }
    data.update(time).unwrap();
}

/// What the table's cameras see of it.
pub fn table_masks() -> &'static [GrayImage] {
    static MASKS: LazyLock<Vec<GrayImage>> = LazyLock::new(|| {
        let table = Subject::new(vec![cuboid(TABLE, Isometry3::identity())]);
        masks_of(&table_cameras(), &table)
    });
    &MASKS
}

/// Publishes the table as the frame of `time`.
pub fn show_table(data: &HullData, time: f64) {
    publish(data, table_masks(), time);
}

/// The table, seen and published at time 0.
pub fn table() -> Arc<HullData> {
    let data = data_with(&table_cameras());
    show_table(&data, 0.0);
    data
}

/// A world with gravity and the parameters that suit a hull.
pub fn world(kind: SpaceKind) -> World {
    let mut world = World::with_space(&Ode::init().unwrap(), kind).unwrap();
    world.set_gravity(&vector![0.0, 0.0, -9.81]).unwrap();
    world.set_cfm(1e-5).unwrap();
    world.set_erp(0.2).unwrap();
    world.set_contact_surface_layer(0.001).unwrap();
    world
}

/// A body of 1 kg with one geom.
pub fn add_body(world: &mut World, shape: &Shape, pose: &Isometry3<f64>) -> (BodyId, GeomId) {
    let body = world.add_body();
    let root = world.root_space();
    let geom = world.add_geom(root, shape).unwrap();
    world.geom_mut(geom).set_body(Some(body)).unwrap();
    world.body_mut(body).set_mass(&Mass::of(shape, Amount::Total(1.0)).unwrap()).unwrap();
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

pub fn step(world: &mut World, dt: f64) {
    world.default_collide(&Surface::default(), 8).unwrap();
    world.quick_step(dt).unwrap();
}

pub fn cube(side: f64) -> Shape {
    Shape::cuboid(side, side, side)
}

pub fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

pub fn height(world: &World, body: BodyId) -> f64 {
    world.body(body).position().z
}

pub const ORIGIN: Point3<f64> = Point3::new(0.0, 0.0, 0.0);
