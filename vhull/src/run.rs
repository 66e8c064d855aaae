//! `vhull run`: virtual bodies and a recorded subject in one simulation.

mod placement;

use crate::arguments::open_recording;
use crate::{Outcome, progress};
use clap::ValueEnum;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::set_random_seed;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{
    ASSUMED_RATE, FRAME_RATE, FilmOptions, Movement, Playback, PlaybackOptions, Simulation, Story,
    VolumeOptions, ground, in_the_way, numbers, parse_frames, parse_rate, parse_times, run_film, view_of,
};
use std::io::Write;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Drop virtual bodies on a recorded subject, or let it knock over a stack of boxes.
///
/// The recording's masks collide with the bodies, at the pace at which they were recorded. The first frame is held
/// until the bodies have come to rest. Between its frames the subject moves on and pushes bodies with its own speed
/// (`--motion`). World z is up, the floor at z = 0. Writes a film (GIF, 30 frames a second) and three stills of it, the
/// state of each body in each frame of the film (CSV), what the bodies look like and how the recording was played (TOML),
/// and a plot of their heights. Prints what became of the bodies, and how fast they were beside the subject. The film shows
/// the recording's images or videos (these need ffmpeg), or its masks where there are none.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of a recording: rig.toml, and masks in CAMERA/mask/000000.png.
    recording: PathBuf,
    /// Folder for the results; it is made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "vhull_run")]
    out: PathBuf,

    /// Bodies to drop on the subject [default: boxes].
    #[arg(long, value_enum, value_name = "KIND", conflicts_with = "stack", help_heading = "Bodies")]
    drop: Option<Kind>,
    /// Number of bodies to drop [default: 6].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=200), conflicts_with = "stack", help_heading = "Bodies")]
    count: Option<u16>,
    /// Stack so many boxes on the floor where the subject will knock them over, or on a subject that does not move.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=40), help_heading = "Bodies")]
    stack: Option<u16>,
    /// Place of the stack in metres, on the subject or the floor there [default: chosen by the subject's way].
    #[arg(long, value_name = "X,Y", value_parser = parse_place, allow_hyphen_values = true, requires = "stack", help_heading = "Bodies")]
    at: Option<[f64; 2]>,
    /// Edge of the boxes and diameter of the balls, in metres [default: 0.1, of a stack 0.2].
    #[arg(long, value_name = "METRES", value_parser = parse_side, help_heading = "Bodies")]
    side: Option<f64>,

    #[command(flatten)]
    volume: VolumeOptions,

    /// How the subject moves between its recorded frames, where they are at most 0.5 s apart.
    #[arg(long, value_enum, value_name = "MOTION", default_value_t = Movement::Interpolated, help_heading = "Film")]
    motion: Movement,
    /// Seconds of the film in which bodies that touch the subject stick to it, from A up to but not B; either may be left out.
    /// May be given several times.
    #[arg(long, value_name = "A..B", value_parser = parse_times, help_heading = "Film")]
    hold: Vec<Range<f64>>,
    /// Recorded frames to play, from A up to but not B; either may be left out [default: all].
    #[arg(long, value_name = "A..B", value_parser = parse_frames, help_heading = "Film")]
    frames: Option<Range<u32>>,
    /// Recorded images a second [default: as frames.csv or the videos say, else 30].
    #[arg(long, value_name = "RATE", value_parser = parse_rate, help_heading = "Film")]
    rate: Option<f64>,
    /// Seconds for which the first frame is shown, so that bodies come to rest.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, default_value = "3", help_heading = "Film")]
    wait: f64,
    /// Seconds for which the last frame is shown.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, default_value = "1", help_heading = "Film")]
    linger: f64,
    /// Camera whose view is drawn, by name or by number from 0 [default: the nearest].
    #[arg(long, value_name = "CAMERA", help_heading = "Film")]
    view: Option<String>,
    /// Write states and plot only, without a film: several times faster.
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
  vhull run my_recording --rate 60                           recorded at 60 images a second, which it does not state
  vhull run my_recording --hold 3..4.5                       bodies stick to the subject for a while
  vhull run my_recording --stack 3 --at 0.4,-0.2             the stack stands at a given place
  vhull run my_recording --no-gif --out states               states and plot only

Images without masks: `vhull segment` first.";

/// The shapes of bodies to drop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Cubes.
    Boxes,
    /// Spheres.
    Spheres,
    /// Cubes and spheres in turn.
    Mix,
}

const COLOURS: [[u8; 3]; 6] =
    [[222, 86, 62], [66, 118, 202], [240, 188, 60], [146, 92, 186], [236, 236, 228], [64, 168, 160]];

