//! From a [`Shape`] to a geom of ODE.

use super::check;
use super::trimesh::MeshData;
use crate::shape::{MAX_ASPECT, Shape};
use crate::{Error, Result};
use ode_sys::{
    dCreateBox, dCreateCapsule, dCreateConvex, dCreateCylinder, dCreatePlane, dCreateRay, dCreateSphere,
    dCreateTriMesh, dGeomBoxSetLengths, dGeomCapsuleSetParams, dGeomCylinderSetParams, dGeomID,
    dGeomPlaneSetParams, dGeomRaySetLength, dGeomSphereSetRadius,
};

/// Checks the numbers of `shape` and returns the shape, for a plane with a unit normal.
pub(super) fn checked(shape: &Shape) -> Result<Shape> {
    // Each arm names the number that an error is about.
    match shape {
        Shape::Sphere { radius } => {
            check::length("radius of the sphere", *radius)?;
        }
        Shape::Box { sides } => {
            for (axis, &side) in ["x", "y", "z"].iter().zip(sides.iter()) {
                check::length(&format!("{axis} side of the box"), side)?;
            }
            check_aspect("sides of the box", sides.as_slice())?;
        }
        Shape::Capsule { radius, length } => {
            check::length("radius of the capsule", *radius)?;
            check::length("length of the capsule", *length)?;
            check_aspect("radius and length of the capsule", &[*radius, *length])?;
        }
        Shape::Cylinder { radius, length } => {
            check::length("radius of the cylinder", *radius)?;
            check::length("length of the cylinder", *length)?;
            check_aspect("radius and length of the cylinder", &[*radius, *length])?;
        }
        Shape::Plane { normal, offset } => {
            let normal = check::direction("normal of the plane", normal)?.into_inner();
            check::within("offset of the plane", *offset, -check::REACH, check::REACH)?;
            return Ok(Shape::Plane { normal, offset: *offset });
        }
        Shape::Ray { length } => {
            check::length("length of the ray", *length)?;
        }
        // Their constructors have checked them.
        Shape::Convex(_) | Shape::TriMesh(_) => {}
    }

    Ok(shape.clone())
}

/// Refuses sizes of one shape that differ by a larger factor than ODE's colliders can compute with.
fn check_aspect(name: &str, sizes: &[f64]) -> Result<()> {
    let (least, most) = sizes.iter().fold((f64::INFINITY, 0.0), |(a, b), &size| (size.min(a), size.max(b)));
    if most <= MAX_ASPECT * least {
        return Ok(());
    }
    Err(Error::argument(format!(
        "{name}: expected sizes that differ by a factor of at most {MAX_ASPECT:e}, found {least} and {most} m"
    )))
}

/// Creates a geom of this shape, in no space, and for a mesh its search tree.
///
/// # Safety
///
/// ODE is open, [`checked`] has accepted the shape, and the caller keeps the shape and the search tree until the geom is
/// destroyed.
pub(super) unsafe fn create(shape: &Shape) -> Result<(dGeomID, Option<MeshData>)> {
    let no_space = std::ptr::null_mut();
    let mut mesh_data = None;

    // SAFETY: the caller has checked that sizes are positive and normals of unit length. The arrays of polyhedra
    // and meshes are in an `Arc` that the caller keeps, so they do not move.
    let raw = unsafe {
        match shape {
            Shape::Sphere { radius } => dCreateSphere(no_space, *radius),
            Shape::Box { sides } => dCreateBox(no_space, sides.x, sides.y, sides.z),
            Shape::Capsule { radius, length } => dCreateCapsule(no_space, *radius, *length),
            Shape::Cylinder { radius, length } => dCreateCylinder(no_space, *radius, *length),
            Shape::Plane { normal, offset } => dCreatePlane(no_space, normal.x, normal.y, normal.z, *offset),
            Shape::Ray { length } => dCreateRay(no_space, *length),
            Shape::Convex(convex) => dCreateConvex(
                no_space,
                convex.planes().as_ptr().cast(),
                convex.planes().len() as u32,
                convex.points().as_ptr().cast(),
                convex.points().len() as u32,
                convex.polygons().as_ptr(),
            ),
            Shape::TriMesh(mesh) => {
                let data = mesh_data.insert(MeshData::build(mesh)?);
                dCreateTriMesh(no_space, data.id(), None, None, None)
            }
        }
    };

    if raw.is_null() { Err(Error::Ode("memory ran out for a geom".into())) } else { Ok((raw, mesh_data)) }
}

/// Changes the sizes of the geom `raw`, of shape `shape`, to those of `new`, a shape of the same kind.
///
/// # Safety
///
/// `raw` is a living geom that was created from a shape of the kind of `shape`, and [`checked`] has accepted `new`.
pub(super) unsafe fn resize(shape: &Shape, raw: dGeomID, new: &Shape) -> Result<()> {
    // Polyhedra and meshes are not resized, because their geoms refer to the arrays in `shape`.
    // SAFETY: `shape` and `new` are of one kind, so the class of `raw` fits the function; sizes are positive.
    unsafe {
        match (shape, new) {
            (Shape::Sphere { .. }, Shape::Sphere { radius }) => dGeomSphereSetRadius(raw, *radius),
            (Shape::Box { .. }, Shape::Box { sides }) => dGeomBoxSetLengths(raw, sides.x, sides.y, sides.z),
            (Shape::Capsule { .. }, Shape::Capsule { radius, length }) => {
                dGeomCapsuleSetParams(raw, *radius, *length);
            }
            (Shape::Cylinder { .. }, Shape::Cylinder { radius, length }) => {
                dGeomCylinderSetParams(raw, *radius, *length);
            }
            (Shape::Plane { .. }, Shape::Plane { normal, offset }) => {
                dGeomPlaneSetParams(raw, normal.x, normal.y, normal.z, *offset);
            }
            (Shape::Ray { .. }, Shape::Ray { length }) => dGeomRaySetLength(raw, *length),
            _ => {
                return Err(Error::argument(format!(
                    "shape: expected new sizes for {shape:?}, found {new:?}; remove the geom and add another"
                )));
            }
        }
    }
    Ok(())
}
