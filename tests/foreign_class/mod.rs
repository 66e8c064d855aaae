//! User classes of ODE that another library in the process would register.

use ode_sys::{dCreateGeomClass, dGeomClass, dGeomID, dInfiniteAABB, dReal};

unsafe extern "C" fn no_box(geom: dGeomID, bounds: *mut dReal) {
    // SAFETY: ODE passes a geom and six numbers.
    unsafe { dInfiniteAABB(geom, bounds) };
}

unsafe extern "C" fn no_collider(_: i32) -> ode_sys::dColliderFn {
    None
}

/// Registers a class while ODE is open and returns its number, which is 14 for the first class since ODE was opened.
pub fn register() -> i32 {
    let class =
        dGeomClass { bytes: 8, collider: Some(no_collider), aabb: Some(no_box), aabb_test: None, dtor: None };
    // SAFETY: the structure is whole, and ODE copies it.
    unsafe { dCreateGeomClass(&class) }
}
