//! Finding what touches, and the contacts that keep it apart.

use crate::lock::lock;
use std::any::Any;
use std::cell::Cell;
use std::ffi::c_void;
use std::fmt;
use std::ops::Deref;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Mutex;

use nalgebra::{Point3, Vector3};
use ode_sys::{
    CONTACTS_UNIMPORTANT, dAreConnectedExcluding, dBodyID, dCollide, dContact, dContactGeom, dGeomGetBody,
    dGeomGetClass, dGeomID, dGeomIsEnabled, dGeomIsSpace, dJointAttach, dJointCreateContact,
    dJointGroupEmpty, dJointGroupID, dJointID, dJointTypeContact, dSpaceCollide, dSpaceCollide2,
    dTriMeshClass, dWorldID,
};

use super::arena::{BodyId, GeomId};
use super::body::Body;
use super::geom::Geom;
use super::surface::Surface;
use super::world::World;
use super::{check, convert, panic};
use crate::{Error, Result};

/// The most contacts that one call of ODE can return: the count has 16 bits.
const MOST_CONTACTS: usize = 0xffff;

/// Debian's ODE keeps one cache for all collisions with meshes, whatever the thread.
static MESH_CACHE: Mutex<()> = Mutex::new(());

/// A point where two geoms touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactGeom {
    /// Where, in the world.
    pub position: Point3<f64>,
    /// Points into the first geom: moving that along it by `depth` separates the two.
    pub normal: Vector3<f64>,
    /// How deep they are in each other, m, 0 or more. For a ray, how far away the hit is.
    pub depth: f64,
    /// The two geoms.
    pub geoms: [GeomId; 2],
}

/// Two geoms whose boxes overlap, and which the world's [`collide`](World::collide) shows to its closure.
pub struct Pair<'c> {
    world: &'c World,
    problem: &'c Cell<Option<Error>>,
    raw: [dGeomID; 2],
    geoms: [GeomId; 2],
}

/// The contacts of a pair. A slice, in memory that is used again for the next pair.
pub struct Contacts<'c> {
    points: Vec<ContactGeom>,
    home: &'c Cell<Vec<ContactGeom>>,
}

impl Deref for Contacts<'_> {
    type Target = [ContactGeom];

    fn deref(&self) -> &[ContactGeom] {
        &self.points
    }
}

impl fmt::Debug for Contacts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.points.fmt(f)
    }
}

impl Drop for Contacts<'_> {
    fn drop(&mut self) {
        self.home.set(std::mem::take(&mut self.points));
    }
}

impl World {
    /// Shows every pair of geoms that may touch to `visit`, which attaches contacts to it. The contacts of the last
    /// collide are removed first, and visual hulls take up the latest frame that was published.
    ///
    /// Pairs are found across nested spaces, each once. Two geoms of one body are no pair, neither are disabled geoms,
    /// nor those whose category and collide bits do not meet. Pairs come in the same order in each run.
    ///
    /// # Errors
    ///
    /// The first thing that was wrong with an [`attach`](Pair::attach); the other contacts are attached.
    ///
    /// # Panics
    ///
    /// If `visit` does. The pairs after that are not visited, and the world works on.
    pub fn collide(&mut self, mut visit: impl FnMut(&Pair<'_>)) -> Result<()> {
        self.ode.ensure_thread_data()?;
        self.clear_contacts();
        self.apply_latest_frames();
        let problem = Cell::new(None);
        let mut search = PairSearch { world: self, visit: &mut visit, problem: &problem, panic: None };
        let data: *mut PairSearch<'_> = &mut search;
        for (_, space) in self.spaces.iter() {
            // SAFETY: the space is alive, `data` points to a search that outlives the call, and nothing in the
            // callback adds, moves or removes a geom: all that needs the world mutably.
            unsafe { dSpaceCollide(space.raw, data.cast(), Some(near_callback)) };
        }
        if let Some(payload) = search.panic.take() {
            resume_unwind(payload);
        }
        panic::resume_parked();
        problem.take().map_or(Ok(()), Err)
    }

    /// The usual way to collide: up to `max` contacts with this surface for each pair with a body that moves, except
    /// between bodies that a joint connects.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a surface with NaN or numbers out of range.
    pub fn default_collide(&mut self, surface: &Surface, max: usize) -> Result<()> {
        surface.to_ode()?;
        self.collide(|pair| {
            if pair.bodies() == [None, None] || pair.are_connected_excluding_contact() {
                return;
            }
            for contact in pair.contacts(max).iter() {
                pair.attach(contact, surface);
            }
        })
    }

    /// Removes the contacts that the last collide attached.
    pub fn clear_contacts(&mut self) {
        // SAFETY: the group is alive as long as the world, and no record leads to its joints.
        unsafe { dJointGroupEmpty(self.contacts) };
    }

    /// Up to `max` contacts of two geoms, whatever spaces they are in. They are not attached.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a geom is gone.
    pub fn collide_geoms(&mut self, first: GeomId, second: GeomId, max: usize) -> Result<Vec<ContactGeom>> {
        self.ode.ensure_thread_data()?;
        let raw = [self.geoms.find(first)?.raw, self.geoms.find(second)?.raw];
        self.apply_latest_frames();
        let found = contacts(self, raw, [first, second], max, 0).to_vec();
        panic::resume_parked();
        Ok(found)
    }
}

impl<'c> Pair<'c> {
    /// The two geoms.
    pub fn geoms(&self) -> [GeomId; 2] {
        self.geoms
    }

