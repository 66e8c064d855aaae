//! Geoms: collision shapes with a pose.

mod view;

use ode_sys::{dGeomDestroy, dGeomID, dGeomSetData, dSpaceAdd};

use super::arena::{GeomId, Key, SpaceId};
use super::shape::{ShapeData, checked, create};
use super::world::World;
use crate::Result;
use crate::shape::Shape;

pub use view::{Geom, GeomMut};

/// A geom that a world owns, with the data that it borrows.
#[derive(Debug)]
pub(super) struct GeomRecord {
    pub(super) raw: dGeomID,
    pub(super) space: Key,
    /// The geom's shape; `None` for a class that is not built into ODE, and where ODE does not tell the shape of an
    /// adopted geom.
    shape: Option<Shape>,
    /// What ODE keeps of a mesh or heightfield, which refers to the arrays of `shape`.
    _data: Option<ShapeData>,
}

/// Options for the hits of a ray with triangle meshes and other geoms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RayFlags {
    /// Report the first hit found with a mesh, which need not be the nearest.
    pub first_contact: bool,
    /// Ignore triangles that face away from the ray's origin.
    pub backface_cull: bool,
    /// Report only the nearest hit with a mesh.
    pub closest_hit: bool,
}

impl GeomRecord {
    /// The record of a geom made elsewhere, with its shape if ODE tells it.
    pub(super) fn adopted(raw: dGeomID, space: Key, shape: Option<Shape>) -> Self {
        Self { raw, space, shape, _data: None }
    }

    /// Whether the geom has a pose. All geoms but planes have one.
    fn is_placeable(&self) -> bool {
        self.shape.as_ref().is_none_or(Shape::is_placeable)
    }
}

impl World {
    /// Adds a geom of this shape to `space`, at the origin and without a body.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the space was removed, or if a size is not positive, finite and within
    /// [`REACH`](super::REACH); [`crate::Error::Ode`] if memory runs out.
    pub fn add_geom(&mut self, space: SpaceId, shape: &Shape) -> Result<GeomId> {
        let raw_space = self.spaces.find(space)?.raw;
        let shape = checked(shape)?;
        // SAFETY: ODE is open as long as the world lives, and the record keeps the shape and the data as long as the
        // geom.
        let (raw, data) = unsafe { create(&shape)? };
        // SAFETY: space and geom are alive, and a new geom is in no space.
        unsafe { dSpaceAdd(raw_space, raw) };
        Ok(self.keep_geom(GeomRecord { raw, space: space.0, shape: Some(shape), _data: data }))
    }

    /// Takes ownership of a geom of a user-defined class, and adds it to `space`.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the space was removed; the geom is destroyed then.
    ///
    /// # Safety
    ///
    /// `raw` is a living, placeable geom in no space and on no body, and no other code destroys it. Its class computes
    /// bounding boxes without NaN, whose finite coordinates are within 3 [`REACH`](super::REACH).
    pub(super) unsafe fn insert_geom(&mut self, space: SpaceId, raw: dGeomID) -> Result<GeomId> {
        let raw_space = match self.spaces.find(space) {
            Ok(record) => record.raw,
            Err(error) => {
                // SAFETY: the caller has given up ownership of the geom.
                unsafe { dGeomDestroy(raw) };
                return Err(error);
            }
        };

        // SAFETY: the space is alive, and the geom is in none.
        unsafe { dSpaceAdd(raw_space, raw) };
        Ok(self.keep_geom(GeomRecord::adopted(raw, space.0, None)))
    }

    /// Stores the record of a geom, and its key in the geom's user data.
    pub(super) fn keep_geom(&mut self, record: GeomRecord) -> GeomId {
        let raw = record.raw;
        let key = self.geoms.insert(record);
        // SAFETY: the geom is alive, and only the world uses its user data.
        unsafe { dGeomSetData(raw, key.user_data() as *mut _) };
        GeomId(key)
    }
}
