//! From a [`Shape`] to a geom of ODE.

use super::heightfield::HeightData;
use super::trimesh::MeshData;
use super::{check, convert};
use crate::shape::{MAX_ASPECT, Shape};
use crate::{Error, Result};
use ode_sys::{
    dBoxClass, dCapsuleClass, dCreateBox, dCreateCapsule, dCreateConvex, dCreateCylinder, dCreateHeightfield,
    dCreatePlane, dCreateRay, dCreateSphere, dCreateTriMesh, dCylinderClass, dGeomBoxGetLengths,
    dGeomBoxSetLengths, dGeomCapsuleGetParams, dGeomCapsuleSetParams, dGeomCylinderGetParams,
    dGeomCylinderSetParams, dGeomGetClass, dGeomID, dGeomPlaneGetParams, dGeomPlaneSetParams,
    dGeomRayGetLength, dGeomRaySetLength, dGeomSphereGetRadius, dGeomSphereSetRadius, dPlaneClass, dRayClass,
    dReal, dSphereClass,
};

/// ODE's data behind a geom, which refers to the arrays of its shape.
#[derive(Debug)]
#[allow(dead_code, reason = "the data is only kept, and freed when it is dropped")]
pub(super) enum ShapeData {
    /// The search tree of a mesh.
    Mesh(MeshData),
    /// The description of a heightfield.
    Heights(HeightData),
}

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
        Shape::Convex(_) | Shape::TriMesh(_) | Shape::Heightfield(_) => {}
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

/// Creates a geom of this shape, in no space, and the data behind it if its class has some.
///
/// # Safety
///
/// ODE is open, [`checked`] has accepted the shape, and the caller keeps the shape and the data until the geom is
/// destroyed.
pub(super) unsafe fn create(shape: &Shape) -> Result<(dGeomID, Option<ShapeData>)> {
    let no_space = std::ptr::null_mut();
    let mut shape_data = None;

    // SAFETY: the caller has checked that sizes are positive and normals of unit length. The arrays of polyhedra,
    // meshes and heightfields are in an `Arc` that the caller keeps, so they do not move.
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
                let data = MeshData::build(mesh)?;
                let id = data.id();
                shape_data = Some(ShapeData::Mesh(data));
                dCreateTriMesh(no_space, id, None, None, None)
            }
            Shape::Heightfield(field) => {
                let data = HeightData::build(field)?;
                let id = data.id();
                shape_data = Some(ShapeData::Heights(data));
                dCreateHeightfield(no_space, id, 1)
            }
        }
    };

    if raw.is_null() { Err(Error::Ode("memory ran out for a geom".into())) } else { Ok((raw, shape_data)) }
}

/// The shape of a geom of any class, if it is one of those that ODE has getters for.
///
/// # Safety
///
/// `geom` is alive.
pub(super) unsafe fn shape_of(geom: dGeomID) -> Option<Shape> {
    type TwoNumbers = unsafe extern "C" fn(dGeomID, *mut dReal, *mut dReal);
    let radius_and_length = |get: TwoNumbers| {
        let (mut radius, mut length) = (0.0, 0.0);
        // SAFETY: the caller guarantees a living geom, which is of the class that `get` takes.
        unsafe { get(geom, &raw mut radius, &raw mut length) };
        (radius, length)
    };

    // SAFETY: the caller guarantees a living geom; each getter is called on a geom of its class, and writes up to four
    // numbers.
    unsafe {
        let mut numbers = [0.0; 4];
        Some(match dGeomGetClass(geom) as u32 {
            class if class == dSphereClass => Shape::Sphere { radius: dGeomSphereGetRadius(geom) },
            class if class == dBoxClass => {
                dGeomBoxGetLengths(geom, numbers.as_mut_ptr());
                Shape::Box { sides: convert::vector(&numbers) }
            }
            class if class == dCapsuleClass => {
                let (radius, length) = radius_and_length(dGeomCapsuleGetParams);
                Shape::Capsule { radius, length }
            }
            class if class == dCylinderClass => {
                let (radius, length) = radius_and_length(dGeomCylinderGetParams);
                Shape::Cylinder { radius, length }
            }
            class if class == dPlaneClass => {
                dGeomPlaneGetParams(geom, numbers.as_mut_ptr());
                Shape::Plane { normal: convert::vector(&numbers), offset: numbers[3] }
            }
            class if class == dRayClass => Shape::Ray { length: dGeomRayGetLength(geom) },
            _ => return None,
        })
    }
}

/// Changes the sizes of the geom `raw`, of shape `shape`, to those of `new`, a shape of the same kind.
///
/// # Safety
///
/// `raw` is a living geom that was created from a shape of the kind of `shape`, and [`checked`] has accepted `new`.
pub(super) unsafe fn resize(shape: &Shape, raw: dGeomID, new: &Shape) -> Result<()> {
    // Polyhedra, meshes and heightfields are not resized, because their geoms refer to the arrays in `shape`.
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
