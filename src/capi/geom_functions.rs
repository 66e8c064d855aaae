//! The functions on hulls, on contacts and on the bodies that hulls collide with.

use super::arguments::{finite_point, not_null, step_size, vectors, write_vector};
use super::data::{self, DataId};
use super::event::dVisualHullEvent;
use super::fence::fenced;
use super::{FAILED, NONE, OK, arguments};
use crate::contact::Mode;
use crate::hull::Motion;
use crate::ode::{self, RawHull, Swept};
use crate::{Error, sample};
use nalgebra::Point3;
use ode_sys::{dContact, dContactGeom, dGeomID, dReal, dSpaceID};
use std::ffi::c_int;

/// # Safety
/// `space` is NULL or a living space that is not being collided.
#[unsafe(no_mangle)]
pub(super) unsafe extern "C" fn dCreateVisualHull(space: dSpaceID, d: DataId) -> dGeomID {
    fenced(std::ptr::null_mut(), || {
        let data = data::get(d)?;
        // SAFETY: the caller guarantees a living space or NULL.
        unsafe { ode::create_hull_in(space, data) }
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullUpdate(g: dGeomID) -> c_int {
    fenced(FAILED, || {
        let hull = RawHull::find(g)?;
        // SAFETY: the header requires a call between two collides, on the thread that steps the geom's world.
        unsafe { hull.apply_latest_frame() };
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetData(g: dGeomID, d: DataId) {
    fenced((), || {
        let (hull, data) = (RawHull::find(g)?, data::get(d)?);
        hull.set_data(data.clone());
        // SAFETY: the header requires a call between two collides.
        unsafe { ode::apply_latest_frame_everywhere(&data) };
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullGetData(g: dGeomID) -> DataId {
    fenced(std::ptr::null_mut(), || Ok(data::id_of(&RawHull::find(g)?.data())))
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMotion(g: dGeomID, mode: c_int) {
    fenced((), || {
        let motion = match mode {
            0 => Motion::Held,
            1 => Motion::Interpolated,
            2 => Motion::Predicted,
            _ => return Err(Error::argument(format!("mode: expected dVisualHullMotion..., found {mode}"))),
        };
        RawHull::find(g)?.set_motion(motion);
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetTime(g: dGeomID, time: dReal) -> c_int {
    fenced(FAILED, || {
        let hull = RawHull::find(g)?;
        // SAFETY: the header requires a call between two collides, on the thread that steps the geom's world.
        unsafe { hull.set_time(time) }?;
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetSwept(g: dGeomID, mode: c_int) {
    fenced((), || {
        let swept = match mode {
            0 => Swept::Off,
            1 => Swept::BroadPhase,
            2 => Swept::On,
            _ => return Err(Error::argument(format!("mode: expected dVisualHullSwept..., found {mode}"))),
        };
        RawHull::find(g)?.set_swept(swept);
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullHold(g: dGeomID, on: c_int) -> c_int {
    fenced(FAILED, || {
        RawHull::find(g)?.hold(on != 0);
        Ok(OK)
    })
}

/// # Safety
/// `contact` is NULL or points to a contact, whose geoms are NULL or living.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullContactTime(contact: *const dContactGeom) -> dReal {
    fenced(f64::from(NONE), || {
        // SAFETY: the caller guarantees a contact.
        let contact = unsafe { contact.as_ref() };
        let contact = contact
            .ok_or_else(|| Error::argument("contact: expected one that dCollide has filled, found NULL"))?;
        Ok(ode::contact_seconds(contact))
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullPointInside(g: dGeomID, x: dReal, y: dReal, z: dReal) -> c_int {
    fenced(NONE, || Ok(c_int::from(RawHull::find(g)?.inside(&Point3::new(x, y, z)))))
}

/// # Safety
/// `w` is NULL or points to writable memory for three numbers.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullPointResponse(
    g: dGeomID,
    x: dReal,
    y: dReal,
    z: dReal,
    w: *mut dReal,
) -> c_int {
    fenced(NONE, || {
        let response = RawHull::find(g)?.point_response(&Point3::new(x, y, z));
        // SAFETY: the caller guarantees memory for the vector.
        unsafe { write_vector(response.unwrap_or_default(), w, "w") }?;
        Ok(c_int::from(response.is_some()))
    })
}

/// # Safety
/// `v` is NULL or points to writable memory for three numbers.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullPointVelocity(
    g: dGeomID,
    x: dReal,
    y: dReal,
    z: dReal,
    v: *mut dReal,
) -> c_int {
    fenced(NONE, || {
        let velocity = RawHull::find(g)?.point_velocity(&finite_point(x, y, z)?);
        // SAFETY: the caller guarantees memory for the vector.
        unsafe { write_vector(velocity.unwrap_or_default(), v, "v") }?;
        Ok(c_int::from(velocity.is_some()))
    })
}

/// # Safety
/// `body` is NULL or a living geom, and `v` is NULL or points to writable memory for three numbers.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullBodyResponse(g: dGeomID, body: dGeomID, v: *mut dReal) -> c_int {
    fenced(NONE, || {
        let hull = RawHull::find(g)?;
        not_null(body, "body")?;
        // SAFETY: the caller guarantees a living geom and memory for the vector.
        unsafe {
            let response = hull.body_response(body)?;
            write_vector(response.vector, v, "v")?;
            Ok(response.colliding as c_int)
        }
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetContactMode(g: dGeomID, mode: c_int) {
    fenced((), || {
        let mode = match mode {
            0 => Mode::Clustered,
            1 => Mode::Paper,
            2 => Mode::Point,
            3 => Mode::Single,
            _ => return Err(Error::argument(format!("mode: expected dVisualHullContacts..., found {mode}"))),
        };
        RawHull::find(g)?.set_mode(mode);
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMaxContacts(g: dGeomID, n: c_int) {
    fenced((), || RawHull::find(g)?.set_max_contacts(arguments::count(n, c_int::MAX, "n")?));
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMaxDepth(g: dGeomID, depth: dReal) {
    fenced((), || RawHull::find(g)?.set_max_depth(depth));
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMinFeature(g: dGeomID, diameter: dReal) {
    fenced((), || RawHull::find(g)?.set_min_feature(diameter));
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetEvents(g: dGeomID, on: c_int) {
    fenced((), || {
        RawHull::find(g)?.set_events(on != 0);
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetEventWait(g: dGeomID, seconds: dReal) {
    fenced((), || RawHull::find(g)?.set_event_wait(seconds));
}

/// # Safety
/// `events` is NULL or points to writable memory for `size` events.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullGetEvents(
    g: dGeomID,
    events: *mut dVisualHullEvent,
    size: c_int,
) -> c_int {
    fenced(NONE, || {
        let (hull, size) = (RawHull::find(g)?, arguments::count(size, c_int::MAX, "size")?);
        if events.is_null() && size > 0 {
            return Err(Error::argument(format!(
                "events: expected memory for {size} events, found NULL; pass a size of 0 to count those that wait"
            )));
        }

        let mut written = 0;
        let waiting = hull.fetch_events(size, |event| {
            // SAFETY: the caller guarantees memory for `size` events, and no more are fetched.
            unsafe { events.add(written).write(event.into()) };
            written += 1;
        })?;
        Ok(if size == 0 { waiting } else { written } as c_int)
    })
}

/// # Safety
/// `contact` is NULL or points to a contact, whose geoms are NULL or living.
#[unsafe(no_mangle)]
unsafe extern "C" fn dVisualHullSetContactMotion(contact: *mut dContact, stepsize: dReal) -> c_int {
    fenced(NONE, || {
        let stepsize = step_size(stepsize)?;
        // SAFETY: the caller guarantees a contact and its geoms; the body of a living geom is living.
        unsafe {
            let contact = arguments::contact(contact)?;
            Ok(c_int::from(ode::set_contact_motion(contact, stepsize)))
        }
    })
}

/// # Safety
/// `contact` is NULL or points to a contact, whose geoms are NULL or living.
#[unsafe(no_mangle)]
unsafe extern "C" fn dVisualHullSetContactFriction(contact: *mut dContact, stepsize: dReal) -> c_int {
    fenced(NONE, || {
        let stepsize = step_size(stepsize)?;
        // SAFETY: the caller guarantees a contact and its geoms; the body of a living geom is living.
        unsafe {
            let contact = arguments::contact(contact)?;
            Ok(c_int::from(ode::set_contact_friction(contact, stepsize)))
        }
    })
}

/// # Safety
/// `body` is NULL or a living geom; `points`, and `normals` where it is not NULL, are `count` vectors of three
/// numbers, `stride` bytes apart.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullSetSamples(
    body: dGeomID,
    points: *const dReal,
    normals: *const dReal,
    count: c_int,
    stride: c_int,
) -> c_int {
    fenced(FAILED, || {
        not_null(body, "body")?;
        let count = arguments::count(count, sample::MAX_SAMPLES as c_int, "count")?;

        // SAFETY: the caller guarantees the arrays and a living geom.
        unsafe {
            let points: Vec<Point3<f64>> =
                vectors(points, count, stride, "points")?.into_iter().map(Point3::from).collect();
            // Without normals every sample can carry a contact, whatever its direction.
            let normals =
                if normals.is_null() { None } else { Some(vectors(normals, count, stride, "normals")?) };
            ode::set_samples(body, sample::from_points(&points, normals.as_deref())?);
        }
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullClearSamples(body: dGeomID) {
    fenced((), || {
        ode::clear_samples(body);
        Ok(())
    });
}
