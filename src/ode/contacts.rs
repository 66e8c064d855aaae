//! The contact points of two geoms, and the contact joints between their bodies.

use crate::lock::lock;
use std::cell::Cell;
use std::fmt;
use std::ops::Deref;
use std::sync::Mutex;

use nalgebra::{Point3, Vector3};
use ode_sys::{
    dBodyID, dCapsuleClass, dCollide, dContact, dContactGeom, dCylinderClass, dGeomGetClass, dGeomID,
    dJointAttach, dJointCreateContact, dJointGroupID, dJointID, dTriMeshClass, dWorldID,
};

use super::arena::GeomId;
use super::hull::contact_seconds;
use super::surface::Surface;
use super::world::World;
use super::{check, convert, heightfield};
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
pub(super) fn true_contacts<'c>(
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
