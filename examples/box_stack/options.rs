//! The command line.

use super::capture::Capture;
use clap::{Parser, ValueEnum};
use ode_visual_hull::hull::{Aabb, HullData, Unseen};
use ode_visual_hull::{Error, Result};
use std::path::PathBuf;

/// Virtual boxes rest on a real object that cameras see, and fall when it moves.
///
/// Without --recording, eight synthetic cameras watch a real box. Five virtual boxes are stacked on it; the real box
/// is lifted and tilted, and the stack tips over. Each frame goes the whole way: colour images with sensor noise,
/// subtraction of the empty room, silhouettes, visual hull, physics.
///
/// With --recording, boxes fall on the person of a real recording instead.
#[derive(Debug, Parser)]
#[command(name = "box_stack", version, after_help = EXAMPLES)]
pub struct Options {
    /// Folder for the film, the table of states and the plot; made if need be.
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
    /// Do not draw: several times faster, states and plot only.
    #[arg(long)]
    pub no_gif: bool,

    /// Folder of a recording: rig.toml, and masks in <camera>/mask/000000.png; world z up, floor at z = 0.
    #[arg(long, value_name = "DIR", help_heading = "Recordings")]
    pub recording: Option<PathBuf>,
    /// Number of boxes that fall.
    #[arg(long, value_name = "N", default_value_t = 6, help_heading = "Recordings", requires = "recording")]
    pub boxes: usize,
    /// Edge of the boxes, in metres.
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 0.1,
        help_heading = "Recordings",
        requires = "recording"
    )]
    pub side: f64,
    /// Seconds for which the first frame stands still, so that the boxes come to rest before it plays.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 3.0,
        help_heading = "Recordings",
        requires = "recording"
    )]
    pub hold: f64,
    /// How often each recorded frame is shown, at 30 a second [default: so that all of them last 5 seconds].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), help_heading = "Recordings", requires = "recording")]
    pub repeat: Option<u32>,
    /// Work volume, in metres [default: around the spot that the cameras look at, as far as they stand from it].
    #[arg(
        long,
        value_name = "X0,X1,Y0,Y1,Z0,Z1",
        value_parser = parse_bounds,
        allow_hyphen_values = true,
        help_heading = "Recordings",
        requires = "recording"
    )]
    pub bounds: Option<Aabb>,
    /// What a camera says of points beyond its image.
    #[arg(long, value_enum, default_value_t = UnseenPolicy::Outside, help_heading = "Recordings", requires = "recording")]
    pub unseen: UnseenPolicy,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release --example box_stack
  cargo run --release --example box_stack -- --view 1 --out target/from_the_side
  cargo run --release --example box_stack -- --recording my_recording --boxes 8 --side 0.1";

/// [`Unseen`] by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnseenPolicy {
    /// They are outside the hull.
    Outside,
    /// Nothing; two cameras must see a point of the hull.
    Abstain,
}

impl From<UnseenPolicy> for Unseen {
    fn from(policy: UnseenPolicy) -> Self {
        match policy {
            UnseenPolicy::Outside => Self::Outside,
            UnseenPolicy::Abstain => Self::ABSTAIN,
        }
    }
}

impl Options {
    /// The index of the camera to draw.
    pub fn view_of(&self, capture: &dyn Capture, data: &HullData) -> Result<usize> {
        let Some(wanted) = &self.view else { return Ok(capture.best_view(data)) };
        let cameras = capture.cameras();
        let by_name = cameras.iter().position(|camera| camera.name() == wanted);
        let by_number = || wanted.parse().ok().filter(|&view: &usize| view < cameras.len());
        by_name.or_else(by_number).ok_or_else(|| {
            let names: Vec<_> = cameras.iter().map(|camera| camera.name()).collect();
            let most = cameras.len() - 1;
            let names = names.join(", ");
            Error::argument(format!("--view: expected 0 to {most} or one of {names}, found {wanted}"))
        })
    }
}

fn parse_bounds(text: &str) -> std::result::Result<Aabb, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse())
        .collect::<std::result::Result<_, _>>()
        .map_err(|_| "expected six numbers between commas: x0,x1,y0,y1,z0,z1".to_owned())?;
    let [x0, x1, y0, y1, z0, z1] = numbers[..] else {
        return Err(format!("expected six numbers, x0,x1,y0,y1,z0,z1, found {}", numbers.len()));
    };
    Aabb::new([x0, y0, z0].into(), [x1, y1, z1].into()).map_err(|error| error.to_string())
}
