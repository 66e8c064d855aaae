//! Collision detection: pairs of geoms, their contact points, and the contact joints between their bodies.

use crate::lock::lock;
use std::cell::Cell;
use std::fmt;
use std::ops::Deref;
use std::sync::Mutex;

use nalgebra::{Point3, Vector3};
use ode_sys::{
    CONTACTS_UNIMPORTANT, dAreConnectedExcluding, dBodyID, dCapsuleClass, dCollide, dContact, dContactGeom,
    dCylinderClass, dGeomGetBody, dGeomGetClass, dGeomID, dJointAttach, dJointCreateContact,
    dJointGroupEmpty, dJointGroupID, dJointID, dJointTypeContact, dSpaceCollide, dSpaceCollide2,
    dTriMeshClass, dWorldID,
};

use super::arena::{BodyId, GeomId};
use super::body::Body;
use super::geom::Geom;
use super::hull::{Softness, SurfaceMotion, Touching, contact_seconds, grip_softness, surface_motion};
use super::pair_search::{near_callback, search_pairs};
use super::slip::friction_direction;
use super::surface::Surface;
use super::world::World;
use super::{check, convert, heightfield, panic};
use crate::{Error, Result};

/// The largest number of contacts that one call of ODE can return: the count has 16 bits.
const MAX_CONTACTS: usize = 0xffff;

/// The largest number of contacts of a capsule or cylinder with a mesh, for which ODE takes 80 bytes a contact asked for
/// from the stack.
const MAX_STACK_CONTACTS: usize = 1000;

/// Guards the cache that Debian's ODE shares between all threads for collisions with meshes.
static MESH_CACHE: Mutex<()> = Mutex::new(());

/// A contact point of two geoms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactGeom {
    /// The position, in the world's frame.
    pub position: Point3<f64>,
    /// The unit normal, which points into the first geom: moving that geom along it by `depth` separates the two.
    pub normal: Vector3<f64>,
    /// The penetration depth, m, 0 or more. For a ray it is the distance of the hit from the ray's origin.
    pub depth: f64,
    /// Seconds until the geoms touch, with a hull that is [`Swept`](super::Swept); 0 where they do.
    pub time: f64,
    /// The first and the second geom.
    pub geoms: [GeomId; 2],
}

/// Two geoms whose bounding boxes overlap, as [`World::collide`] passes them to its closure.
pub struct Pair<'c> {
    pub(super) world: &'c World,
    pub(super) first_error: &'c Cell<Option<Error>>,
    pub(super) raw: [dGeomID; 2],
    pub(super) geoms: [GeomId; 2],
}

/// The contacts of a pair, as a slice in a buffer that the next pair reuses.
pub struct Contacts<'c> {
    points: Vec<ContactGeom>,
    /// The cell that takes the buffer back when this value is dropped.
    reused: &'c Cell<Vec<ContactGeom>>,
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

impl Contacts<'_> {
    /// Drops the contacts that do not fulfil a condition.
    pub(super) fn retain(&mut self, keep: impl FnMut(&ContactGeom) -> bool) {
        self.points.retain(keep);
    }
}

impl Drop for Contacts<'_> {
    fn drop(&mut self) {
        self.reused.set(std::mem::take(&mut self.points));
    }
}

