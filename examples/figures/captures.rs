//! What is needed to measure the hulls of real captures, here and in `tests/real_hulls.rs`.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use ode_visual_hull::camera::{Camera, Distortion};
use ode_visual_hull::hull::{Aabb, Hull};
use std::path::Path;

/// The seated person's work volume.
pub const SEATED: Aabb = Aabb { min: Point3::new(-0.5, -0.5, 0.0), max: Point3::new(1.5, 1.5, 2.0) };

/// The box that the dinosaur is known to fill.
pub const DINO: Aabb =
    Aabb { min: Point3::new(-0.0619, -0.0189, -0.0578), max: Point3::new(0.0109, 0.0682, 0.0155) };

/// Volume in cubic metres and bounding box of a hull, by a grid of points `spacing` apart.
pub fn carve(hull: &Hull, spacing: f64) -> (f64, Aabb) {
    let bounds = hull.bounds();
    let counts = (bounds.max - bounds.min).map(|extent| (extent / spacing) as usize);
    let (mut count, mut aabb) = (0, Aabb::EMPTY);
    for k in 0..counts.z {
        for j in 0..counts.y {
            for i in 0..counts.x {
                let p = bounds.min + Vector3::new(i, j, k).map(|n| (n as f64 + 0.5) * spacing);
                if hull.inside(&p) {
                    count += 1;
                    aabb = aabb.union(&Aabb { min: p, max: p });
                }
            }
        }
    }
    (count as f64 * spacing.powi(3), aabb)
}

/// The dinosaur's views by number, but for the sixth, of which there is no usable mask.
pub fn dino_cameras(dir: &Path) -> Vec<(usize, Camera)> {
    let cameras = std::fs::read_to_string(dir.join("dinoSR_par.txt")).expect("a readable file");
    let cameras = (1..).zip(cameras.lines().skip(1)).filter(|&(view, _)| view != 6);
    cameras.map(|(view, line)| (view, middlebury(line))).collect()
}

/// A line of `name k11 .. k33 r11 .. r33 t1 t2 t3`, pixel centres at whole numbers.
fn middlebury(line: &str) -> Camera {
    let mut words = line.split_whitespace();
    let name = words.next().expect("a name");
    let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
    let shift = Matrix3::new(1.0, 0.0, 0.5, 0.0, 1.0, 0.5, 0.0, 0.0, 1.0);
    let k = shift * Matrix3::from_row_slice(&numbers[..9]);
    let r = Rotation3::from_matrix(&Matrix3::from_row_slice(&numbers[9..18]));
    let r = UnitQuaternion::from_rotation_matrix(&r);
    let t = Vector3::from_row_slice(&numbers[18..]);
    let pose = Isometry3::from_parts(t.into(), r);
    Camera::new(name, (640, 480), k, Distortion::none(), pose).expect("a usable camera")
}
