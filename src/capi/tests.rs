//! Panics in callbacks and in exported functions.

use super::data_functions::*;
use super::geom_functions::*;
use super::*;
use crate::Result;
use crate::ode::injected_panic;
use ode_sys::{
    dCloseODE, dCollide, dContactGeom, dCreateSphere, dGeomDestroy, dGeomGetAABB, dGeomSetPosition, dInitODE2,
};
use std::ffi::CStr;
use std::ptr::null_mut;

/// This thread's error message.
fn message() -> String {
    // SAFETY: the function returns a C string that is valid until this thread's next call.
    unsafe { CStr::from_ptr(dVisualHullGetErrorMessage()) }.to_string_lossy().into_owned()
}

#[test]
fn a_panic_in_a_callback_gives_no_contact_and_a_message_and_the_next_call_works() {
    // SAFETY: ODE is open, the geoms are destroyed before it closes, and the arrays have the sizes passed to ODE.
    unsafe {
        assert_ne!(dInitODE2(0), 0);
        assert_eq!(dInitVisualHull(), OK);
        let data = dGeomVisualHullDataCreate();
        let (hull, ball) = (dCreateVisualHull(null_mut(), data), dCreateSphere(null_mut(), 1.0));

        // The collider panics once.
        let mut contacts = [dContactGeom::default(); 8];
        let mut collide =
            || dCollide(ball, hull, 8, contacts.as_mut_ptr(), size_of::<dContactGeom>() as c_int);
        injected_panic::inject_panic();
        assert_eq!(collide(), 0);
        assert!(message().contains("a panic injected by a test"), "{}", message());
        assert_eq!(collide(), 0);

        // The callback that computes the bounding box panics.
        injected_panic::inject_panic();
        let mut aabb = [f64::NAN; 6];
        dGeomSetPosition(hull, 1.0, 0.0, 0.0);
        dGeomGetAABB(hull, aabb.as_mut_ptr());
        assert!(aabb.iter().all(|x| x.is_finite()), "{aabb:?}");

        dGeomDestroy(ball);
        dGeomDestroy(hull);
        dGeomVisualHullDataDestroy(data);
        dCloseVisualHull();
        dCloseODE();
    }
}

#[test]
fn a_panic_in_an_exported_function_gives_its_failure_value_and_a_message() {
    fence::keep_quiet();
    assert_eq!(fence::fenced(NONE, || -> Result<c_int> { panic!("in the function") }), NONE);
    for words in ["in the function", "capi/tests.rs", "please report it"] {
        assert!(message().contains(words), "{}", message());
    }
}
