//! One scene, as the owner of everything in it.

mod export;

use std::cell::{Cell, RefCell};
use std::fmt;
use std::sync::atomic::{AtomicU32, Ordering};

use ode_sys::{
    dBodyCreate, dBodyDestroy, dBodyID, dBodySetData, dContactGeom, dGeomDestroy, dJointDestroy,
    dJointGroupCreate, dJointGroupDestroy, dJointGroupID, dSpaceDestroy,
    dThreadingAllocateSelfThreadedImplementation, dThreadingFreeImplementation,
    dThreadingImplementationGetFunctions, dThreadingImplementationID, dWorldCreate, dWorldDestroy, dWorldID,
    dWorldSetStepThreadingImplementation,
};

use super::arena::{Arena, BodyId, GeomId, Key, SpaceId};
use super::body::{Body, BodyMut};
use super::contacts::ContactGeom;
use super::geom::{Geom, GeomMut, GeomRecord};
use super::hull::clear_samples;
use super::init::Ode;
use super::joint::{GroupRecord, JointRecord, MeasuredContact};
use super::space::{SpaceKind, SpaceRecord};
use crate::{Error, Result};

/// The serial number of the next world, which distinguishes ids of different worlds.
static NEXT_SERIAL: AtomicU32 = AtomicU32::new(1);

/// A scene of ODE, which owns its bodies, geoms, spaces and joints.
///
/// Objects are addressed by ids. Functions that return a view, such as [`body`](Self::body), panic on an id whose
/// object was removed, as indexing does; functions that take an id as an argument return an error.
///
/// A world may be sent to another thread, and several threads may each use a world of their own at the same time.
pub struct World {
    pub(super) raw: dWorldID,
    pub(super) threading: dThreadingImplementationID,
    /// The group of the contact joints that the last collide attached.
    pub(super) contacts: dJointGroupID,
    root: SpaceId,
    pub(super) bodies: Arena<dBodyID>,
    pub(super) geoms: Arena<GeomRecord>,
    pub(super) spaces: Arena<SpaceRecord>,
    pub(super) joints: Arena<JointRecord>,
    pub(super) groups: Arena<GroupRecord>,
    pub(super) buffers: Buffers,
    /// The bodies that the last step stopped.
    pub(super) stopped: Vec<BodyId>,
    /// The length of the last step in seconds; 0 before the first.
    pub(super) last_dt: f64,
    /// Whether `default_collide` directs friction along the slip at contacts without a hull too.
    pub(super) slip_friction: bool,
    /// Whether a hull has ever recorded events.
    pub(super) has_events: Cell<bool>,
    /// Declared last, so that it is dropped last: ODE stays open until all other fields are dropped.
    pub(super) ode: Ode,
}

/// Buffers that are reused from step to step.
#[derive(Default)]
pub(super) struct Buffers {
    pub(super) raw_contacts: Cell<Vec<dContactGeom>>,
    pub(super) contacts: Cell<Vec<ContactGeom>>,
    pub(super) poses: Cell<Vec<nalgebra::Isometry3<f64>>>,
    /// The contacts of the last collide whose forces are measured.
    pub(super) measured: RefCell<Vec<MeasuredContact>>,
}

// SAFETY: ODE's objects belong to no thread: its per-thread data is allocated before each collide and step. All objects
// are reached through this one value, and the world steps with its own threading object. The remaining global state of
// ODE is atomic (the random numbers) or locked (`Ode`, and the cache for meshes, see `collide`). The data of hull geoms
// is `Send`, see `hull::geom`.
unsafe impl Send for World {}

impl World {
    /// Makes an empty world without gravity, with a hash space as its root.
    ///
    /// # Errors
    ///
    /// [`Error::Ode`] if memory runs out.
    pub fn new(ode: &Ode) -> Result<Self> {
        Self::with_space(ode, SpaceKind::default())
    }

