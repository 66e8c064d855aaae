//! The search trees that ODE builds over triangle meshes.

use crate::shape::TriMesh;
use crate::{Error, Result};
use nalgebra::Point3;
use ode_sys::{
    dGeomTriMeshDataBuildDouble, dGeomTriMeshDataCreate, dGeomTriMeshDataDestroy,
    dGeomTriMeshDataPreprocess2, dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES,
    dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, dTriIndex, dTriMeshDataID,
};
use std::ffi::c_void;
use std::mem::size_of;

/// ODE's search tree over a mesh. It refers to the mesh's arrays, so its owner must keep the mesh.
#[derive(Debug)]
pub(super) struct MeshData {
    id: dTriMeshDataID,
    /// The mesh that the tree refers to in place of one with a single triangle.
    _halved: Option<Box<Halved>>,
}

/// A triangle as two halves. ODE builds no tree over a single triangle, and its colliders for convex geoms and meshes read
/// that tree.
#[derive(Debug)]
struct Halved {
    points: [Point3<f64>; 4],
    triangles: [[u32; 3]; 2],
}

impl Halved {
    /// The halves on both sides of the median to the longest side.
    fn new([a, b, c]: [Point3<f64>; 3]) -> Self {
        let corners = [[a, b, c], [b, c, a], [c, a, b]];
        let length = |[a, b, _]: &[Point3<f64>; 3]| (b - a).norm_squared();
        let [a, b, c] =
            corners.into_iter().max_by(|x, y| length(x).total_cmp(&length(y))).unwrap_or([a, b, c]);
        Self { points: [a, b, c, nalgebra::center(&a, &b)], triangles: [[0, 3, 2], [3, 1, 2]] }
    }
}

impl MeshData {
    /// Builds the search tree of `mesh`.
    ///
    /// # Safety
    ///
    /// ODE is open, and `mesh` is neither moved nor dropped before the returned value is.
    pub(super) unsafe fn build(mesh: &TriMesh) -> Result<Self> {
        const { assert!(size_of::<dTriIndex>() == 4, "expected an ODE with 32-bit triangle indices") };

        let no_memory = || Error::Ode("memory ran out for the search tree of a triangle mesh".into());
        // SAFETY: ODE is open.
        let id = unsafe { dGeomTriMeshDataCreate() };
        if id.is_null() {
            return Err(no_memory());
        }
        let halved = match mesh.triangles() {
            [single] => Some(Box::new(Halved::new(single.map(|corner| mesh.points()[corner as usize])))),
            _ => None,
        };
        let (points, triangles) = match &halved {
            Some(halved) => (halved.points.as_slice(), halved.triangles.as_slice()),
            None => (mesh.points(), mesh.triangles()),
        };

        // Without the face angles collisions with convex shapes abort.
        // SAFETY: the strides and counts describe the two arrays, which the caller or the value keeps alive; indices are in range
        // and triangles have an area, see `TriMesh::new`.
        let built = unsafe {
            dGeomTriMeshDataBuildDouble(
                id,
                points.as_ptr().cast::<c_void>(),
                size_of::<Point3<f64>>() as i32,
                points.len() as i32,
                triangles.as_ptr().cast::<c_void>(),
                3 * triangles.len() as i32,
                size_of::<[u32; 3]>() as i32,
            );
            let requests =
                (1 << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES) | (1 << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES);
            dGeomTriMeshDataPreprocess2(id, requests, std::ptr::null())
        };
        let data = Self { id, _halved: halved };
        if built == 0 { Err(no_memory()) } else { Ok(data) }
    }

    /// ODE's id of the search tree.
    pub(super) fn id(&self) -> dTriMeshDataID {
        self.id
    }
}

impl Drop for MeshData {
    fn drop(&mut self) {
        // SAFETY: dGeomTriMeshDataCreate made it, and its owner destroys the geom that uses it first.
        unsafe { dGeomTriMeshDataDestroy(self.id) };
    }
}
