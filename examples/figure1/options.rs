//! The command line.

use super::shared::FilmArguments;
use clap::{Parser, ValueEnum};
use ode_visual_hull::hull::Motion;

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
    #[command(flatten)]
    pub film: FilmArguments,
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
