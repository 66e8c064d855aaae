//! Finds ODE with pkg-config, generates bindings of `<ode/ode.h>`, and passes the precision to dependants
//! (`DEP_ODE_PRECISION`).

use std::env;
use std::panic;
use std::path::PathBuf;
use std::process::ExitCode;

#[path = "build/problem.rs"]
mod problem;

use problem::{Problem, precision};

fn main() -> ExitCode {
    match build() {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

fn build() -> Result<(), Problem> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build/problem.rs");
    let ode = pkg_config::Config::new()
        .range_version("0.16.2".."0.17")
        .probe("ode")
        .map_err(|error| Problem::Missing(reason(&error)))?;
    let configured = pkg_config::get_variable("ode", "precision").ok();

    let bindings = bind(&ode.include_paths)?;
    let precision = precision(configured.as_deref(), &bindings)?;

    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    std::fs::write(out.join("bindings.rs"), bindings)
        .map_err(|error| Problem::Bindings(error.to_string()))?;
    println!("cargo::metadata=precision={precision}");

    // The layout test compiles a C program for the same target, with the same headers.
    println!("cargo::rustc-env=ODE_SYS_TARGET={}", env::var("TARGET").expect("cargo sets TARGET"));
    println!("cargo::rustc-env=ODE_SYS_HOST={}", env::var("HOST").expect("cargo sets HOST"));
    let include =
        env::join_paths(&ode.include_paths).map_err(|error| Problem::Bindings(error.to_string()))?;
    println!("cargo::rustc-env=ODE_SYS_INCLUDE={}", include.to_string_lossy());

    Ok(())
}

/// The output of pkg-config on stderr, or the reason why it did not run.
fn reason(error: &pkg_config::Error) -> String {
    match error {
        pkg_config::Error::Failure { output, .. } | pkg_config::Error::ProbeFailure { output, .. } => {
            String::from_utf8_lossy(&output.stderr).into_owned()
        }
        other => other.to_string(),
    }
}

/// The bindings as Rust source. bindgen panics where it cannot load libclang, so that is caught here.
fn bind(include_paths: &[PathBuf]) -> Result<String, Problem> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| ()));
    let loaded = panic::catch_unwind(bindgen::clang_version);
    panic::set_hook(hook);
    if loaded.is_err() {
        return Err(Problem::NoClang);
    }

    bindgen::Builder::default()
        .header_contents("ode_sys.h", "#include <ode/ode.h>\n")
        .clang_args(include_paths.iter().map(|path| format!("-I{}", path.display())))
        .rust_target(bindgen::RustTarget::stable(89, 0).expect("bindgen knows the workspace's rust-version"))
        .rust_edition(bindgen::RustEdition::Edition2024)
        .allowlist_function("d[A-Z].*")
        .allowlist_type("d[A-Z].*")
        .allowlist_var("_?d[A-Z].*|CONTACTS_UNIMPORTANT")
        // Where they fail (a full table of user classes, a motion that is not finite), the debug handler unwinds out of
        // them.
        .override_abi(bindgen::Abi::CUnwind, "dCreateGeomClass|dWorldStep|dWorldQuickStep")
        // C's types come from the crate libc, so that a FILE opened through libc can be passed to ODE.
        .ctypes_prefix("libc")
        .blocklist_type("FILE|_IO_.*")
        .raw_line("use libc::FILE;")
        .prepend_enum_name(false)
        .generate_comments(false)
        .derive_default(true)
        .layout_tests(true)
        .parse_callbacks(Box::new(bindgen::CargoCallbacks::new()))
        .generate()
        .map(|bindings| bindings.to_string())
        .map_err(|error| Problem::Bindings(error.to_string()))
}
