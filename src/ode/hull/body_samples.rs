//! From a geom of ODE to its surface samples, through the public interface alone.

use crate::lock::lock;
use crate::ode::convert;
use crate::sample::{SampleCache, Samples};
use crate::shape::Shape;
use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{
    dBoxClass, dCapsuleClass, dCollide, dContactGeom, dConvexClass, dCreatePlane, dCylinderClass,
    dGeomBoxGetLengths, dGeomCapsuleGetParams, dGeomCylinderGetParams, dGeomDestroy, dGeomGetAABB,
    dGeomGetClass, dGeomID, dGeomSphereGetRadius, dGeomTriMeshGetData, dGeomTriMeshGetTriangle,
    dGeomTriMeshGetTriangleCount, dSphereClass, dTriMeshClass,
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

/// Samples that a program has set for a geom.
#[derive(Debug, Clone)]
struct UserSamples {
    samples: Arc<Samples>,
    /// The geom's shape when they were set: they do not fit another size, nor another geom at the same address.
    shape: GeomShape,
}

/// What ODE tells of a geom's shape.
#[derive(Debug, Clone, PartialEq)]
enum GeomShape {
    /// A class with sizes: as many as the class has, then zeros.
    Sizes { class: c_int, sizes: [f64; 3] },
    /// The vertices of a convex geom, in its own frame.
    Convex(Vec<Point3<f64>>),
    /// The data of a mesh, as an address that is not followed, and its number of triangles.
    TriMesh { data: usize, count: c_int },
}

/// The surface samples of a geom.
#[derive(Debug)]
pub(super) struct BodySamples {
    /// Samples in the geom's own frame; `None` for a class whose surface ODE does not reveal.
    pub(super) samples: Option<Arc<Samples>>,
    /// Why the samples that the program has set are not used any more.
    pub(super) outdated: Option<Error>,
}

/// Sets the samples of `geom`, in place of those of its class and sizes.
///
/// # Safety
/// `geom` is a living geom.
pub(crate) unsafe fn set_samples(geom: dGeomID, samples: Samples) {
    // SAFETY: the caller vouches for the geom.
    let shape = unsafe { shape(geom, &convert::any_pose(geom)) };
    lock(&USER_SAMPLES).insert(geom as usize, UserSamples { samples: Arc::new(samples), shape });
}

/// Removes the samples set for the geom at this address.
pub(crate) fn clear_samples(geom: dGeomID) {
    lock(&USER_SAMPLES).remove(&(geom as usize));
}

/// The surface samples of `geom`: those that were set, else those of its class and sizes.
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
) -> Result<BodySamples> {
    let given = lock(&USER_SAMPLES).get(&(geom as usize)).cloned();
    let mut outdated = None;
    if let Some(given) = given {
        // SAFETY: the caller vouches for the geom and its pose.
        if unsafe { shape(geom, world_from_geom) }.is_about(&given.shape) {
            return Ok(BodySamples { samples: Some(given.samples), outdated: None });
        }
        outdated = Some(Error::argument(
            "samples of a geom: expected the shape for which they were set, found another shape or size, so those of its \
             class are used; set samples for the new shape, or clear them before a geom is resized or destroyed",
        ));
    }
    // SAFETY: as above.
    let samples = unsafe { of_class(geom, world_from_geom, min_feature)? };
    Ok(BodySamples { samples, outdated })
}

