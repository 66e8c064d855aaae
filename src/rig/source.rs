//! What a program is pointed at: a calibration file, or a folder of them.

use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// A calibration file's text, or the files of a folder.
pub(super) struct Source {
    pub(super) path: PathBuf,
    content: Content,
}

enum Content {
    Text(String),
    Files(Vec<PathBuf>),
}

impl Source {
    /// Reads the file, or lists the folder, at `path`.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let content = if path.is_dir() { Content::Files(list(path)?) } else { Content::Text(read(path)?) };
        Ok(Self { path: path.to_owned(), content })
    }

    /// The file's text; `None` for a folder.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.content {
            Content::Text(text) => Some(text),
            Content::Files(_) => None,
        }
    }

    /// The file's text where it begins as an object of JSON does.
    pub(super) fn json(&self) -> Option<&str> {
        self.text().filter(|text| text.trim_start_matches('\u{feff}').trim_start().starts_with('{'))
    }

    /// The folder's files, by name; none for a file.
    pub(super) fn files(&self) -> &[PathBuf] {
        match &self.content {
            Content::Text(_) => &[],
            Content::Files(files) => files,
        }
    }

    /// The folder's own folders, by name; none for a file or what cannot be listed.
    pub(super) fn folders(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(&self.path).into_iter().flatten().flatten();
        let mut folders: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        folders.sort();
        folders
    }

    /// The folder that holds the file called `name` beside what was opened: the folder itself, or the file's own.
    pub(super) fn beside(&self, name: &str) -> Option<PathBuf> {
        let folder = if self.text().is_some() { self.path.parent()? } else { &self.path };
        Some(folder.join(name)).filter(|path| path.is_file())
    }

    /// Whether the file's name ends so, in any case.
    pub(super) fn has_extension(&self, extension: &str) -> bool {
        self.path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
    }
}

/// The text of a file.
pub(super) fn read(path: &Path) -> Result<String> {
    let fail = |found: &dyn std::fmt::Display| {
        Error::file(path, format!("expected a calibration file, found: {found}; check the path"))
    };
    let bytes = std::fs::read(path).map_err(|e| fail(&e))?;
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
