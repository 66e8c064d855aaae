//! The command line.

use clap::Parser;
use std::path::PathBuf;

/// Virtual boxes rest on a real object that cameras see, and fall when it moves.
///
/// Eight synthetic cameras watch a real box. Five virtual boxes are stacked on it. The real box is lifted and tilted,
/// and the stack tips over. Each frame goes through all steps: colour images with sensor noise, segmentation,
/// silhouettes, visual hull, physics.
#[derive(Debug, Parser)]
#[command(name = "box_stack", version, after_help = EXAMPLES)]
pub struct Options {
    /// Folder for the film, the table of states and the plot; it is made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "target/demo")]
    pub out: PathBuf,
    /// Camera whose view is drawn, by number from 0 or by name [default: the one that shows most].
    #[arg(long, value_name = "CAMERA")]
    pub view: Option<String>,
    /// Stop after so many frames, at 30 a second [default: all].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: Option<u32>,
    /// Seed of the sensor noise and of ODE's solver: the same seed gives the same run.
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// Write states and plot only, without a film: several times faster.
    #[arg(long)]
    pub no_gif: bool,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release --example box_stack
  cargo run --release --example box_stack -- --view 1 --out target/from_the_side";
