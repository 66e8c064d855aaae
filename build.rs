//! Checks that the crate is built against an ODE of double precision, and names the shared library.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var_os("CARGO_FEATURE_ODE").is_some() {
        check_precision();
    }
    link_shared_library();
    // Tests compile C programs for the same target.
    println!("cargo::rustc-env=TEST_TARGET={}", env::var("TARGET").unwrap_or_default());
    println!("cargo::rustc-env=TEST_HOST={}", env::var("HOST").unwrap_or_default());
}

fn check_precision() {
    let precision = env::var("DEP_ODE_PRECISION").unwrap_or_default();
    if precision != "double" {
        println!(
            "cargo::error=ode-visual-hull needs an ODE of double precision, but ode-sys reports {precision:?}: \
             install Debian's libode-dev (apt-get install libode-dev libclang-dev pkg-config) and build again"
        );
    }
}

/// Gives `libode_visual_hull.so` its name and interface version, which cargo leaves out, and keeps it loaded. cargo-c, which sets the
/// feature `capi`, does it itself, and a second name would win over its own.
fn link_shared_library() {
    let linux = env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux");
    if linux {
        // ODE keeps the addresses of the library's functions, so a plugin host must not unload it.
        println!("cargo::rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
    if linux && env::var_os("CARGO_FEATURE_CAPI").is_none() {
        let major = env::var("CARGO_PKG_VERSION_MAJOR").unwrap_or_default();
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libode_visual_hull.so.{major}");
    }
}
