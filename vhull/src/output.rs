//! Folders for results.

use ode_visual_hull::{Error, Result};
use std::path::Path;

/// Creates the folder `dir` and its parents where they do not exist.
pub fn make_folder(dir: &Path) -> Result<()> {
    std::fs::create_dir_all(dir).map_err(|e| {
        Error::file(
            dir,
            format!("expected to make this folder, found: {e}; choose a folder that you may write to"),
        )
    })
}

/// Creates the folder in which `file` is to be written.
pub fn make_folder_of(file: &Path) -> Result<()> {
    file.parent().filter(|dir| !dir.as_os_str().is_empty()).map_or(Ok(()), make_folder)
}
