//! `vhull`: from calibrated cameras to a visual hull. Each subcommand has a file of its own.

mod arguments;
mod check;
mod convert;
mod mesh;
mod output;
mod progress;
mod run;
mod segment;
mod synth;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Visual hulls from several calibrated cameras: check a rig, segment its images, simulate collisions with the subject.
#[derive(Debug, Parser)]
#[command(name = "vhull", version, after_help = EXIT_CODES)]
struct Options {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Check(check::Options),
    Convert(convert::Options),
    Mesh(mesh::Options),
    Run(run::Options),
    Segment(segment::Options),
    Synth(synth::Options),
}

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  an error, printed on standard error
  2  an invalid command line
  3  `check` found problems";

/// Result of a subcommand that ran without an error; the exit code follows from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Done,
    ProblemsFound,
}

fn main() -> ExitCode {
    let outcome = match Options::parse().verb {
        Verb::Check(options) => check::run(&options),
        Verb::Convert(options) => convert::run(&options),
        Verb::Mesh(options) => mesh::run(&options),
        Verb::Run(options) => run::run(&options),
        Verb::Segment(options) => segment::run(&options),
        Verb::Synth(options) => synth::run(&options),
    };

    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::ProblemsFound) => ExitCode::from(3),
        Err(error) => {
            // Only the rig file of a recording still lacks hints here: it is read without options for them.
            let error = arguments::hinted(error, "write the rig file again: vhull convert ..");
            eprintln!("vhull: {error}");
            ExitCode::FAILURE
        }
    }
}
