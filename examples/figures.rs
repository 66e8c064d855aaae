//! Measures how good the hull is and writes it into `target/figures.json`: one flat object, name to number, in which
//! the figures of `make bench` stand too.
//!
//! `cargo run --release --example figures [-- GROUP...]` measures the named groups, all of them by default, and
//! prints a table of what was measured and what was asked. It fails where a bound is missed.

#[path = "figures/accuracy.rs"]
mod accuracy;
#[path = "figures/agreement.rs"]
mod agreement;
#[path = "figures/analytic.rs"]
mod analytic;
#[path = "figures/at_rest.rs"]
mod at_rest;
#[path = "figures/capi.rs"]
mod capi;
#[path = "figures/captures.rs"]
mod captures;
#[path = "figures/contour.rs"]
mod contour;
#[path = "../tests/data/mod.rs"]
mod data;
#[path = "figures/figure.rs"]
mod figure;
#[path = "figures/geometry.rs"]
mod geometry;
#[path = "figures/grip.rs"]
mod grip;
#[path = "figures/random.rs"]
mod random;
#[path = "figures/scene.rs"]
mod scene;
#[path = "figures/segmentation.rs"]
mod segmentation;
#[path = "figures/stack.rs"]
mod stack;
#[path = "figures/studio.rs"]
mod studio;
#[path = "figures/table.rs"]
mod table;
#[path = "figures/trajectories.rs"]
mod trajectories;

use figure::Figure;
use std::process::ExitCode;

/// Measures a group's figures; what it is at is told to the argument.
type Measure = fn(&dyn Fn(&str)) -> Vec<Figure>;

/// The groups by their names on the command line.
const GROUPS: [(&str, Measure); 8] = [
    ("geometry", geometry::measure),
    ("agreement", agreement::measure),
    ("trajectories", trajectories::measure),
    ("rest", at_rest::measure),
    ("stack", stack::measure),
    ("grip", grip::measure),
    ("capi", capi::measure),
    ("segmentation", segmentation::measure),
];

fn main() -> ExitCode {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let names = GROUPS.map(|(name, _)| name);
    if let Some(unknown) = asked.iter().find(|name| !names.contains(&name.as_str())) {
        eprintln!("usage: figures [GROUP...], groups: {}; found {unknown}", names.join(", "));
        return ExitCode::from(2);
    }
    let mut figures = Vec::new();
    for (name, measure) in GROUPS {
        if asked.is_empty() || asked.iter().any(|asked| asked == name) {
            figures.extend(measure(&|at| eprintln!("{name}: {at}")));
        }
    }
    table::print_table(&figures);
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("target/figures.json");
    if let Err(error) = table::record(&path, &figures) {
        eprintln!("{}: {error}", path.display());
        return ExitCode::FAILURE;
    }
    println!("\n{} figures written to {}", figures.len(), path.display());
    if figures.iter().all(Figure::holds) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
