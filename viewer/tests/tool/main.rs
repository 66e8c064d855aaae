//! `vhull-view` on the command line, with small recordings of a synthetic person.

mod bad_input;
mod film;

use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::synthetic::{Subject, coverage};
use ode_visual_hull_testing::rendered::Rendered;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// What a command printed, and whether it succeeded.
struct Run {
    succeeded: bool,
    out: String,
    error: String,
}

/// A person seen by five cameras.
static PERSON: LazyLock<Rendered> =
    LazyLock::new(|| Rendered::new(Subject::person_at(0.4), 5, (160, 120)).expect("a scene"));

/// Runs `vhull-view` in `folder` with the arguments `words`.
fn view(folder: &Path, words: &[&str]) -> Run {
    finished(command(folder, words))
}

fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vhull-view"));
    command.args(words).current_dir(folder);
    command
}

fn finished(mut command: Command) -> Run {
    let output = command.output().expect("vhull-view runs");
    Run {
        succeeded: output.status.success(),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        error: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Creates an empty folder for a test.
fn folder(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("view_{test}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder");
    path
}

/// A folder with the recording `person` of the first `cameras` cameras: `frames` frames with masks, all with images but the
/// last.
fn recorded(test: &str, cameras: usize, frames: u32) -> PathBuf {
    let folder = folder(test);
    let rig = Rig::new(PERSON.cameras[..cameras].to_vec()).expect("cameras");
    let mut recording = Recording::create(folder.join("person"), &rig).expect("a recording");
    let masks: Vec<_> = rig.cameras().iter().map(|camera| coverage(camera, &PERSON.scene.subject)).collect();
    for frame in 0..frames {
        recording.write_masks(frame, &masks).expect("masks");
        if frame + 1 < frames {
            recording.write_images(frame, &PERSON.images[..cameras]).expect("images");
        }
    }
    folder
}

#[test]
fn the_help_of_every_subcommand_says_what_it_draws() {
    for (verb, says) in [
        ("still", "one frame of a recording"),
        ("film", "a moving viewpoint"),
        ("compare", "beside its own image"),
    ] {
        let run = view(Path::new("."), &[verb, "--help"]);
        assert!(run.succeeded && run.out.contains(says), "{}", run.out);
    }
}

#[test]
fn a_still_has_the_size_asked_for_and_shows_the_person() {
    let folder = recorded("still", 5, 2);
    let run = view(&folder, &["still", "person", "--size", "200x150", "--out", "new/still.png"]);
    assert!(run.succeeded && run.error.is_empty(), "{}", run.error);
    let picture = image::open(folder.join("new/still.png")).expect("a picture").into_rgb8();
    assert_eq!(picture.dimensions(), (200, 150));
    // The shirt is the only thing that is red.
    let is_red = |pixel: &&image::Rgb<u8>| pixel.0[0] > 100 && pixel.0[1] < 60 && pixel.0[2] < 60;
    assert!(picture.pixels().filter(is_red).count() > 200);
}

#[test]
fn a_still_from_the_place_of_a_camera_is_its_image() {
    let folder = recorded("snap", 5, 2);
    let name = PERSON.cameras[2].name();
    let run = view(&folder, &["still", "person", "--camera", name, "--samples", "1", "--out", "snap.png"]);
    assert!(run.succeeded, "{}", run.error);
    let picture = image::open(folder.join("snap.png")).expect("a picture").into_rgb8();
    assert_eq!(picture, PERSON.images[2]);
}
