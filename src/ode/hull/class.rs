//! The visual hull as a geometry class of ODE: registration and the callbacks that ODE calls.
//!
//! ODE has room for four user classes in a process, cannot remove one, and forgets all of them when it closes. So this
//! crate registers one class, at most once while ODE is open, whether this crate or the program opened it.

use super::collider;
use super::geom::HullGeom;
use crate::lock::lock;
use crate::ode::abort;
use crate::ode::panic::fence;
use crate::{Error, Result};
use ode_sys::{
    dCollide, dColliderFn, dContactGeom, dCreateGeomClass, dCreateRay, dGeomClass, dGeomDestroy,
    dGeomGetClass, dGeomGetClassData, dGeomID, dPlaneClass, dRayClass, dReal, dSetColliderOverride,
};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ffi::c_int;
use std::mem::size_of;
use std::ptr::{null, null_mut};
use std::sync::{Arc, Mutex};

/// What ODE keeps in a geom of the class: the geom's data, which `HULL_GEOMS` owns, or null before it is filled in.
type ClassData = *const HullGeom;

/// The number under which the class was registered last.
static NUMBER: Mutex<Option<c_int>> = Mutex::new(None);

/// All living hull geoms by their addresses, which are not followed here: another thread may be about to destroy one.
static HULL_GEOMS: Mutex<BTreeMap<usize, Arc<HullGeom>>> = Mutex::new(BTreeMap::new());

thread_local! {
    static CANARY_RAN: Cell<bool> = const { Cell::new(false) };
}

/// The class's number. Registers the class where ODE does not know it. ODE must be open.
///
/// # Errors
/// All four user classes are taken by other libraries.
pub(super) fn number() -> Result<c_int> {
    let mut number = lock(&NUMBER);
    if let Some(known) = *number
        && is_still_registered()
    {
        return Ok(known);
    }

    let class = dGeomClass {
        bytes: size_of::<ClassData>() as c_int,
        collider: Some(collider),
        aabb: Some(aabb),
        aabb_test: None,
        dtor: Some(destroy),
    };
    // SAFETY: ODE is open, copies the class, and the callbacks live as long as the process; a full table is refused
    // before anything changes.
    let fresh = unsafe { abort::guarded(|| dCreateGeomClass(&raw const class)) };
    let fresh = fresh.map_err(|message| {
        Error::Ode(format!(
            "expected room for one more user class, found all four taken ({message}); register fewer classes in this \
             process"
        ))
    })?;
    // SAFETY: both numbers are ODE's own; two rays never touch, so that no other library collides the pair.
    unsafe { dSetColliderOverride(dRayClass as c_int, dRayClass as c_int, Some(canary_collider)) };
    *number = Some(fresh);
    Ok(fresh)
}

/// Whether ODE, which must be open, has stayed open since the class was registered.
///
/// ODE has no getter for that, and a stale class number may be another library's class by now. But ODE forgets collider
/// overrides together with its classes: if the one between two rays, a pair that never collides, still runs, then the
/// class is registered too.
pub(super) fn is_still_registered() -> bool {
    CANARY_RAN.set(false);
    // SAFETY: ODE is open; the rays are in no space and destroyed here; the buffer holds the one contact asked for.
    unsafe {
        let (one, other) = (dCreateRay(null_mut(), 1.0), dCreateRay(null_mut(), 1.0));
        let mut contact: dContactGeom = std::mem::zeroed();
        dCollide(one, other, 1, &raw mut contact, size_of::<dContactGeom>() as c_int);
        dGeomDestroy(one);
        dGeomDestroy(other);
    }
    CANARY_RAN.get()
}

extern "C" fn canary_collider(_: dGeomID, _: dGeomID, _: c_int, _: *mut dContactGeom, _: c_int) -> c_int {
    CANARY_RAN.set(true);
    0
}