    /// The two geoms, to read.
    pub fn geom_views(&self) -> [Geom<'c>; 2] {
        self.geoms.map(|geom| self.world.geom(geom))
    }

    /// The bodies of the two geoms; `None` for a geom that belongs to the world.
    pub fn bodies(&self) -> [Option<BodyId>; 2] {
        // SAFETY: ODE has just passed both geoms, and so they are alive, as are their bodies.
        self.raw.map(|geom| unsafe { self.world.body_id(dGeomGetBody(geom)) })
    }

    /// A body, to read.
    pub fn body(&self, id: BodyId) -> Option<Body<'c>> {
        self.world.get_body(id)
    }

    /// Whether a joint that is not a contact connects the two bodies.
    pub fn are_connected_excluding_contact(&self) -> bool {
        // SAFETY: both geoms are alive, and so are their bodies.
        let [first, second] = self.raw.map(|geom| unsafe { dGeomGetBody(geom) });
        // SAFETY: two living bodies.
        !first.is_null()
            && !second.is_null()
            && unsafe { dAreConnectedExcluding(first, second, dJointTypeContact as i32) } != 0
    }

    /// Up to `max` contacts, at most 65 535.
    pub fn contacts(&self, max: usize) -> Contacts<'c> {
        contacts(self.world, self.raw, self.geoms, max, 0)
    }

    /// Whether they touch at all, which is found faster than where.
    pub fn touches(&self) -> bool {
        !contacts(self.world, self.raw, self.geoms, 1, CONTACTS_UNIMPORTANT).is_empty()
    }

    /// Lets the pair's bodies act on each other at this contact, until the next [`collide`](World::collide). Nothing
    /// happens if there are none.
    ///
    /// What is wrong with the contact or the surface becomes the error of [`collide`](World::collide).
    pub fn attach(&self, contact: &ContactGeom, surface: &Surface) {
        // SAFETY: both geoms are alive, and so are their bodies.
        let bodies = self.raw.map(|geom| unsafe { dGeomGetBody(geom) });
        if bodies[0].is_null() && bodies[1].is_null() {
            return;
        }
        // SAFETY: world, group and bodies are alive. ODE shows no pair of one body.
        let joint = unsafe { create_contact(self.world.raw, self.world.contacts, bodies, contact, surface) };
        if let Err(error) = joint {
            let first = self.problem.take().unwrap_or(error);
            self.problem.set(Some(first));
        }
    }
}

impl fmt::Debug for Pair<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Pair").field(&self.geoms[0]).field(&self.geoms[1]).finish()
    }
}

/// A contact joint between two bodies.
///
/// # Safety
///
/// `world` and `group` are alive, `bodies` are null or alive and of `world`, and not equal.
pub(super) unsafe fn create_contact(
    world: dWorldID,
    group: dJointGroupID,
    bodies: [dBodyID; 2],
    contact: &ContactGeom,
    surface: &Surface,
) -> Result<dJointID> {
    check::point("position of the contact", &contact.position)?;
    check::not_negative("depth of the contact", contact.depth)?;
    let length = contact.normal.norm();
    if length.is_nan() || (length - 1.0).abs() > 1e-3 {
        return Err(Error::argument(format!(
            "normal of the contact: expected a unit vector, found length {length}"
        )));
    }
    let geom = dContactGeom {
        pos: convert::ode_vector(&contact.position.coords),
        normal: convert::ode_vector(&contact.normal),
        depth: contact.depth,
        ..Default::default()
    };
    let contact = dContact { surface: surface.to_ode()?, geom, ..Default::default() };
    // SAFETY: as the caller vouches; ODE copies the contact.
    unsafe {
        let joint = dJointCreateContact(world, group, &contact);
        dJointAttach(joint, bodies[0], bodies[1]);
        Ok(joint)
    }
}