impl World {
    /// Calls `visit` for every pair of geoms that may touch, so that it can attach contacts between them. The contacts
    /// of the last collide are removed first, and visual hulls switch to the latest published frame.
    ///
    /// Pairs are found across nested spaces, each pair once, and in the same order in each run. Two geoms of one
    /// body are left out, as are disabled geoms and geoms whose category and collide bits exclude each other.
    ///
    /// # Errors
    ///
    /// The first error of an [`attach`](Pair::attach), or of a pair that ODE cannot collide, see
    /// [`Shape::Heightfield`](super::Shape::Heightfield). All other pairs are visited, and their contacts attached.
    ///
    /// # Panics
    ///
    /// If `visit` panics. The remaining pairs are not visited, and the world remains usable.
    pub fn collide(&mut self, mut visit: impl FnMut(&Pair<'_>)) -> Result<()> {
        self.ode.ensure_thread_data()?;
        self.clear_contacts();
        self.begin_event_steps();
        self.apply_latest_frames();

        let searched = search_pairs(self, None, &mut visit, |data| {
            for (_, space) in self.spaces.iter() {
                // SAFETY: the space is alive; the search guarantees the rest.
                unsafe { dSpaceCollide(space.raw, data, Some(near_callback)) };
            }
            for [first, second] in self.overlooked_pairs() {
                // SAFETY: both are geoms or spaces of this world; the search guarantees the rest.
                unsafe { dSpaceCollide2(first, second, data, Some(near_callback)) };
            }
        });
        self.identify_touchers();
        searched
    }

    /// Collides all pairs and attaches up to `max` contacts with this surface to each, the usual collision step. Pairs
    /// without a body, and pairs of bodies that another joint connects, get none. Contacts with a visual hull in
    /// [`Motion`](crate::hull::Motion) move as the real surface does: see [`Pair::surface_motion`]. Friction with a visual
    /// hull is along the slip, so that it is Coulomb's, where the surface states no direction: see
    /// [`set_slip_friction`](Self::set_slip_friction) for other contacts, and [`Pair::slip_direction`]. Contacts of bodies that
    /// a hull presses from opposite sides are soft: see [`Pair::grip_softness`].
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a surface with NaN or numbers out of range.
    pub fn default_collide(&mut self, surface: &Surface, max: usize) -> Result<()> {
        surface.to_ode()?;
        let (dt, everywhere) = (self.last_dt, self.slip_friction);
        self.collide(|pair| {
            if pair.bodies() == [None, None] || pair.are_connected_excluding_contact() {
                return;
            }
            for contact in pair.contacts(max).iter() {
                let mut surface = pair.surface_at(contact, surface, dt);
                if everywhere && surface.friction_direction.is_none() {
                    surface.friction_direction = pair.slip_direction(contact, dt);
                }
                pair.attach(contact, &surface);
            }
        })
    }

    /// Whether [`default_collide`](Self::default_collide) directs the friction of all contacts along the slip, not only of
    /// those with a visual hull. Off by default, as in ODE.
    pub fn slip_friction(&self) -> bool {
        self.slip_friction
    }

    /// Sets [`slip_friction`](Self::slip_friction). A box that slides over ODE's plane then stops where Coulomb's law says, in
    /// all directions, and one that is pushed along the diagonal of ODE's friction directions begins to move.
    pub fn set_slip_friction(&mut self, everywhere: bool) {
        self.slip_friction = everywhere;
    }

    /// Removes the contacts that the last collide attached.
    pub fn clear_contacts(&mut self) {
        // SAFETY: the group is alive as long as the world, and no record refers to its joints.
        unsafe { dJointGroupEmpty(self.contacts) };
        self.buffers.measured.get_mut().clear();
    }

    /// Up to `max` contacts of two geoms in any spaces, without attaching them.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a geom was removed, and for a pair that ODE cannot collide, see
    /// [`Shape::Heightfield`](super::Shape::Heightfield).
    pub fn collide_geoms(&mut self, first: GeomId, second: GeomId, max: usize) -> Result<Vec<ContactGeom>> {
        self.ode.ensure_thread_data()?;
        let raw = [self.geoms.find(first)?.raw, self.geoms.find(second)?.raw];
        heightfield::check_pair(self, [first, second])?;
        self.apply_latest_frames();
        let found = true_contacts(self, raw, [first, second], max, 0).to_vec();
        panic::resume_parked();
        Ok(found)
    }
}

impl<'c> Pair<'c> {
    /// The ids of the two geoms.
    pub fn geoms(&self) -> [GeomId; 2] {
        self.geoms
    }

    /// Read access to the two geoms.
    pub fn geom_views(&self) -> [Geom<'c>; 2] {
        self.geoms.map(|geom| self.world.geom(geom))
    }

    /// The bodies of the two geoms; `None` for a geom without a body.
    pub fn bodies(&self) -> [Option<BodyId>; 2] {
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        self.raw.map(|geom| unsafe { self.world.body_id(dGeomGetBody(geom)) })
    }

    /// Read access to a body, if it exists in this world.
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

    /// Up to `max` contacts, at most 65 535; at most 1000 of a capsule or cylinder with a triangle mesh.
    pub fn contacts(&self, max: usize) -> Contacts<'c> {
        true_contacts(self.world, self.raw, self.geoms, max, 0)
    }

    /// Whether the two geoms touch. For visual hulls this is faster than computing their contacts.
    pub fn touches(&self) -> bool {
        // ODE's own colliders miss touching boxes with this flag, and read contacts that they have not written.
        let has_hull = self.has_hull();
        // A few, since false ones of heightfields are dropped.
        let (max, flags) = if has_hull { (1, CONTACTS_UNIMPORTANT) } else { (8, 0) };
        !true_contacts(self.world, self.raw, self.geoms, max, flags).is_empty()
    }

    fn has_hull(&self) -> bool {
        self.raw.iter().any(|&geom| self.world.is_hull(geom))
    }

    /// The unit direction in which the first body would slip over the second in the next step without friction, for
    /// [`Surface::friction_direction`]; `None` where it would not. `dt` is the length of the step in seconds, in which gravity
    /// and forces change how the bodies move. The surface of a hull counts as at rest: see
    /// [`surface_motion`](Self::surface_motion) for one that moves.
    ///
    /// ODE limits friction in each of two directions. Where the first one is along the slip, the limit is that of Coulomb's
    /// law; otherwise it is up to 1.4 times as large.
    pub fn slip_direction(&self, contact: &ContactGeom, dt: f64) -> Option<Vector3<f64>> {
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        unsafe { friction_direction(self.raw, &contact.position, &contact.normal.normalize(), dt) }
    }

