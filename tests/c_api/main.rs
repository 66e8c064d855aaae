//! The C functions, called from C: the programs in `tests/c` pass as C99 and as C++, with the shared and with the
//! static library, and under valgrind. The header agrees with the library.

mod header;
mod program;

use program::{Language, Linkage, Program, root, scratch};
use std::sync::LazyLock;

/// A test for each way to build and run a program of `tests/c`.
macro_rules! programs {
    ($($name:ident)*) => {
        $(mod $name {
            use super::*;

            /// Compiled once for two tests.
            static SHARED: LazyLock<Program> =
                LazyLock::new(|| Program::build(stringify!($name), Language::C99, Linkage::Shared));

            #[test]
            fn passes_with_the_shared_library() {
                SHARED.run();
            }

            #[test]
            fn passes_with_the_static_library() {
                Program::build(stringify!($name), Language::C99, Linkage::Static).run();
            }

            #[test]
            fn passes_as_cpp() {
                Program::build(stringify!($name), Language::Cpp11, Linkage::Shared).run();
            }

            #[test]
            fn has_no_error_and_no_leak_under_valgrind() {
                SHARED.run_under_valgrind();
            }
        })*
    };
}

programs! {
    falling_box ode_habits bad_input bounce classes copies events grip hold late_calls motion sleepers swept threads transforms
}

/// The blocks of C in the documentation.
fn documented_code() -> Vec<String> {
    let page = std::fs::read_to_string(root().join("docs/c.md")).unwrap();
    page.split("```c\n").skip(1).map(|rest| rest.split_once("```").unwrap().0.to_owned()).collect()
}

/// The height at which the box of the documented program ends, in metres.
fn documented_height(name: &str, code: &str) -> f64 {
    let source = scratch().join(format!("{name}.c"));
    std::fs::write(&source, code).unwrap();
    let program = Program::build_from(name, &[source], Language::C99, Linkage::Shared);
    let last = program.run().lines().last().unwrap().to_owned();
    last.split_whitespace().rev().nth(1).unwrap().parse().unwrap()
}

#[test]
fn the_program_in_the_documentation_does_what_it_says() {
    let height = documented_height("documented", &documented_code()[0]);
    // The page says "rests at 0.3 m"; the contact surface layer lets the body sink by a millimetre.
    assert!((height - 0.3).abs() < 0.002, "{height}");
}

#[test]
fn the_near_callback_for_a_moving_subject_serves_a_subject_at_rest_too() {
    let code = documented_code();
    let (head, rest) = code[0].split_once("static void near_callback").unwrap();
    let (_, main) = rest.split_once("int main").unwrap();
    let program = format!("{head}{}\nint main{main}", code[1]);
    let height = documented_height("documented_motion", &program);
    // As above: without motion the callback gives plain contacts.
    assert!((height - 0.3).abs() < 0.002, "{height}");
}

#[test]
fn the_events_in_the_documentation_tell_of_the_fall() {
    let code = documented_code();
    let replaced = [
        ("int main(void) {", format!("{}\nint main(void) {{\n  dGeomID hull;", code[3])),
        ("dCreateVisualHull(space, data);", "hull = dCreateVisualHull(space, data); dGeomVisualHullSetEvents(hull, 1);".into()),
        ("dSpaceCollide(space, 0, near_callback);", "dGeomVisualHullSetTime(hull, 0.005 * k); dSpaceCollide(space, 0, near_callback); print_events(hull);".into()),
    ];
    let program = replaced.iter().fold(code[0].clone(), |code, (from, to)| {
        assert!(code.contains(from), "{from}");
        code.replace(from, to)
    });
    let source = scratch().join("documented_events.c");
    std::fs::write(&source, program).unwrap();
    let output = Program::build_from("documented_events", &[source], Language::C99, Linkage::Shared).run();
    // It falls 0.2 m, for 0.2 s, and hits the table at 2 m/s.
    assert_eq!(output.matches("a body").count(), 1, "{output}");
    assert!(output.contains("0.20 s: a body touches part 1, 2.0 m/s"), "{output}");
}