/// The contacts of two living geoms of `world`. Those that are not finite are left out.
fn contacts<'c>(
    world: &'c World,
    raw: [dGeomID; 2],
    ids: [GeomId; 2],
    max: usize,
    flags: u32,
) -> Contacts<'c> {
    let max = max.min(MOST_CONTACTS);
    let home = &world.buffers.contacts;
    let mut points = home.take();
    points.clear();
    if max > 0 {
        let mut found = world.buffers.raw_contacts.take();
        if found.len() < max {
            found.resize(max, dContactGeom::default());
        }
        let flags = (max as u32 | flags) as i32;
        // SAFETY: both geoms are alive, no space (which `GeomId` never names), and the buffer holds `max` contacts.
        let count = unsafe { collide_raw(raw, flags, &mut found) };
        points.extend(found.iter().take(count).map(|contact| ContactGeom {
            position: convert::point(&contact.pos),
            normal: convert::vector(&contact.normal),
            depth: contact.depth,
            geoms: ids,
        }));
        points.retain(|contact| {
            let numbers = contact.position.iter().chain(contact.normal.iter());
            numbers.chain([&contact.depth]).all(|number| number.is_finite())
        });
        world.buffers.raw_contacts.set(found);
    }
    Contacts { points, home }
}

/// # Safety
///
/// Both geoms are alive, and the low 16 bits of `flags` are neither 0 nor more than the length of `found`.
unsafe fn collide_raw([first, second]: [dGeomID; 2], flags: i32, found: &mut [dContactGeom]) -> usize {
    // SAFETY: the geoms are alive.
    let is_mesh = |geom| unsafe { dGeomGetClass(geom) } == dTriMeshClass as i32;
    let _cache = (is_mesh(first) || is_mesh(second)).then(|| lock(&MESH_CACHE));
    // SAFETY: as the caller vouches; the contacts lie one after the other.
    let count =
        unsafe { dCollide(first, second, flags, found.as_mut_ptr(), size_of::<dContactGeom>() as i32) };
    count.max(0) as usize
}

/// What goes through ODE to the callback.
struct PairSearch<'c> {
    world: &'c World,
    visit: &'c mut dyn FnMut(&Pair<'_>),
    problem: &'c Cell<Option<Error>>,
    panic: Option<Box<dyn Any + Send>>,
}

/// ODE's callback: opens spaces, and shows pairs of geoms.
unsafe extern "C" fn near_callback(data: *mut c_void, first: dGeomID, second: dGeomID) {
    // SAFETY: ODE passes living geoms.
    let is_space = |geom| unsafe { dGeomIsSpace(geom) != 0 };
    if is_space(first) || is_space(second) {
        // Only the pairs across: what is inside of each space is collided on its own.
        // SAFETY: as for the call that led here.
        unsafe { dSpaceCollide2(first, second, data, Some(near_callback)) };
        return;
    }
    // SAFETY: `data` is the search of `World::collide`, and no other reference to it is in use: the callback is left
    // before the next one begins.
    let search = unsafe { &mut *data.cast::<PairSearch<'_>>() };
    // ODE itself overlooks the enabled flag of geoms in the smaller of two spaces.
    // SAFETY: both are alive.
    let enabled = [first, second].iter().all(|&geom| unsafe { dGeomIsEnabled(geom) != 0 });
    if search.panic.is_some() || !enabled {
        return;
    }
    // SAFETY: both are alive. Geoms that were added behind the world's back have no id, and are left out.
    let ids = unsafe { (search.world.geom_id(first), search.world.geom_id(second)) };
    if let (Some(a), Some(b)) = ids {
        let pair = Pair { world: search.world, problem: search.problem, raw: [first, second], geoms: [a, b] };
        // A panic must not unwind through ODE, which would leave its spaces locked. It goes on in `World::collide`.
        search.panic = catch_unwind(AssertUnwindSafe(|| (search.visit)(&pair))).err();
    }
}
