//! The C compiler and the bindings agree on the layout of every structure that passes between C and Rust.

use std::env;
use std::fmt::Write;
use std::fs;
use std::mem::{offset_of, size_of};
use std::path::Path;
use std::process::Command;

use ode_sys::{dContact, dContactGeom, dGeomClass, dJointFeedback, dMass, dReal, dSurfaceParameters};

/// Appends the size of a structure and the offsets of its fields: to `$c` as source that prints them, and to `$rust` as
/// the values in Rust.
macro_rules! layout {
    ($c:ident, $rust:ident, $name:ident { $($field:ident),* $(,)? }) => {
        writeln!($c, "print(\"{0}\", sizeof({0}));", stringify!($name)).unwrap();
        writeln!($rust, "{} {}", stringify!($name), size_of::<$name>()).unwrap();
        $(
            writeln!($c, "print(\"{0}.{1}\", offsetof({0}, {1}));", stringify!($name), stringify!($field)).unwrap();
            writeln!($rust, "{}.{} {}", stringify!($name), stringify!($field), offset_of!($name, $field)).unwrap();
        )*
    };
}

#[test]
fn c_and_rust_agree_on_sizes_and_offsets() {
    let mut c = String::from(
        "#include <ode/ode.h>\n#include <stddef.h>\n#include <stdio.h>\n\
         static void print(const char *name, size_t n) { printf(\"%s %lu\\n\", name, (unsigned long)n); }\n\
         int main(void) {\n",
    );

    let mut rust = String::new();
    layout!(c, rust, dReal {});
    layout!(c, rust, dContactGeom { pos, normal, depth, g1, g2, side1, side2 });
    layout!(c, rust, dContact { surface, geom, fdir1 });
    layout!(c, rust, dGeomClass { bytes, collider, aabb, aabb_test, dtor });
    layout!(
        c,
        rust,
        dSurfaceParameters {
            mode,
            mu,
            mu2,
            rho,
            rho2,
            rhoN,
            bounce,
            bounce_vel,
            soft_erp,
            soft_cfm,
            motion1,
            motion2,
            motionN,
            slip1,
            slip2
        }
    );
    layout!(c, rust, dMass { mass, c, I });
    layout!(c, rust, dJointFeedback { f1, t1, f2, t2 });

    c.push_str("return 0;\n}\n");

    assert_eq!(compiled_output("layout", &c), rust);
}

/// The output of the program `source`, compiled by the system's C compiler against the bound headers.
fn compiled_output(name: &str, source: &str) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (file, program) = (folder.join(format!("{name}.c")), folder.join(name));
    fs::write(&file, source).unwrap();

    let mut build = cc::Build::new();
    build.target(env!("ODE_SYS_TARGET")).host(env!("ODE_SYS_HOST")).opt_level(0).cargo_metadata(false);
    for include in env::split_paths(env!("ODE_SYS_INCLUDE")).filter(|path| !path.as_os_str().is_empty()) {
        build.include(include);
    }

    let status = build.get_compiler().to_command().arg(&file).arg("-o").arg(&program).status().unwrap();
    assert!(status.success(), "the C compiler refused {}", file.display());

    let output = Command::new(&program).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}
