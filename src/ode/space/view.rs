//! Read access to spaces.

use ode_sys::dSpaceID;

use super::{SpaceKind, SpaceRecord};
use crate::ode::arena::{GeomId, SpaceId};
use crate::ode::world::World;

/// Read access to a space of a [`World`].
#[derive(Debug, Clone, Copy)]
pub struct Space<'w> {
    world: &'w World,
    record: &'w SpaceRecord,
    id: SpaceId,
}

impl Space<'_> {
    /// The space's id.
    pub fn id(&self) -> SpaceId {
        self.id
    }

    /// The space's broad phase.
    pub fn kind(&self) -> SpaceKind {
        self.record.kind
    }

    /// The space that contains this one; `None` for the root.
    pub fn parent(&self) -> Option<SpaceId> {
        self.record.parent.map(SpaceId)
    }

    /// The geoms directly in this space, not in its inner spaces.
    pub fn geoms(&self) -> Vec<GeomId> {
        self.world.geoms_in(self.id)
    }

    /// The spaces directly in this one.
    pub fn inner_spaces(&self) -> Vec<SpaceId> {
        let inner = self.world.spaces.iter().filter(|(_, space)| space.parent == Some(self.id.0));
        inner.map(|(key, _)| SpaceId(key)).collect()
    }

    /// ODE's own id of the space.
    ///
    /// # Safety
    ///
    /// The id is valid until the space is removed, and its use must follow the rules of [`World::raw`].
    pub unsafe fn raw(&self) -> dSpaceID {
        self.record.raw
    }
}

impl World {
    /// Read access to a space. [`get_space`](Self::get_space) does not panic.
    ///
    /// # Panics
    ///
    /// If the space was removed or belongs to another world.
    #[track_caller]
    pub fn space(&self, id: SpaceId) -> Space<'_> {
        Space { world: self, record: self.spaces.expect(id), id }
    }

    /// Read access to a space, if it exists in this world.
    pub fn get_space(&self, id: SpaceId) -> Option<Space<'_>> {
        self.spaces.get(id.0).map(|record| Space { world: self, record, id })
    }
}