/// Gap between the boxes of a stack, in metres.
const GAP: f64 = 0.001;

pub fn run(options: &Options) -> Result<Outcome> {
    set_random_seed(options.seed);
    let data = Arc::new(HullData::new());
    let played = PlaybackOptions {
        frames: options.frames.clone(),
        rate: options.rate,
        wait: options.wait,
        linger: options.linger,
        volume: options.volume,
    };
    let dir = &options.recording;
    let mut playback = Playback::new(open_recording(dir)?, dir, &played, &data)?;
    let view = view_of(&playback, options.view.as_deref())?;
    let mut simulation = Simulation::new(&data, playback.pixel_size(), options.motion.motion())?;
    simulation.hold_during(&options.hold);
    let placed = match options.stack {
        Some(count) => stack(options, count.into(), &mut playback, &data, &mut simulation)?,
        None => drop(options, &playback, &data, &mut simulation)?,
    };
    let film = FilmOptions {
        out: &options.out,
        name: "run",
        frames: playback.frames(),
        view: (!options.no_gif).then_some(view),
    };

    let end = film.frames as f64 / FRAME_RATE;
    if let Some(late) = options.hold.iter().find(|times| times.start >= end) {
        return Err(Error::argument(format!(
            "--hold: expected seconds that begin before the end of the film, at {end:.2} s, found {}..; --wait and \
             --linger belong to the film",
            late.start
        )));
    }

    if playback.is_rate_assumed() && playback.pace().0 > 1 {
        eprintln!(
            "note: the recording does not state its images a second; {ASSUMED_RATE} are assumed, give --rate if it has \
             another rate"
        );
    }

    let bar = progress::bar(film.frames, "frames");
    let text = run_film(&film, &mut playback, &data, &mut simulation, &mut |_| bar.inc(1));
    bar.finish_and_clear();
    if let Some(left_out) = simulation.take_left_out() {
        eprintln!("note: {left_out}");
    }
    let (count, seconds) = playback.pace();
    let hull = options.motion.description(playback.period());
    let text =
        format!("{placed}\n{count} recorded frames play in {seconds:.2} s\nhull: {hull}\n{}", text?.text);

    // The reader may have closed the pipe.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(Outcome::Done)
}

/// Lets bodies fall on the subject.
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

    let fewer =
        if poses.len() < count { format!(", of {count}: there is no room for more") } else { String::new() };
    Ok(format!("{} bodies fall on the subject{fewer}", poses.len()))
}

/// Stacks boxes in the way of the subject, or on it.
fn stack(
    options: &Options,
    count: usize,
    playback: &mut Playback,
    data: &Arc<HullData>,
    simulation: &mut Simulation,
) -> Result<String> {
    let side = options.side.unwrap_or(0.2);
    let (foot, found) = match options.at {
        Some([x, y]) => (ground(playback.first(), x, y), "on the subject or the floor there"),
        None => match in_the_way(playback.sampled_hulls(), side, side * count as f64) {
            Some(foot) => (foot, "on the floor, in the subject's way"),
            None => {
                let places = placement::poses(data, 1, side, playback.pixel_size())?;
                let place = places.first().ok_or_else(|| {
                    Error::argument(
                        "expected a place in the subject's way or on it, found none; place the stack with --at, or take a \
                         smaller --side",
                    )
                })?;
                let top = place.translation.vector - Vector3::z() * (0.5 * side + placement::DROP);
                (top.into(), "on the subject")
            }
        },
    };

    for i in 0..count {
        let height = (i as f64 + 0.5) * side + (i as f64 + 1.0) * GAP;
        // Small turns let the boxes of the stack be told apart in the film.
        let turn = Vector3::z() * [0.05, -0.12, 0.20, -0.06, 0.30][i % 5];
        let pose = Isometry3::new(foot.coords + Vector3::z() * height, turn);
        simulation.add(&Shape::cube(side), &pose, COLOURS[i % COLOURS.len()])?;
    }

    playback.show(&foot, side, side * count as f64);
    Ok(format!("{count} boxes stand at ({:.2}, {:.2}, {:.2}) m, {found}", foot.x, foot.y, foot.z))
}

fn parse_place(text: &str) -> std::result::Result<[f64; 2], String> {
    numbers(text, "x,y")
}

fn parse_side(text: &str) -> std::result::Result<f64, String> {
    let side = text.parse().ok().filter(|side| (0.05..=2.0).contains(side));
    side.ok_or_else(|| format!("expected 0.05 to 2 m, found {text}"))
}

fn parse_seconds(text: &str) -> std::result::Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=3600.0).contains(seconds));
    seconds.ok_or_else(|| format!("expected 0 to 3600 s, found {text}"))
}
