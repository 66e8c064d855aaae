//! The command line.

use clap::Parser;
use std::path::PathBuf;

/// A person walks up and topples a stack of virtual boxes.
///
/// Eight synthetic cameras watch a person of capsules, who walks through a stack of five virtual boxes. Each frame goes
/// through all steps: colour images with sensor noise, segmentation, silhouettes, visual hull, physics.
#[derive(Debug, Parser)]
#[command(name = "figure6", version, after_help = EXAMPLES)]
pub struct Options {
    /// Folder for the film, the table of states and the plot; it is made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "target/figure6")]
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
  cargo run --release --example figure6
  cargo run --release --example figure6 -- --view 1 --out target/from_the_side";
