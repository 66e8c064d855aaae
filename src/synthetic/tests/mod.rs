//! Tests of what other tests and figures rely on: exact rays, exact masks, and images that agree with them.

mod hands;
mod images;
mod layouts;
mod noise;
mod person;
mod solids;

use super::random::Random;
use super::*;
use crate::camera::{Camera, Distortion, Ray};
use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};

/// One solid of each kind, of different sizes.
fn each_solid() -> [Solid; 4] {
    [
        Solid::sphere(0.3).unwrap(),
        Solid::cuboid(Vector3::new(0.3, 0.5, 0.4)).unwrap(),
        Solid::capsule(0.12, 0.5).unwrap(),
        Solid::torus(0.3, 0.1).unwrap(),
    ]
}

fn direction(random: &mut Random) -> Vector3<f64> {
    let ([x, y], [z, _]) = (random.normal_pair(), random.normal_pair());
    Vector3::new(x, y, z).normalize()
}

/// A random pose within 0.3 m of `about`.
fn pose(random: &mut Random, about: Vector3<f64>) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_scaled_axis(direction(random) * 3.0 * random.even());
    Isometry3::from_parts((about + direction(random) * 0.3 * random.even()).into(), rotation)
}

/// One solid of each kind, in a heap about `about`.
fn heap(about: Vector3<f64>) -> Subject {
    let mut random = Random::new(5);
    let textures =
        [Texture::plain([200, 60, 40]), Texture::checker([60, 60, 200], 0.1), Texture::cloth([190, 40, 160])];
    let placed = |(i, solid): (usize, Solid)| Placed::new(solid, pose(&mut random, about), textures[i % 3]);
    Subject::new(each_solid().into_iter().enumerate().map(placed).collect())
}

/// A camera 2.5 m from the origin with a strongly distorting lens.
fn distorting_camera() -> Camera {
    let straight = Camera::look_at(
        "c",
        (160, 120),
        0.9,
        Point3::new(2.3, 0.8, 0.5),
        Point3::new(0.0, 0.1, 0.0),
        Vector3::z(),
    )
    .unwrap();
    let lens = Distortion::from_opencv(&[-0.3, 0.1, 1e-3, -5e-4]).unwrap();
    let k = Matrix3::new(160.0, 0.0, 78.0, 0.0, 162.0, 63.0, 0.0, 0.0, 1.0);
    Camera::new("distorting", (160, 120), k, lens, *straight.cam_from_world()).unwrap()
}
