//! The C functions, called from C: the programs in `tests/c` pass as C99 and as C++, with the shared and with the
//! static library, and under valgrind. The header agrees with the library.

mod header;
mod program;

use program::{Language, Linkage, Program, root, scratch};

/// A test for each way to build and run a program of `tests/c`.
macro_rules! programs {
    ($($name:ident)*) => {
        $(mod $name {
            use super::*;

            #[test]
            fn passes_with_the_shared_library() {
                Program::build(stringify!($name), Language::C99, Linkage::Shared).run();
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
                Program::build(stringify!($name), Language::C99, Linkage::Shared).run_under_valgrind();
            }
        })*
    };
}

programs! { falling_box ode_habits bad_input classes copies late_calls sleepers threads transforms }

#[test]
fn the_program_in_the_documentation_does_what_it_says() {
    let page = std::fs::read_to_string(root().join("docs/c.md")).unwrap();
    let code = page.split_once("```c\n").unwrap().1.split_once("```").unwrap().0;
    let source = scratch().join("documented.c");
    std::fs::write(&source, code).unwrap();
    let program = Program::build_from("documented", &[source], Language::C99, Linkage::Shared);

    let last = program.run().lines().last().unwrap().to_owned();
    let height: f64 = last.split_whitespace().rev().nth(1).unwrap().parse().unwrap();
    // The page says "rests at 0.3 m"; the contact surface layer lets the body sink by a millimetre.
    assert!((height - 0.3).abs() < 0.002, "{last}");
}
