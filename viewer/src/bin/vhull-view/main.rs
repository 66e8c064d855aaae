//! `vhull-view`: a recorded subject and virtual bodies from any viewpoint. Each subcommand has a file of its own.

mod compare;
mod film;
#[cfg(feature = "window")]
mod live;
mod options;
mod still;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Draws a recorded subject, and the virtual bodies of a simulation, from any viewpoint.
#[derive(Debug, Parser)]
#[command(name = "vhull-view", version)]
struct Options {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Still(still::Options),
    Film(film::Options),
    Compare(compare::Options),
    #[cfg(feature = "window")]
    Live(Box<live::Options>),
}

fn main() -> ExitCode {
    let done = match Options::parse().verb {
        Verb::Still(options) => still::run(&options),
        Verb::Film(options) => film::run(&options),
        Verb::Compare(options) => compare::run(&options),
        #[cfg(feature = "window")]
        Verb::Live(options) => live::run(&options),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("vhull-view: {error}");
            ExitCode::FAILURE
        }
    }
}
