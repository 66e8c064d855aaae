//! A triangle mesh of ODE that is rebuilt in each frame, collided with boxes of ODE.
//!
//! ODE is called directly, so that the peer does not pay for the checks of the library's wrapper. The mesh is not
//! preprocessed, since collision with boxes does not need it, and ODE reads the arrays in place.

#![allow(unsafe_code)]

use crate::nets::Mesh;
use crate::scene::{BOX, Bodies};
use ode_sys::{
    dAllocateMaskAll, dAllocateODEDataForThread, dBoxClass, dCollide, dContactGeom, dCreateBox,
    dCreateTriMesh, dGeomDestroy, dGeomGetClass, dGeomGetData, dGeomID, dGeomSetData, dGeomSetPosition,
    dGeomSetQuaternion, dGeomTriMeshDataBuildSingle, dGeomTriMeshDataCreate, dGeomTriMeshDataDestroy,
    dSimpleSpaceCreate, dSpaceCollide2, dSpaceDestroy, dSpaceID,
};
use ode_visual_hull::ode::Ode;
use std::ffi::c_void;
use std::ptr::null_mut;

/// Maximum number of contacts of a pair, equal to the default of a hull.
const MOST_CONTACTS: usize = 8;

/// The boxes in a space of ODE.
#[derive(Debug)]
pub struct Boxes {
    space: dSpaceID,
    count: usize,
    /// Declared last, so that ODE closes after the space is gone.
    _ode: Ode,
}

impl Boxes {
    /// Creates a geom for each box of `bodies`.
    ///
    /// # Errors
    /// ODE cannot be opened.
    pub fn new(bodies: &Bodies) -> ode_visual_hull::Result<Self> {
        let ode = Ode::init()?;
        // SAFETY: ODE is open. The space owns its boxes and destroys them.
        let space = unsafe {
            dAllocateODEDataForThread(dAllocateMaskAll as u32);
            dSimpleSpaceCreate(null_mut())
        };

        for (index, pose) in bodies.poses.iter().enumerate() {
            let p = pose.translation.vector;
            let [i, j, k, w]: [f64; 4] = pose.rotation.coords.into();
            // SAFETY: the space is alive; ODE's quaternions begin with the scalar part. The data is a number.
            unsafe {
                let geom = dCreateBox(space, BOX.x, BOX.y, BOX.z);
                dGeomSetPosition(geom, p.x, p.y, p.z);
                dGeomSetQuaternion(geom, [w, i, j, k].as_ptr());
                dGeomSetData(geom, index as *mut c_void);
            }
        }

        Ok(Self { space, count: bodies.poses.len(), _ode: ode })
    }

    /// Builds ODE's mesh, collides the boxes with it, and writes each box's number of contacts to `counts`.
    pub fn with_mesh(&mut self, mesh: &Mesh, counts: &mut Vec<usize>) {
        counts.clear();
        counts.resize(self.count, 0);

        // SAFETY: strides and counts describe the two arrays, which live until the data is destroyed. The geom is in
        // no space and is destroyed before its data. `near` gets what it expects, and destroys nothing.
        unsafe {
            let data = dGeomTriMeshDataCreate();
            dGeomTriMeshDataBuildSingle(
                data,
                mesh.points.as_ptr().cast(),
                size_of::<[f32; 3]>() as i32,
                mesh.points.len() as i32,
                mesh.triangles.as_ptr().cast(),
                3 * mesh.triangles.len() as i32,
                size_of::<[u32; 3]>() as i32,
            );
            let geom = dCreateTriMesh(null_mut(), data, None, None, None);
            let counts: *mut Vec<usize> = counts;
            dSpaceCollide2(geom, self.space.cast(), counts.cast(), Some(near_callback));

            dGeomDestroy(geom);
            dGeomTriMeshDataDestroy(data);
        }
    }
}

impl Drop for Boxes {
    fn drop(&mut self) {
        // SAFETY: made by `new`, and ODE is still open.
        unsafe { dSpaceDestroy(self.space) };
    }
}

/// Counts the contacts of a pair whose boxes overlap: the mesh and a box.
unsafe extern "C" fn near_callback(counts: *mut c_void, first: dGeomID, second: dGeomID) {
    let mut contacts = [dContactGeom::default(); MOST_CONTACTS];
    // SAFETY: ODE passes two living geoms, and the pointer to the counts, which has an entry for each box's
    // index; the buffer holds as many contacts as `dCollide` may write.
    unsafe {
        let counts = &mut *counts.cast::<Vec<usize>>();
        let skip = size_of::<dContactGeom>() as i32;
        let found = dCollide(first, second, MOST_CONTACTS as i32, contacts.as_mut_ptr(), skip);
        let body = if dGeomGetClass(first) == dBoxClass as i32 { first } else { second };
        counts[dGeomGetData(body) as usize] = found.max(0) as usize;
    }
}
