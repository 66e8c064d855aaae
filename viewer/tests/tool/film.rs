//! Films of finished runs.

use super::{PERSON, Run, command, finished, recorded, view};
use nalgebra::Isometry3;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::shape::Shape;
use ode_visual_hull_film::{BodiesFile, DrawnPart, PlaybackOptions, PlayedRecording};
use std::path::{Path, PathBuf};

/// A folder with the recording `person` and a run of three frames in which a box falls.
fn with_run(test: &str) -> PathBuf {
    let folder = recorded(test, 5, 4);
    let part =
        DrawnPart { shape: Shape::cube(0.2), body_from_part: Isometry3::identity(), colour: [222, 86, 62] };
    let options = PlaybackOptions { frames: Some(0..3), rate: Some(30.0), ..PlaybackOptions::default() };
    let playback = Some(PlayedRecording { options, motion: Motion::Held });
    let bodies = BodiesFile { bodies: vec![vec![part]], fixed: Vec::new(), playback };
    bodies.write(folder.join(BodiesFile::NAME)).expect("bodies");
    let mut states = String::from("time_s,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n");
    for k in 1..=3 {
        let time = f64::from(k) / 30.0;
        states += &format!("{time:.4},1,0.6,0.0,{:.4},1,0,0,0,0,0,0,0,0,0\n", 1.0 - 0.1 * f64::from(k));
    }
    std::fs::write(folder.join("states.csv"), states).expect("states");
    folder
}

fn film(folder: &Path, more: &[&str]) -> Run {
    let words = [
        "film",
        "person",
        "--states",
        "states.csv",
        "--size",
        "96x72",
        "--samples",
        "1",
        "--renderer",
        "cpu",
    ];
    view(folder, &[&words, more].concat())
}

/// Width, height and number of frames of a film.
fn probed(folder: &Path, name: &str) -> String {
    let probe = std::process::Command::new("ffprobe")
        .args(["-v", "error", "-count_frames", "-select_streams", "v:0", "-of", "csv=p=0"])
        .args(["-show_entries", "stream=width,height,nb_read_frames", name])
        .current_dir(folder)
        .output()
        .expect("ffprobe runs");
    String::from_utf8_lossy(&probe.stdout).trim().to_owned()
}

fn refused(folder: &Path, more: &[&str], expected: &str) {
    let run = film(folder, more);
    assert!(!run.succeeded && run.error.contains(expected), "{more:?}: {}", run.error);
}

#[test]
fn a_film_has_a_frame_for_each_entry_of_the_states() {
    let folder = with_run("film");
    for name in ["film.gif", "film.mp4"] {
        let run = film(&folder, &["--out", name]);
        assert!(run.succeeded && run.out.contains("3 frames"), "{}{}", run.out, run.error);
        assert_eq!(probed(&folder, name), "96,72,3", "{name}");
    }
}

#[test]
fn a_tour_is_followed_and_a_viewpoint_in_a_body_is_noted() {
    let folder = with_run("tour");
    std::fs::write(folder.join("tour.toml"), "[[key]]\ntime = 0\neye = [0.6, 0, 0.9]\n").expect("a tour");
    let run = film(&folder, &["--tour", "tour.toml"]);
    assert!(run.succeeded && run.error.contains("it is inside body 1"), "{}", run.error);
}

#[test]
fn files_of_a_run_that_are_missing_or_wrong_are_refused_by_name() {
    let folder = with_run("wrong_files");
    refused(&folder, &["--tour", "missing.toml"], "missing.toml: expected a tour");
    std::fs::write(folder.join("tour.toml"), "[[key]]\ntime = 0\nspeed = 1\n").expect("a tour");
    refused(&folder, &["--tour", "tour.toml"], "unknown field `speed`");
    refused(&folder, &["--out", "film.avi"], "expected a film's name to end with .gif or .mp4");
    std::fs::write(folder.join("states.csv"), "time,body\n").expect("states");
    refused(&folder, &[], "states.csv");
    std::fs::remove_file(folder.join("bodies.toml")).expect("a file");
    std::fs::remove_file(folder.join("states.csv")).expect("a file");
    refused(&folder, &[], "states.csv");
}

#[test]
fn a_frame_without_a_subject_ends_the_film_and_the_frames_before_are_kept() {
    let folder = with_run("lost_subject");
    let masks = folder.join("person").join(PERSON.cameras[0].name()).join("mask");
    let mut files: Vec<_> =
        masks.read_dir().expect("masks").map(|file| file.expect("a mask").path()).collect();
    files.sort();
    image::GrayImage::new(160, 120).save(&files[2]).expect("an empty mask");
    refused(&folder, &["--out", "film.gif"], "the 2 frames before are in film.gif");
    assert_eq!(probed(&folder, "film.gif"), "96,72,2");
}

#[test]
fn an_mp4_without_ffmpeg_says_what_to_install() {
    let folder = with_run("no_ffmpeg");
    let words = ["film", "person", "--states", "states.csv", "--renderer", "cpu", "--out", "film.mp4"];
    let mut without = command(&folder, &words);
    without.env("PATH", &folder);
    let run = finished(without);
    let says = "install ffmpeg, or give a name that ends with .gif";
    assert!(!run.succeeded && run.error.contains(says), "{}", run.error);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_a_film_with_an_error() {
    let folder = with_run("full_film");
    for name in ["film.gif", "film.mp4"] {
        let path = folder.join(name);
        std::os::unix::fs::symlink("/dev/full", &path).expect("a link");
        refused(&folder, &["--out", name], name);
    }
}
