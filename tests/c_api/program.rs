//! Compiling and running C programs.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

#[derive(Debug, Clone, Copy)]
pub enum Language {
    C99,
    Cpp11,
}

#[derive(Debug, Clone, Copy)]
pub enum Linkage {
    Shared,
    Static,
}

/// A compiled program.
pub struct Program {
    path: PathBuf,
}

impl Program {
    /// Compiles and links `tests/c/<name>.c` with the common `scene.c`.
    pub fn build(name: &str, language: Language, linkage: Linkage) -> Self {
        let sources = root().join("tests/c");
        let sources = [sources.join(format!("{name}.c")), sources.join("scene.c")];
        Self::build_from(name, &sources, language, linkage)
    }

    /// Compiles and links `sources`.
    pub fn build_from(name: &str, sources: &[PathBuf], language: Language, linkage: Linkage) -> Self {
        let path = scratch().join(format!("{name}_{language:?}_{linkage:?}_{}", thread_name()));
        let mut compile = compiler(language);
        compile.args(sources).arg("-o").arg(&path);

        // The files that follow are libraries, not sources.
        compile.args(["-x", "none"]);
        let libraries = libraries();
        match linkage {
            Linkage::Shared => {
                compile.arg(shared_library());
                // The program finds the library by its soname, like an installed one.
                compile.arg(format!("-Wl,-rpath,{}", soname_folder().display()));
            }
            Linkage::Static => {
                compile.arg(libraries.join("libode_visual_hull.a"));
            }
        }

        compile.args(pkg_config(&["--libs", "ode"])).args(native_libraries());
        succeed(&mut compile);
        Self { path }
    }

    /// Runs the program and returns its output on stdout. Fails with its messages on stderr if a check in it fails.
    pub fn run(&self) -> String {
        String::from_utf8(succeed(&mut Command::new(&self.path)).stdout).unwrap()
    }

    /// Runs the program under valgrind, or prints that the test is skipped where valgrind is missing.
    pub fn run_under_valgrind(&self) {
        if Command::new("valgrind").arg("--version").output().is_err() {
            eprintln!("skipped: no valgrind; make setup installs it");
            return;
        }
        let mut valgrind = Command::new("valgrind");
        valgrind.args(["--quiet", "--error-exitcode=9", "--leak-check=full"]);
        valgrind.args(["--show-leak-kinds=definite,indirect", "--errors-for-leak-kinds=definite,indirect"]);
        succeed(valgrind.arg(&self.path));
    }
}

/// The system's compiler with all warnings as errors, and with the include paths of the header and of ODE.
pub fn compiler(language: Language) -> Command {
    let mut build = cc::Build::new();
    build.target(env!("TEST_TARGET")).host(env!("TEST_HOST")).opt_level(1).cargo_metadata(false);
    let arguments = match language {
        Language::C99 => ["-std=c99", "-x", "c"],
        Language::Cpp11 => ["-std=c++11", "-x", "c++"],
    };

    let mut command = build.cpp(matches!(language, Language::Cpp11)).get_compiler().to_command();
    command.args(arguments).args(["-g", "-pthread", "-Wall", "-Wextra", "-Werror"]);
    command.arg("-I").arg(root().join("include")).args(pkg_config(&["--cflags", "ode"]));
    command
}

/// Runs `command` and asserts that it succeeds.
pub fn succeed(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {}\n{messages}", output.status);
    output
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn scratch() -> &'static Path {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
}

/// The folder of this test's binary, in which cargo places the library in all of its crate types.
fn libraries() -> PathBuf {
    env::current_exe().unwrap().parent().unwrap().to_owned()
}

pub fn shared_library() -> PathBuf {
    libraries().join("libode_visual_hull.so")
}

/// A folder that contains the library under its soname.
fn soname_folder() -> PathBuf {
    let folder = scratch().join("soname").join(thread_name());
    std::fs::create_dir_all(&folder).unwrap();
    let major = env!("CARGO_PKG_VERSION_MAJOR");
    let link = folder.join(format!("libode_visual_hull.so.{major}"));
    let _ = std::fs::remove_file(&link);
    std::os::unix::fs::symlink(shared_library(), link).unwrap();
    folder
}

/// The name of the current thread, which is the name of the test.
fn thread_name() -> String {
    std::thread::current().name().unwrap_or("main").replace(':', "_")
}

pub fn pkg_config(arguments: &[&str]) -> Vec<String> {
    let output = succeed(Command::new("pkg-config").args(arguments));
    String::from_utf8(output.stdout).unwrap().split_whitespace().map(str::to_owned).collect()
}

/// The libraries that a program needs besides the static library and ODE, from the pkg-config file.
fn native_libraries() -> Vec<String> {
    let template = std::fs::read_to_string(root().join("ode_visual_hull.pc.in")).unwrap();
    let line = template.lines().find_map(|line| line.strip_prefix("Libs.private:")).unwrap();
    line.split_whitespace().map(str::to_owned).collect()
}
