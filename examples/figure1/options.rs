//! The command line.

use clap::{Parser, ValueEnum};
use ode_visual_hull::hull::Motion;
use std::path::PathBuf;

/// A person among a hundred virtual boxes.
///
/// Seven synthetic cameras watch a person of capsules, who walks to and fro among the boxes. Each frame of the film goes
/// through all steps: colour images with sensor noise, segmentation, silhouettes, visual hull, physics.
#[derive(Debug, Parser)]
#[command(name = "figure1", version, after_help = EXAMPLES)]
pub struct Options {
    /// Play the masks by the wall clock on a thread of their own, simulate on another, and tell what was late: no film.
    #[arg(long)]
    pub pace: bool,
    /// Which hull the boxes meet at the simulation's time.
    #[arg(long, value_enum, default_value = "interpolated")]
    pub motion: MotionName,
    /// With --pace: how long to play by the wall clock, in seconds.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 10.0,
        allow_negative_numbers = true,
        help_heading = "Pace"
    )]
    pub seconds: f64,
    /// With --pace: steps of the simulation a second.
    #[arg(long, value_name = "RATE", default_value_t = 120.0, help_heading = "Pace")]
    pub step_rate: f64,
    /// Folder for the film, the table of states and the plot; it is made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "target/figure1", help_heading = "Film")]
    pub out: PathBuf,
    /// Camera whose view is drawn, by number from 0 or by name [default: the one that shows most].
    #[arg(long, value_name = "CAMERA", help_heading = "Film")]
    pub view: Option<String>,
    /// Stop after so many frames, at 30 a second [default: all].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), help_heading = "Film")]
    pub frames: Option<u32>,
    /// Write states and plot only, without a film: several times faster.
    #[arg(long, help_heading = "Film")]
    pub no_gif: bool,
    /// Seed of the sensor noise and of ODE's solver: the same seed gives the same film.
    #[arg(long, default_value_t = 1, help_heading = "Film")]
    pub seed: u32,
}

/// The names of [`Motion`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MotionName {
    /// The latest frame.
    Held,
    /// The hull between the last two frames, one frame late.
    Interpolated,
    /// The latest frame, moved ahead.
    Predicted,
}

impl MotionName {
    /// The motion of this name.
    pub fn motion(self) -> Motion {
        match self {
            Self::Held => Motion::Held,
            Self::Interpolated => Motion::Interpolated,
            Self::Predicted => Motion::Predicted,
        }
    }
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release --example figure1
  cargo run --release --example figure1 -- --pace --motion held
  cargo run --release --example figure1 -- --view 1 --out target/from_the_side";
