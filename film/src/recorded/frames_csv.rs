//! Writer of `frames.csv`, the capture times of a recording's frames.

use ode_visual_hull::source::frames_csv;
use ode_visual_hull::{Error, Result};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// First line of the table written here. A table with other columns comes from the user and is left alone.
const COLUMNS: &str = "frame,time";

/// The table of capture times in a recording's folder; each frame appends a line.
#[derive(Debug)]
pub struct FramesCsv {
    path: PathBuf,
    is_new: bool,
}

impl FramesCsv {
    /// Opens the table in `dir` and removes the lines of frames in `rewritten`. `None` where the table has columns
    /// other than frame and time.
    ///
    /// # Errors
    /// A table that exists and cannot be read, or cannot be written.
    pub fn open(dir: &Path, rewritten: Option<&Range<u32>>) -> Result<Option<Self>> {
        let path = dir.join(frames_csv::NAME);
        let text = match std::fs::read_to_string(&path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Some(Self { path, is_new: true })),
            text => text.map_err(|e| {
                Error::file(&path, format!("expected the frames' times, found: {e}; move it away"))
            })?,
        };

        // A table with other columns, one time for each camera, belongs to the user.
        if text.lines().next() != Some(COLUMNS) {
            return Ok(None);
        }

        // Drop the lines of frames that are about to be written again.
        let frame = |line: &str| line.split(',').next().and_then(|frame| frame.parse::<u32>().ok());
        let is_rewritten = |line: &str| match (frame(line), rewritten) {
            (Some(frame), Some(rewritten)) => rewritten.contains(&frame),
            _ => false,
        };
        let kept: String =
            text.lines().filter(|line| !is_rewritten(line)).map(|line| format!("{line}\n")).collect();
        if kept != text {
            std::fs::write(&path, kept).map_err(|e| not_written(&path, &e))?;
        }
        Ok(Some(Self { path, is_new: false }))
    }

    /// Appends `frame`, captured at `time` seconds.
    ///
    /// # Errors
    /// A table that cannot be written.
    pub fn add(&mut self, frame: u32, time: f64) -> Result<()> {
        // The heading is written with the first frame, so that no empty table is left behind.
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
        format!(
            "expected to write the frames' times, found: {e}; free space on the disk, or choose another folder"
        ),
    )
}
