//! Geometry classes of somebody else's in the same process.

use ode_sys::{dCreateGeomClass, dGeomClass, dGeomID, dInfiniteAABB, dReal};

unsafe extern "C" fn no_box(geom: dGeomID, bounds: *mut dReal) {
    // SAFETY: ODE passes a geom and six numbers.
    unsafe { dInfiniteAABB(geom, bounds) };
}

unsafe extern "C" fn no_collider(_: i32) -> ode_sys::dColliderFn {
    None
}

/// Registers one, while ODE is open. Its number, from 14 on, tells how many there were since ODE was opened.
pub fn register() -> i32 {
    let class =
        dGeomClass { bytes: 8, collider: Some(no_collider), aabb: Some(no_box), aabb_test: None, dtor: None };
    // SAFETY: the structure is whole, and ODE copies it.
    unsafe { dCreateGeomClass(&class) }
}
