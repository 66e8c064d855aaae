//! Measures how good and how fast pictures are, and adds the figures to `target/figures.json`.
//!
//! `cargo run --release -p ode-visual-hull-viewer --example view_figures`. It fails where a bound is missed. With names of groups
//! (quality, occlusion, flicker, speed, live, live-recording) it measures these alone. Live systems simulate in real time, which the
//! user must be allowed.

mod flicker;
mod live;
mod live_recording;
mod occlusion;
mod quality;
mod speed;

use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::figure_table;
use std::process::ExitCode;

/// Measures a group of figures.
type Measure = fn() -> ode_visual_hull::Result<Vec<Figure>>;

fn main() -> ExitCode {
    // By words on the command line, some groups alone.
    let groups: [(&str, Measure); 6] = [
        ("quality", quality::measure),
        ("occlusion", occlusion::measure),
        ("flicker", flicker::measure),
        ("speed", speed::measure),
        ("live", live::measure),
        ("live-recording", live_recording::measure),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|one| one == name);
    let measured = groups.into_iter().filter(|(name, _)| is_wanted(name)).map(|(_, measure)| measure());
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
