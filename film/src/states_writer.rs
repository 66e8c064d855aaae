//! Writes `states.csv` while a simulation runs.

use crate::simulated_body::State;
use crate::states::HEADER;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::{Error, Result};
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A file of states that grows entry by entry. [`States`](crate::States) reads it, at any time between two entries.
#[derive(Debug)]
pub struct StatesWriter {
    path: PathBuf,
    file: File,
    text: String,
}

impl StatesWriter {
    /// Begins the file at `path`, which is replaced if it exists.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref().to_owned();
        let file = File::create(&path).map_err(|e| unwritten(&path, &e))?;
        let mut writer = Self { path, file, text: format!("{HEADER}\n") };
        writer.write()?;
        Ok(writer)
    }

    /// Adds the states of all bodies at `time`, in seconds. Each entry has as many bodies as the first one.
    ///
    /// # Errors
    /// A file that cannot be written, as on a full disk.
    pub fn add(&mut self, time: f64, states: &[State]) -> Result<()> {
        write_entry(&mut self.text, time, states);
        self.write()
    }

    /// Writes what is waiting in one piece, so that no entry is cut off where the program ends.
    fn write(&mut self) -> Result<()> {
        let written = self.file.write_all(self.text.as_bytes());
        self.text.clear();
        written.map_err(|e| unwritten(&self.path, &e))
    }
}

impl State {
    /// The state that stands in a file for a body that does not exist at that time: a kilometre below the floor, where no
    /// picture shows it.
    pub fn absent() -> Self {
        Self {
            pose: Isometry3::translation(0.0, 0.0, -1000.0),
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
        }
    }
}

/// Appends one line for each body, numbered from 1.
pub(crate) fn write_entry(text: &mut String, time: f64, states: &[State]) {
    for (i, state) in states.iter().enumerate() {
        let (p, q) = (state.pose.translation.vector, state.pose.rotation.coords);
        let (v, w) = (state.linear_velocity, state.angular_velocity);
        let numbers = [p.x, p.y, p.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z];
        let _ = write!(text, "{time:.4},{}", i + 1);
        for number in numbers {
            let _ = write!(text, ",{number:.6}");
        }
        text.push('\n');
    }
}

fn unwritten(path: &Path, found: &std::io::Error) -> Error {
    Error::file(path, format!("expected to write the states, found: {found}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::States;

    #[test]
    fn what_is_written_can_be_read_after_each_entry() {
        let path = std::env::temp_dir().join(format!("ode-visual-hull-states-{}", std::process::id()));
        let mut writer = StatesWriter::create(&path).unwrap();
        let at = |x: f64| State { pose: Isometry3::translation(x, 0.5, 0.25), ..State::absent() };
        for k in 1..=3 {
            writer.add(0.1 * f64::from(k), &[at(f64::from(k)), State::absent()]).unwrap();
            let states = States::read(&path).unwrap();
            assert_eq!((states.times().len(), states.body_count()), (k as usize, 2));
            let last = states.poses(k as usize - 1).unwrap();
            assert_eq!(last, [at(f64::from(k)).pose, State::absent().pose]);
        }
        std::fs::remove_file(path).unwrap();
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_that_names_the_file() {
        let error = StatesWriter::create("/dev/full").unwrap_err().to_string();
        assert!(error.starts_with("/dev/full: expected to write the states, found"), "{error}");
    }
}
