//! The C face, from C: the programs in `tests/c` pass as C99 and as C++, with the shared and with the static library,
//! and under valgrind; the header says what the library holds.

#[path = "c_api/header.rs"]
mod header;
#[path = "c_api/program.rs"]
mod program;

use program::{Language, Linkage, Program};

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

programs! { falling_box ode_habits bad_input classes threads }
