//! The exported C functions, in the order of `include/ode_visual_hull.h`, which documents them.
//!
//! Each function runs in `fenced`: an error, or a panic in this library, becomes the thread's message and the
//! function's failure value. Ids of data objects and of hulls are looked up in tables and never dereferenced. The
//! caller guarantees that arrays, other geoms and spaces are valid, as for all of ODE.

#![allow(unsafe_code)]

mod arguments;
mod data;
mod data_functions;
mod event;
mod fence;
mod geom_functions;
#[cfg(test)]
mod tests;

use crate::ode;
use fence::fenced;
use std::ffi::{c_char, c_int};

/// Success of a function that returns an `int`.
const OK: c_int = 1;
/// Failure of a function that returns an `int`.
const FAILED: c_int = 0;
/// Failure of a function that returns an index, a number or a state from 0.
const NONE: c_int = -1;

#[unsafe(no_mangle)]
extern "C" fn dInitVisualHull() -> c_int {
    fence::keep_quiet();
    fenced(FAILED, || ode::open_class().map(|()| OK))
}

#[unsafe(no_mangle)]
extern "C" fn dCloseVisualHull() {
    fenced((), ode::close_class);
}

#[unsafe(no_mangle)]
extern "C" fn dGetVisualHullClass() -> c_int {
    fenced(NONE, ode::open_class_number)
}

#[unsafe(no_mangle)]
extern "C" fn dVisualHullGetErrorMessage() -> *const c_char {
    fence::message()
}

#[unsafe(no_mangle)]
extern "C" fn dVisualHullGetVersion() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
