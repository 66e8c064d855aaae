//! Recordings of a synthetic studio, made while its film is made, in the hands of the tool.

use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::hull::{Aabb, HullData, Motion};
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, layout};
use ode_visual_hull_film::{
    BodiesFile, FilmOptions, FinishedRun, Scenario, Simulation, States, Story, Studio, run_film,
};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

/// Height of the table's top, in metres.
const TABLE_TOP: f64 = 0.4;

/// Frames of the film.
const FRAMES: usize = 6;

/// A table that is lifted by 5 mm a frame.
struct Table;

impl Scenario for Table {
    fn name(&self) -> &str {
        "table"
    }

    fn subject(&self, time: f64) -> Result<Subject> {
        let pose = Isometry3::translation(0.0, 0.0, 0.5 * TABLE_TOP + 0.15 * time);
        let solid = Solid::cuboid(Vector3::new(0.5, 0.5, TABLE_TOP))?;
        Ok(Subject::new(vec![Placed::new(solid, pose, Texture::plain([180, 40, 40]))]))
    }

    fn top(&self, time: f64) -> Option<f64> {
        Some(TABLE_TOP + 0.15 * time)
    }

    fn still_until(&self) -> f64 {
        0.0
    }

    fn end(&self) -> f64 {
        FRAMES as f64 / 30.0
    }

    fn moments(&self) -> [f64; 3] {
        [0.0; 3]
    }
}

/// Runs the verb on the recording, which has to succeed.
fn vhull(verb: &str, recording: &Path, arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vhull"));
    let output = command.arg(verb).arg(recording).args(arguments).output().unwrap();
    let (out, error) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{verb}: {out}{error}");
}

#[test]
fn a_studio_recorded_while_its_film_is_made_is_checked_and_run_by_the_tool() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("studio");
    let _ = std::fs::remove_dir_all(&folder);
    let (recording, out) = (folder.join("recording"), folder.join("out"));

    let data = Arc::new(HullData::new());
    let cameras = layout::ring(6, 3.0, TABLE_TOP, Point3::new(0.0, 0.0, 0.4), (200, 160), 0.6).unwrap();
    let bounds = Aabb::new(Point3::new(-0.6, -0.6, -0.1), Point3::new(0.6, 0.6, 1.0)).unwrap();
    let mut studio = Studio::new(Table, cameras, bounds, 1, &data).unwrap();
    studio.record(&recording).unwrap();
    let mut simulation = Simulation::new(&data, 0.01, Motion::Held).unwrap();
    let pose = Isometry3::translation(0.0, 0.0, TABLE_TOP + 0.06);
    simulation.add(&Shape::cube(0.1), &pose, [66, 118, 202]).unwrap();
    let options = FilmOptions { out: &out, name: "table", frames: FRAMES, view: None };
    run_film(&options, &mut studio, &data, &mut simulation, &mut |_| ()).unwrap();

    // The film's own description fits the recording.
    let run = FinishedRun::read(out.join(States::NAME), out.join(BodiesFile::NAME)).unwrap();
    let played = run.playback().unwrap();
    assert_eq!((Some(&played.options), played.motion), (studio.playback().as_ref(), Motion::Held));
    assert_eq!((run.times().len(), played.options.frames.clone()), (FRAMES, Some(0..FRAMES as u32)));
    assert_eq!(run.drawn(0)[0].shape, Shape::cube(0.1));

    vhull("check", &recording, &["--bounds", "-0.6,0.6,-0.6,0.6,-0.1,1"]);
    let again = folder.join("again");
    vhull("run", &recording, &["--count", "1", "--wait", "0.2", "--out", again.to_str().unwrap()]);
    assert!(again.join("run.gif").is_file());
}
