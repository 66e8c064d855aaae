//! Times the library and the alternatives in one run and writes the figures into `target/figures.json`. If all groups
//! are measured, it also writes `docs/performance.md`, and the plots of the scaling into `docs/performance/`.
//!
//! `make bench`, or `cargo run --release -p ode-visual-hull-bench -- --help`. It fails where a bound is missed.

mod frames;
mod motion;
mod page;
mod peers;
mod plot;
mod points;
mod prepare;
mod real_cameras;
mod scaling;
mod segmentation;
mod session;
mod simulation;
mod threads;
mod timing;

use clap::Parser;
use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::figure_table;
use session::Session;
use std::path::Path;
use std::process::ExitCode;

/// Times a group's candidates and adds its figures to the session.
type RunGroup = fn(&mut Session);

/// The groups by their names on the command line.
const GROUPS: [(&str, RunGroup); 10] = [
    ("points", points::run_group),
    ("segmentation", segmentation::run_group),
    ("prepare", prepare::run_group),
    ("real_cameras", real_cameras::run_group),
    ("motion", motion::run_group),
    ("frames", frames::run_group),
    ("peers", peers::run_group),
    ("simulation", simulation::run_group),
    ("threads", threads::run_group),
    ("scaling", scaling::run_group),
];

/// The visual hull beside the paper's algorithm and beside rebuilding a mesh, in one run.
#[derive(Parser)]
struct Options {
    /// Measures this group alone; may be given several times
    #[arg(long, value_parser = GROUPS.map(|(name, _)| name))]
    only: Vec<String>,

    /// Rounds in which all candidates of a comparison take turns
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut session = Session::new(options.rounds as usize, root.join("docs"));

    for (name, run_group) in GROUPS {
        if options.only.is_empty() || options.only.iter().any(|only| only == name) {
            session.start_group(name);
            run_group(&mut session);
        }
    }

    let rows = session.into_rows();
    let figures: Vec<_> = rows.iter().map(|row| row.figure.clone()).collect();
    figure_table::print_table(&figures);
    let mut written = figure_table::record(&root.join("target/figures.json"), &figures);
    if options.only.is_empty() {
        // The page describes a single run of all groups.
        written = written.and_then(|()| page::write(&root.join("docs/performance.md"), &rows));
    }

    if let Err(error) = written {
        eprintln!("expected to write target/figures.json and docs/performance.md, found: {error}");
        return ExitCode::FAILURE;
    }

    println!("\n{} figures written to target/figures.json", figures.len());
    if figures.iter().all(Figure::holds) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
