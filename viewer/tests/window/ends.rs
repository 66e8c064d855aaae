//! How a live system begins and ends: without a display, by a signal, with a recording that goes on or breaks off.

use super::display::{Display, End, folder};
use ode_visual_hull::recording::Recording;
use ode_visual_hull_film::{FinishedRun, States};
use std::path::Path;
use std::process::{Command, Stdio};

const SMALL: [&str; 5] = ["live", "--synthetic", "3", "--image-size", "160x120"];

fn run(words: &[&str], display: Option<&str>, folder: &Path) -> End {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vhull-view"));
    command.args(words).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").env_remove("DISPLAY");
    display.map(|display| command.env("DISPLAY", display));
    let output = command.current_dir(folder).stdin(Stdio::null()).output().expect("vhull-view runs");
    End {
        succeeded: output.status.success(),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        error: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

fn headless(more: &[&str], folder: &Path) -> End {
    run(&[&SMALL, &["--headless", "--size", "160x120", "--renderer", "cpu"], more].concat(), None, folder)
}

#[test]
fn without_a_display_it_says_what_else_to_do() {
    let folder = folder("no_display");
    let end = run(&SMALL, None, &folder);
    assert!(
        !end.succeeded && end.error.contains("neither DISPLAY nor WAYLAND_DISPLAY is set"),
        "{}",
        end.error
    );
    assert!(end.error.contains("--headless"), "{}", end.error);
    let end = run(&SMALL, Some(":4711"), &folder);
    assert!(!end.succeeded && end.error.contains("none that answers at DISPLAY=:4711"), "{}", end.error);
}

#[test]
fn real_time_is_given_or_refused_with_what_allows_it() {
    let end = headless(&["--seconds", "1", "--real-time"], &folder("real_time"));
    assert!(
        if end.succeeded { end.out.contains(" in time") } else { end.error.contains("USER - rtprio 1") },
        "{}",
        end.error
    );
}

#[cfg(unix)]
#[test]
fn a_window_that_is_terminated_ends_with_its_report_and_its_film() {
    let display = Display::start();
    let folder = folder("terminated");
    let film = folder.join("film.mp4");
    let words = ["--synthetic", "3", "--image-size", "160x120", "--film", film.to_str().expect("a path")];
    let session = display.live(&words);
    let process = session.process().to_string();
    assert!(Command::new("kill").args(["-TERM", &process]).status().expect("kill runs").success());
    let end = session.end();
    assert!(end.succeeded && end.out.contains("image sets"), "{}{}", end.out, end.error);
    let probe = Command::new("ffprobe")
        .args([
            "-v",
            "error",
            "-count_frames",
            "-show_entries",
            "stream=width,nb_read_frames",
            "-of",
            "csv=p=0",
        ])
        .arg(&film)
        .output()
        .expect("ffprobe runs");
    let probe = String::from_utf8_lossy(&probe.stdout).into_owned();
    assert!(probe.starts_with("320,") && !probe.contains("N/A"), "{probe}");
}

#[test]
fn what_is_recorded_can_be_filmed_afterwards_with_its_bodies() {
    let folder = folder("recorded");
    let end = headless(&["--seconds", "6", "--record", "live", "--bodies", "rain", "--count", "4"], &folder);
    assert!(end.succeeded && end.out.contains("recorded"), "{}{}", end.out, end.error);

    let recording = Recording::open(folder.join("live")).expect("a recording");
    assert!(recording.has_images() && recording.frames().len() > 10, "{} frames", recording.frames().len());
    let run = FinishedRun::read(folder.join("live").join(States::NAME), folder.join("live/bodies.toml"));
    let run = run.expect("states and bodies");
    // The four boxes, and the balls that may be thrown.
    assert!(run.states().body_count() > 4);

    let words = ["film", "live", "--states", "live/states.csv", "--size", "96x72", "--samples", "1"];
    let film = self::run(&[&words[..], &["--renderer", "cpu", "--out", "film.gif"]].concat(), None, &folder);
    assert!(film.succeeded && film.out.contains("frames, drawn by"), "{}{}", film.out, film.error);
}

#[test]
fn a_folder_that_holds_a_recording_is_not_recorded_to() {
    let folder = folder("twice");
    let end = headless(&["--seconds", "1", "--record", "live"], &folder);
    assert!(end.succeeded, "{}", end.error);
    let end = headless(&["--seconds", "1", "--record", "live"], &folder);
    assert!(!end.succeeded && end.error.contains("choose another folder"), "{}", end.error);
}

#[test]
fn cameras_that_do_not_fit_the_rig_are_refused_by_name() {
    let folder = folder("rig");
    let end = headless(&["--seconds", "1", "--record", "live"], &folder);
    assert!(end.succeeded, "{}", end.error);
    let rig = ["live", "--rig", "live/rig.toml", "--headless", "--seconds", "1"];
    let refused = |more: &[&str], expected: &str| {
        let end = run(&[&rig[..], more].concat(), None, &folder);
        assert!(!end.succeeded && end.error.contains(expected), "{more:?}: {}", end.error);
    };
    refused(
        &["--camera", "left=/dev/video0"],
        "expected one of cam0, cam1, cam2, the cameras of the rig, found left",
    );
    refused(&["--camera", "cam0=/dev/video0"], "found none for cam1");
    refused(&["--camera", "cam0"], "expected NAME=SOURCE");
}

#[test]
fn a_camera_that_is_missing_is_told_and_looked_for_again() {
    let folder = folder("missing");
    let end = headless(&["--seconds", "1", "--record", "live"], &folder);
    assert!(end.succeeded, "{}", end.error);
    let cameras = [
        "--camera",
        "cam0=/dev/video-none",
        "--camera",
        "cam1=/dev/video-none",
        "--camera",
        "cam2=/dev/video-none",
    ];
    let words = ["live", "--rig", "live/rig.toml", "--headless", "--seconds", "3", "--size", "160x120"];
    let end = run(&[&words[..], &cameras].concat(), None, &folder);
    assert!(end.succeeded, "{}", end.error);
    assert!(end.error.contains("/dev/video-none") && end.error.contains("trying again"), "{}", end.error);
    assert!(end.error.contains("no empty room is learnt"), "{}", end.error);
}
