//! What a rig sees: the spot its cameras look at, the volume around it, and how many cameras see how much of that.

use super::Rig;
use crate::camera::Camera;
use crate::math::aabb::Aabb;
use crate::{Error, Result};
use nalgebra::{Matrix3, Point3, Vector3};

/// How much of the way from the spot that is looked at to the nearest camera belongs to the work volume.
const REACH: f64 = 0.9;

impl Rig {
    /// The point nearest to all optical axes, in the world.
    ///
    /// # Errors
    /// Cameras that all look in one direction, or back.
    pub fn focus(&self) -> Result<Point3<f64>> {
        // The sum of (1 - d d^T) (x - c) over the axes is zero.
        let (mut matrix, mut vector) = (Matrix3::zeros(), Vector3::zeros());
        for camera in self.cameras() {
            let across = Matrix3::identity() - camera.forward() * camera.forward().transpose();
            matrix += across;
            vector += across * camera.centre().coords;
        }
        // Its determinant is that of the angles between the axes; below this they are a hundredth of a degree.
        let inverse = matrix.try_inverse().filter(|_| matrix.determinant() > 1e-8);
        inverse.map(|inverse| Point3::from(inverse * vector)).ok_or_else(|| {
            Error::argument(
                "expected cameras that look in different directions, found parallel ones; give a work volume",
            )
        })
    }

    /// A work volume around the [`focus`](Self::focus), 0.9 times as far as the nearest camera stands from it; above
    /// the floor z = 0 where the cameras and the focus are.
    ///
    /// # Errors
    /// As [`focus`](Self::focus); a camera that stands at it.
    pub fn work_volume(&self) -> Result<Aabb> {
        let focus = self.focus()?;
        let distances = self.cameras().iter().map(|camera| (camera.centre() - focus).norm());
        let reach = Vector3::repeat(REACH * distances.fold(f64::INFINITY, f64::min));
        let (mut min, max) = (focus - reach, focus + reach);
        if focus.z > 0.0 && self.cameras().iter().all(|camera| camera.centre().z > 0.0) {
            min.z = min.z.max(0.0);
        }
        Aabb::new(min, max)
    }

    /// The shares of `volume` that exactly 0, 1, 2, ... cameras have in their images, by a grid of points of which
    /// there are `fineness` along its longest side (at least one). They add up to 1.
    pub fn coverage(&self, volume: &Aabb, fineness: usize) -> Vec<f64> {
        let mut counts = vec![0_usize; self.len() + 1];
        for point in grid(volume, fineness) {
            counts[self.cameras().iter().filter(|camera| camera.sees(&point)).count()] += 1;
        }
        let all = counts.iter().sum::<usize>() as f64;
        counts.into_iter().map(|count| count as f64 / all).collect()
    }

    /// The share of `volume` that one camera has in its image, as [`coverage`](Self::coverage) counts.
    pub fn coverage_of(camera: &Camera, volume: &Aabb, fineness: usize) -> f64 {
        let (mut seen, mut all) = (0_usize, 0_usize);
        for point in grid(volume, fineness) {
            all += 1;
            seen += usize::from(camera.sees(&point));
        }
        seen as f64 / all as f64
    }
}

/// The middles of cubes that fill `volume`.
fn grid(volume: &Aabb, fineness: usize) -> impl Iterator<Item = Point3<f64>> {
    let (min, sides) = (volume.min, volume.max - volume.min);
    let spacing = sides.max() / fineness.max(1) as f64;
    let counts = sides.map(|side| ((side / spacing).round() as usize).max(1));
    let at = move |axis: usize, k: usize| min[axis] + sides[axis] * (k as f64 + 0.5) / counts[axis] as f64;
    (0..counts.z).flat_map(move |k| {
        (0..counts.y).flat_map(move |j| (0..counts.x).map(move |i| Point3::new(at(0, i), at(1, j), at(2, k))))
    })
}
