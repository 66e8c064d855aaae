//! `vhull segment`: masks from the images of a recording.

mod empty_room;
mod masks;
mod tally;

use crate::arguments::open_recording;
use crate::{Outcome, progress};
use clap::ValueEnum;
use empty_room::EmptyRoom;
use image::RgbImage;
use masks::Masks;
use ode_visual_hull::pipeline::Segmenters;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::segment::{
    ChromaKey, CleanPlate, Key, Learning, RunningGaussian, Segmenter, Thresholds,
};
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{parse_frames, parse_rate};
use std::ops::Range;
use std::path::PathBuf;
use tally::Tally;

/// Find the subject in the images or videos of a recording, and write masks.
///
/// RECORDING holds rig.toml and, for each camera, images in CAMERA/image/000000.png or a video CAMERA/video.mp4 (or
/// .avi, .mov, ..; also videos/CAMERA.mp4). The background without the subject is CAMERA/background.png or a video
/// CAMERA/background.avi by default. Videos need ffmpeg.
///
/// Images are combined into frames by their numbers, or by frames.csv (columns: frame and the cameras' names; seconds)
/// where the recording has one. Masks go to CAMERA/mask/000000.png, numbered as the first camera's images.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the recording.
    recording: PathBuf,
    /// Folder for the masks, a recording of its own that keeps their times [default: the recording].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How to separate the subject from the background.
    #[arg(long, value_enum, default_value_t = Method::CleanPlate)]
    method: Method,
    /// Colour of the cloth or walls in bright light, for chroma-key [default: 0,170,60, a green].
    #[arg(long, value_name = "R,G,B", value_parser = parse_colour)]
    key: Option<[u8; 3]>,
    /// The first N images of each camera show the background without the subject.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with = "background")]
    empty: Option<u32>,
    /// Background without the subject, images or videos: a folder with CAMERA.png or CAMERA.avi, or the name of a file
    /// in each camera's folder.
    #[arg(long, value_name = "DIR|FILE")]
    background: Option<PathBuf>,
    /// Correct an outdated background image, or one with a person in it: pixels on which nearly all images of the
    /// recording agree are taken from them. For subjects that move about; clean-plate only.
    #[arg(long)]
    refine: bool,
    /// Frames to segment, from A to before B; either may be left out [default: all].
    #[arg(long, value_name = "A..B", value_parser = parse_frames, default_value = "..", hide_default_value = true)]
    frames: Range<u32>,
    /// Images per second [default: from frames.csv or the videos, else 30].
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    rate: Option<f64>,
    /// Greatest time difference, in seconds, between the images of a frame [default: half the time between images].
    #[arg(long, value_name = "SECONDS")]
    bound: Option<f64>,
    /// Keep existing masks and segment the remaining frames.
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Overwrite existing masks.
    #[arg(long)]
    force: bool,
    /// Write the masks as run lengths, one file CAMERA/mask.rle per camera, less than half the size of PNG files.
    #[arg(long)]
    rle: bool,
}

/// Default key of chroma-key: a typical green cloth.
const GREEN: [u8; 3] = [0, 170, 60];

const EXAMPLES: &str = "\
Examples:
  vhull segment my_recording
  vhull segment my_recording --empty 50 --frames 50..
  vhull segment my_recording --background background.avi --out segmented
  vhull segment my_recording --refine
  vhull segment my_recording --method chroma-key --key 40,150,70
  vhull segment my_recording --resume
  vhull segment my_recording --rle --out small";

/// Values of `--method`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// By the difference from the background without the subject.
    CleanPlate,
    /// By the difference from a background whose colours and noise are learnt and follow changes of the light.
    RunningGaussian,
    /// By the colour --key of cloth or walls behind the subject; needs no background images.
    ChromaKey,
}

