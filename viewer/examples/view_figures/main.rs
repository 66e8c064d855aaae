//! Measures how good and how fast pictures are, and adds the figures to `target/figures.json`.
//!
//! `cargo run --release -p ode-visual-hull-viewer --example view_figures`. It fails where a bound is missed.

mod flicker;
mod live;
mod occlusion;
mod quality;
mod speed;

use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::figure_table;
use std::process::ExitCode;

fn main() -> ExitCode {
    let groups = [quality::measure, occlusion::measure, flicker::measure, speed::measure, live::measure];
    let measured = groups.into_iter().map(|measure| measure());
    let figures: Vec<Figure> = match measured.collect::<ode_visual_hull::Result<Vec<_>>>() {
        Ok(groups) => groups.into_iter().flatten().collect(),
        Err(error) => {
            eprintln!("view_figures: {error}");
            return ExitCode::FAILURE;
        }
    };

    figure_table::print_table(&figures);
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/figures.json");
    if let Err(error) = figure_table::record(&path, &figures) {
        eprintln!("{}: {error}", path.display());
        return ExitCode::FAILURE;
    }
    if figures.iter().all(Figure::holds) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
