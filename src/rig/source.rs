//! The input of a reader: a file and its neighbours, a folder of files, or text in memory. Readers reach the file
//! system only through this module.

use crate::{Error, Result, image_file};
use std::path::{Path, PathBuf};

/// The next step in errors about a missing file where the text came without a path.
const LOAD: &str = "a text in memory has no files beside it: save all of them into one folder and read it with Calibration::load";

/// A calibration file's text, or the files of a folder.
pub(super) struct Source {
    /// The path of the file or folder; for a text in memory the name used in messages.
    pub(super) path: PathBuf,
    content: Content,
}

enum Content {
    /// The text of a file; other files may lie beside it.
    File(String),
    /// A text without a place on disk; it has no neighbours, whatever its name.
    InMemory(String),
    Folder(Vec<PathBuf>),
}

impl Source {
    /// Reads the file, or lists the folder, at `path`.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let content = if path.is_dir() { Content::Folder(list(path)?) } else { Content::File(read(path)?) };
        Ok(Self { path: path.to_owned(), content })
    }

    /// The text in `bytes`, called `name` in messages.
    pub(super) fn in_memory(name: &str, bytes: &[u8]) -> Result<Self> {
        let path = PathBuf::from(name);
        let content = Content::InMemory(text(&path, bytes.to_vec())?);
        Ok(Self { path, content })
    }

    /// Whether the source is a text without a place on disk.
    pub(super) fn is_in_memory(&self) -> bool {
        matches!(self.content, Content::InMemory(_))
    }

    /// The file's text; `None` for a folder.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.content {
            Content::File(text) | Content::InMemory(text) => Some(text),
            Content::Folder(_) => None,
        }
    }

    /// The file's text if it begins like a JSON object.
    pub(super) fn json(&self) -> Option<&str> {
        self.text().filter(|text| text.trim_start_matches('\u{feff}').trim_start().starts_with('{'))
    }

    /// The folder's files, sorted by name; empty for a file.
    pub(super) fn files(&self) -> &[PathBuf] {
        match &self.content {
            Content::Folder(files) => files,
            _ => &[],
        }
    }

    /// The folder's subfolders, sorted by name; empty for a file or a folder that cannot be listed.
    pub(super) fn folders(&self) -> Vec<PathBuf> {
        if self.text().is_some() {
            return Vec::new();
        }
        let entries = std::fs::read_dir(&self.path).into_iter().flatten().flatten();
        let mut folders: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        folders.sort();
        folders
    }

    /// The path of the file called `name` in the opened folder, or in the folder of the opened file, if there is one.
    pub(super) fn beside(&self, name: &str) -> Option<PathBuf> {
        let folder = match &self.content {
            Content::File(_) => self.path.parent()?,
            Content::InMemory(_) => return None,
            Content::Folder(_) => &self.path,
        };
        Some(folder.join(name)).filter(|path| path.is_file())
    }

    /// Width and height in pixels of the image called `name` beside the source, if there is one.
    pub(super) fn image_size(&self, name: &str) -> Result<Option<(u32, u32)>> {
        self.beside(name).map(|path| image_file::size(&path)).transpose()
    }

    /// The error about a required file beside the source that is missing; it ends in `next_step` where such a file can
    /// exist.
    pub(super) fn lacks(&self, name: &str, next_step: &str) -> Error {
        let place = if self.text().is_some() { "beside" } else { "in" };
        let next_step = self.next_step(next_step);
        Error::file(&self.path, format!("expected {name} {place} it, found none; {next_step}"))
    }

    /// The next step about a missing file: `at_path`, or for a text in memory to load it by its path.
    pub(super) fn next_step<'a>(&self, at_path: &'a str) -> &'a str {
        if self.is_in_memory() { LOAD } else { at_path }
    }

    /// The name of the folder that contains the source; for a text in memory, the folder part of its name.
    pub(super) fn folder_name(&self) -> Option<String> {
        if self.is_in_memory() { name(self.path.parent()?.file_name()) } else { folder_name(&self.path) }
    }

    /// Whether the file's name has this extension, in any case.
    pub(super) fn has_extension(&self, extension: &str) -> bool {
        self.path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
    }
}

/// Reads a text file.
pub(super) fn read(path: &Path) -> Result<String> {
    let fail = |e| Error::file(path, format!("expected a calibration file, found: {e}; check the path"));
    text(path, std::fs::read(path).map_err(fail)?)
}

/// The name of the folder that contains the file at `path`; the working directory's where `path` names no folder.
pub(super) fn folder_name(path: &Path) -> Option<String> {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    name(absolute.parent()?.file_name())
}

fn name(part: Option<&std::ffi::OsStr>) -> Option<String> {
    part.map(|part| part.to_string_lossy().into_owned())
}

fn text(path: &Path, bytes: Vec<u8>) -> Result<String> {
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let problem = format!(
            "expected text, found a byte at {at} that is none; export the calibration as a text file (COLMAP's \
             .bin with colmap model_converter --output_type TXT)"
        );
        Error::file(path, problem)
    })
}

fn list(folder: &Path) -> Result<Vec<PathBuf>> {
    let fail = |e: std::io::Error| Error::file(folder, format!("expected a readable folder, found: {e}"));
    let entries = std::fs::read_dir(folder).map_err(fail)?;
    let paths: std::io::Result<Vec<_>> = entries.map(|entry| Ok(entry?.path())).collect();
    let mut files: Vec<_> = paths.map_err(fail)?.into_iter().filter(|path| path.is_file()).collect();
    files.sort();
    Ok(files)
}
