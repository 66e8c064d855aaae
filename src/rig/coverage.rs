//! Where the cameras of a rig look, the work volume around that point, and how many cameras see each part of it.

use super::Rig;
use crate::camera::Camera;
use crate::math::aabb::Aabb;
use crate::{Error, Result};
use nalgebra::{Matrix3, Point3, Vector3};

/// Half side of the work volume, as a fraction of the distance from the focus to the nearest camera.
const REACH: f64 = 0.9;

impl Rig {
    /// The point nearest to all optical axes, in the world.
    ///
    /// # Errors
    /// Cameras whose optical axes are all parallel.
    pub fn focus(&self) -> Result<Point3<f64>> {
        // The sum of (1 - d d^T) (x - c) over the axes is zero.
        let (mut matrix, mut vector) = (Matrix3::zeros(), Vector3::zeros());
        for camera in self.cameras() {
            let across = Matrix3::identity() - camera.forward() * camera.forward().transpose();
            matrix += across;
            vector += across * camera.centre().coords;
        }
        // The determinant falls with the angles between the axes; at this limit they are about 0.01 degrees.

        let inverse = matrix.try_inverse().filter(|_| matrix.determinant() > 1e-8);
        inverse.map(|inverse| Point3::from(inverse * vector)).ok_or_else(|| {
            Error::argument(
                "expected cameras that look in different directions, found parallel ones; give a work volume",
            )
        })
    }

    /// A cube around the [`focus`](Self::focus) whose half side is 0.9 times the distance to the nearest camera, in
    /// metres. It is cut off at the floor z = 0 if all cameras and the focus are above it.
    ///
    /// # Errors
    /// All errors of [`focus`](Self::focus); a camera that stands at the focus.
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

    /// The shares of `volume` that exactly 0, 1, 2, ... cameras have in their images; they add up to 1. The volume is
    /// sampled by a grid with `fineness` points along its longest side (at least one).
    pub fn coverage(&self, volume: &Aabb, fineness: usize) -> Vec<f64> {
        let mut counts = vec![0_usize; self.len() + 1];
        for point in grid(volume, fineness) {
            counts[self.cameras().iter().filter(|camera| camera.sees(&point)).count()] += 1;
        }
        let all = counts.iter().sum::<usize>() as f64;
        counts.into_iter().map(|count| count as f64 / all).collect()
    }

    /// The share of `volume` that one camera has in its image, sampled as in [`coverage`](Self::coverage).
    pub fn coverage_of(camera: &Camera, volume: &Aabb, fineness: usize) -> f64 {
        let (mut seen, mut all) = (0_usize, 0_usize);
        for point in grid(volume, fineness) {
            all += 1;
            seen += usize::from(camera.sees(&point));
        }
        seen as f64 / all as f64
    }
}

/// The centres of cells that fill `volume`.
fn grid(volume: &Aabb, fineness: usize) -> impl Iterator<Item = Point3<f64>> {
    let (min, sides) = (volume.min, volume.max - volume.min);
    let spacing = sides.max() / fineness.max(1) as f64;
    let counts = sides.map(|side| ((side / spacing).round() as usize).max(1));
    let at = move |axis: usize, k: usize| min[axis] + sides[axis] * (k as f64 + 0.5) / counts[axis] as f64;
    (0..counts.z).flat_map(move |k| {
        (0..counts.y).flat_map(move |j| (0..counts.x).map(move |i| Point3::new(at(0, i), at(1, j), at(2, k))))
    })
}
