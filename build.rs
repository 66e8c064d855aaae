//! Checks that the crate is built against an ODE of double precision.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let precision = env::var("DEP_ODE_PRECISION").unwrap_or_default();
    if precision != "double" {
        println!(
            "cargo::error=ode-visual-hull needs an ODE of double precision, but ode-sys reports {precision:?}: \
             install Debian's libode-dev (apt-get install libode-dev libclang-dev pkg-config) and build again"
        );
    }
}