pub fn run(options: &Options) -> Result<Outcome> {
    check(options)?;
    let recording = open_recording(&options.recording)?;
    if !recording.has_images() {
        let problem =
            "expected images or a video of every camera, found masks alone; there is nothing to segment";
        return Err(Error::file(&options.recording, problem));
    }

    // Refuse masks that exist before the backgrounds are read, which takes longer.
    let streaming = StreamOptions { first: 0, rate: options.rate, bound: options.bound };
    let mut masks = Masks::open(options, &recording, &streaming)?;
    let segmenters = segmenters(options, &recording, &streaming)?;
    let mut segmenters = Segmenters::new(recording.rig().cameras(), segmenters)?;

    let mut sets = recording.synchronised(&StreamOptions { first: options.frames.start, ..streaming })?;
    let expected = sets.streams().filter_map(|stream| stream.frames_expected()).max();
    let bar = progress::bar(count(&options.frames, expected), "frames");
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
                let found = segmenters.segment(&set)?;
                let found: Vec<_> = found.into_iter().flatten().collect();
                masks.write(number, set.time, &found)?;
                tally.written(&set);
            }
            Ok(true)
        });

        // On an error the frames so far are kept, and the message says how to continue.
        match done {
            Ok(true) => {}
            Ok(false) => break,
            Err(e) => return Err(tally.broken_off(&e, masks.dir())),
        }
    }

    bar.finish_and_clear();
    tally.print_summary(&options.recording, masks.dir(), &sets)
}

/// Refuses options that do not go with the method.
fn check(options: &Options) -> Result<()> {
    if options.key.is_some() && options.method != Method::ChromaKey {
        return Err(Error::argument("--key: expected --method chroma-key, found another; leave one out"));
    }
    if (options.empty.is_some() || options.background.is_some()) && options.method == Method::ChromaKey {
        let problem = "--empty, --background: expected a --method that needs background images, found chroma-key; \
                       leave one out";
        return Err(Error::argument(problem));
    }
    if options.refine && options.method != Method::CleanPlate {
        return Err(Error::argument("--refine: expected --method clean-plate, found another; leave one out"));
    }
    Ok(())
}

/// Number of frames to segment: the length of `frames`, at most the `left` images of the streams; 0 where both are
/// unknown.
fn count(frames: &Range<u32>, left: Option<u32>) -> usize {
    let requested = (frames.end < u32::MAX).then(|| frames.end - frames.start);
    left.into_iter().chain(requested).min().unwrap_or(0) as usize
}

/// A segmenter for each camera.
fn segmenters(
    options: &Options,
    recording: &Recording,
    streaming: &StreamOptions,
) -> Result<Vec<Box<dyn Segmenter>>> {
    if options.method == Method::ChromaKey {
        let key = Key::new(options.key.unwrap_or(GREEN));
        return recording.rig().cameras().iter().map(|_| Ok(Box::new(ChromaKey::new(key)?) as _)).collect();
    }

    let empty = EmptyRoom::find(options, recording, streaming)?.images;
    if options.method == Method::RunningGaussian {
        return empty.iter().map(|images| learnt(images)).collect();
    }

    let plates = empty.iter().map(|images| CleanPlate::from_empty(images, Thresholds::default()));
    if !options.refine {
        return plates.map(|plate| Ok(Box::new(plate?) as _)).collect();
    }

    // --refine: correct each plate by images from all over the recording.
    let frames = empty_room::throughout(recording, streaming)?;
    plates.zip(&frames).map(|(plate, frames)| Ok(Box::new(plate?.refined_with(frames)?) as _)).collect()
}

/// A [`RunningGaussian`] that has learnt the background `images` of a camera.
fn learnt(images: &[RgbImage]) -> Result<Box<dyn Segmenter>> {
    let mut segmenter = RunningGaussian::new(Learning::default())?;
    images.iter().try_for_each(|image| segmenter.learn(image))?;
    Ok(Box::new(segmenter))
}

/// Parses red, green and blue, as `0,170,60`.
fn parse_colour(text: &str) -> std::result::Result<[u8; 3], String> {
    let bytes: Option<Vec<u8>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    bytes.and_then(|bytes| bytes.try_into().ok()).ok_or_else(|| {
        format!(
            "expected red, green and blue from 0 to 255 separated by commas, as in 0,170,60, found {text}"
        )
    })
}
