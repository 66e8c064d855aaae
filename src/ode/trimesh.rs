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
pub(super) struct MeshData(dTriMeshDataID);

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
        let data = Self(id);

        // Without the face angles collisions with convex shapes abort.
        // SAFETY: the strides and counts describe the two arrays, which the caller keeps alive; indices are in range
        // and triangles have an area, see `TriMesh::new`.
        let built = unsafe {
            dGeomTriMeshDataBuildDouble(
                id,
                mesh.points().as_ptr().cast::<c_void>(),
                size_of::<Point3<f64>>() as i32,
                mesh.points().len() as i32,
                mesh.triangles().as_ptr().cast::<c_void>(),
                3 * mesh.triangles().len() as i32,
                size_of::<[u32; 3]>() as i32,
            );
            let requests =
                (1 << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES) | (1 << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES);
            dGeomTriMeshDataPreprocess2(id, requests, std::ptr::null())
        };
        if built == 0 { Err(no_memory()) } else { Ok(data) }
    }

    /// ODE's id of the search tree.
    pub(super) fn id(&self) -> dTriMeshDataID {
        self.0
    }
}

impl Drop for MeshData {
    fn drop(&mut self) {
        // SAFETY: dGeomTriMeshDataCreate made it, and its owner destroys the geom that uses it first.
        unsafe { dGeomTriMeshDataDestroy(self.0) };
    }
}
