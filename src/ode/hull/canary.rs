//! How this library recognises that ODE still knows its geometry class.
//!
//! ODE forgets all user classes when it closes, and has no getter for that: a number from before may be another library's
//! class by now. But ODE forgets collider overrides together with the classes. So two colliders, the canaries, are
//! registered with the class: if one of them runs, ODE has stayed open since.
//!
//! They are registered for pairs of unbounded, motionless classes, two planes and two heightfields, which ODE does not
//! collide and a program has no reason to. A program may override one of them without harm. If this library is loaded
//! twice, as a shared library and inside a plugin, the copy that comes later replaces the canaries. So a canary answers
//! for all copies: it writes down which copy has registered which class.

use ode_sys::{
    dCollide, dContactGeom, dCreateHeightfield, dCreatePlane, dFirstUserClass, dGeomDestroy,
    dGeomHeightfieldDataCreate, dGeomHeightfieldDataDestroy, dGeomID, dHeightfieldClass, dMaxUserClasses,
    dPlaneClass, dSetColliderOverride,
};
use std::ffi::c_int;
use std::ptr::null_mut;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// For each user class of ODE the copy of this library that has registered it; 0 for others.
type Owners = [u64; dMaxUserClasses as usize];

/// Tells a canary's answer from the colliders of other libraries.
const SIGNATURE: u64 = 0x6f64_655f_6875_6c6c;

/// Two planes in no space, which collide with each other in every query. They are kept for the process, since making them
/// takes longer than the query.
static PLANES: LazyLock<Planes> = LazyLock::new(|| {
    // SAFETY: the planes are in no space; ODE need not be open to make them, and keeps them when it closes.
    Planes([0; 2].map(|_| unsafe { dCreatePlane(null_mut(), 0.0, 0.0, 1.0, 0.0) }))
});

struct Planes([dGeomID; 2]);

// SAFETY: the planes are only collided, which reads them.
unsafe impl Send for Planes {}
// SAFETY: as above.
unsafe impl Sync for Planes {}

/// What this copy's canaries answer.
static OWNERS: [AtomicU64; dMaxUserClasses as usize] =
    [const { AtomicU64::new(0) }; dMaxUserClasses as usize];

/// Registers the canaries together with the class of this number. ODE must be open.
pub(super) fn register(class: c_int) {
    // The classes of other copies, where ODE has stayed open since they were registered.
    let mut owners = query().unwrap_or_default();
    if let Some(owner) = owners.get_mut(index(class)) {
        *owner = this_copy();
    }
    OWNERS.iter().zip(owners).for_each(|(own, owner)| own.store(owner, Ordering::Release));

    for class in [dPlaneClass, dHeightfieldClass] {
        // SAFETY: ODE is open, and the number is one of its own classes.
        unsafe { dSetColliderOverride(class as c_int, class as c_int, Some(answer)) };
    }
}

/// Whether ODE, which must be open, has stayed open since this copy of the library registered the class.
pub(super) fn is_registered(class: c_int) -> bool {
    query().is_some_and(|owners| owners.get(index(class)) == Some(&this_copy()))
}

/// The place of a user class among ODE's.
fn index(class: c_int) -> usize {
    usize::try_from(class - dFirstUserClass as c_int).unwrap_or(usize::MAX)
}

/// A number that no other copy of this library in the process has.
fn this_copy() -> u64 {
    &raw const OWNERS as u64
}

/// The answer of the first canary that still runs.
fn query() -> Option<Owners> {
    // SAFETY: ODE is open, and the planes are never destroyed.
    if let Some(answer) = unsafe { collide(PLANES.0) } {
        return Some(answer);
    }

    // SAFETY: ODE is open; the geoms are in no space, and destroyed here before the data that they refer to.
    unsafe {
        let data = dGeomHeightfieldDataCreate();
        let fields = [0; 2].map(|_| dCreateHeightfield(null_mut(), data, 0));
        let answer = collide(fields);
        fields.into_iter().for_each(|field| dGeomDestroy(field));
        dGeomHeightfieldDataDestroy(data);
        answer
    }
}

/// The answer of the canary for these two geoms, if it runs.
///
/// # Safety
/// The geoms are living, and ODE is open.
unsafe fn collide([first, second]: [dGeomID; 2]) -> Option<Owners> {
    let mut contact = dContactGeom::default();
    // SAFETY: the caller vouches for the geoms; there is memory for the one contact asked for.
    unsafe { dCollide(first, second, 1, &raw mut contact, size_of::<dContactGeom>() as c_int) };
    (contact.depth.to_bits() == SIGNATURE).then(|| contact.pos.map(f64::to_bits))
}

/// The canary: reports no contact, and leaves its answer in the memory of the first.
unsafe extern "C" fn answer(_: dGeomID, _: dGeomID, _: c_int, contact: *mut dContactGeom, _: c_int) -> c_int {
    // SAFETY: ODE passes memory for at least one contact, which its caller does not read where there is none.
    unsafe {
        (*contact).pos = OWNERS.each_ref().map(|owner| f64::from_bits(owner.load(Ordering::Acquire)));
        (*contact).depth = f64::from_bits(SIGNATURE);
    }
    0
}
