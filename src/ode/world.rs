//! One scene: the owner of everything in it.

mod export;

use std::cell::Cell;
use std::fmt;
use std::sync::atomic::{AtomicU32, Ordering};

use ode_sys::{
    dBodyCreate, dBodyDestroy, dBodyGetData, dBodyID, dBodySetData, dContactGeom, dGeomDestroy, dGeomGetData,
    dGeomID, dJointDestroy, dJointGroupCreate, dJointGroupDestroy, dJointGroupID, dSpaceDestroy,
    dThreadingAllocateSelfThreadedImplementation, dThreadingFreeImplementation,
    dThreadingImplementationGetFunctions, dThreadingImplementationID, dWorldCreate, dWorldDestroy, dWorldID,
    dWorldSetStepThreadingImplementation,
};

use super::arena::{Arena, BodyId, GeomId, Key, SpaceId};
use super::body::{Body, BodyMut};
use super::collide::ContactGeom;
use super::geom::{Geom, GeomMut, GeomRecord};
use super::hull::clear_samples;
use super::init::Ode;
use super::joint::{GroupRecord, JointRecord};
use super::space::{SpaceKind, SpaceRecord};
use crate::{Error, Result};

/// Tells the ids of one world from those of another.
static NEXT_SERIAL: AtomicU32 = AtomicU32::new(1);

/// A scene of ODE and the owner of everything in it: bodies, geoms, spaces, joints.
///
/// Things are addressed by ids. Views such as [`body`](Self::body) panic on an id of something that was removed, as
/// indexing does; functions that take an id as an argument return an error.
///
/// A world may be sent to another thread, and different worlds may be used at the same time on different threads;
/// one world is used by one thread at a time.
pub struct World {
    pub(super) raw: dWorldID,
    threading: dThreadingImplementationID,
    /// The contacts of the last collide.
    pub(super) contacts: dJointGroupID,
    root: SpaceId,
    pub(super) bodies: Arena<dBodyID>,
    pub(super) geoms: Arena<GeomRecord>,
    pub(super) spaces: Arena<SpaceRecord>,
    pub(super) joints: Arena<JointRecord>,
    pub(super) groups: Arena<GroupRecord>,
    pub(super) buffers: Buffers,
    /// The bodies that the last step had to stop.
    pub(super) stopped: Vec<BodyId>,
    /// Declared last, so that it is dropped last: ODE stays open until all of the above is gone.
    pub(super) ode: Ode,
}

/// Memory that is used again from step to step.
#[derive(Default)]
pub(super) struct Buffers {
    pub(super) raw_contacts: Cell<Vec<dContactGeom>>,
    pub(super) contacts: Cell<Vec<ContactGeom>>,
    pub(super) poses: Cell<Vec<nalgebra::Isometry3<f64>>>,
}

// SAFETY: ODE's objects belong to no thread (what ODE keeps per thread is allocated in each collide and step), all of
// them are reached through this one value, and the world steps with a threading object of its own. What is left
// global in ODE is atomic (the random numbers), or locked (`Ode`, and the cache for meshes, see `collide`). The
// data of hull geoms is `Send`, see `hull::geom`.
unsafe impl Send for World {}

impl World {
    /// An empty world without gravity, with a hash space as its root.
    ///
    /// # Errors
    ///
    /// [`Error::Ode`] if there is no memory.
    pub fn new(ode: &Ode) -> Result<Self> {
        Self::with_space(ode, SpaceKind::default())
    }

