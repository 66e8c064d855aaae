//! Subjects, cameras, masks and worlds that the figures of simulations share.

use image::GrayImage;
use nalgebra::{Isometry3, point, vector};
use ode_visual_hull::camera::{Camera, Distortion};
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::ode::{Amount, BodyId, GeomId, Ode, Shape, SpaceKind, Surface, World, set_random_seed};
use ode_visual_hull::synthetic::{Subject, layout};
use ode_visual_hull_testing::world::add_body_of;
use std::sync::Arc;

pub use ode_visual_hull_testing::median;
pub use ode_visual_hull_testing::scene::{ORIGIN, TABLE, TOP, at, cuboid, publish};

/// Seeds over which medians are taken, both of ODE's random numbers and of the masks' noise.
pub const SEEDS: std::ops::Range<u64> = 0..8;

/// Step size of all simulations, in seconds, as in most programs with ODE.
pub const DT: f64 = 0.01;

/// Seven cameras of 640x480 pixels on a ring of 3 m, level with `height`: about 4 mm a pixel.
pub fn level_ring(height: f64) -> Vec<Camera> {
    let target = point![0.0, 0.0, height - 0.1];
    layout::ring(7, 3.0, height, target, (640, 480), 0.8).expect("a ring of seven")
}

/// The cameras with a lens: OpenCV's k1 = -0.2.
pub fn through_lenses(cameras: &[Camera]) -> Vec<Camera> {
    let lens = Distortion::from_opencv(&[-0.2, 0.0, 0.0, 0.0]).expect("four finite coefficients");
    cameras
        .iter()
        .map(|camera| camera.clone().with_lens(lens).expect("a lens that its image allows"))
        .collect()
}

/// The size of a pixel of [`level_ring`] at the middle of the ring, in metres.
pub fn pixel() -> f64 {
    3.0 * 2.0 * (0.8_f64 / 2.0).tan() / 640.0
}

/// Data for `cameras` with a work volume of 2 m.
pub fn data(cameras: &[Camera]) -> Arc<HullData> {
    let data = HullData::new();
    for camera in cameras {
        data.add_view(camera.clone()).expect("names of their own");
    }
    let bounds = Aabb::new(point![-1.0, -1.0, -1.0], point![1.0, 1.0, 1.0]).expect("a volume");
    data.set_bounds(bounds).expect("a volume");
    Arc::new(data)
}

/// The masks of `subject` in each camera, rendered by `draw`.
pub fn masks(
    cameras: &[Camera],
    subject: &Subject,
    draw: fn(&Camera, &Subject) -> GrayImage,
) -> Vec<GrayImage> {
    cameras.iter().map(|camera| draw(camera, subject)).collect()
}

/// The table as a subject.
pub fn table() -> Subject {
    Subject::new(vec![cuboid(TABLE, Isometry3::identity())])
}

/// A world with parameters that suit a hull.
pub fn world(seed: u64, surface_layer: f64) -> World {
    set_random_seed(seed as u32 + 1);
    let ode = Ode::init().expect("ODE in double precision");
    let mut world = World::with_space(&ode, SpaceKind::default()).expect("memory");
    world.set_gravity(&vector![0.0, 0.0, -9.81]).expect("finite");
    world.set_erp(0.2).expect("in range");
    world.set_cfm(1e-5).expect("in range");
    world.set_contact_surface_layer(surface_layer).expect("in range");
    world.set_quick_step_iterations(50).expect("positive");
    world
}

/// A body of density 100 kg/m3 with one geom.
pub fn add_body(world: &mut World, shape: &Shape, pose: &Isometry3<f64>) -> (BodyId, GeomId) {
    add_body_of(world, shape, Amount::Density(100.0), pose)
}

pub fn step(world: &mut World) {
    world.default_collide(&Surface::with_friction(0.8), 8).expect("a valid surface");
    world.quick_step(DT).expect("finite states");
}

/// The speed of `body`, in m/s.
pub fn speed(world: &World, body: BodyId) -> f64 {
    world.body(body).linear_velocity().norm()
}

pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
