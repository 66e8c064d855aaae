//! From a geom of ODE to its surface samples, through the public interface alone.

use crate::Result;
use crate::lock::lock;
use crate::sample::{SampleCache, Samples};
use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{
    dBoxClass, dCapsuleClass, dCollide, dContactGeom, dConvexClass, dCreatePlane, dCylinderClass,
    dGeomBoxGetLengths, dGeomCapsuleGetParams, dGeomCylinderGetParams, dGeomDestroy, dGeomGetAABB,
    dGeomGetClass, dGeomID, dGeomSphereGetRadius, dGeomTriMeshGetTriangle, dGeomTriMeshGetTriangleCount,
    dSphereClass, dTriMeshClass,
};
use std::collections::HashMap;
use std::ffi::c_int;
use std::mem::size_of;
use std::ptr::null_mut;
use std::sync::{Arc, LazyLock, Mutex};

/// Samples of the shapes that collided lately, for all hulls of the process.
static CACHE: LazyLock<Mutex<SampleCache>> = LazyLock::new(Mutex::default);

/// Samples that programs have set for geoms, by the geom's address.
static USER_SAMPLES: LazyLock<Mutex<HashMap<usize, UserSamples>>> = LazyLock::new(Mutex::default);

/// Grid on which the vertices of convex geoms are sorted, in metres: coarser than the rounding of a pose.
const VERTEX_GRID: f64 = 1e-7;

#[derive(Debug)]
struct UserSamples {
    samples: Arc<Samples>,
    /// The geom's class and sizes when they were set: another geom at the same address must not inherit them.
    kind: Kind,
}

/// A geom's class and its sizes, as many as the class has, then zeros.
#[derive(Debug, Clone, PartialEq)]
struct Kind {
    class: c_int,
    sizes: [f64; 3],
}

/// Sets the samples of `geom`, in place of those of its class and sizes.
///
/// # Safety
/// `geom` is a living geom.
pub(crate) unsafe fn set_samples(geom: dGeomID, samples: Samples) {
    // SAFETY: the caller vouches for the geom.
    let kind = unsafe { kind(geom) };
    lock(&USER_SAMPLES).insert(geom as usize, UserSamples { samples: Arc::new(samples), kind });
}

/// Removes the samples set for the geom at this address.
pub(crate) fn clear_samples(geom: dGeomID) {
    lock(&USER_SAMPLES).remove(&(geom as usize));
}

/// The surface samples of `geom` in its own frame: those that were set, else those of its class and sizes. `None` for a
/// class whose surface ODE does not reveal.
///
/// # Errors
/// A shape that cannot be sampled: degenerate, or too large for `min_feature`.
///
/// # Safety
/// `geom` is a living geom and `world_from_geom` its pose.
pub(super) unsafe fn of(
    geom: dGeomID,
    world_from_geom: &Isometry3<f64>,
    min_feature: f64,
) -> Result<Option<Arc<Samples>>> {
    let address = geom as usize;
    // SAFETY: the caller vouches for the geom throughout; each getter is called on a geom of its class.
    unsafe {
        let kind = kind(geom);
        if let Some(given) = lock(&USER_SAMPLES).get(&address).filter(|given| given.kind == kind) {
            return Ok(Some(given.samples.clone()));
        }
        let class = kind.class as u32;
        if class == dConvexClass {
            let vertices = convex_vertices(geom, world_from_geom);
            lock(&CACHE).get_convex(address, &vertices, min_feature).map(Some)
        } else if class == dTriMeshClass {
            let triangles = triangles(geom, world_from_geom);
            lock(&CACHE).get_trimesh(address, &triangles, min_feature).map(Some)
        } else {
            let shape = plain_shape(class, kind.sizes);
            shape.map(|shape| lock(&CACHE).get(&shape, min_feature)).transpose()
        }
    }
}

fn plain_shape(class: u32, [x, y, z]: [f64; 3]) -> Option<Shape> {
    let shape = match class {
        c if c == dSphereClass => Shape::Sphere { radius: x },
        c if c == dBoxClass => Shape::Box { sides: Vector3::new(x, y, z) },
        c if c == dCapsuleClass => Shape::Capsule { radius: x, length: y },
        c if c == dCylinderClass => Shape::Cylinder { radius: x, length: y },
        _ => return None,
    };
    Some(shape)
}

