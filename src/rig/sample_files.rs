//! Calibrations from text, for tests of their readers.

use super::{Calibration, Hints};
use crate::Result;
use crate::camera::Camera;
use nalgebra::Point3;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What arbitrary scales and files without sizes need.
pub(super) const HINTS: Hints = Hints { size: Some((640, 480)), metres_per_unit: Some(1.0) };

/// A folder of text files, removed with this.
pub(super) struct Folder(pub(super) PathBuf);

impl Folder {
    pub(super) fn of(files: &[(&str, &str)]) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("ode-visual-hull-rig-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        let folder = Self(path);
        for (name, text) in files {
            std::fs::write(folder.0.join(name), text).unwrap();
        }
        folder
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The calibration in a folder of these files.
pub(super) fn load_folder(files: &[(&str, &str)], hints: &Hints) -> Result<Calibration> {
    Calibration::load(&Folder::of(files).0, hints)
}

/// The calibration in a file of a name that says nothing.
pub(super) fn load_text(text: &str, hints: &Hints) -> Result<Calibration> {
    let folder = Folder::of(&[("calibration.txt", text)]);
    Calibration::load(folder.0.join("calibration.txt"), hints)
}

/// That an error says all of `parts`.
pub(super) fn assert_refused(result: Result<Calibration>, parts: &[&str]) {
    let message = result.unwrap_err().to_string();
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

/// That `camera` sees `point` at (u, v), to the rounding of a few operations.
pub(super) fn assert_sees(camera: &Camera, point: [f64; 3], u: f64, v: f64) {
    let found = camera.project(&Point3::from(point)).unwrap();
    assert!((found.u - u).abs() < 1e-9 && (found.v - v).abs() < 1e-9, "found {found:?}, not {u}, {v}");
}
