//! Folders of OpenCV's files: a file per camera, or a folder per camera.
//!
//! ```text
//! rig/left.yml          rig/cam1/config.xml          rig/intrinsics.yml
//! rig/right.yml         rig/cam2/config.xml          rig/extrinsics.yml
//! ```
//!
//! Files without a complete camera (intrinsics alone, a checkerboard) are ignored where another file of the folder is
//! complete; where none is, the files of the folder are merged.

use super::super::format::RawCamera;
use super::super::source::{self, Source};
use super::{OpenCvFile, name_of, recognise_text};
use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// The extensions of files of this format.
const EXTENSIONS: &[&str] = &["yml", "yaml", "xml", "json"];

pub(super) fn recognise(source: &Source) -> bool {
    !files(source).is_empty() || source.folders().iter().any(|folder| !files_at(folder).is_empty())
}

/// The cameras of a folder, and notes on the files and folders that were ignored.
pub(super) fn read(folder: &Source) -> Result<(Vec<RawCamera>, Vec<String>)> {
    let own = open(&files(folder))?;
    if own.iter().any(|(_, contents)| !contents.is_empty()) {
        return cameras_of_files(&folder.path, own);
    }

    // One folder per camera, which gives the camera its name.
    let (mut cameras, mut notes) = (Vec::new(), Vec::new());
    for folder in folder.folders() {
        let files = files_at(&folder);
        let name = last(&folder);
        if files.is_empty() {
            notes.push(format!("the folder {name} holds no calibration and is ignored"));
            continue;
        }

        let (mut found, more) = cameras_of_files(&folder, open(&files)?)?;
        if found.len() > 1 {
            let names: Vec<_> = found.iter().map(|camera| camera.name.as_str()).collect();
            let problem =
                format!("expected the calibration of one camera, found {}; remove others", names.join(", "));
            return Err(Error::file(folder, problem));
        }

        found.iter_mut().for_each(|camera| camera.name.clone_from(&name));
        cameras.extend(found);
        notes.extend(more.into_iter().map(|note| format!("{name}/{note}")));
    }
    Ok((cameras, notes))
}

/// The name of the file that completes this one: `intrinsics` and `extrinsics` with the same extension belong
/// together.
pub(super) fn counterpart(path: &Path) -> Option<String> {
    let (stem, extension) = (path.file_stem()?.to_str()?, path.extension()?.to_str()?);
    let other = match stem {
        "intrinsics" => "extrinsics",
        "extrinsics" => "intrinsics",
        _ => return None,
    };
    Some(format!("{other}.{extension}"))
}

fn open(files: &[PathBuf]) -> Result<Vec<(PathBuf, OpenCvFile)>> {
    files.iter().map(|path| Ok((path.clone(), OpenCvFile::open(path)?))).collect()
}

/// The cameras of a folder's own files.
fn cameras_of_files(
    folder: &Path,
    contents: Vec<(PathBuf, OpenCvFile)>,
) -> Result<(Vec<RawCamera>, Vec<String>)> {
    let (complete, others): (Vec<_>, Vec<_>) =
        contents.into_iter().partition(|(_, contents)| contents.is_complete());
    if complete.is_empty() {
        let merged =
            others.into_iter().map(|(_, contents)| contents).reduce(OpenCvFile::or).unwrap_or_default();
        let cameras = merged.cameras(&last(folder)).map_err(|e| Error::file(folder, e))?;
        return Ok((cameras, Vec::new()));
    }

    let note = |path: &Path| format!("{} holds no complete camera and is ignored", last(path));
    let notes = others.iter().map(|(path, _)| note(path)).collect();

    let name = |path: &Path| name_of(path, || source::folder_name(path));
    let cameras = complete.iter().map(|(path, contents)| contents.cameras(&name(path)));
    let cameras = cameras.collect::<Result<Vec<_>>>()?;
    Ok((cameras.into_iter().flatten().collect(), notes))
}

/// The files of the folder that look like this format.
fn files(folder: &Source) -> Vec<PathBuf> {
    let is_one = |path: &&PathBuf| {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        EXTENSIONS.contains(&extension.to_ascii_lowercase().as_str())
            && source::read(path).is_ok_and(|text| recognise_text(&text))
    };
    folder.files().iter().filter(is_one).cloned().collect()
}

fn files_at(folder: &Path) -> Vec<PathBuf> {
    Source::open(folder).map(|source| files(&source)).unwrap_or_default()
}

/// The last part of a path.
fn last(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
