//! `vhull check`: what a rig sees, whether its calibration and masks fit together, and what to fix.

mod pictures;
mod placement;
mod silhouettes;

use crate::Outcome;
use crate::arguments::{HintOptions, RIG, VolumeOptions, numbers, parse_positive, print_notes};
use crate::recorded_hulls::RecordedHulls;
use nalgebra::Point3;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::{Error, Result};
use std::path::{Path, PathBuf};

/// Report on a rig, and on a recording's silhouettes: what is seen, what fits, and what has to be fixed.
///
/// The report on the rig says where each camera stands and looks, whether all look at one place, how much of the work
/// volume they see, and how high the hull rises above a table. The report on a recording with masks says whether the
/// silhouettes of a view are shifted against the others', and which view cuts away what the others see.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Calibration file or folder of any known format, or the folder of a recording.
    rig: PathBuf,
    /// Folder of a recording with masks [default: RIG, if it is one].
    recording: Option<PathBuf>,
    #[command(flatten)]
    hints: HintOptions,
    #[command(flatten)]
    volume: VolumeOptions,
    /// Report the hull's height above this table: the centre of its top and the edge length of a cube under it, in
    /// metres; may be given several times.
    #[arg(long, value_name = "X,Y,Z,SIZE", value_parser = parse_table, allow_hyphen_values = true)]
    table: Vec<Table>,
    /// How far a view's silhouettes may be shifted, in pixels; masks of real people reach 3 to 5 px, exact ones 0.
    #[arg(long, value_name = "PIXELS", default_value = "5", value_parser = parse_positive)]
    tolerance: f64,
    /// Number of frames to check at most, evenly spread.
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Write each view's image, overlaid with its silhouette and the hull's, to this folder, which is made if it is missing.
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// The frame of the pictures, and of all else if --frames is 1 [default: the middle one].
    #[arg(long, value_name = "N")]
    frame: Option<u32>,
}

const EXAMPLES: &str = "\
Examples:
  vhull check calibration.toml
  vhull check calibration.toml --table 0,0,0.4,0.5
  vhull check my_recording --pictures overlays
  vhull check other_rig.toml my_recording --tolerance 2

Ends with code 3 if it finds a problem.";

/// A table: the centre of its top and the edge length of a cube under it, in metres.
#[derive(Debug, Clone, Copy)]
struct Table {
    top: Point3<f64>,
    side: f64,
}

fn parse_table(text: &str) -> std::result::Result<Table, String> {
    let [x, y, z, side] = numbers(text, "x,y,z,size")?;
    if side <= 0.0 {
        return Err(format!("expected a size above zero, found {side}"));
    }
    Ok(Table { top: Point3::new(x, y, z), side })
}

/// The problems found so far.
#[derive(Debug, Default)]
struct Report {
    /// A sentence for each, with what to do.
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
    let comparable = placement::describe_rig(&rig, options, &mut report)?;

    if let Some(folder) = folder.as_ref().filter(|_| !comparable) {
        println!("\nthe silhouettes in {} are not compared: the cameras come first", folder.display());
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

    Ok(verdict(&report))
}

/// The rig, and the folder of the recording, if there is one.
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

/// Whether a rig file has folders beside it, which a recording has.
fn has_pictures(folder: &Path) -> Result<bool> {
    let fail = |e: std::io::Error| Error::file(folder, format!("expected a readable folder, found: {e}"));
    let mut entries = std::fs::read_dir(folder).map_err(fail)?;
    Ok(entries.any(|entry| entry.is_ok_and(|entry| entry.path().is_dir())))
}

fn verdict(report: &Report) -> Outcome {
    println!();
    let problems = &report.problems;
    if problems.is_empty() {
        println!("verdict: ok");
        return Outcome::Done;
    }
    println!("verdict: {} problem{}", problems.len(), if problems.len() == 1 { "" } else { "s" });
    problems.iter().for_each(|problem| println!("- {problem}"));
    Outcome::ProblemsFound
}
