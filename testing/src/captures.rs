//! Real recordings for some tests and figures. They are not part of the repository.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, Hull, HullData, Unseen};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The environment variable that names the folder of captures.
pub const VARIABLE: &str = "ODE_VISUAL_HULL_DATA";

/// The work volume of the capture `seated_person`.
pub const SEATED: Aabb = Aabb { min: Point3::new(-0.5, -0.5, 0.0), max: Point3::new(1.5, 1.5, 2.0) };

/// The work volume of the capture `balancing_person`.
pub const BALANCING: Aabb = Aabb { min: Point3::new(-1.5, -1.5, 0.0), max: Point3::new(1.5, 1.5, 2.2) };

/// The known bounding box of the subject of the capture `dino`.
pub const DINO: Aabb =
    Aabb { min: Point3::new(-0.0619, -0.0189, -0.0578), max: Point3::new(0.0109, 0.0682, 0.0155) };

/// The file or folder at `path` among the captures: in the folder that [`VARIABLE`] names, else in `../shared/data`
/// beside the repository. Where it is absent, this prints that the test is skipped and returns `None`.
pub fn find(path: &str) -> Option<PathBuf> {
    let default = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let found = std::env::var_os(VARIABLE).map_or_else(default, PathBuf::from).join(path);
    if found.exists() {
        return Some(found);
    }
    eprintln!("skipped: no {}; set {VARIABLE} to the folder of captures", found.display());
    None
}

/// The hull in `bounds` of a frame of the recording in the folder `dir`.
///
/// # Panics
///
/// If the recording cannot be read.
pub fn hull_of(dir: &Path, frame: u32, bounds: Aabb, unseen: Unseen) -> Arc<Hull> {
    let read = || {
        let recording = Recording::open(dir)?;
        let data = HullData::new();
        data.set_bounds(bounds)?;
        data.set_unseen(unseen)?;
        for (camera, mask) in recording.rig().cameras().iter().zip(recording.masks(frame)?) {
            data.set_mask(data.add_view(camera.clone())?, &mask)?;
        }
        data.update(0.0)
    };
    read().expect("a recording")
}

/// The volume of a hull in cubic metres and its bounding box, from a grid of points `spacing` metres apart.
pub fn carve(hull: &Hull, spacing: f64) -> (f64, Aabb) {
    let bounds = hull.bounds();
    let counts = (bounds.max - bounds.min).map(|extent| (extent / spacing) as usize);

    let (mut count, mut aabb) = (0, Aabb::EMPTY);

    for k in 0..counts.z {
        for j in 0..counts.y {
            for i in 0..counts.x {
                let p = bounds.min + Vector3::new(i, j, k).map(|n| (n as f64 + 0.5) * spacing);
                if hull.inside(&p) {
                    count += 1;
                    aabb = aabb.union(&Aabb { min: p, max: p });
                }
            }
        }
    }

    (count as f64 * spacing.powi(3), aabb)
}

/// The numbered cameras of the capture `dino`, without the sixth, which has no usable mask.
///
/// # Panics
///
/// If the calibration cannot be read.
pub fn dino_cameras(dir: &Path) -> Vec<(usize, Camera)> {
    let rig = Rig::load(dir.join("dinoSR_par.txt")).expect("a calibration");
    (1..).zip(rig.cameras().iter().cloned()).filter(|&(view, _)| view != 6).collect()
}
