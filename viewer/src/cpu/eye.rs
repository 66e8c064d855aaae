//! The viewpoint of a picture: the ray of each pixel.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::lanes::LANES;
use super::march::Ray;
use super::raster::Projection;
use crate::scene::Scene;
use nalgebra::{Matrix3, Matrix3x4, Point3, RowVector4, Vector3};
use ode_visual_hull::camera::Camera;

/// Viewpoints nearer than this to each other, in metres, are the same.
const SAME_PLACE: f64 = 1e-4;

/// A pinhole camera from whose place a picture is drawn.
#[derive(Debug, Clone)]
pub struct Eye {
    origin: Point3<f32>,
    /// Maps homogeneous image coordinates to directions in the world, of length 1 along the camera's axis.
    world_from_image: Matrix3<f32>,
    /// The camera's axis.
    forward: Vector3<f32>,
    projection: Matrix3x4<f32>,
    radians_per_pixel: f32,
    /// Width and height of the picture in pixels.
    size: (u32, u32),
}

impl Eye {
    /// The viewpoint of `camera`, whose lens is ignored.
    pub fn new(camera: &Camera) -> Self {
        let turn = camera.cam_from_world().rotation.inverse().to_rotation_matrix();
        // The intrinsic matrix of a camera is invertible: its focal lengths are positive.
        let inverse = camera.intrinsics().try_inverse().unwrap_or_else(Matrix3::identity);
        Self {
            origin: camera.centre().cast(),
            world_from_image: (turn.matrix() * inverse).cast(),
            forward: camera.forward().cast(),
            projection: camera.projection_matrix().cast(),
            radians_per_pixel: (1.0 / camera.intrinsics()[(0, 0)].min(camera.intrinsics()[(1, 1)])) as f32,
            size: camera.size(),
        }
    }

    /// Its place.
    pub fn origin(&self) -> Point3<f32> {
        self.origin
    }

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The ray through image position `(u, v)`.
    pub fn ray(&self, u: f32, v: f32) -> Ray {
        let direction = self.world_from_image * Vector3::new(u, v, 1.0);
        Ray { origin: self.origin, direction: direction.normalize() }
    }

    /// The unit directions of the rays of pixels next to one another, from column `x` on in row `y`, axis by axis.
    #[inline(always)]
    pub fn directions(&self, (x, y): (usize, usize)) -> [[f32; LANES]; 3] {
        let m = &self.world_from_image;
        let mut directions = [[0.0; LANES]; 3];
        for k in 0..LANES {
            let (u, v) = ((x + k) as f32 + 0.5, y as f32 + 0.5);
            let along = [0, 1, 2].map(|axis| m[(axis, 0)] * u + m[(axis, 1)] * v + m[(axis, 2)]);
            let length = (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]).sqrt();
            for axis in 0..3 {
                directions[axis][k] = along[axis] / length;
            }
        }
        directions
    }

    /// The camera's axis.
    pub fn forward(&self) -> Vector3<f32> {
        self.forward
    }

    /// From the world to the picture.
    pub fn projection(&self) -> Projection {
        let row = self.projection.row(2);
        Projection { image: self.projection, depth: RowVector4::new(row[0], row[1], row[2], row[3]) }
    }

    /// The angle between the rays of neighbouring pixels, at most.
    pub fn radians_per_pixel(&self) -> f32 {
        self.radians_per_pixel
    }

    /// The index of the view of `scene` from whose place the picture is drawn, if there is one.
    pub fn real_view(&self, scene: &Scene) -> Option<usize> {
        let origin: Point3<f64> = self.origin.cast();
        scene.views.iter().position(|view| (view.centre() - origin).norm() < SAME_PLACE)
    }

    /// How much depth along the camera's axis a metre along `direction` is.
    pub fn depth_per_metre(&self, direction: &Vector3<f32>) -> f32 {
        direction.dot(&self.forward)
    }
}
