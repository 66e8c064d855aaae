//! `vhull` on the command line: its output, files and exit codes.

mod check;
mod convert;
mod mesh;
mod synth;

use std::path::{Path, PathBuf};
use std::process::Command;

/// Exit code, standard output and standard error of a run.
struct Run {
    code: i32,
    out: String,
    error: String,
}

/// Runs `vhull` in `folder` with the arguments `words`.
fn vhull(folder: &Path, words: &[&str]) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_vhull")).args(words).current_dir(folder).output().unwrap();
    Run {
        code: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        error: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Creates an empty folder for a test.
fn folder(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("tool_{test}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// A folder that contains a small recording, `studio`, with five cameras and three frames.
fn studio(test: &str, subject: &str) -> PathBuf {
    let folder = folder(test);
    let words =
        ["synth", "studio", "--cameras", "5", "--frames", "3", "--size", "200x240", "--subject", subject];
    let run = vhull(&folder, &words);
    assert_eq!((run.code, run.error.as_str()), (0, ""), "{}", run.out);
    folder
}

#[test]
fn the_help_of_every_subcommand_has_examples() {
    let here = Path::new(".");
    for verb in ["check", "convert", "mesh", "synth"] {
        let run = vhull(here, &[verb, "--help"]);
        assert_eq!(run.code, 0);
        assert!(run.out.contains(&format!("Examples:\n  vhull {verb}")), "{}", run.out);
    }
    assert_eq!(vhull(here, &["frobnicate"]).code, 2);
    assert_eq!(vhull(here, &["check", "rig.toml", "--bounds", "0,1,0"]).code, 2);
}
