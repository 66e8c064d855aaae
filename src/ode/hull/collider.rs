//! The collider of the class: a hull against a body's samples, and against a ray.

use super::contact_time::{TOUCHES, side_of};
use super::geom::{self, HullGeom};
use super::prefetch;
use super::query::ContactQuery;
use super::wake::{self, CollidedBody};
use crate::camera::Ray;
use crate::contact::{self, BodyContacts, Contact, SweptContact};
use crate::ode::convert;
use crate::recycle::{keep_scratch, take_scratch};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{
    CONTACTS_UNIMPORTANT, dContactGeom, dGeomID, dGeomRayGet, dGeomRayGetBackfaceCull, dGeomRayGetLength,
};
use std::cell::Cell;
use std::ffi::c_int;

/// The low bits of a collider's flags: how many contacts the caller has room for.
const CONTACT_CAPACITY_MASK: u32 = 0xffff;

thread_local! {
    /// Memory for the contacts of one pair at a time.
    static SCRATCH: Cell<Option<BodyContacts>> = const { Cell::new(None) };
    static SWEPT: Cell<Option<Vec<SweptContact>>> = const { Cell::new(None) };
}

/// Writes the contacts of the geom `hull`, whose data is `geom`, with the geom `other`; returns how many there are.
///
/// # Safety
/// Both geoms are living, and `contacts` has room for as many contacts as the low 16 bits of `flags` say, `skip`
/// bytes apart.
pub(super) unsafe fn collide_body(
    geom: &HullGeom,
    hull: dGeomID,
    other: dGeomID,
    flags: c_int,
    contacts: *mut dContactGeom,
    skip: c_int,
) -> c_int {
    // SAFETY: the caller vouches for the geom.
    let Some(mut context) = (unsafe { geom.start_collide(hull) }) else { return 0 };
    let flags = flags as u32;
    let capacity = (flags & CONTACT_CAPACITY_MASK) as usize;
    context.settings.max_contacts = context.settings.max_contacts.min(capacity);

    // SAFETY: the caller vouches for the geom.
    if unsafe { context.carry(other) } {
        // SAFETY: as above.
        unsafe { context.record_held(other) };
        return 0;
    }

    // SAFETY: as above.
    let query = match unsafe { ContactQuery::new(other, &context) } {
        Ok(Some(query)) => query,
        Ok(None) => return 0,
        Err(error) => {
            geom.record_error(error);
            return 0;
        }
    };

    let (hull_from_other, mut found) = (query.stamp.hull_from_other, take_scratch(&SCRATCH));
    let mut swept: Vec<SweptContact> = take_scratch(&SWEPT);
    swept.clear();
    if flags & CONTACTS_UNIMPORTANT != 0 {
        let hull = context.hull_for(query.other);
        contact::collide_any(&mut found, hull, &query.samples, &hull_from_other, &context.settings);
    } else {
        // SAFETY: the caller vouches for the geoms, and ODE for those in the spaces that it collides.
        unsafe {
            prefetch::contacts_for(&geom.prefetch, &context, other, &query, &mut found);
            let kept_loss = context.keep_lost_views(&query, &mut found);
            let collided =
                CollidedBody { geom: other, samples: &query.samples, hull_from_body: hull_from_other };
            wake::record_contacts(&context, &collided, &found, kept_loss);
            if context.grab(other, &found) {
                context.record_touch(hull, other, &found, &swept);
                keep_scratch(&SCRATCH, found);
                keep_scratch(&SWEPT, swept);
                return 0;
            }
            context.limit_depths(hull, other, &mut found);
            let (touches, most) = (!found.points.is_empty(), capacity - found.points.len());
            context.sweep(hull, other, &query, (touches, most), &mut swept);
        }
    }

    // SAFETY: the caller vouches for the geoms, and ODE for their bodies.
    unsafe { context.record_touch(hull, other, &found, &swept) };
    let world_from_hull = context.hull_from_world.inverse();
    let to_come = swept.iter().map(|&SweptContact { point, direction, seconds, .. }| {
        (Contact { point, direction, depth: 0.0 }, side_of(seconds))
    });
    let all = found.contacts().map(|contact| (contact, TOUCHES)).chain(to_come);
    for (k, (contact, side)) in all.enumerate() {
        let contact = in_ode_terms(&contact, side, &world_from_hull, [hull, other]);
        // SAFETY: k is below the room that the caller vouches for.
        unsafe { contacts.byte_add(k * skip as usize).write(contact) };
    }
    let count = found.points.len() + swept.len();
    keep_scratch(&SCRATCH, found);
    keep_scratch(&SWEPT, swept);
    count as c_int
}

/// ODE's convention: the normal points into geom 1, which is the hull, so it is minus the exit direction.
fn in_ode_terms(
    contact: &Contact,
    side: i32,
    world_from_hull: &Isometry3<f64>,
    [hull, other]: [dGeomID; 2],
) -> dContactGeom {
    let pos = world_from_hull * contact.point;
    let normal = world_from_hull * -contact.direction;
    dContactGeom {
        pos: convert::ode_vector(&pos.coords),
        normal: convert::ode_vector(&normal),
        depth: contact.depth,
        g1: hull,
        g2: other,
        side1: side,
        side2: TOUCHES,
    }
}

/// Writes where the ray geom `ray` meets the geom `hull`, whose data is `geom`: at most one contact, its depth the distance
/// along the ray in metres.
///
/// As for ODE's own shapes it is the first surface that the ray crosses, with the normal towards the ray's start. For
/// (hull, ray) the sign is the opposite, since the normal points into geom 1.
///
/// # Safety
/// Both geoms are living, `ray` is a ray, and `contacts` has room for one contact.
pub(super) unsafe fn collide_ray(
    geom: &HullGeom,
    hull: dGeomID,
    ray: dGeomID,
    contacts: *mut dContactGeom,
) -> c_int {
    let Some(frame) = geom.hull() else { return 0 };
    let (mut start, mut direction) = ([0.0; 4], [0.0; 4]);
    // SAFETY: the caller vouches for the geoms; both arrays hold four numbers.
    let (world_from_hull, length, is_culled) = unsafe {
        dGeomRayGet(ray, start.as_mut_ptr(), direction.as_mut_ptr());
        (geom::pose(hull), dGeomRayGetLength(ray), dGeomRayGetBackfaceCull(ray) != 0)
    };

    let (start, direction) = (Point3::from(convert::vector(&start)), convert::vector(&direction));
    let hull_from_world = world_from_hull.inverse();
    let in_hull = Ray { origin: hull_from_world * start, direction: hull_from_world * direction };
    let Some((entry, exit)) = frame.ray_cast(&in_hull) else { return 0 };
    let starts_inside = entry.is_none();
    let hit = entry.unwrap_or(exit);
    if hit.t > length || (starts_inside && is_culled) {
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