    /// An empty world without gravity, with a root space of this kind.
    ///
    /// # Errors
    ///
    /// [`Error::Ode`] if there is no memory, [`Error::Argument`] for the space's parameters, as in
    /// [`add_space`](Self::add_space).
    pub fn with_space(ode: &Ode, kind: SpaceKind) -> Result<Self> {
        let kind = kind.checked()?;
        let ode = ode.clone();
        ode.ensure_thread_data()?;
        // SAFETY: ODE is open, since `ode` lives.
        let (raw, threading) = unsafe { (dWorldCreate(), dThreadingAllocateSelfThreadedImplementation()) };
        if raw.is_null() || threading.is_null() {
            return Err(Error::Ode("no memory for a world".into()));
        }
        // SAFETY: all ids are alive. The implementation that worlds share by default is not guarded against two
        // threads that step two worlds, so this world gets its own; it is freed after the world.
        let (contacts, root) = unsafe {
            dWorldSetStepThreadingImplementation(
                raw,
                dThreadingImplementationGetFunctions(threading),
                threading,
            );
            (dJointGroupCreate(0), kind.create(std::ptr::null_mut()))
        };
        let serial = NEXT_SERIAL.fetch_add(1, Ordering::Relaxed);
        let mut spaces = Arena::new(serial);
        let root = SpaceId(spaces.insert(SpaceRecord { raw: root, parent: None, kind }));
        Ok(Self {
            raw,
            threading,
            contacts,
            root,
            bodies: Arena::new(serial),
            geoms: Arena::new(serial),
            spaces,
            joints: Arena::new(serial),
            groups: Arena::new(serial),
            buffers: Buffers::default(),
            stopped: Vec::new(),
            ode,
        })
    }

    /// The reference on ODE that this world holds.
    pub fn ode(&self) -> &Ode {
        &self.ode
    }

    /// The space that holds all others. It cannot be removed.
    pub fn root_space(&self) -> SpaceId {
        self.root
    }

    /// A body at the origin, at rest, of 1 kg and unit inertia.
    pub fn add_body(&mut self) -> BodyId {
        // SAFETY: the world is alive.
        let raw = unsafe { dBodyCreate(self.raw) };
        let key = self.bodies.insert(raw);
        // SAFETY: the body was just made.
        unsafe { dBodySetData(raw, key.user_data() as *mut _) };
        BodyId(key)
    }

    /// Removes a body; false if it was gone already.
    ///
    /// Its geoms stay where they are, without a body. Its joints stay too, attached to nothing, so that they no
    /// longer act, until they are removed or attached again.
    pub fn remove_body(&mut self, id: BodyId) -> bool {
        let Some(raw) = self.bodies.remove(id.0) else { return false };
        // SAFETY: the record was alive, and is gone now, so that this happens once.
        unsafe { dBodyDestroy(raw) };
        true
    }

    /// Removes a body and all geoms on it; false if it was gone already.
    pub fn remove_body_and_geoms(&mut self, id: BodyId) -> bool {
        if !self.contains_body(id) {
            return false;
        }
        for geom in self.geoms_of(id) {
            self.remove_geom(geom);
        }
        self.remove_body(id)
    }

    /// Whether the body is there.
    pub fn contains_body(&self, id: BodyId) -> bool {
        self.bodies.get(id.0).is_some()
    }