/// Binds `data` to a new geom of the class, which owns it from here on.
///
/// # Safety
/// `geom` is a living geom of the class without data.
pub(super) unsafe fn give_data(geom: dGeomID, data: HullGeom) {
    let data = Arc::new(data);
    // SAFETY: the caller vouches for the geom's class, whose data is one pointer.
    unsafe { *dGeomGetClassData(geom).cast::<ClassData>() = Arc::as_ptr(&data) };
    lock(&HULL_GEOMS).insert(geom as usize, data);
}

/// The data of the hull geom that lives at this address, which is not followed.
pub(super) fn find(geom: dGeomID) -> Option<Arc<HullGeom>> {
    lock(&HULL_GEOMS).get(&(geom as usize)).cloned()
}

/// All hull geoms of the process, in the order of their addresses.
pub(super) fn all() -> Vec<(dGeomID, Arc<HullGeom>)> {
    lock(&HULL_GEOMS).iter().map(|(&geom, data)| (geom as dGeomID, data.clone())).collect()
}

/// The data of a geom; `None` where it is not of the class.
///
/// # Safety
/// `geom` is a living geom, and lives as long as `'a`.
pub(super) unsafe fn data<'a>(geom: dGeomID) -> Option<&'a HullGeom> {
    let number = *lock(&NUMBER);
    // SAFETY: the class is checked first, since ODE aborts on a geom without class data.
    unsafe {
        if geom.is_null() || Some(dGeomGetClass(geom)) != number {
            return None;
        }
        (*dGeomGetClassData(geom).cast::<ClassData>()).as_ref()
    }
}

/// The collider of a pair of classes, which ODE looks up once. A hull collides with all classes but itself and planes,
/// which are unbounded and cannot be sampled.
extern "C" fn collider(other: c_int) -> dColliderFn {
    let own = *lock(&NUMBER);
    if other == dPlaneClass as c_int || Some(other) == own {
        None
    } else if other == dRayClass as c_int {
        Some(collide_ray)
    } else {
        Some(collide_body)
    }
}

extern "C" fn collide_body(
    hull: dGeomID,
    body: dGeomID,
    flags: c_int,
    contacts: *mut dContactGeom,
    skip: c_int,
) -> c_int {
    // SAFETY: ODE passes living geoms, the hull first, since it dispatches by class number. There is room for as many
    // contacts as the low 16 bits of `flags` say, `skip` bytes apart.
    fence(0, || unsafe {
        #[cfg(test)]
        crate::ode::injected_panic::panic_if_injected();
        data(hull).map_or(0, |geom| collider::collide_body(geom, hull, body, flags, contacts, skip))
    })
}

extern "C" fn collide_ray(
    hull: dGeomID,
    ray: dGeomID,
    flags: c_int,
    contacts: *mut dContactGeom,
    skip: c_int,
) -> c_int {
    let _ = (flags, skip);
    // SAFETY: as in `collide_body`; ODE asks for at least one contact.
    fence(0, || unsafe { data(hull).map_or(0, |geom| collider::collide_ray(geom, hull, ray, contacts)) })
}

/// The box of a hull geom in ODE's order: min x, max x, min y, max y, min z, max z. Never NaN, on which a hash space
/// aborts.
extern "C" fn aabb(geom: dGeomID, into: *mut dReal) {
    let bounds = fence([0.0; 6], || {
        #[cfg(test)]
        crate::ode::injected_panic::panic_if_injected();
        // SAFETY: ODE passes a living geom of the class; its data may not be filled in yet.
        unsafe { data(geom).map_or([0.0; 6], |hull| hull.world_aabb(geom)) }
    });
    // SAFETY: ODE passes room for six numbers.
    unsafe { into.cast::<[dReal; 6]>().write(bounds) };
}

extern "C" fn destroy(geom: dGeomID) {
    fence((), || {
        // SAFETY: ODE passes a living geom of the class, once, while its data can still be reached.
        unsafe { *dGeomGetClassData(geom).cast::<ClassData>() = null() };
        // Outside the lock, since it may free a data object with all its frames.
        let data = lock(&HULL_GEOMS).remove(&(geom as usize));
        drop(data);
    });
}
