//! The body shapes as values.

use super::{Samples, box_, capsule, convex, cylinder, sphere, trimesh};
use crate::Result;
use nalgebra::{Point3, Vector3};

/// A body's shape in its own frame: lengths in metres, the axis of capsules and cylinders along the local z axis.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum BodyShape {
    /// A sphere, see [`sphere`].
    Sphere {
        /// The radius.
        radius: f64,
    },
    /// A box, see [`box_`].
    Box {
        /// The lengths of the edges along x, y and z.
        lengths: Vector3<f64>,
    },
    /// A capsule, see [`capsule`].
    Capsule {
        /// The radius of the side and of the hemispheres.
        radius: f64,
        /// The length of the side, without the hemispheres.
        length: f64,
    },
    /// A cylinder, see [`cylinder`].
    Cylinder {
        /// The radius of the side.
        radius: f64,
        /// The full length.
        length: f64,
    },
    /// A convex hull, see [`convex`].
    Convex {
        /// The vertices, in any order.
        vertices: Vec<Point3<f64>>,
    },
    /// A triangle mesh, see [`trimesh`].
    Trimesh {
        /// The triangles, counter-clockwise as seen from outside.
        triangles: Vec<[Point3<f64>; 3]>,
    },
}

impl BodyShape {
    /// Samples the surface so that no feature of diameter `min_feature` (metres) fits between the samples.
    ///
    /// # Errors
    /// All errors of the shape's function.
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
