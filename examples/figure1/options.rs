//! The command line.

use super::recording::RecordingArguments;
use super::shared::FilmArguments;
use clap::Parser;
use ode_visual_hull_film::Movement;

/// A person among a hundred virtual boxes.
///
/// Seven synthetic cameras watch a person of capsules, who walks to and fro among the boxes. Each frame of the film goes
/// through all steps: colour images with sensor noise, segmentation, silhouettes, visual hull, physics. With --recording a
/// real person takes the place of the synthetic one; with --pace too, their masks play to and fro.
#[derive(Debug, Parser)]
#[command(name = "figure1", version, after_help = EXAMPLES)]
pub struct Options {
    /// Play the masks by the wall clock on a thread of their own, simulate on another, and tell what was late: no film.
    #[arg(long, conflicts_with = "record")]
    pub pace: bool,
    /// Which hull the boxes meet at the simulation's time.
    #[arg(long, value_enum, default_value = "interpolated")]
    pub motion: Movement,
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
    #[command(flatten)]
    pub recording: RecordingArguments,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release --example figure1
  cargo run --release --example figure1 -- --pace --motion held
  cargo run --release --example figure1 -- --view 1 --out target/from_the_side
  cargo run --release --example figure1 -- --pace --recording my_recording --rate 60";