    /// `surface` with all that a visual hull adds to it at a contact of this pair, as
    /// [`World::default_collide`] does: the motion of the real surface ([`surface_motion`](Self::surface_motion)), the
    /// direction of friction ([`slip_direction`](Self::slip_direction)), and the softness of a grip
    /// ([`grip_softness`](Self::grip_softness)). A friction direction and a softness that it states are kept, and so is all of it
    /// where neither geom is a hull. `dt` is the length of the next step in seconds.
    pub fn surface_at(&self, contact: &ContactGeom, surface: &Surface, dt: f64) -> Surface {
        if !self.has_hull() {
            return *surface;
        }
        let mut found = match self.surface_motion_along(contact, dt, surface.friction_direction) {
            Some(motion) => surface.with_motion(&motion),
            None => *surface,
        };
        found.friction_direction = found.friction_direction.or_else(|| self.slip_direction(contact, dt));
        self.grip_softness(dt).map_or(found, |softness| found.with_softness(softness))
    }

    /// How the real surface moves at a contact of this pair; `None` unless one of its geoms is a visual hull in
    /// [`Motion`](crate::hull::Motion) whose velocity is known there.
    ///
    /// `dt` is the length of the next step in seconds, in which gravity and forces change how the body slips.
    /// [`Surface::with_motion`] hands the result to a contact.
    pub fn surface_motion(&self, contact: &ContactGeom, dt: f64) -> Option<SurfaceMotion> {
        self.surface_motion_along(contact, dt, None)
    }

    /// The softness of this pair's contacts, if one of its geoms is a visual hull that has pressed the other one's body from
    /// opposite sides, as two hands do, in this collide or one of the last twenty; `None` otherwise. It is that of a critically
    /// damped spring of 140 rad/s at the body's mass, and `dt` is the length of the next step in seconds. Ask for it after
    /// [`contacts`](Self::contacts); [`Surface::with_softness`] hands it to a contact.
    ///
    /// As stiff as other contacts, two opposite sides would press a body by thousands of times its weight, and the solver's
    /// errors would move it out from between them.
    pub fn grip_softness(&self, dt: f64) -> Option<Softness> {
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        unsafe { grip_softness(self.raw, dt) }
    }

    fn surface_motion_along(
        &self,
        contact: &ContactGeom,
        dt: f64,
        friction_direction: Option<Vector3<f64>>,
    ) -> Option<SurfaceMotion> {
        let &ContactGeom { position, normal, depth, time, .. } = contact;
        let touching = Touching { position, normal, depth, seconds: time };
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        unsafe { surface_motion(self.raw, &touching, dt, friction_direction) }
    }

    /// Attaches a contact joint between the pair's bodies, which lasts until the next [`collide`](World::collide). A
    /// pair without a body is left alone.
    ///
    /// An invalid contact or surface becomes the error of [`collide`](World::collide).
    pub fn attach(&self, contact: &ContactGeom, surface: &Surface) {
        self.create_contact(contact, surface);
    }

    /// Attaches a contact joint as [`attach`](Self::attach) does, and has the next steps record its forces, which
    /// [`World::contact_feedback`] returns until the contacts are cleared.
    pub fn attach_measured(&self, contact: &ContactGeom, surface: &Surface) {
        if let Some(joint) = self.create_contact(contact, surface) {
            // SAFETY: the joint was just created in the world's group of contacts.
            unsafe { self.world.measure_contact(joint, contact) };
        }
    }

    fn create_contact(&self, contact: &ContactGeom, surface: &Surface) -> Option<dJointID> {
        // SAFETY: both geoms are alive, and so are their bodies.
        let bodies = self.raw.map(|geom| unsafe { dGeomGetBody(geom) });
        if bodies[0].is_null() && bodies[1].is_null() {
            return None;
        }

        // SAFETY: world, group and bodies are alive, and ODE reports no pair of geoms of one body.
        let joint = unsafe { create_contact(self.world.raw, self.world.contacts, bodies, contact, surface) };
        joint
            .map_err(|error| {
                let first = self.first_error.take().unwrap_or(error);
                self.first_error.set(Some(first));
            })
            .ok()
    }
}

impl fmt::Debug for Pair<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Pair").field(&self.geoms[0]).field(&self.geoms[1]).finish()
    }
}

