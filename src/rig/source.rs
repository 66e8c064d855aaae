//! What a calibration is read from: a file and those beside it, a folder of files, or text in memory. Readers reach the
//! file system only through here.

use crate::{Error, Result, image_file};
use std::path::{Path, PathBuf};

/// What ends an error about a missing file where the text came without a path.
const LOAD: &str = "a text in memory has no files beside it: save all of them into one folder and read it with Calibration::load";

/// A calibration file's text, or the files of a folder.
pub(super) struct Source {
    /// Of the file or folder; of a text in memory the name that messages call it.
    pub(super) path: PathBuf,
    content: Content,
}

enum Content {
    /// A file's; others may lie beside it.
    File(String),
    /// Nothing lies beside it, whatever its name.
    InMemory(String),
    Folder(Vec<PathBuf>),
}

impl Source {
    /// Reads the file, or lists the folder, at `path`.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let content = if path.is_dir() { Content::Folder(list(path)?) } else { Content::File(read(path)?) };
        Ok(Self { path: path.to_owned(), content })
    }

    /// The text that `bytes` are, under a name.
    pub(super) fn in_memory(name: &str, bytes: &[u8]) -> Result<Self> {
        let path = PathBuf::from(name);
        let content = Content::InMemory(text(&path, bytes.to_vec())?);
        Ok(Self { path, content })
    }

    /// Whether it is a text without a place on disk.
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

    /// The file's text where it begins as an object of JSON does.
    pub(super) fn json(&self) -> Option<&str> {
        self.text().filter(|text| text.trim_start_matches('\u{feff}').trim_start().starts_with('{'))
    }

    /// The folder's files, by name; none for a file.
    pub(super) fn files(&self) -> &[PathBuf] {
        match &self.content {
            Content::Folder(files) => files,
            _ => &[],
        }
    }

    /// The folder's own folders, by name; none for a file or what cannot be listed.
    pub(super) fn folders(&self) -> Vec<PathBuf> {
        if self.text().is_some() {
            return Vec::new();
        }
        let entries = std::fs::read_dir(&self.path).into_iter().flatten().flatten();
        let mut folders: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        folders.sort();
        folders
    }

    /// The path of the file called `name` beside what was opened, where there is one: in the folder itself, or in the
    /// file's own.
    pub(super) fn beside(&self, name: &str) -> Option<PathBuf> {
        let folder = match &self.content {
            Content::File(_) => self.path.parent()?,
            Content::InMemory(_) => return None,
            Content::Folder(_) => &self.path,
        };
        Some(folder.join(name)).filter(|path| path.is_file())
    }

    /// Width and height of the image called `name` beside what was opened, where there is one.
    pub(super) fn image_size(&self, name: &str) -> Result<Option<(u32, u32)>> {
        self.beside(name).map(|path| image_file::size(&path)).transpose()
    }

    /// The error about a file that has to be beside what was opened and is not; it ends in `next_step` where there can
    /// be such a file.
    pub(super) fn lacks(&self, name: &str, next_step: &str) -> Error {
        let place = if self.text().is_some() { "beside" } else { "in" };
        let next_step = self.next_step(next_step);
        Error::file(&self.path, format!("expected {name} {place} it, found none; {next_step}"))
    }

    /// What to do about a missing file: `at_path`, or for a text in memory to load it by its path.
    pub(super) fn next_step<'a>(&self, at_path: &'a str) -> &'a str {
        if self.is_in_memory() { LOAD } else { at_path }
    }

    /// The name of the folder that a file is in; of a text in memory, as far as its own name tells.
    pub(super) fn folder_name(&self) -> Option<String> {
        if self.is_in_memory() { name(self.path.parent()?.file_name()) } else { folder_name(&self.path) }
    }

    /// Whether the file's name ends so, in any case.
    pub(super) fn has_extension(&self, extension: &str) -> bool {
        self.path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
    }
}

/// The text of a file.
pub(super) fn read(path: &Path) -> Result<String> {
    let fail = |e| Error::file(path, format!("expected a calibration file, found: {e}; check the path"));
    text(path, std::fs::read(path).map_err(fail)?)
}

/// The name of the folder that the file at `path` is in, of the working directory where `path` names none.
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
