//! A person walks up and topples a stack of virtual boxes (the paper's figure 6).
//!
//! ```text
//!   cameras ──► masks ──► HullData ──► World (ODE) ──► one camera's view with the boxes in it, CSV, plot, table
//! ```
//!
//! `cargo run --release --example figure6 -- --help` lists the options. `vhull run --stack` does the same with a recording of
//! a real person.

mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use clap::Parser;
use ode_visual_hull::Result;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::ode::Swept;
use shared::{FilmArguments, Filmed, tell};
use std::process::ExitCode;

/// A person walks up and topples a stack of virtual boxes.
///
/// Eight synthetic cameras watch a person of capsules, who walks through a stack of five virtual boxes. Each frame goes
/// through all steps: colour images with sensor noise, segmentation, silhouettes, visual hull, physics.
#[derive(Debug, Parser)]
#[command(name = "figure6", version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    film: FilmArguments,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release --example figure6
  cargo run --release --example figure6 -- --view 1 --out target/from_the_side";

fn main() -> ExitCode {
    tell(run(&Options::parse()))
}

fn run(options: &Options) -> Result<String> {
    let filmed = Filmed {
        scenario: scene::Walker,
        cameras: scene::cameras()?,
        bounds: scene::bounds()?,
        place: scene::foot(),
        motion: Motion::Interpolated,
        name: "figure6",
        out: "target/figure6",
    };
    shared::film(filmed, &options.film, |simulation| {
        simulation.set_swept(Swept::On);
        scene::stack(simulation)
    })
}
