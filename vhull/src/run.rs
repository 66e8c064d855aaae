//! `vhull run`: virtual bodies and a recorded subject in one simulation.

mod obstacle;
mod placement;
mod playback;
mod timeline;

use crate::arguments::{VolumeOptions, numbers, parse_frames, parse_rate};
use crate::frame_times::ASSUMED_RATE;
use crate::{Outcome, progress};
use clap::ValueEnum;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{FilmOptions, Simulation, Story, run_film, view_of};
use playback::Playback;
use std::io::Write;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Drop virtual bodies on a recorded subject, or let it knock over a stack of boxes.
///
/// The hulls of the recording's masks collide with the bodies at the pace of the recording; the first frame is held for
/// a while so that the bodies come to rest. World z is up, the floor is at z = 0. Writes a film (GIF, 30 frames per
/// second) and three stills of it, the state of each body in each frame of the film (CSV) and a plot of their heights,
/// and prints where each body ends up. The film shows the recording's images or videos (these need ffmpeg), or its
/// masks where there are none.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of a recording: rig.toml, and masks in CAMERA/mask/000000.png.
    recording: PathBuf,
    /// Folder for the results; created if missing.
    #[arg(long, value_name = "DIR", default_value = "vhull_run")]
    out: PathBuf,

    /// Bodies that fall on the subject [default: boxes].
    #[arg(long, value_enum, value_name = "KIND", conflicts_with = "stack", help_heading = "Bodies")]
    drop: Option<Kind>,
    /// Number of bodies that fall [default: 6].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=200), conflicts_with = "stack", help_heading = "Bodies")]
    count: Option<u16>,
    /// Number of boxes stacked on the floor where the subject will knock them over, or on a subject that keeps still.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=40), help_heading = "Bodies")]
    stack: Option<u16>,
    /// Position of the stack, on the subject or the floor there, in metres [default: found automatically].
    #[arg(long, value_name = "X,Y", value_parser = parse_place, allow_hyphen_values = true, requires = "stack", help_heading = "Bodies")]
    at: Option<[f64; 2]>,
    /// Edge of the boxes and diameter of the balls, in metres [default: 0.1, of a stack 0.2].
    #[arg(long, value_name = "METRES", value_parser = parse_side, help_heading = "Bodies")]
    side: Option<f64>,

    #[command(flatten)]
    volume: VolumeOptions,

    /// Recorded frames to play, from A up to but not B; either may be left out [default: all].
    #[arg(long, value_name = "A..B", value_parser = parse_frames, help_heading = "Film")]
    frames: Option<Range<u32>>,
    /// Recorded images per second [default: from frames.csv or the videos, else 30].
    #[arg(long, value_name = "RATE", value_parser = parse_rate, help_heading = "Film")]
    rate: Option<f64>,
    /// Seconds for which the first frame is held.
    #[arg(long, value_name = "SECONDS", value_parser = parse_hold, default_value = "3", help_heading = "Film")]
    hold: f64,
    /// Seconds for which the last frame is held.
    #[arg(long, value_name = "SECONDS", value_parser = parse_hold, default_value = "1", help_heading = "Film")]
    linger: f64,
    /// Camera whose view is drawn, by name or by number from 0 [default: the one nearest to the subject].
    #[arg(long, value_name = "CAMERA", help_heading = "Film")]
    view: Option<String>,
    /// Write states and plot only, no film; several times faster.
    #[arg(long, help_heading = "Film")]
    no_gif: bool,
    /// Seed of ODE's solver: the same seed gives the same run.
    #[arg(long, default_value_t = 1, help_heading = "Film")]
    seed: u32,
}

const EXAMPLES: &str = "\
Examples:
  vhull run my_recording                                     six boxes fall on the subject
  vhull run my_recording --drop mix --count 20 --side 0.08   boxes and balls
  vhull run my_recording --stack 5 --view left               the subject knocks over five boxes, seen from `left`
  vhull run my_recording --rate 60                           a recording of 60 images per second without times
  vhull run my_recording --stack 3 --at 0.4,-0.2             three boxes stand at this place
  vhull run my_recording --no-gif --out states               states and plot only

Recordings without masks need `vhull segment` first.";

/// Values of `--drop`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Cubes.
    Boxes,
    /// Spheres.
    Spheres,
    /// Cubes and balls in turn.
    Mix,
}

/// Colours of the bodies, repeated.
const COLOURS: [[u8; 3]; 6] =
    [[222, 86, 62], [66, 118, 202], [240, 188, 60], [146, 92, 186], [236, 236, 228], [64, 168, 160]];

/// Vertical gap between the boxes of a stack at the start, in metres.
const GAP: f64 = 0.001;

