//! Problems with the installed ODE, with messages that say what to do.
//!
//! Shared by the build script and by `tests/problem.rs`.

use std::fmt;

/// The command that installs everything needed on Debian.
const INSTALL: &str = "apt-get install libode-dev libclang-dev pkg-config";

/// The reason why no bindings could be generated.
#[derive(Debug, PartialEq, Eq)]
pub enum Problem {
    /// pkg-config finds no ODE of a suitable version; with its output.
    Missing(String),
    /// libclang cannot be loaded.
    NoClang,
    /// bindgen failed; with its message.
    Bindings(String),
    /// pkg-config and the header name different precisions.
    Disagree { configured: String, header: &'static str },
    /// ODE is built with a precision other than double.
    NotDouble(&'static str),
    /// The header defines `dReal` as neither `f64` nor `f32`.
    NoReal,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(why) => write!(
                f,
                "ode-sys needs the Open Dynamics Engine 0.16.2 or a later 0.16, which pkg-config did not find.\n\
                 On Debian: {INSTALL}\n\npkg-config said: {}",
                why.trim()
            ),

            Self::NoClang => write!(
                f,
                "ode-sys reads ODE's headers with libclang, which could not be loaded.\n\
                 On Debian: {INSTALL} (or set LIBCLANG_PATH to the folder of libclang.so)"
            ),

            Self::Bindings(why) => write!(
                f,
                "ode-sys could not make bindings from <ode/ode.h>.\n\
                 On Debian, both the headers and clang's own are in: {INSTALL}\n\nbindgen said: {}",
                why.trim()
            ),

            Self::Disagree { configured, header } => write!(
                f,
                "pkg-config says that the installed ODE is built with {configured}, but the header found says {header}.\n\
                 Two versions of ODE are mixed: remove the other one from the include path (CPATH, BINDGEN_EXTRA_CLANG_ARGS),\n\
                 then on Debian: {INSTALL}"
            ),

            Self::NotDouble(found) => write!(
                f,
                "ode-sys needs an ODE of double precision (dDOUBLE), but the installed one is {found}.\n\
                 Build ODE with --enable-double-precision, or on Debian (amd64, arm64): {INSTALL}"
            ),

            Self::NoReal => write!(
                f,
                "ode-sys found no type dReal in <ode/ode.h>, so this is not an ODE it knows.\n\
                 On Debian: {INSTALL}"
            ),
        }
    }
}

/// The precision of the installed ODE, `"double"`.
///
/// `configured` is pkg-config's variable `precision`, which older builds of ODE lack, and `bindings` are those that
/// bindgen generated from the header. The header decides, since code is compiled against it.
///
/// # Errors
///
/// [`Problem::NoReal`], [`Problem::Disagree`] and [`Problem::NotDouble`].
pub fn precision(configured: Option<&str>, bindings: &str) -> Result<&'static str, Problem> {
    let header = if bindings.contains("pub type dReal = f64;") {
        "dDOUBLE"
    } else if bindings.contains("pub type dReal = f32;") {
        "dSINGLE"
    } else {
        return Err(Problem::NoReal);
    };
    match configured.map(str::trim) {
        Some(configured) if !configured.is_empty() && configured != header => {
            Err(Problem::Disagree { configured: configured.to_owned(), header })
        }
        _ if header == "dDOUBLE" => Ok("double"),
        _ => Err(Problem::NotDouble(header)),
    }
}
