//! Raw bindings to the [Open Dynamics Engine](https://ode.org) 0.16 as Debian ships it (double precision).
//!
//! All names that start with `d` in `<ode/ode.h>`, with C's own types (`c_int`, `FILE`) from the crate `libc`. Names,
//! units and rules are ODE's own, and its manual is the documentation. Three things differ from C:
//!
//! - constants of unnamed enums are `u32`, while the functions take `c_int`: cast;
//! - [`CONTACTS_UNIMPORTANT`] is the sign bit of `dCollide`'s `flags`: cast it with `as c_int`;
//! - array parameters (`const dReal aabb[6]`) are pointers, and `dInfinity` is `f64::INFINITY`.
//!
//! `dReal` is `f64`; the build fails where the installed library has another precision. A dependant's build script sees
//! that as `DEP_ODE_PRECISION`.

#![allow(missing_docs)]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]
#![allow(clippy::all)]

include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
