//! Where the real captures lie that some tests run on. They are not part of the repository.

use std::path::PathBuf;

/// The environment variable that names the folder of captures.
pub const VARIABLE: &str = "ODE_VISUAL_HULL_DATA";

/// The file or folder at `path` among the captures: in the folder that [`VARIABLE`] names, else in `../shared/data`
/// beside the repository. Where it is absent this says so, and the test has nothing to test.
pub fn find(path: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let found = std::env::var_os(VARIABLE).map_or_else(beside, PathBuf::from).join(path);
    if found.exists() {
        return Some(found);
    }
    eprintln!("skipped: no {}; set {VARIABLE} to the folder of captures", found.display());
    None
}