    /// Makes an empty world without gravity, with a root space of this kind.
    ///
    /// # Errors
    ///
    /// [`Error::Ode`] if memory runs out; [`Error::Argument`] if the space's parameters are out of range, as in
    /// [`add_space`](Self::add_space).
    pub fn with_space(ode: &Ode, kind: SpaceKind) -> Result<Self> {
        let kind = kind.checked()?;
        let ode = ode.clone();
        ode.ensure_thread_data()?;

        // SAFETY: ODE is open, since `ode` lives.
        let (raw, threading) = unsafe { (dWorldCreate(), dThreadingAllocateSelfThreadedImplementation()) };
        if raw.is_null() || threading.is_null() {
            return Err(Error::Ode("memory ran out while making a world".into()));
        }

        // The threading implementation that worlds share by default is not safe when two threads step two worlds, so
        // this world gets its own.
        // SAFETY: all ids are alive, and the threading implementation is freed after the world.
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
            last_dt: 0.0,
            has_events: Cell::new(false),
            slip_friction: false,
            ode,
        })
    }

    /// The reference to ODE that this world holds.
    pub fn ode(&self) -> &Ode {
        &self.ode
    }

    /// The space that contains all other spaces. It cannot be removed.
    pub fn root_space(&self) -> SpaceId {
        self.root
    }

    /// Adds a body at the origin, at rest, with a mass of 1 kg and unit inertia.
    pub fn add_body(&mut self) -> BodyId {
        // SAFETY: the world is alive.
        let raw = unsafe { dBodyCreate(self.raw) };
        let key = self.bodies.insert(raw);
        // SAFETY: the body was just made.
        unsafe { dBodySetData(raw, key.user_data() as *mut _) };
        BodyId(key)
    }

    /// Removes a body. Returns false if it was removed before.
    ///
    /// Its geoms stay where they are, without a body. Its joints remain too, attached to nothing and without effect,
    /// until they are removed or attached again.
    pub fn remove_body(&mut self, id: BodyId) -> bool {
        let Some(raw) = self.bodies.remove(id.0) else { return false };
        // SAFETY: the body was alive, and its record was just removed, so it is destroyed only once.
        unsafe { dBodyDestroy(raw) };
        true
    }

    /// Removes a body and all geoms attached to it. Returns false if the body was removed before.
    pub fn remove_body_and_geoms(&mut self, id: BodyId) -> bool {
        if !self.contains_body(id) {
            return false;
        }
        for geom in self.geoms_of(id) {
            self.remove_geom(geom);
        }
        self.remove_body(id)
    }

    /// Whether the body exists in this world.
    pub fn contains_body(&self, id: BodyId) -> bool {
        self.bodies.get(id.0).is_some()
    }

    /// The ids of all bodies.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.bodies.iter().map(|(key, _)| BodyId(key))
    }

    /// Read access to a body. [`get_body`](Self::get_body) does not panic.
    ///
    /// # Panics
    ///
    /// If the body was removed or belongs to another world.
    #[track_caller]
    pub fn body(&self, id: BodyId) -> Body<'_> {
        Body::new(*self.bodies.expect(id), id)
    }

    /// Read access to a body, if it exists in this world.
    pub fn get_body(&self, id: BodyId) -> Option<Body<'_>> {
        self.bodies.get(id.0).map(|&raw| Body::new(raw, id))
    }

    /// Write access to a body.
    ///
    /// # Panics
    ///
    /// If the body was removed or belongs to another world.
    #[track_caller]
    pub fn body_mut(&mut self, id: BodyId) -> BodyMut<'_> {
        BodyMut::new(*self.bodies.expect(id))
    }

    /// The geoms attached to a body; none if the body was removed.
    pub fn geoms_of(&self, body: BodyId) -> Vec<GeomId> {
        self.geoms().filter(|&geom| self.geom(geom).body() == Some(body)).collect()
    }

    /// Whether the geom exists in this world.
    pub fn contains_geom(&self, id: GeomId) -> bool {
        self.geoms.get(id.0).is_some()
    }

    /// The ids of all geoms.
    pub fn geoms(&self) -> impl Iterator<Item = GeomId> + '_ {
        self.geoms.iter().map(|(key, _)| GeomId(key))
    }

    /// Read access to a geom. [`get_geom`](Self::get_geom) does not panic.
    ///
    /// # Panics
    ///
    /// If the geom was removed or belongs to another world.
    #[track_caller]
    pub fn geom(&self, id: GeomId) -> Geom<'_> {
        Geom::new(self, self.geoms.expect(id), id)
    }

    /// Read access to a geom, if it exists in this world.
    pub fn get_geom(&self, id: GeomId) -> Option<Geom<'_>> {
        self.geoms.get(id.0).map(|record| Geom::new(self, record, id))
    }

    /// Write access to a geom.
    ///
    /// # Panics
    ///
    /// If the geom was removed or belongs to another world.
    #[track_caller]
    pub fn geom_mut(&mut self, id: GeomId) -> GeomMut<'_> {
        self.geoms.expect(id);
        GeomMut::new(self, id)
    }

    /// ODE's own id of the world.
    ///
    /// # Safety
    ///
    /// The id is valid until the world is dropped. For the objects that the world owns, the caller must not
    ///
    /// - destroy them, change the user data of bodies, geoms and joints, or move geoms and spaces to other spaces;
    /// - attach geoms to bodies of another world;
    /// - set numbers that this wrapper would refuse, after which ODE may abort.
    ///
    /// Other objects may be made with ODE's own functions. [`adopt_geom`](Self::adopt_geom) and
    /// [`adopt_body`](Self::adopt_body) let the world own them. Until then [`collide`](Self::collide) leaves such geoms
    /// out; all are destroyed with the world or their space.
    pub unsafe fn raw(&self) -> dWorldID {
        self.raw
    }

    /// The arena key of the root space.
    pub(super) fn root_key(&self) -> Key {
        self.root.0
    }
}

impl Drop for World {
    fn drop(&mut self) {
        // SAFETY: every id is alive and destroyed once: single joints, then groups with their joints, geoms before the
        // spaces that contain them, spaces with their root, bodies with the world. The data that geoms borrow is in the
        // arena, which is dropped later.
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
