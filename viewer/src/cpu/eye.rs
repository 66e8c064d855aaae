//! The viewpoint of a picture: the ray of each pixel.

use super::march::Ray;
use nalgebra::{Matrix3, Point3, Vector3};
use ode_visual_hull::camera::Camera;

/// A pinhole camera from whose place a picture is drawn.
#[derive(Debug, Clone)]
pub struct Eye {
    origin: Point3<f32>,
    /// Maps homogeneous image coordinates to directions in the world, of length 1 along the camera's axis.
    world_from_image: Matrix3<f32>,
    /// The camera's axis.
    forward: Vector3<f32>,
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

    /// How much depth along the camera's axis a metre along `direction` is.
    pub fn depth_per_metre(&self, direction: &Vector3<f32>) -> f32 {
        direction.dot(&self.forward)
    }
}
