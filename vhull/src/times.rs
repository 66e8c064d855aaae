//! The file `frames.csv` with the times of a recording's frames.

use ode_visual_hull::source::frames_csv;
use ode_visual_hull::{Error, Result};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The first line of tables that this program writes. A table with other columns is left as it is.
const COLUMNS: &str = "frame,time";

/// A table that grows by a line for each frame.
#[derive(Debug)]
pub struct Times {
    path: PathBuf,
    is_new: bool,
}

impl Times {
    /// The table of the recording in `dir`, without the lines of the frames `rewritten`; `None` where a table with other
    /// columns is there.
    ///
    /// # Errors
    /// A table that cannot be read or written.
    pub fn open(dir: &Path, rewritten: Option<&Range<u32>>) -> Result<Option<Self>> {
        let path = dir.join(frames_csv::NAME);
        let text = match std::fs::read_to_string(&path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Some(Self { path, is_new: true })),
            text => text.map_err(|e| {
                Error::file(&path, format!("expected the frames' times, found: {e}; move it away"))
            })?,
        };

        if text.lines().next() != Some(COLUMNS) {
            return Ok(None);
        }
        let frame = |line: &str| line.split(',').next().and_then(|frame| frame.parse::<u32>().ok());
        let is_kept = |line: &&str| {
            !frame(line).is_some_and(|frame| rewritten.is_some_and(|rewritten| rewritten.contains(&frame)))
        };
        let kept: String = text.lines().filter(is_kept).map(|line| format!("{line}\n")).collect();
        if kept != text {
            std::fs::write(&path, kept).map_err(|e| not_written(&path, &e))?;
        }

        Ok(Some(Self { path, is_new: false }))
    }

    /// Adds a frame, taken at `time` seconds.
    pub fn add(&mut self, frame: u32, time: f64) -> Result<()> {
        let heading = if self.is_new { format!("{COLUMNS}\n") } else { String::new() };
        let file = OpenOptions::new().create(true).append(true).open(&self.path);
        file.and_then(|mut file| file.write_all(format!("{heading}{frame},{time:.6}\n").as_bytes()))
            .map_err(|e| not_written(&self.path, &e))?;
        self.is_new = false;
        Ok(())
    }
}

fn not_written(path: &Path, e: &std::io::Error) -> Error {
    Error::file(
        path,
        format!("expected to write the frames' times, found: {e}; make room, or choose another folder"),
    )
}
