//! The shapes of bodies, by value: what ODE makes geoms of, samples are taken of, and films are drawn of.

mod convex;
mod heightfield;
mod reach;
mod trimesh;

pub use convex::Convex;
pub use heightfield::Heightfield;
#[cfg(feature = "ode")]
pub(crate) use reach::MAX_ASPECT;
pub use reach::{MIN_SIZE, REACH};
pub use trimesh::TriMesh;

pub(crate) use reach::check_point;

use nalgebra::Vector3;
use std::sync::Arc;

/// The shape of a body or a geom, in its own frame, in metres.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A ball centred at the origin.
    Sphere {
        /// The ball's radius.
        radius: f64,
    },
    /// A box centred at the origin, with its sides along the axes.
    Box {
        /// The full side lengths.
        sides: Vector3<f64>,
    },
    /// A cylinder along z, centred at the origin, with a half ball at each end.
    Capsule {
        /// The radius of the cylinder and of the half balls.
        radius: f64,
        /// The length of the cylinder, without the half balls.
        length: f64,
    },
    /// A cylinder along z, centred at the origin.
    Cylinder {
        /// The cylinder's radius.
        radius: f64,
        /// The cylinder's full length.
        length: f64,
    },
    /// The half-space of all x with `normal . x <= offset`, in the world's frame. A plane has no pose and no body.
    Plane {
        /// The normal, which points to the free side, of any length but 0.
        normal: Vector3<f64>,
        /// The plane's distance from the world's origin along the normalised `normal`.
        offset: f64,
    },
    /// A line segment from the origin along z. Its contacts are hits, with the position, the surface normal, and the
    /// distance from the origin as depth.
    ///
    /// ODE 0.16 misses most hits of a [`Shape::Convex`] that are oblique.
    Ray {
        /// The length of the segment.
        length: f64,
    },
    /// A convex polyhedron, which geoms may share.
    Convex(Arc<Convex>),
    /// A triangle mesh, which geoms may share.
    TriMesh(Arc<TriMesh>),
    /// Ground given by heights on a grid, which geoms may share. Its y axis points up, see [`Heightfield::z_up`].
    ///
    /// ODE collides it with balls, boxes, capsules, cylinders, polyhedra, meshes and rays, and not with planes, other
    /// heightfields and visual hulls, which get no contacts. Some properties of ODE 0.16:
    ///
    /// - Its bounding box is right only for rotations by quarter turns. At other rotations it is too small, so that
    ///   geoms near the border of the field may go unnoticed.
    /// - Where all heights under a geom are equal, it collides with their whole plane, even beyond the border.
    /// - The depth of a geom that is entirely below the surface is its distance from the surface, not the distance that
    ///   it has to move to leave the ground.
    /// - A ray from below hits the ground too. The normal of its hit points upwards, not towards the ray.
    /// - The time for a pair grows with the square of the number of cells under the geom. A pair over more than 4096
    ///   cells has no contacts, and its collide returns an error.
    Heightfield(Arc<Heightfield>),
}

impl Shape {
    /// A box with these full side lengths.
    pub fn cuboid(x: f64, y: f64, z: f64) -> Self {
        Self::Box { sides: Vector3::new(x, y, z) }
    }

    /// A cube with this side length.
    pub fn cube(side: f64) -> Self {
        Self::cuboid(side, side, side)
    }

    /// Whether a geom of this shape has a pose. All shapes but planes have one.
    pub fn is_placeable(&self) -> bool {
        !matches!(self, Self::Plane { .. })
    }
}
