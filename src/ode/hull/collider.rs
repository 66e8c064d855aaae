//! The collider of the class: a hull against a body's samples, and against a ray.

use super::class;
use super::geom::{self, HullGeom};
use super::prefetch::{self, InForce, Question};
use crate::camera::Ray;
use crate::contact::{self, BodyContacts, Contact};
use crate::hull::Hull;
use crate::ode::convert;
use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{
    CONTACTS_UNIMPORTANT, dBodyEnable, dBodyIsEnabled, dContactGeom, dGeomGetBody, dGeomID, dGeomRayGet,
    dGeomRayGetBackfaceCull, dGeomRayGetLength,
};
use std::cell::Cell;
use std::ffi::c_int;

/// The low bits of a collider's flags: how many contacts the caller has room for.
const ROOM: u32 = 0xffff;

thread_local! {
    /// Memory for the contacts of one pair at a time.
    static SPARE: Cell<BodyContacts> =
        const { Cell::new(BodyContacts { manifolds: Vec::new(), points: Vec::new(), escape: None }) };
}

/// Contacts of hull geom `hull` with `other`; returns their number.
///
/// # Safety
/// Both geoms are living, and `contacts` has room for as many contacts as the low 16 bits of `flags` say, `skip`
/// bytes apart.
pub(super) unsafe fn collide_body(
    hull: dGeomID,
    other: dGeomID,
    flags: c_int,
    contacts: *mut dContactGeom,
    skip: c_int,
) -> c_int {
    // SAFETY: the caller vouches for both geoms.
    let (geom, hull_from_world) = unsafe {
        let Some(geom) = class::data(hull) else { return 0 };
        (geom, geom::pose(hull).inverse())
    };
    let Some(mut now) = geom.begin() else { return 0 };
    let flags = flags as u32;
    now.settings.max_contacts = now.settings.max_contacts.min((flags & ROOM) as usize);
    let in_force = InForce { geom, now: &now, hull_from_world: &hull_from_world };
    // SAFETY: as above.
    let question = match unsafe { Question::of(other, &in_force) } {
        Ok(Some(question)) => question,
        Ok(None) => return 0,
        Err(error) => {
            geom.record_error(error);
            return 0;
        }
    };
    let (hull_from_other, mut found) = (question.when.hull_from_other, SPARE.take());
    if flags & CONTACTS_UNIMPORTANT != 0 {
        contact::collide_any(&mut found, &now.hull, &question.samples, &hull_from_other, &now.settings);
    } else {
        // SAFETY: the caller vouches for the geoms, and ODE for those in the spaces that it collides.
        unsafe {
            prefetch::answer(&in_force, other, question, &mut found);
            wake(geom, other, &now.hull, &found, &hull_from_other);
        }
    }
    let world_from_hull = hull_from_world.inverse();
    for (k, contact) in found.contacts().enumerate() {
        // SAFETY: k is below the room that the caller vouches for.
        unsafe {
            contacts.byte_add(k * skip as usize).write(in_ode_terms(&contact, &world_from_hull, hull, other))
        };
    }
    let count = found.points.len();
    SPARE.set(found);
    count as c_int
}

/// Wakes the body of `other` where it sleeps and the hull at it has changed: ODE wakes a body only through an enabled
/// one. The body is the one that ODE names now, not one remembered.
///
/// # Safety
/// `other` is a living geom.
unsafe fn wake(
    geom: &HullGeom,
    other: dGeomID,
    frame: &Hull,
    found: &BodyContacts,
    hull_from_other: &Isometry3<f64>,
) {
    // SAFETY: the caller vouches for the geom, and ODE for its body.
    let body = unsafe { dGeomGetBody(other) };
    // SAFETY: as above.
    let asleep = !body.is_null() && unsafe { dBodyIsEnabled(body) } == 0;
    let depth = found.points.iter().map(|point| point.depth).reduce(f64::max);
    let pixel = frame.pixel_size(&Point3::from(hull_from_other.translation.vector));
    if geom.finish(other as usize, asleep, depth, found.escape, pixel) {
        // SAFETY: as above; it sets flags of the body and touches no space.
        unsafe { dBodyEnable(body) };
    }
}

/// ODE's convention: the normal points into geom 1, which is the hull, so it is minus the way out.
fn in_ode_terms(
    contact: &Contact,
    world_from_hull: &Isometry3<f64>,
    hull: dGeomID,
    other: dGeomID,
) -> dContactGeom {
    let pos = world_from_hull * contact.point;
    let normal = world_from_hull * -contact.direction;
    dContactGeom {
        pos: convert::ode_vector(&pos.coords),
        normal: convert::ode_vector(&normal),
        depth: contact.depth,
        g1: hull,
        g2: other,
        side1: -1,
        side2: -1,
    }
}

/// Where ray geom `ray` meets hull geom `hull`: at most one contact, its depth the distance along the ray.
///
/// As ODE's own shapes answer: the first surface that the ray crosses, its normal towards the ray's start. For
/// (hull, ray) the sign is the opposite, since the normal points into geom 1.
///
/// # Safety
/// Both geoms are living, `ray` is a ray, and `contacts` has room for one contact.
pub(super) unsafe fn collide_ray(hull: dGeomID, ray: dGeomID, contacts: *mut dContactGeom) -> c_int {
    // SAFETY: the caller vouches for the geoms; both arrays hold four numbers.
    let (frame, world_from_hull, start, direction, length, cull) = unsafe {
        let Some(frame) = class::data(hull).and_then(HullGeom::hull) else { return 0 };
        let (mut start, mut direction) = ([0.0; 4], [0.0; 4]);
        dGeomRayGet(ray, start.as_mut_ptr(), direction.as_mut_ptr());
        let cull = dGeomRayGetBackfaceCull(ray) != 0;
        (frame, geom::pose(hull), start, direction, dGeomRayGetLength(ray), cull)
    };
    let (start, direction) = (Point3::from(convert::vector(&start)), convert::vector(&direction));
    let hull_from_world = world_from_hull.inverse();
    let in_hull = Ray { origin: hull_from_world * start, direction: hull_from_world * direction };
    let Some((entry, exit)) = frame.ray_cast(&in_hull) else { return 0 };
    let starts_inside = entry.is_none();
    let hit = entry.unwrap_or(exit);
    if hit.t > length || (starts_inside && cull) {
        return 0;
    }
    let towards_start: Vector3<f64> = if starts_inside { -hit.normal } else { hit.normal };
    let contact = dContactGeom {
        pos: convert::ode_vector(&(start + direction * hit.t).coords),
        normal: convert::ode_vector(&(world_from_hull * -towards_start)),
        depth: hit.t,
        g1: hull,
        g2: ray,
        side1: -1,
        side2: -1,
    };
    // SAFETY: the caller vouches for room for one.
    unsafe { contacts.write(contact) };
    1
}

#[cfg(test)]
mod tests;
