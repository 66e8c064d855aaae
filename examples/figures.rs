//! Measures how good the hull is and writes `target/figures.json`: one flat object, name to number.
//!
//! `cargo run --release --example figures [-- GROUP...]` measures the named groups, all of them by default, and
//! prints a table of what was measured and what was asked. It fails where a bound is missed.

#[path = "figures/accuracy.rs"]
mod accuracy;
#[path = "figures/analytic.rs"]
mod analytic;
#[path = "figures/capi.rs"]
mod capi;
#[path = "figures/contour.rs"]
mod contour;
#[path = "figures/figure.rs"]
mod figure;
#[path = "figures/geometry.rs"]
mod geometry;
#[path = "figures/grip.rs"]
mod grip;
#[path = "figures/random.rs"]
mod random;
#[path = "figures/rest.rs"]
mod rest;
#[path = "figures/scene.rs"]
mod scene;
#[path = "figures/stack.rs"]
mod stack;
#[path = "figures/studio.rs"]
mod studio;
#[path = "figures/trajectories.rs"]
mod trajectories;

use figure::{Bound, Figure};
use std::process::ExitCode;

/// Measures a group's figures; what it is at is told to the argument.
type Measure = fn(&dyn Fn(&str)) -> Vec<Figure>;

/// The groups by their names on the command line.
const GROUPS: [(&str, Measure); 6] = [
    ("geometry", geometry::measure),
    ("trajectories", trajectories::measure),
    ("rest", rest::measure),
    ("stack", stack::measure),
    ("grip", grip::measure),
    ("capi", capi::measure),
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
    print_table(&figures);
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("target/figures.json");
    if let Err(error) = std::fs::write(&path, json(&figures)) {
        eprintln!("{}: {error}", path.display());
        return ExitCode::FAILURE;
    }
    println!("\n{} figures in {}", figures.len(), path.display());
    if figures.iter().all(Figure::holds) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// One row a figure, those with a bound first.
fn print_table(figures: &[Figure]) {
    let width = figures.iter().map(|figure| figure.name.len()).max().unwrap_or(0);
    println!("{:width$} | {:>10} | {:>16} | ok", "name", "measured", "asked");
    println!("{:-<width$}-|-{:->10}-|-{:->16}-|---", "", "", "");
    let (bounded, free): (Vec<&Figure>, _) = figures.iter().partition(|figure| figure.bound.is_some());
    for figure in bounded.into_iter().chain(free) {
        let asked = figure.bound.as_ref().map(Bound::to_string).unwrap_or_default();
        let ok = match figure.bound {
            Some(_) if figure.holds() => "yes",
            Some(_) => "NO",
            None => "",
        };
        println!("{:width$} | {:>10.5} | {asked:>16} | {ok}", figure.name, figure.value);
    }
}

fn json(figures: &[Figure]) -> String {
    // JSON has no word for NaN; Rust prints any other number as JSON has it, and names need no escapes.
    let number = |value: f64| if value.is_finite() { value.to_string() } else { "null".into() };
    let line = |figure: &Figure| format!("  \"{}\": {}", figure.name, number(figure.value));
    format!("{{\n{}\n}}\n", figures.iter().map(line).collect::<Vec<_>>().join(",\n"))
}