/// Creates a contact joint between two bodies, or between a body and the world (null).
///
/// # Safety
///
/// `world` is alive, `group` is null or alive, and `bodies` are null or alive and of `world`, and not equal.
pub(super) unsafe fn create_contact(
    world: dWorldID,
    group: dJointGroupID,
    bodies: [dBodyID; 2],
    contact: &ContactGeom,
    surface: &Surface,
) -> Result<dJointID> {
    check::point("position of the contact", &contact.position)?;
    check::not_negative("depth of the contact", contact.depth)?;
    let soft_depth = check::not_negative("soft depth", surface.soft_depth)?;
    let length = contact.normal.norm();
    if length.is_nan() || (length - 1.0).abs() > 1e-3 {
        return Err(Error::argument(format!(
            "normal of the contact: expected a unit vector, found length {length}"
        )));
    }

    let geom = dContactGeom {
        pos: convert::ode_vector(&contact.position.coords),
        normal: convert::ode_vector(&contact.normal),
        depth: (contact.depth - soft_depth).max(0.0),
        ..Default::default()
    };
    let contact = dContact {
        surface: surface.to_ode()?,
        geom,
        fdir1: convert::ode_vector(&surface.friction_direction_at(&contact.normal)?),
    };

    // SAFETY: the caller guarantees living objects, and ODE copies the contact.
    unsafe {
        let joint = dJointCreateContact(world, group, &contact);
        dJointAttach(joint, bodies[0], bodies[1]);
        Ok(joint)
    }
}

/// The contacts of two living geoms of `world`, without false ones of heightfields.
fn true_contacts<'c>(
    world: &'c World,
    raw: [dGeomID; 2],
    ids: [GeomId; 2],
    max: usize,
    flags: u32,
) -> Contacts<'c> {
    let mut found = contacts(world, raw, ids, max, flags);
    // SAFETY: both geoms are alive, and `ids` are theirs.
    unsafe { heightfield::drop_false_contacts(world, raw, ids, &mut found) };
    found
}

/// The contacts of two living geoms of `world`, without those whose numbers are not finite.
fn contacts<'c>(
    world: &'c World,
    raw: [dGeomID; 2],
    ids: [GeomId; 2],
    max: usize,
    flags: u32,
) -> Contacts<'c> {
    // SAFETY: both geoms are alive.
    let max = max.min(unsafe { max_contacts(raw) });
    let reused = &world.buffers.contacts;
    let mut points = reused.take();
    points.clear();
    if max > 0 {
        let mut found = world.buffers.raw_contacts.take();
        if found.len() < max {
            found.resize(max, dContactGeom::default());
        }

        let flags = (max as u32 | flags) as i32;
        // SAFETY: both geoms are alive and no spaces, since `GeomId` never names one; the buffer holds `max` contacts.
        let count = unsafe { collide_raw(raw, flags, &mut found) };

        let has_hull = raw.iter().any(|&geom| world.is_hull(geom));
        points.extend(found.iter().take(count).map(|contact| ContactGeom {
            position: convert::point(&contact.pos),
            normal: convert::vector(&contact.normal),
            depth: contact.depth,
            time: if has_hull { contact_seconds(contact) } else { 0.0 },
            geoms: ids,
        }));
        points.retain(|contact| {
            let numbers = contact.position.iter().chain(contact.normal.iter());
            numbers.chain([&contact.depth]).all(|number| number.is_finite())
        });
        world.buffers.raw_contacts.set(found);
    }
    Contacts { points, reused }
}

/// The largest number of contacts to ask ODE for.
///
/// # Safety
///
/// Both geoms are alive.
unsafe fn max_contacts(geoms: [dGeomID; 2]) -> usize {
    // SAFETY: the caller guarantees living geoms.
    let classes = geoms.map(|geom| unsafe { dGeomGetClass(geom) } as u32);
    let takes_stack = |class: &u32| *class == dCapsuleClass || *class == dCylinderClass;
    let is_on_stack = classes.contains(&dTriMeshClass) && classes.iter().any(takes_stack);
    if is_on_stack { MAX_STACK_CONTACTS } else { MAX_CONTACTS }
}

/// Collides two geoms with ODE, writes their contacts to `found`, and returns their number.
///
/// # Safety
///
/// Both geoms are alive, and the low 16 bits of `flags` are neither 0 nor more than the length of `found`.
unsafe fn collide_raw([first, second]: [dGeomID; 2], flags: i32, found: &mut [dContactGeom]) -> usize {
    // SAFETY: the geoms are alive.
    let is_mesh = |geom| unsafe { dGeomGetClass(geom) } == dTriMeshClass as i32;
    let _mesh_cache_guard = (is_mesh(first) || is_mesh(second)).then(|| lock(&MESH_CACHE));
    // SAFETY: the caller guarantees living geoms and enough memory for the contacts, which are adjacent in memory.
    let count =
        unsafe { dCollide(first, second, flags, found.as_mut_ptr(), size_of::<dContactGeom>() as i32) };
    count.max(0) as usize
}
