//! The header agrees with the exported functions and with the package.

use crate::program::*;
use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

fn header() -> String {
    fs::read_to_string(root().join("include/ode_visual_hull.h")).unwrap()
}

/// The names of the functions that the header declares, in order.
fn declared() -> Vec<String> {
    let header = header();
    let code = without_comments(&header);
    // Each declaration ends in `name(arguments);`.
    let declarations = code.split(';').filter_map(|declaration| {
        let before = declaration.split_once('(')?.0;
        let name = before.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next()?;
        (before.split_whitespace().count() > 1 && name.starts_with('d')).then(|| name.to_owned())
    });
    declarations.collect()
}

fn without_comments(code: &str) -> String {
    let mut parts = code.split("/*");
    let mut bare = parts.next().unwrap().to_owned();
    bare.extend(parts.map(|part| part.split_once("*/").unwrap().1));
    bare
}

/// The names that follow each `before` in `text`, in order.
fn names_after(text: &str, before: &str) -> Vec<String> {
    let names = text
        .split(before)
        .skip(1)
        .map(|rest| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect());
    names.collect()
}

#[test]
fn the_header_declares_the_functions_that_the_shared_library_exports_and_no_others() {
    let output = succeed(Command::new("nm").args(["-D", "--defined-only"]).arg(shared_library()));
    let listing = String::from_utf8(output.stdout).unwrap();
    let exported: BTreeSet<String> =
        listing.lines().map(|line| line.rsplit(' ').next().unwrap().to_owned()).collect();
    let declared = declared();
    assert!(declared.len() >= 29, "{declared:?}");
    assert_eq!(declared.iter().cloned().collect::<BTreeSet<_>>(), exported);
}

#[test]
fn the_source_has_the_functions_in_the_headers_order() {
    let files = ["capi.rs", "capi/data_functions.rs", "capi/geom_functions.rs"];
    let sources = files.map(|file| fs::read_to_string(root().join("src").join(file)).unwrap());
    assert_eq!(names_after(&sources.concat(), "extern \"C\" fn "), declared());
}

#[test]
fn the_header_has_the_packages_version() {
    let line = format!("#define dVISUAL_HULL_VERSION \"{}\"\n", env!("CARGO_PKG_VERSION"));
    assert!(header().contains(&line), "expected {line}");
}

#[test]
fn the_header_compiles_alone_in_c99_and_cpp11() {
    for language in [Language::C99, Language::Cpp11] {
        let mut compile = compiler(language);
        compile.args(["-pedantic", "-fsyntax-only"]).arg(root().join("include/ode_visual_hull.h"));
        succeed(&mut compile);
    }
}

#[test]
fn the_header_refuses_an_ode_of_single_precision() {
    for language in [Language::C99, Language::Cpp11] {
        let mut compile = compiler(language);
        // By this macro ODE's own header takes its precision from the compiler's options.
        compile.args(["-DdIDESINGLE", "-fsyntax-only"]).arg(root().join("include/ode_visual_hull.h"));
        let output = compile.output().unwrap();
        let messages = String::from_utf8_lossy(&output.stderr);
        assert!(
            !output.status.success() && messages.contains("needs an ODE of double precision"),
            "{messages}"
        );
    }
}

#[test]
fn the_shared_library_stays_loaded_since_ode_keeps_addresses_of_its_functions() {
    let output = succeed(Command::new("readelf").arg("-d").arg(shared_library()));
    assert!(String::from_utf8(output.stdout).unwrap().contains("NODELETE"));
}

#[test]
fn the_shared_library_has_the_interface_version_in_its_name() {
    let output = succeed(Command::new("readelf").arg("-d").arg(shared_library()));
    let listing = String::from_utf8(output.stdout).unwrap();
    let name = concat!("[libode_visual_hull.so.", env!("CARGO_PKG_VERSION_MAJOR"), "]");
    assert!(listing.lines().any(|line| line.contains("SONAME") && line.contains(name)), "{listing}");
    // ODE is linked dynamically, so that the process has a single ODE, shared with the caller.
    assert!(listing.lines().any(|line| line.contains("NEEDED") && line.contains("libode.so")), "{listing}");
}
