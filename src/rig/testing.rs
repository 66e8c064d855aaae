//! Calibrations from text and from folders of files, for the tests of their readers.

use super::{
    Calibration, Hints, colmap, easymocap, kalibr, matrices, middlebury, nerfstudio, opencv, panoptic,
    qualisys, ros, toml, voxelpose,
};
use crate::Result;
use crate::camera::Camera;
use nalgebra::Point3;
use std::fmt::Debug;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Hints for formats without a unit or without image sizes.
pub(super) const HINTS: Hints = Hints { size: Some((640, 480)), metres_per_unit: Some(1.0) };

/// A calibration in a single file, with a typical file name.
pub(super) struct Sample {
    pub(super) name: &'static str,
    pub(super) text: &'static str,
}

/// At least one file of each format that consists of a single file.
pub(super) fn single_files() -> impl Iterator<Item = Sample> {
    let files = [
        ("rig.toml", toml::tests::CAMERA),
        ("rig_par.txt", middlebury::tests::TEXT),
        ("studio.qca.txt", qualisys::tests::TEXT),
        ("calibration_171204_pose1.json", panoptic::tests::TEXT),
        ("calibration_shelf.json", voxelpose::tests::TEXT),
        ("transforms.json", nerfstudio::tests::TEXT),
        ("camchain.yaml", kalibr::tests::CHAIN),
        ("left.yml", opencv::tests::YAML),
        ("left.xml", opencv::tests::XML),
        ("left.json", opencv::tests::JSON),
        ("matrices.txt", matrices::tests::ROWS),
    ];

    files.into_iter().map(|(name, text)| Sample { name, text })
}

/// The names and texts of the files of each format that consists of several.
pub(super) fn several_files() -> [&'static [(&'static str, &'static str)]; 4] {
    [
        &[("cameras.txt", colmap::tests::CAMERAS), ("images.txt", colmap::tests::IMAGES)],
        &[("intri.yml", easymocap::tests::INTRI), ("extri.yml", easymocap::tests::EXTRI)],
        &[("left.yaml", ros::tests::INFO), ("left_pose.yaml", ros::tests::POSE)],
        &[("left.yaml", ros::tests::MESSAGE), ("left_pose.yaml", ros::tests::POSE)],
    ]
}

/// A folder that is removed at the end of its test.
pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn new() -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let (process, number) = (std::process::id(), NUMBER.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(format!("ode-visual-hull-rig-{process}-{number}"));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A folder that holds these files.
    pub(super) fn of(files: &[(&str, &str)]) -> Self {
        let folder = Self::new();
        for (name, text) in files {
            folder.write(name, text);
        }
        folder
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Writes a file and the folders above it, and returns its path.
    pub(super) fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        path
    }

    pub(super) fn load(&self) -> Result<Calibration> {
        Calibration::load(&self.0, &Hints::default())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Loads the calibration from a folder with these files.
pub(super) fn load_folder(files: &[(&str, &str)], hints: &Hints) -> Result<Calibration> {
    Calibration::load(Folder::of(files).path(), hints)
}

/// Loads the calibration from a file whose name says nothing about its format.
pub(super) fn load_text(text: &str, hints: &Hints) -> Result<Calibration> {
    let folder = Folder::new();
    Calibration::load(folder.write("calibration.txt", text), hints)
}

/// Asserts that the error message contains all of `parts`.
#[track_caller]
pub(super) fn assert_refused<T: Debug>(result: Result<T>, parts: &[&str]) {
    let message = result.unwrap_err().to_string();
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

/// Asserts that `camera` projects `point` to (u, v), up to the rounding of a few operations.
#[track_caller]
pub(super) fn assert_sees(camera: &Camera, point: [f64; 3], u: f64, v: f64) {
    let found = camera.project(&Point3::from(point)).unwrap();
    assert!((found.u - u).abs() < 1e-9 && (found.v - v).abs() < 1e-9, "found {found:?}, not {u}, {v}");
}

/// Asserts that a thousand points spread over the image, at depths of 0.3 to 8 m, return to their pixels when they are
/// unprojected and projected, twice. Returns how many of them the lens model reaches.
pub(super) fn assert_points_return(camera: &Camera) -> usize {
    let (width, height) = camera.size();
    // Powers of the inverse of the root of x^4 = x + 1 spread points evenly in three dimensions.
    let unit = |i: u32, power: i32| (f64::from(i) * 0.819_172_513_396_164_4_f64.powi(power)).fract();
    let mut reached = 0;
    for i in 0..1000 {
        let (u, v) = (f64::from(width) * unit(i, 1), f64::from(height) * unit(i, 2));
        let Some(world) = camera.unproject(u, v, 0.3 + 7.7 * unit(i, 3)) else { continue };
        let seen = camera.project(&world).unwrap();
        let again = camera.project(&camera.unproject(seen.u, seen.v, seen.depth).unwrap()).unwrap();
        for pixel in [seen, again] {
            assert!((pixel.u - u).abs() < 1e-6 && (pixel.v - v).abs() < 1e-6, "{pixel:?}, not {u}, {v}");
        }
        reached += 1;
    }
    reached
}
