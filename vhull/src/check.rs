//! `vhull check`: coverage of a rig, consistency of its calibration with the masks, and problems to fix.

mod pictures;
mod placement;
mod silhouettes;

use crate::Outcome;
use crate::arguments::{HintOptions, RIG, print_notes};
use nalgebra::Point3;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{RecordedHulls, VolumeOptions, numbers, parse_positive};
use std::path::{Path, PathBuf};

/// Report on a rig and on the silhouettes of a recording, and list problems to fix.
///
/// For a rig: where each camera stands and looks, whether all look at one point, how much of the work volume they see,
/// how high the hull rises above a table. For a recording with masks: which views' silhouettes are shifted against the
/// others', and which views cut away what the others see.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Calibration file or folder of any known format, or the folder of a recording.
    rig: PathBuf,
    /// Folder of a recording with masks [default: RIG if it is one].
    recording: Option<PathBuf>,
    #[command(flatten)]
    hints: HintOptions,
    #[command(flatten)]
    volume: VolumeOptions,
    /// Table above which the height of the hull is reported: centre of its top and edge length of a cube below it, in
    /// metres. May be repeated.
    #[arg(long, value_name = "X,Y,Z,SIZE", value_parser = parse_table, allow_hyphen_values = true)]
    table: Vec<Table>,
    /// Greatest acceptable shift of a view's silhouettes, in pixels; masks of real people vary by 3 to 5 px, exact
    /// masks do not.
    #[arg(long, value_name = "PIXELS", default_value = "5", value_parser = parse_positive)]
    tolerance: f64,
    /// Greatest number of frames to examine, evenly spread.
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Folder for each view's image overlaid with its silhouette and the hull's; created if missing.
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Frame of the pictures, and with --frames 1 of the whole report [default: the middle one].
    #[arg(long, value_name = "N")]
    frame: Option<u32>,
}

const EXAMPLES: &str = "\
Examples:
  vhull check calibration.toml
  vhull check calibration.toml --table 0,0,0.4,0.5
  vhull check my_recording --pictures overlays
  vhull check other_rig.toml my_recording --tolerance 2

Exits with code 3 if there are problems.";

/// A table: a cube below the centre `top` of its upper face, with edges of `side` metres.
#[derive(Debug, Clone, Copy)]
struct Table {
    top: Point3<f64>,
    side: f64,
}

/// Parses `X,Y,Z,SIZE`, in metres.
fn parse_table(text: &str) -> std::result::Result<Table, String> {
    let [x, y, z, side] = numbers(text, "x,y,z,size")?;
    if side <= 0.0 {
        return Err(format!("expected a size above zero, found {side}"));
    }
    Ok(Table { top: Point3::new(x, y, z), side })
}

/// Problems found so far.
#[derive(Debug, Default)]
struct Report {
    /// A sentence each, with the next step.
    problems: Vec<String>,
}

impl Report {
    fn add_problem(&mut self, sentence: impl Into<String>) {
        self.problems.push(sentence.into());
    }
}

pub fn run(options: &Options) -> Result<Outcome> {
    let (rig, folder) = load(options)?;
    let mut report = Report::default();
    print!("{}", rig.describe());
    println!();

    // Silhouettes of cameras that do not see the work volume cannot be compared.
    let comparable = placement::describe_rig(&rig, options, &mut report)?;
    if let Some(folder) = folder.as_ref().filter(|_| !comparable) {
        println!("\nthe silhouettes in {} are not compared: fix the cameras first", folder.display());
    } else if let Some(folder) = &folder {
        let recorded = RecordedHulls::new(Recording::open_with(folder, rig)?, folder, &options.volume)?;
        if let Some(frame) = options.frame {
            recorded.check_has(frame)?;
        }

        println!();
        silhouettes::describe_silhouettes(&recorded, options, &mut report)?;
        if let Some(out) = &options.pictures {
            pictures::write(&recorded, options.frame, out)?;
        }
    } else if options.pictures.is_some() || options.frame.is_some() {
        return Err(Error::argument(
            "--pictures, --frame: expected a recording, found none; give its folder after the calibration",
        ));
    }

    Ok(print_verdict(&report))
}

/// Loads the rig and prints notes on its calibration; also returns the folder of the recording, if there is one.
fn load(options: &Options) -> Result<(Rig, Option<PathBuf>)> {
    let folder = match &options.recording {
        Some(folder) => Some(folder.clone()),
        None if options.rig.join(RIG).is_file() => has_pictures(&options.rig)?.then(|| options.rig.clone()),
        None => None,
    };
    let calibration = options.hints.load(&options.rig)?;
    println!("{} cameras, read as {}", calibration.rig.len(), calibration.format);
    print_notes(&calibration);
    Ok((calibration.rig, folder))
}

/// Whether `folder` holds folders beside its rig file, as a recording does.
fn has_pictures(folder: &Path) -> Result<bool> {
    let fail = |e: std::io::Error| Error::file(folder, format!("expected a readable folder, found: {e}"));
    let mut entries = std::fs::read_dir(folder).map_err(fail)?;
    Ok(entries.any(|entry| entry.is_ok_and(|entry| entry.path().is_dir())))
}

/// Prints `verdict: ok`, or the number of problems and the list of them.
fn print_verdict(report: &Report) -> Outcome {
    println!();
    match report.problems.len() {
        0 => println!("verdict: ok"),
        1 => println!("verdict: 1 problem"),
        count => println!("verdict: {count} problems"),
    }
    report.problems.iter().for_each(|problem| println!("- {problem}"));
    if report.problems.is_empty() { Outcome::Done } else { Outcome::ProblemsFound }
}
