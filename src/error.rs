//! The error type of the crate.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// An error that says what went wrong, where, and what to do next.
///
/// Every message names the file, the view or the argument, what was expected and what was found.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read, written or understood.
    #[error("{}: {problem}", path.display())]
    File {
        /// The path of the file, as passed by the caller.
        path: PathBuf,
        /// Expected, found, next step.
        problem: String,
    },
    /// A camera's calibration cannot be used.
    #[error("camera \"{camera}\": {problem}")]
    Camera {
        /// The camera's name.
        camera: String,
        /// Expected, found, next step.
        problem: String,
    },
    /// One view of a rig cannot be used with what it was given.
    #[error("view \"{view}\": {problem}")]
    View {
        /// The view's name.
        view: String,
        /// Expected, found, next step.
        problem: String,
    },
    /// An argument is out of its range.
    #[error("{0}")]
    Argument(String),
    /// A calibration lacks necessary information, and the [`Hints`](crate::rig::Hints) do not give it.
    #[error("{error}")]
    MissingHint {
        /// The missing information.
        what: MissingHint,
        /// The error with its message.
        error: Box<Error>,
    },
    /// ODE is missing, closed, or refused the call.
    #[error("ODE: {0}")]
    Ode(String),
}

/// Information that a calibration may lack and [`Hints`](crate::rig::Hints) can give.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MissingHint {
    /// Width and height of the images.
    Size,
    /// The unit of length.
    MetresPerUnit,
}

/// A result with the crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An [`Error::File`].
    pub fn file(path: impl AsRef<Path>, problem: impl ToString) -> Self {
        Self::File { path: path.as_ref().to_owned(), problem: problem.to_string() }
    }

    /// An [`Error::File`] for a file that could not be written.
    pub(crate) fn unwritten(path: impl AsRef<Path>, found: &io::Error) -> Self {
        let next = match found.kind() {
            ErrorKind::NotFound => "; make its folder first",
            ErrorKind::IsADirectory => "; name a file in this folder",
            ErrorKind::InvalidInput => "; choose another name",
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                "; make room on the disk"
            }
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                "; choose a folder that you may write"
            }
            _ => "",
        };
        Self::file(path, format!("expected to write this file, found: {found}{next}"))
    }

    /// An [`Error::Camera`].
    pub fn camera(camera: impl ToString, problem: impl ToString) -> Self {
        Self::Camera { camera: camera.to_string(), problem: problem.to_string() }
    }

    /// An [`Error::View`].
    pub fn view(view: impl ToString, problem: impl ToString) -> Self {
        Self::View { view: view.to_string(), problem: problem.to_string() }
    }

    /// An [`Error::MissingHint`].
    pub(crate) fn missing_hint(what: MissingHint, error: Self) -> Self {
        Self::MissingHint { what, error: Box::new(error) }
    }

    /// An [`Error::Argument`].
    pub fn argument(problem: impl ToString) -> Self {
        Self::Argument(problem.to_string())
    }
}
