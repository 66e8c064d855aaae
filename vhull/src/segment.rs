//! `vhull segment`: the images of a recording become masks.

mod empty_room;
mod frames;
mod masks;

use crate::{Outcome, progress};
use clap::ValueEnum;
use empty_room::EmptyRoom;
use frames::{Frames, Tally};
use image::{GrayImage, RgbImage};
use masks::Masks;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::segment::{CleanPlate, Thresholds};
use ode_visual_hull::source::ImageSet;
use ode_visual_hull::{Error, Result};
use std::path::PathBuf;

/// Find the subject in the images or videos of a recording, and write masks.
///
/// RECORDING holds rig.toml and, for each camera, images in <camera>/image/000000.png or a video <camera>/video.mp4 (or
/// .avi, .mov, ..; also videos/<camera>.mp4). What the empty room looks like comes from <camera>/background.png or a
/// video <camera>/background.avi, unless told otherwise. Videos need ffmpeg.
///
/// Images of one time belong together: by their numbers, or by frames.csv (columns: frame and the cameras' names;
/// seconds) where the recording has one. Masks go to <camera>/mask/000000.png, numbered as the first camera's images.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the recording.
    recording: PathBuf,
    /// Folder to write the masks to, as a recording of its own [default: the recording].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How to tell the subject from the room.
    #[arg(long, value_enum, default_value_t = Method::CleanPlate)]
    method: Method,
    /// The first N images of each camera show the empty room.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with = "background")]
    empty: Option<u32>,
    /// Images of the empty room: a folder with <camera>.png or <camera>.avi, or the name of a file in each camera's
    /// folder; pictures or videos.
    #[arg(long, value_name = "DIR|FILE")]
    background: Option<PathBuf>,
    /// Frames to segment, from A to before B; either may be left out [default: all].
    #[arg(long, value_name = "A..B", value_parser = frames::parse, default_value = "..", hide_default_value = true)]
    frames: Frames,
    /// Images a second [default: as frames.csv or the videos say, else 30].
    #[arg(long, value_name = "RATE")]
    rate: Option<f64>,
    /// Images of one time lie within so many seconds [default: half the time from one to the next].
    #[arg(long, value_name = "SECONDS")]
    bound: Option<f64>,
    /// Keep the masks that are there, and go on with the frames that have none.
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Write over the masks that are there.
    #[arg(long)]
    force: bool,
}

const EXAMPLES: &str = "\
Examples:
  vhull segment my_recording
  vhull segment my_recording --empty 50 --frames 50..
  vhull segment my_recording --background background.avi --out segmented
  vhull segment my_recording --resume";

/// How to tell the subject from the room.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// By the difference from the empty room.
    CleanPlate,
}

pub fn run(options: &Options) -> Result<Outcome> {
    let recording = Recording::open(&options.recording)?;
    if !recording.has_images() {
        let problem =
            "expected images or a video of every camera, found masks alone; there is nothing to segment";
        return Err(Error::file(&options.recording, problem));
    }
    let mut masks = Masks::open(options, recording.rig())?;
    let streaming = StreamOptions { first: 0, rate: options.rate, bound: options.bound };
    let empty = EmptyRoom::find(options, &recording, &streaming)?;
    let segmenters = empty.images.iter().map(|images| segmenter(options.method, images));
    let mut segmenters = segmenters.collect::<Result<Vec<_>>>()?;

    let mut sets = recording.synchronised(&StreamOptions { first: options.frames.first, ..streaming })?;
    let expected = sets.streams().filter_map(|stream| stream.frames_expected()).max();
    let bar = progress::bar(options.frames.count(expected), "frames");
    let mut tally = Tally::default();
    for set in &mut sets {
        let done = set.and_then(|set| {
            let number = set.number();
            if number >= options.frames.end {
                return Ok(false);
            }
            bar.inc(1);
            if !set.is_complete() {
                tally.left_out(&set, recording.rig());
            } else if masks.has(number) {
                tally.kept += 1;
            } else {
                tally.frame_at_work = Some(number);
                masks.write(number, &segment(&mut segmenters, &set)?)?;
                tally.written(&set);
            }
            Ok(true)
        });
        match done {
            Ok(true) => {}
            Ok(false) => break,
            Err(e) => return Err(tally.broken_off(&e, masks.dir())),
        }
    }
    bar.finish_and_clear();
    tally.report(&options.recording, masks.dir(), &sets)
}

/// What finds the subject in one camera's images, given some of the empty room.
fn segmenter(method: Method, empty: &[RgbImage]) -> Result<CleanPlate> {
    match method {
        Method::CleanPlate => Ok(CleanPlate::new(empty_room::mean(empty)?, Thresholds::default())),
    }
}

/// The masks of a complete set, the cameras side by side.
fn segment(segmenters: &mut [CleanPlate], set: &ImageSet) -> Result<Vec<GrayImage>> {
    std::thread::scope(|scope| {
        let pairs = segmenters.iter_mut().zip(set.images.iter().flatten());
        let threads: Vec<_> =
            pairs.map(|(segmenter, frame)| scope.spawn(|| segmenter.subtract(&frame.image))).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}
