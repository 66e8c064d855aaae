//! The visual hull as a geometry class of ODE: registration and the callbacks that ODE calls.
//!
//! ODE has room for four user classes in a process, cannot remove one, and forgets all of them when it closes. So this
//! crate registers one class, at most once while ODE is open, whether this crate or the program opened it.

use super::geom::HullGeom;
use super::{canary, collider};
use crate::lock::lock;
use crate::ode::abort;
use crate::ode::init;
use crate::ode::panic::fence;
use crate::{Error, Result};
use ode_sys::{
    dColliderFn, dContactGeom, dCreateGeomClass, dGeomClass, dGeomGetClass, dGeomGetClassData, dGeomID,
    dPlaneClass, dRayClass, dReal,
};
use std::collections::BTreeMap;
use std::ffi::c_int;
use std::mem::size_of;
use std::ptr::null;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// What ODE keeps in a geom of the class.
#[repr(C)]
struct ClassData {
    /// The geom's data, which `HULL_GEOMS` owns; null before it is filled in.
    geom: *const HullGeom,
    /// The registration under which the geom was made.
    registration: Registration,
}

/// A registration of the class in ODE: the class's number in the low byte, and above it a count of the registrations of
/// this process, which tells geoms of this one from older ones.
type Registration = u64;

/// The registration that is in force, as far as this library knows; 0 for none.
static REGISTRATION: AtomicU64 = AtomicU64::new(0);

/// The registration in force, and its class number.
fn registration() -> Option<(Registration, c_int)> {
    match REGISTRATION.load(Ordering::Acquire) {
        0 => None,
        registration => Some((registration, (registration & 0xff) as c_int)),
    }
}

/// All living hull geoms by their addresses, which are not followed here: another thread may be about to destroy one.
static HULL_GEOMS: Mutex<BTreeMap<usize, Arc<HullGeom>>> = Mutex::new(BTreeMap::new());

/// The class's number. Registers the class where ODE does not know it. ODE must be open.
///
/// # Errors
/// All four user classes are taken by other libraries.
pub(super) fn number() -> Result<c_int> {
    static COUNT: Mutex<u64> = Mutex::new(0);
    let mut count = lock(&COUNT);
    if is_still_registered()
        && let Some((_, number)) = registration()
    {
        return Ok(number);
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
    let number = fresh.map_err(|message| {
        Error::Ode(format!(
            "expected room for one more user class, found all four taken ({message}); register fewer classes in this \
             process"
        ))
    })?;

    canary::register(number);
    *count += 1;
    REGISTRATION.store(*count << 8 | number as u64, Ordering::Release);
    Ok(number)
}

/// Whether ODE still knows the class. Where it was closed since the class was registered, all geoms of the class are
/// forgotten: ODE no longer reports when they are destroyed.
pub(super) fn is_still_registered() -> bool {
    let Some((_, number)) = registration() else { return false };

    let is_registered = init::with_ode_open(|| canary::is_registered(number)).unwrap_or(false);
    if !is_registered {
        REGISTRATION.store(0, Ordering::Release);
        // Outside the lock, since this may free data objects with all their frames.
        let forgotten = std::mem::take(&mut *lock(&HULL_GEOMS));
        drop(forgotten);
    }
    is_registered
}

/// Binds `data` to a new geom of the class, which owns it from here on.
///
/// # Safety
/// `geom` is a living geom of the class without data.
pub(super) unsafe fn give_data(geom: dGeomID, data: HullGeom) {
    let data = Arc::new(data);
    let registration = REGISTRATION.load(Ordering::Acquire);
    // SAFETY: the caller vouches for the geom's class, whose data is of this type.
    unsafe {
        dGeomGetClassData(geom)
            .cast::<ClassData>()
            .write(ClassData { geom: Arc::as_ptr(&data), registration });
    }
    lock(&HULL_GEOMS).insert(geom as usize, data);
}

/// The data of the hull geom that lives at this address, which is not followed.
pub(super) fn find(geom: dGeomID) -> Option<Arc<HullGeom>> {
    lock(&HULL_GEOMS).get(&(geom as usize)).cloned()
}

/// As [`find`], for an address that a program has passed: ODE may have been closed since.
pub(super) fn find_current(geom: dGeomID) -> Option<Arc<HullGeom>> {
    if is_still_registered() { find(geom) } else { None }
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
    let (in_force, number) = registration()?;
    // SAFETY: the class is checked first, since ODE aborts on a geom without class data. A geom of an older registration
    // is not followed, since its data was dropped.
    unsafe {
        if geom.is_null() || dGeomGetClass(geom) != number {
            return None;
        }
        let ClassData { geom: data, registration } = dGeomGetClassData(geom).cast::<ClassData>().read();
        if registration == in_force { data.as_ref() } else { None }
    }
}

/// The collider of a pair of classes, which ODE looks up once. A hull collides with all classes but itself and planes,
/// which are unbounded and cannot be sampled.
extern "C" fn collider(other: c_int) -> dColliderFn {
    let own = registration().map(|(_, number)| number);
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
        unsafe { (*dGeomGetClassData(geom).cast::<ClassData>()).geom = null() };
        // Outside the lock, since it may free a data object with all its frames.
        let data = lock(&HULL_GEOMS).remove(&(geom as usize));
        drop(data);
    });
}
