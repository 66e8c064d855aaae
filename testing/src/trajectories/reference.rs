//! The reference files. Each has a table of body poses, under comments that describe the scene.

use super::stage::{CONTACTS, DT, Run, SEED, Scene};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Steps from one row of a file to the next: 25 ms.
pub const EVERY: usize = 5;

/// Largest allowed RMS distance of the worst body on the hull from the reference, in pixels of the rig.
pub fn tolerance_px(scene: &Scene) -> f64 {
    if scene.edge_first { 4.0 } else { 2.0 }
}

/// Poses of bodies on ODE's own box, at some steps from the first impact to the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// The size of a pixel of the rig, in metres.
    pub pixel: f64,
    /// Largest RMS distance of the hull's run from this one, in pixels.
    pub tolerance_px: f64,
    /// Step numbers, and the poses of all bodies after each of these steps.
    pub rows: Vec<(usize, Vec<Isometry3<f64>>)>,
}

impl Reference {
    /// The reference from `run` on ODE's own box.
    pub fn of(scene: &Scene, run: &Run) -> Self {
        // The last step is included, whatever its number.
        let kept = (run.first..run.last).step_by(EVERY).chain([run.last]);
        let poses = |k: usize| run.states[k].iter().map(|state| state.pose).collect();
        Self {
            pixel: scene.rig.pixel(),
            tolerance_px: tolerance_px(scene),
            rows: kept.map(|k| (k, poses(k))).collect(),
        }
    }

    /// The last step.
    pub fn last(&self) -> usize {
        self.rows.last().map_or(0, |(k, _)| *k)
    }

    /// Reads the scene's file.
    ///
    /// # Panics
    ///
    /// If the file is missing or malformed.
    pub fn read(scene: &Scene) -> Self {
        let path = path(scene);
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| {
            panic!("{}: {error}; record it with RECORD_TRAJECTORIES=1", path.display())
        });
        Self::parse(&text)
            .unwrap_or_else(|| panic!("{}: expected header and rows as written", path.display()))
    }

    /// Writes the scene's file.
    ///
    /// # Panics
    ///
    /// If the file cannot be written.
    pub fn write(&self, scene: &Scene, run: &Run) {
        std::fs::write(path(scene), self.text(scene, run)).unwrap();
    }

    fn text(&self, scene: &Scene, run: &Run) -> String {
        let mut text = String::new();
        let rig = scene.rig;
        let (first, last) = (run.first as f64 * DT, run.last as f64 * DT);
        let l = rig.lengths;

        for line in [
            format!("{}: {}", scene.name, scene.about),
            format!("native geoms of ODE 0.16.2 on a box of {} x {} x {} m ({})", l.x, l.y, l.z, rig.name),
            format!(
                "1 kg a body, gravity 9.81 m/s^2, friction {}, dt {DT} s, quick step of 50 iterations, erp 0.2, cfm 1e-5, surface layer 1 mm, {CONTACTS} contacts a pair, seed {SEED}",
                scene.surface.mu
            ),
            format!("from the first impact at {first:.3} s to {last:.3} s: {}", run.ending),
            format!("pixel_m = {:e}", self.pixel),
            format!("tolerance_px = {}", self.tolerance_px),
        ] {
            writeln!(text, "# {line}").unwrap();
        }

        writeln!(text, "t,body,x,y,z,qw,qx,qy,qz").unwrap();
        for (k, poses) in &self.rows {
            for (body, pose) in poses.iter().enumerate() {
                let (p, q) = (pose.translation.vector, pose.rotation);
                write!(text, "{:.3},{body}", *k as f64 * DT).unwrap();
                for number in [p.x, p.y, p.z, q.w, q.i, q.j, q.k] {
                    // Adding zero turns -0 into 0.
                    write!(text, ",{:.12}", (number * 1e12).round() / 1e12 + 0.0).unwrap();
                }
                text.push('\n');
            }
        }

        text
    }

    fn parse(text: &str) -> Option<Self> {
        let header = |name: &str| {
            let line = text
                .lines()
                .find_map(|line| line.strip_prefix("# ")?.strip_prefix(name)?.strip_prefix(" = "));
            line?.parse().ok()
        };

        let mut rows: Vec<(usize, Vec<Isometry3<f64>>)> = Vec::new();
        for line in text.lines().filter(|line| !line.starts_with(['#', 't'])) {
            let numbers: Vec<f64> = line.split(',').map(|field| field.parse().ok()).collect::<Option<_>>()?;
            let [t, body, x, y, z, w, i, j, k] = numbers[..] else { return None };

            let step = (t / DT).round() as usize;

            // Not normalised, so that the file is compared as it is.
            let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
            let pose = Isometry3::from_parts(Translation3::new(x, y, z), rotation);

            if body == 0.0 {
                rows.push((step, Vec::new()));
            }
            rows.last_mut()?.1.push(pose);
        }

        Some(Self { pixel: header("pixel_m")?, tolerance_px: header("tolerance_px")?, rows })
    }
}

fn path(scene: &Scene) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../tests/trajectories/{}.csv", scene.name))
}
