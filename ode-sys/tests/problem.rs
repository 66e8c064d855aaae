//! The build script's check of the installed ODE.

#[path = "../build/problem.rs"]
mod problem;

use problem::{Problem, precision};

const DOUBLE: &str = "pub type dReal = f64;";
const SINGLE: &str = "pub type dReal = f32;";

#[test]
fn double_precision_in_both_places_is_accepted() {
    assert_eq!(precision(Some("dDOUBLE"), DOUBLE), Ok("double"));
}

#[test]
fn the_header_decides_where_pkg_config_has_no_precision() {
    assert_eq!(precision(None, DOUBLE), Ok("double"));
    assert_eq!(precision(Some("\n"), DOUBLE), Ok("double"));
    assert_eq!(precision(None, SINGLE), Err(Problem::NotDouble("dSINGLE")));
}

#[test]
fn a_header_of_another_precision_is_refused() {
    let expected = Problem::Disagree { configured: "dDOUBLE".into(), header: "dSINGLE" };
    assert_eq!(precision(Some("dDOUBLE"), SINGLE), Err(expected));
    let expected = Problem::Disagree { configured: "dSINGLE".into(), header: "dDOUBLE" };
    assert_eq!(precision(Some("dSINGLE"), DOUBLE), Err(expected));
}

#[test]
fn single_precision_in_both_places_is_refused() {
    assert_eq!(precision(Some("dSINGLE"), SINGLE), Err(Problem::NotDouble("dSINGLE")));
}

#[test]
fn a_header_without_a_real_type_is_refused() {
    assert_eq!(precision(Some("dDOUBLE"), "pub type dInt = i32;"), Err(Problem::NoReal));
}

#[test]
fn every_problem_says_what_to_install() {
    let problems = [
        Problem::Missing("no ode.pc".into()),
        Problem::NoClang,
        Problem::Bindings("'stddef.h' file not found".into()),
        Problem::Disagree { configured: "dDOUBLE".into(), header: "dSINGLE" },
        Problem::NotDouble("dSINGLE"),
        Problem::NoReal,
    ];

    for problem in problems {
        assert!(
            problem.to_string().contains("apt-get install libode-dev libclang-dev pkg-config"),
            "{problem:?}"
        );
    }
}