/// The surface samples of a geom's class and sizes.
///
/// # Errors
/// As [`of`].
///
/// # Safety
/// As [`of`].
unsafe fn of_class(
    geom: dGeomID,
    world_from_geom: &Isometry3<f64>,
    min_feature: f64,
) -> Result<Option<Arc<Samples>>> {
    let address = geom as usize;
    // SAFETY: the caller vouches for the geom throughout; each getter is called on a geom of its class.
    unsafe {
        let class = dGeomGetClass(geom);
        if class == dConvexClass as c_int {
            let vertices = convex_vertices(geom, world_from_geom);
            lock(&CACHE).get_convex(address, &vertices, min_feature).map(Some)
        } else if class == dTriMeshClass as c_int {
            let triangles = triangles(geom, world_from_geom);
            lock(&CACHE).get_trimesh(address, &triangles, min_feature).map(Some)
        } else {
            let shape = plain_shape(class as u32, sizes(geom));
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
/// `geom` is a living geom and `world_from_geom` its pose.
unsafe fn shape(geom: dGeomID, world_from_geom: &Isometry3<f64>) -> GeomShape {
    // SAFETY: the caller vouches for the geom; each getter is called on a geom of its class.
    unsafe {
        match dGeomGetClass(geom) {
            class if class == dConvexClass as c_int => {
                GeomShape::Convex(convex_vertices(geom, world_from_geom))
            }
            class if class == dTriMeshClass as c_int => GeomShape::TriMesh {
                data: dGeomTriMeshGetData(geom) as usize,
                count: dGeomTriMeshGetTriangleCount(geom),
            },
            class => GeomShape::Sizes { class, sizes: sizes(geom) },
        }
    }
}

impl GeomShape {
    /// Whether both are one shape; the vertices of a convex geom are rounded differently in each pose.
    fn is_about(&self, other: &Self) -> bool {
        let (Self::Convex(ours), Self::Convex(theirs)) = (self, other) else { return self == other };
        let pairs = ours.iter().zip(theirs);
        ours.len() == theirs.len() && pairs.into_iter().all(|(a, b)| (a - b).amax() < 10.0 * VERTEX_GRID)
    }
}

/// The sizes of a geom, as many as its class has, then zeros.
///
/// # Safety
/// `geom` is a living geom.
unsafe fn sizes(geom: dGeomID) -> [f64; 3] {
    // SAFETY: the caller vouches for the geom; each getter is called on a geom of its class, and writes into memory for
    // what it gives.
    unsafe {
        let two = |get: unsafe extern "C" fn(dGeomID, *mut f64, *mut f64)| {
            let (mut radius, mut length) = (0.0, 0.0);
            get(geom, &raw mut radius, &raw mut length);
            [radius, length, 0.0]
        };
        match dGeomGetClass(geom) as u32 {
            c if c == dSphereClass => [dGeomSphereGetRadius(geom), 0.0, 0.0],
            c if c == dCapsuleClass => two(dGeomCapsuleGetParams),
            c if c == dCylinderClass => two(dGeomCylinderGetParams),
            c if c == dBoxClass => {
                let mut lengths = [0.0; 4];
                dGeomBoxGetLengths(geom, lengths.as_mut_ptr());
                [lengths[0], lengths[1], lengths[2]]
            }
            _ => [0.0; 3],
        }
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

/// The vertices of a convex geom in its own frame; none where no plane through it was found. ODE has no getter for them,
/// but reports every vertex behind a plane as a contact, if some are in front: two opposite planes give them all.
///
/// # Safety
/// `convex` is a living convex geom and `world_from_geom` its pose.
unsafe fn convex_vertices(convex: dGeomID, world_from_geom: &Isometry3<f64>) -> Vec<Point3<f64>> {
    let mut aabb = [0.0; 6];
    // SAFETY: the caller vouches for the geom; the array holds six numbers.
    unsafe { dGeomGetAABB(convex, aabb.as_mut_ptr()) };
    // Inside a geom transform ODE keeps a box of another pose. The origin of a convex geom should be inside it.
    let heights = [0.5 * (aabb[4] + aabb[5]), world_from_geom.translation.z];
    // SAFETY: as above.
    let both_sides = |z: f64| unsafe { [(1.0, z), (-1.0, -z)].map(|(n, d)| vertices_behind(convex, n, d)) };
    let is_cut = |sides: &[Vec<Point3<f64>>; 2]| sides.iter().all(|side| !side.is_empty());

    let mut vertices: Vec<Point3<f64>> = Vec::new();
    for half in heights.into_iter().map(both_sides).find(is_cut).into_iter().flatten() {
        let local = half.iter().map(|v| world_from_geom.inverse_transform_point(v));
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