pub fn run(options: &Options) -> Result<Outcome> {
    set_random_seed(options.seed);

    let data = Arc::new(HullData::new());
    let mut playback = Playback::open(options, &data)?;
    let view = view_of(&playback, options.view.as_deref(), &data)?;

    let mut simulation = Simulation::new(&data, playback.pixel_size())?;
    let placed = match options.stack {
        Some(count) => stack(options, count.into(), &mut playback, &data, &mut simulation)?,
        None => drop(options, &playback, &data, &mut simulation)?,
    };

    let film_options = FilmOptions {
        out: &options.out,
        name: "run",
        frames: playback.frames(),
        view: (!options.no_gif).then_some(view),
    };

    if playback.is_rate_assumed() && playback.pace().0 > 1 {
        eprintln!(
            "note: the recording holds no times; {ASSUMED_RATE} images per second are assumed, set others with --rate"
        );
    }

    let bar = progress::bar(film_options.frames, "frames");
    let text = run_film(&film_options, &mut playback, &data, &mut simulation, &mut |_| bar.inc(1));
    bar.finish_and_clear();

    let (count, seconds) = playback.pace();
    let text = format!("{place}\n{count} recorded frames play in {seconds:.2} s\n{}", text?);
    // Ignore a closed pipe: a pager may end before all is written.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(Outcome::Done)
}

/// Adds the bodies that fall on the subject, and describes them.
fn drop(
    options: &Options,
    playback: &Playback,
    data: &Arc<HullData>,
    simulation: &mut Simulation,
) -> Result<String> {
    let (kind, count) = (options.drop.unwrap_or(Kind::Boxes), options.count.unwrap_or(6).into());
    let side = options.side.unwrap_or(0.1);
    let poses = placement::poses(data, count, side, playback.pixel_size())?;

    if poses.is_empty() {
        return Err(Error::argument(
            "expected a place above 0.3 m for a body to land, found none; check that the world's z is up and the \
             floor at z = 0 (vhull check), take a smaller --side, or place boxes with --stack and --at",
        ));
    }

    for (i, pose) in poses.iter().enumerate() {
        let ball = kind == Kind::Spheres || kind == Kind::Mix && i % 2 == 1;
        let shape = if ball { Shape::Sphere { radius: 0.5 * side } } else { Shape::cube(side) };
        simulation.add(&shape, pose, COLOURS[i % COLOURS.len()])?;
    }

    let fewer = if poses.len() < count {
        format!("; there is no place for the rest of the {count}")
    } else {
        String::new()
    };
    Ok(format!("{} bodies fall on the subject{fewer}", poses.len()))
}

/// Adds a stack of boxes in the way of the subject, or on it, and describes it.
fn stack(
    options: &Options,
    count: usize,
    playback: &mut Playback,
    data: &Arc<HullData>,
    simulation: &mut Simulation,
) -> Result<String> {
    let side = options.side.unwrap_or(0.2);

    // The place of --at, else on the floor where a moving subject comes, else on top of a subject that keeps still.
    let (foot, found) = match options.at {
        Some([x, y]) => (obstacle::ground(playback.first(), x, y), "at the given place"),
        None => match obstacle::in_the_way(playback.sampled_hulls(), side, side * count as f64) {
            Some(foot) => (foot, "on the floor, in the subject's way"),
            None => {
                let places = placement::poses(data, 1, side, playback.pixel_size())?;
                let place = places.first().ok_or_else(|| {
                    Error::argument(
                        "expected a place in the subject's way or on it, found none; give the position of the stack \
                         with --at, or take a smaller --side",
                    )
                })?;
                let top = place.translation.vector - Vector3::z() * (0.5 * side + placement::DROP);
                (top.into(), "on the subject")
            }
        },
    };

    for i in 0..count {
        let height = (i as f64 + 0.5) * side + (i as f64 + 1.0) * GAP;
        // Each box is turned a little against the one below, so that the film shows them apart.
        let turn = Vector3::z() * [0.05, -0.12, 0.20, -0.06, 0.30][i % 5];
        let pose = Isometry3::new(foot.coords + Vector3::z() * height, turn);
        simulation.add(&Shape::cube(side), &pose, COLOURS[i % COLOURS.len()])?;
    }

    playback.show(&foot, side, side * count as f64);
    Ok(format!("{count} boxes stand at ({:.2}, {:.2}, {:.2}) m, {found}", foot.x, foot.y, foot.z))
}

/// Parses `X,Y`, in metres.
fn parse_place(text: &str) -> std::result::Result<[f64; 2], String> {
    numbers(text, "x,y")
}

/// Parses an edge length of 0.05 to 2 m.
fn parse_side(text: &str) -> std::result::Result<f64, String> {
    let side = text.parse().ok().filter(|side| (0.05..=2.0).contains(side));
    side.ok_or_else(|| format!("expected 0.05 to 2 m, found {text}"))
}

/// Parses a duration of 0 to 3600 s.
fn parse_hold(text: &str) -> std::result::Result<f64, String> {
    let hold = text.parse().ok().filter(|hold| (0.0..=3600.0).contains(hold));
    hold.ok_or_else(|| format!("expected 0 to 3600 s, found {text}"))
}