    /// All bodies.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.bodies.iter().map(|(key, _)| BodyId(key))
    }

    /// A body to read.
    ///
    /// # Panics
    ///
    /// If the body was removed, or is of another world. [`get_body`](Self::get_body) does not.
    #[track_caller]
    pub fn body(&self, id: BodyId) -> Body<'_> {
        Body::new(*self.bodies.expect(id), id)
    }

    /// A body to read, if it is there.
    pub fn get_body(&self, id: BodyId) -> Option<Body<'_>> {
        self.bodies.get(id.0).map(|&raw| Body::new(raw, id))
    }

    /// A body to change.
    ///
    /// # Panics
    ///
    /// If the body was removed, or is of another world.
    #[track_caller]
    pub fn body_mut(&mut self, id: BodyId) -> BodyMut<'_> {
        BodyMut::new(*self.bodies.expect(id))
    }

    /// The geoms on a body; none if the body is gone.
    pub fn geoms_of(&self, body: BodyId) -> Vec<GeomId> {
        self.geoms().filter(|&geom| self.geom(geom).body() == Some(body)).collect()
    }

    /// Whether the geom is there.
    pub fn contains_geom(&self, id: GeomId) -> bool {
        self.geoms.get(id.0).is_some()
    }

    /// All geoms.
    pub fn geoms(&self) -> impl Iterator<Item = GeomId> + '_ {
        self.geoms.iter().map(|(key, _)| GeomId(key))
    }

    /// A geom to read.
    ///
    /// # Panics
    ///
    /// If the geom was removed, or is of another world. [`get_geom`](Self::get_geom) does not.
    #[track_caller]
    pub fn geom(&self, id: GeomId) -> Geom<'_> {
        Geom::new(self, self.geoms.expect(id), id)
    }

    /// A geom to read, if it is there.
    pub fn get_geom(&self, id: GeomId) -> Option<Geom<'_>> {
        self.geoms.get(id.0).map(|record| Geom::new(self, record, id))
    }

    /// A geom to change.
    ///
    /// # Panics
    ///
    /// If the geom was removed, or is of another world.
    #[track_caller]
    pub fn geom_mut(&mut self, id: GeomId) -> GeomMut<'_> {
        self.geoms.expect(id);
        GeomMut::new(self, id)
    }

    /// ODE's own id of the world.
    ///
    /// # Safety
    ///
    /// Valid until the world is dropped. Whoever uses it must not destroy what the world owns, nor change the user
    /// data of its bodies, geoms and joints. Geoms that are added to its spaces by hand are not reported by
    /// [`collide`](Self::collide).
    pub unsafe fn raw(&self) -> dWorldID {
        self.raw
    }

    /// The id of a body of ODE, if it is one of this world's.
    ///
    /// # Safety
    ///
    /// `raw` is null or a living body.
    pub(crate) unsafe fn body_id(&self, raw: dBodyID) -> Option<BodyId> {
        if raw.is_null() {
            return None;
        }
        // SAFETY: the caller vouches for the body.
        let data = unsafe { dBodyGetData(raw) } as usize;
        // A foreign body may carry any data: the record must lead back to it.
        self.bodies.by_user_data(data).filter(|&(_, &own)| own == raw).map(|(key, _)| BodyId(key))
    }

    /// The id of a geom of ODE, if it is one of this world's.
    ///
    /// # Safety
    ///
    /// `raw` is null or a living geom.
    pub(crate) unsafe fn geom_id(&self, raw: dGeomID) -> Option<GeomId> {
        if raw.is_null() {
            return None;
        }
        // SAFETY: the caller vouches for the geom.
        let data = unsafe { dGeomGetData(raw) } as usize;
        self.geoms.by_user_data(data).filter(|(_, own)| own.raw == raw).map(|(key, _)| GeomId(key))
    }

    /// The key of the root space.
    pub(super) fn root_key(&self) -> Key {
        self.root.0
    }
}

impl Drop for World {
    fn drop(&mut self) {
        // SAFETY: every id is alive and destroyed once: joints, then their groups, geoms before the spaces that hold
        // them, spaces with their root, bodies with the world. What geoms borrow is dropped with the arena, after.
        unsafe {
            for (_, joint) in self.joints.iter().filter(|(_, joint)| joint.group.is_none()) {
                dJointDestroy(joint.raw);
            }
            for (_, group) in self.groups.iter() {
                dJointGroupDestroy(group.raw);
            }
            dJointGroupDestroy(self.contacts);
            for (_, geom) in self.geoms.iter() {
                clear_samples(geom.raw);
                dGeomDestroy(geom.raw);
            }
            dSpaceDestroy(self.spaces.expect(self.root).raw);
            dWorldDestroy(self.raw);
            dThreadingFreeImplementation(self.threading);
        }
    }
}

impl fmt::Debug for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World")
            .field("bodies", &self.bodies.len())
            .field("geoms", &self.geoms.len())
            .field("spaces", &self.spaces.len())
            .field("joints", &self.joints.len())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