/// # Safety
/// `geom` is a living geom.
unsafe fn kind(geom: dGeomID) -> Kind {
    // SAFETY: the caller vouches for the geom; each getter is called on a geom of its class, and writes into room
    // for what it gives.
    unsafe {
        let class = dGeomGetClass(geom);
        let two = |get: unsafe extern "C" fn(dGeomID, *mut f64, *mut f64)| {
            let (mut radius, mut length) = (0.0, 0.0);
            get(geom, &raw mut radius, &raw mut length);
            [radius, length, 0.0]
        };
        let sizes = match class as u32 {
            c if c == dSphereClass => [dGeomSphereGetRadius(geom), 0.0, 0.0],
            c if c == dCapsuleClass => two(dGeomCapsuleGetParams),
            c if c == dCylinderClass => two(dGeomCylinderGetParams),
            c if c == dBoxClass => {
                let mut lengths = [0.0; 4];
                dGeomBoxGetLengths(geom, lengths.as_mut_ptr());
                [lengths[0], lengths[1], lengths[2]]
            }
            _ => [0.0; 3],
        };
        Kind { class, sizes }
    }
}

/// The triangles of a mesh in its own frame. ODE gives them in the world's.
///
/// # Safety
/// `mesh` is a living trimesh geom and `world_from_geom` its pose.
unsafe fn triangles(mesh: dGeomID, world_from_geom: &Isometry3<f64>) -> Vec<[Point3<f64>; 3]> {
    // SAFETY: the caller vouches for the geom.
    let count = unsafe { dGeomTriMeshGetTriangleCount(mesh) };
    let local = |v: [f64; 4]| world_from_geom.inverse_transform_point(&Point3::new(v[0], v[1], v[2]));
    (0..count)
        .map(|index| {
            let mut corners = [[0.0; 4]; 3];
            let [a, b, c] = &mut corners;
            // SAFETY: the index is below the count; each array holds a vector.
            unsafe { dGeomTriMeshGetTriangle(mesh, index, a, b, c) };
            corners.map(local)
        })
        .collect()
}

/// The vertices of a convex geom in its own frame. ODE has no getter for them, but reports every vertex behind a
/// plane as a contact: two opposite planes through the middle of its box give them all.
///
/// # Safety
/// `convex` is a living convex geom and `world_from_geom` its pose.
unsafe fn convex_vertices(convex: dGeomID, world_from_geom: &Isometry3<f64>) -> Vec<Point3<f64>> {
    let mut aabb = [0.0; 6];
    // SAFETY: the caller vouches for the geom; the array holds six numbers.
    unsafe { dGeomGetAABB(convex, aabb.as_mut_ptr()) };
    let middle = 0.5 * (aabb[4] + aabb[5]);
    let mut vertices: Vec<Point3<f64>> = Vec::new();

    for side in [1.0, -1.0] {
        // SAFETY: as above.
        let behind = unsafe { vertices_behind(convex, side, side * middle) };
        let local = behind.iter().map(|v| world_from_geom.inverse_transform_point(v));
        // A vertex exactly in the middle is behind both planes.
        let fresh: Vec<_> = local.filter(|v| !vertices.contains(v)).collect();
        vertices.extend(fresh);
    }

    // ODE's order depends on the pose. Sorted, the vertices are the same list in every step.
    let rank = |v: &Point3<f64>| [v.x, v.y, v.z].map(|x| (x / VERTEX_GRID).round() as i64);
    vertices.sort_by_key(rank);
    vertices
}

/// # Safety
/// `convex` is a living convex geom.
unsafe fn vertices_behind(convex: dGeomID, normal_z: f64, offset: f64) -> Vec<Point3<f64>> {
    /// ODE counts contacts in 16 bits.
    const MOST: usize = 0xffff;
    let mut room = 64;
    loop {
        let mut contacts: Vec<dContactGeom> = vec![dContactGeom::default(); room];
        // SAFETY: the plane is in no space and destroyed here; the buffer holds `room` contacts.
        let count = unsafe {
            let plane = dCreatePlane(null_mut(), 0.0, 0.0, normal_z, offset);
            let skip = size_of::<dContactGeom>() as c_int;
            let count = dCollide(convex, plane, room as c_int, contacts.as_mut_ptr(), skip);
            dGeomDestroy(plane);
            count as usize
        };
        if count < room || room == MOST {
            let points = contacts[..count].iter();
            return points
                .map(|contact| Point3::new(contact.pos[0], contact.pos[1], contact.pos[2]))
                .collect();
        }
        room = (4 * room).min(MOST);
    }
}
