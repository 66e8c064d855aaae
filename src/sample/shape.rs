//! The body shapes by value.

use super::{Samples, box_, capsule, convex, cylinder, sphere, trimesh};
use crate::Result;
use nalgebra::{Point3, Vector3};

/// A body's shape in its own frame; lengths in metres, axes along the local z axis.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum BodyShape {
    /// See [`sphere`].
    Sphere {
        /// Of the sphere.
        radius: f64,
    },
    /// See [`box_`].
    Box {
        /// Of the edges along x, y and z.
        lengths: Vector3<f64>,
    },
    /// See [`capsule`].
    Capsule {
        /// Of the side and of the half spheres.
        radius: f64,
        /// Of the side, without the half spheres.
        length: f64,
    },
    /// See [`cylinder`].
    Cylinder {
        /// Of the side.
        radius: f64,
        /// From end to end.
        length: f64,
    },
    /// See [`convex`].
    Convex {
        /// In any order.
        vertices: Vec<Point3<f64>>,
    },
    /// See [`trimesh`].
    Trimesh {
        /// Wound counter-clockwise as seen from outside.
        triangles: Vec<[Point3<f64>; 3]>,
    },
}

impl BodyShape {
    /// Samples the surface so that no feature of diameter `min_feature` (metres) passes between the samples.
    ///
    /// # Errors
    /// As the function of the shape.
    pub fn sample(&self, min_feature: f64) -> Result<Samples> {
        match self {
            Self::Sphere { radius } => sphere(*radius, min_feature),
            Self::Box { lengths } => box_(*lengths, min_feature),
            Self::Capsule { radius, length } => capsule(*radius, *length, min_feature),
            Self::Cylinder { radius, length } => cylinder(*radius, *length, min_feature),
            Self::Convex { vertices } => convex(vertices, min_feature),
            Self::Trimesh { triangles } => trimesh(triangles, min_feature),
        }
    }
}
