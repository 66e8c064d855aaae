//! Shapes of geoms.

use std::sync::Arc;

use nalgebra::Vector3;
use ode_sys::{
    dCreateBox, dCreateCapsule, dCreateConvex, dCreateCylinder, dCreatePlane, dCreateRay, dCreateSphere,
    dCreateTriMesh, dGeomBoxSetLengths, dGeomCapsuleSetParams, dGeomCylinderSetParams, dGeomID,
    dGeomPlaneSetParams, dGeomRaySetLength, dGeomSphereSetRadius,
};

use super::check;
use super::convex::Convex;
use super::trimesh::{MeshData, TriMesh};
use crate::{Error, Result};

/// The shape of a geom, in its own frame, in metres.
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
}

impl Shape {
    /// A box with these full side lengths.
    pub fn cuboid(x: f64, y: f64, z: f64) -> Self {
        Self::Box { sides: Vector3::new(x, y, z) }
    }

    /// Whether a geom of this shape has a pose. All shapes but planes have one.
    pub fn is_placeable(&self) -> bool {
        !matches!(self, Self::Plane { .. })
    }

    /// Checks the shape's numbers and returns the shape, for a plane with a unit normal.
    pub(super) fn checked(&self) -> Result<Self> {
        // Each arm names the number that an error is about.
        match self {
            Self::Sphere { radius } => {
                check::length("radius of the sphere", *radius)?;
            }
            Self::Box { sides } => {
                for (axis, &side) in ["x", "y", "z"].iter().zip(sides.iter()) {
                    check::length(&format!("{axis} side of the box"), side)?;
                }
            }
            Self::Capsule { radius, length } => {
                check::length("radius of the capsule", *radius)?;
                check::length("length of the capsule", *length)?;
            }
            Self::Cylinder { radius, length } => {
                check::length("radius of the cylinder", *radius)?;
                check::length("length of the cylinder", *length)?;
            }
            Self::Plane { normal, offset } => {
                let normal = check::direction("normal of the plane", normal)?.into_inner();
                check::within("offset of the plane", *offset, -check::REACH, check::REACH)?;
                return Ok(Self::Plane { normal, offset: *offset });
            }
            Self::Ray { length } => {
                check::length("length of the ray", *length)?;
            }
            // Their constructors have checked them.
            Self::Convex(_) | Self::TriMesh(_) => {}
        }

        Ok(self.clone())
    }

    /// Creates a geom of this shape, in no space, and for a mesh its search tree.
    ///
    /// # Safety
    ///
    /// ODE is open, [`checked`](Self::checked) has accepted the shape, and the caller keeps the shape and the search
    /// tree until the geom is destroyed.
    pub(super) unsafe fn create(&self) -> Result<(dGeomID, Option<MeshData>)> {
        let no_space = std::ptr::null_mut();
        let mut mesh_data = None;

        // SAFETY: the caller has checked that sizes are positive and normals of unit length. The arrays of polyhedra
        // and meshes are in an `Arc` that the caller keeps, so they do not move.
        let raw = unsafe {
            match self {
                Self::Sphere { radius } => dCreateSphere(no_space, *radius),
                Self::Box { sides } => dCreateBox(no_space, sides.x, sides.y, sides.z),
                Self::Capsule { radius, length } => dCreateCapsule(no_space, *radius, *length),
                Self::Cylinder { radius, length } => dCreateCylinder(no_space, *radius, *length),
                Self::Plane { normal, offset } => {
                    dCreatePlane(no_space, normal.x, normal.y, normal.z, *offset)
                }
                Self::Ray { length } => dCreateRay(no_space, *length),
                Self::Convex(convex) => dCreateConvex(
                    no_space,
                    convex.planes().as_ptr().cast(),
                    convex.planes().len() as u32,
                    convex.points().as_ptr().cast(),
                    convex.points().len() as u32,
                    convex.polygons().as_ptr(),
                ),
                Self::TriMesh(mesh) => {
                    let data = mesh_data.insert(MeshData::build(mesh)?);
                    dCreateTriMesh(no_space, data.id(), None, None, None)
                }
            }
        };

        if raw.is_null() { Err(Error::Ode("memory ran out for a geom".into())) } else { Ok((raw, mesh_data)) }
    }

    /// Changes the sizes of the geom `raw`, of shape `self`, to those of `new`, a shape of the same kind.
    ///
    /// # Safety
    ///
    /// `raw` is a living geom that was created from a shape of the kind of `self`, and [`checked`](Self::checked) has
    /// accepted `new`.
    pub(super) unsafe fn resize(&self, raw: dGeomID, new: &Self) -> Result<()> {
        // Polyhedra and meshes are not resized, because their geoms refer to the arrays in `self`.
        // SAFETY: `self` and `new` are of one kind, so the class of `raw` fits the function; sizes are positive.
        unsafe {
            match (self, new) {
                (Self::Sphere { .. }, Self::Sphere { radius }) => dGeomSphereSetRadius(raw, *radius),
                (Self::Box { .. }, Self::Box { sides }) => dGeomBoxSetLengths(raw, sides.x, sides.y, sides.z),
                (Self::Capsule { .. }, Self::Capsule { radius, length }) => {
                    dGeomCapsuleSetParams(raw, *radius, *length);
                }
                (Self::Cylinder { .. }, Self::Cylinder { radius, length }) => {
                    dGeomCylinderSetParams(raw, *radius, *length);
                }
                (Self::Plane { .. }, Self::Plane { normal, offset }) => {
                    dGeomPlaneSetParams(raw, normal.x, normal.y, normal.z, *offset);
                }
                (Self::Ray { .. }, Self::Ray { length }) => dGeomRaySetLength(raw, *length),
                _ => {
                    return Err(Error::argument(format!(
                        "shape: expected new sizes for {self:?}, found {new:?}; remove the geom and add another"
                    )));
                }
            }
        }
        Ok(())
    }
}
