//! Measures the accuracy of the hull and the quality of simulations, and writes the figures into `target/figures.json`:
//! one flat object, name to number, which also holds the figures of `make bench`.
//!
//! `cargo run --release --example figures [-- GROUP...]` measures the named groups, all of them by default, and
//! prints a table of values and bounds. It fails where a bound is missed.

mod agreement;
mod appear;
mod at_rest;
mod camera_loss;
mod capi;
mod coulomb;
mod events;
mod geometry;
mod grip;
mod hands;
mod hold;
mod lines;
mod manifolds;
mod mask_filter;
mod motion;
mod pendulum;
mod predictability;
mod push;
mod realtime;
mod restitution;
mod segmentation;
mod sleepers;
mod stack;
mod studio;
mod trajectories;
mod tunnel;
mod velocity;

use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::figure_table;
use std::process::ExitCode;

/// Measures a group's figures. The argument is called with the name of each step, to show progress.
type Measure = fn(&dyn Fn(&str)) -> Vec<Figure>;

/// The groups by their names on the command line.
const GROUPS: &[(&str, Measure)] = &[
    ("geometry", geometry::run_group),
    ("agreement", agreement::run_group),
    ("lines", lines::run_group),
    ("trajectories", trajectories::run_group),
    ("rest", at_rest::run_group),
    ("sleepers", sleepers::run_group),
    ("stack", stack::run_group),
    ("predictability", predictability::run_group),
    ("grip", grip::run_group),
    ("hands", hands::run_group),
    ("capi", capi::run_group),
    ("segmentation", segmentation::run_group),
    ("motion", motion::run_group),
    ("push", push::run_group),
    ("velocity", velocity::run_group),
    ("camera_loss", camera_loss::run_group),
    ("mask_filter", mask_filter::run_group),
    ("tunnel", tunnel::run_group),
    ("appear", appear::run_group),
    ("realtime", realtime::run_group),
    ("pendulum", pendulum::run_group),
    ("coulomb", coulomb::run_group),
    ("hold", hold::run_group),
    ("restitution", restitution::run_group),
    ("manifolds", manifolds::run_group),
    ("events", events::run_group),
];

fn main() -> ExitCode {
    let groups: Vec<String> = std::env::args().skip(1).collect();
    let names: Vec<&str> = GROUPS.iter().map(|(name, _)| *name).collect();
    if let Some(unknown) = groups.iter().find(|name| !names.contains(&name.as_str())) {
        eprintln!("usage: figures [GROUP...], groups: {}; found {unknown}", names.join(", "));
        return ExitCode::from(2);
    }

    let mut figures = Vec::new();
    for (name, run_group) in GROUPS {
        if groups.is_empty() || groups.iter().any(|group| group == name) {
            figures.extend(run_group(&|step| eprintln!("{name}: {step}")));
        }
    }

    figure_table::print_table(&figures);
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("target/figures.json");
    if let Err(error) = figure_table::record(&path, &figures) {
        eprintln!("{}: {error}", path.display());
        return ExitCode::FAILURE;
    }

    println!("\n{} figures written to {}", figures.len(), path.display());
    if figures.iter().all(Figure::holds) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
