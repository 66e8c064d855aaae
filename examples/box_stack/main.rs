//! A stack of virtual boxes on a real box (the paper's figure 5).
//!
//! ```text
//!   cameras ──► masks ──► HullData ──► World (ODE) ──► one camera's view with the boxes in it, CSV, plot, table
//! ```
//!
//! `cargo run --release --example box_stack -- --help` lists the options. `vhull run` does the same with recordings of
//! real cameras.

mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use clap::Parser;
use ode_visual_hull::Result;
use ode_visual_hull::hull::Motion;
use shared::{FilmArguments, Filmed, tell};
use std::process::ExitCode;

/// Virtual boxes rest on a real object that cameras see, and fall when it moves.
///
/// Eight synthetic cameras watch a real box. Five virtual boxes are stacked on it. The real box is lifted and tilted,
/// and the stack tips over. Each frame goes through all steps: colour images with sensor noise, segmentation,
/// silhouettes, visual hull, physics.
#[derive(Debug, Parser)]
#[command(name = "box_stack", version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    film: FilmArguments,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release --example box_stack
  cargo run --release --example box_stack -- --view 1 --out target/from_the_side";

fn main() -> ExitCode {
    tell(run(&Options::parse()))
}

fn run(options: &Options) -> Result<String> {
    let filmed = Filmed {
        scenario: scene::LiftedBox,
        cameras: scene::cameras()?,
        bounds: scene::bounds()?,
        place: scene::top(),
        motion: Motion::Held,
        name: "box_stack",
        out: "target/demo",
    };
    Ok(shared::film(filmed, &options.film, scene::stack)?.text)
}
