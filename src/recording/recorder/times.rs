//! The table of times of a recording that is being written.

use crate::rig::Rig;
use crate::source::frames_csv;
use crate::{Error, Result};
use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A new `frames.csv`. Each line is written at once, as a whole or not at all.
#[derive(Debug)]
pub(super) struct TimesTable {
    path: PathBuf,
    file: File,
    /// The length of the file in bytes.
    length: u64,
    /// Whether each camera has a column, or all share one.
    has_columns: bool,
}

impl TimesTable {
    /// Starts the table in folder `dir`.
    ///
    /// # Errors
    /// A table that exists already or cannot be written.
    pub(super) fn create(dir: &Path, rig: &Rig) -> Result<Self> {
        let path = dir.join(frames_csv::NAME);
        let file = OpenOptions::new().write(true).create_new(true).open(&path);
        let file = file.map_err(|e| Error::unwritten(&path, &e))?;

        // Names that the table cannot hold leave one column for the time of all.
        let fits = |name: &str| !name.contains([',', '\n', '\r']) && name.trim() == name && !name.is_empty();
        let names = || rig.cameras().iter().map(|camera| camera.name());
        let has_columns = names().all(fits);
        let columns = if has_columns { names().collect::<Vec<_>>().join(",") } else { "time".into() };

        let mut table = Self { path, file, length: 0, has_columns };
        table.append(&format!("frame,{columns}\n"))?;
        Ok(table)
    }

    /// Appends `frame`, at `time` seconds, whose images are of `times`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn add(&mut self, frame: u32, time: f64, times: &[f64]) -> Result<()> {
        let times = if self.has_columns { times } else { &[time] };
        let cells: String = times.iter().map(|time| format!(",{time}")).collect();
        self.append(&format!("{frame}{cells}\n"))
    }

    fn append(&mut self, line: &str) -> Result<()> {
        let written = self.file.write_all(line.as_bytes());
        if written.is_err() {
            // A part of a line would make the table unreadable. If this fails as well, the first error tells why.
            let _ = self.cut();
        }
        written.map_err(|e| Error::unwritten(&self.path, &e))?;
        self.length += line.len() as u64;
        Ok(())
    }

    fn cut(&mut self) -> io::Result<u64> {
        self.file.set_len(self.length)?;
        self.file.seek(SeekFrom::Start(self.length))
    }
}
