//! What a geom looks like.

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

/// The shape of a geom, in its own frame, metres.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A ball around the origin.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A box around the origin.
    Box {
        /// Its whole side lengths.
        sides: Vector3<f64>,
    },
    /// A cylinder along z with a half ball at each end.
    Capsule {
        /// The radius of all parts.
        radius: f64,
        /// The length of the cylinder, without the caps.
        length: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its whole length.
        length: f64,
    },
    /// Everything with `normal . x <= offset`, in the world's frame. A plane has no pose and no body.
    Plane {
        /// Where the free side is; any length but 0.
        normal: Vector3<f64>,
        /// The plane's distance from the world's origin along the normalised `normal`.
        offset: f64,
    },
    /// A line from the origin along z. Its contacts are hits: place, surface normal, and distance as depth.
    ///
    /// ODE 0.16 misses most [`Shape::Convex`] that a ray meets at a slant.
    Ray {
        /// How far it reaches.
        length: f64,
    },
    /// A convex polyhedron.
    Convex(Arc<Convex>),
    /// A mesh of triangles.
    TriMesh(Arc<TriMesh>),
}

impl Shape {
    /// A box of these whole side lengths.
    pub fn cuboid(x: f64, y: f64, z: f64) -> Self {
        Self::Box { sides: Vector3::new(x, y, z) }
    }

    /// Whether a geom of this shape can be placed: all but planes.
    pub fn is_placeable(&self) -> bool {
        !matches!(self, Self::Plane { .. })
    }

    /// The shape with its numbers checked; a plane comes back with its normal normalised.
    pub(super) fn checked(&self) -> Result<Self> {
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
            // Checked when they were made.
            Self::Convex(_) | Self::TriMesh(_) => {}
        }
        Ok(self.clone())
    }

    /// A geom of this shape, outside of any space, and the search tree that it needs.
    ///
    /// # Safety
    ///
    /// ODE is open, the numbers are [`checked`](Self::checked), and the caller keeps the shape and the search tree
    /// until the geom is destroyed.
    pub(super) unsafe fn create(&self) -> Result<(dGeomID, Option<MeshData>)> {
        let none = std::ptr::null_mut();
        let mut mesh_data = None;
        // SAFETY: positive sizes and a unit normal, as the caller has checked. The arrays of meshes sit in an `Arc`
        // that the caller keeps, so they stay where they are.
        let raw = unsafe {
            match self {
                Self::Sphere { radius } => dCreateSphere(none, *radius),
                Self::Box { sides } => dCreateBox(none, sides.x, sides.y, sides.z),
                Self::Capsule { radius, length } => dCreateCapsule(none, *radius, *length),
                Self::Cylinder { radius, length } => dCreateCylinder(none, *radius, *length),
                Self::Plane { normal, offset } => dCreatePlane(none, normal.x, normal.y, normal.z, *offset),
                Self::Ray { length } => dCreateRay(none, *length),
                Self::Convex(convex) => dCreateConvex(
                    none,
                    convex.planes().as_ptr().cast(),
                    convex.planes().len() as u32,
                    convex.points().as_ptr().cast(),
                    convex.points().len() as u32,
                    convex.polygons().as_ptr(),
                ),
                Self::TriMesh(mesh) => {
                    let data = mesh_data.insert(MeshData::build(mesh)?);
                    dCreateTriMesh(none, data.id(), None, None, None)
                }
            }
        };
        if raw.is_null() { Err(Error::Ode("no memory for a geom".into())) } else { Ok((raw, mesh_data)) }
    }

    /// Gives the geom `raw` of the shape `self` the shape `new`, if that is of the same kind.
    ///
    /// # Safety
    ///
    /// `raw` is a living geom that was created from a shape of the kind of `self`; `new` is checked.
    pub(super) unsafe fn resize(&self, raw: dGeomID, new: &Self) -> Result<()> {
        // SAFETY: the class of `raw` fits the function, since `self` and `new` are of one kind; sizes are positive.
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
