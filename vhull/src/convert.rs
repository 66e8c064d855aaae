//! `vhull convert`: a rig file from a calibration of any known format.

use crate::Outcome;
use crate::arguments::{HintOptions, print_notes};
use crate::output::make_folder_of;
use nalgebra::Vector2;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{numbers, parse_positive};
use std::path::PathBuf;

/// Write a calibration of any known format as a rig file.
///
/// The rig file is TOML that anipose, Pose2Sim and caliscope also read.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Calibration file or folder, or the folder of a recording.
    rig: PathBuf,
    /// Rig file to write; its name ends in .toml.
    out: PathBuf,
    #[command(flatten)]
    hints: HintOptions,
    /// Factor by which the images have been scaled since the calibration.
    #[arg(long, value_name = "FACTOR", value_parser = parse_positive)]
    scale: Option<f64>,
    /// Moves the principal point of a camera to the right and down, in pixels of the scaled images, where everything
    /// appears that far from its calibrated position. May be repeated for other cameras.
    #[arg(long, value_name = "CAMERA=DU,DV", value_parser = parse_shift, allow_hyphen_values = true)]
    shift: Vec<ImageShift>,
    /// Replace an existing rig file.
    #[arg(long)]
    force: bool,
}

const EXAMPLES: &str = "\
Examples:
  vhull convert calibration.yml rig.toml
  vhull convert sparse/0 rig.toml --unit 0.25                     one unit of the calibration is 25 cm
  vhull convert cameras.json half.toml --scale 0.5 --shift left=-1.5,0.8";

/// Shift of a camera's principal point, in pixels, u to the right and v down.
#[derive(Debug, Clone)]
struct ImageShift {
    camera: String,
    by: Vector2<f64>,
}

pub fn run(options: &Options) -> Result<Outcome> {
    let Options { rig, out, hints, scale, shift, force } = options;
    if out.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("toml")) {
        return Err(Error::file(
            out,
            "expected a name that ends in .toml, the only format written; rename it",
        ));
    }

    if out.exists() && !force {
        return Err(Error::file(out, "expected no file yet, found one; choose another name or give --force"));
    }

    // Scale first: shifts are in pixels of the scaled images.
    let calibration = hints.load(rig)?;
    let mut rig = calibration.rig.clone();
    if let Some(factor) = *scale {
        rig = rig.scaled(factor)?;
    }
    for ImageShift { camera, by } in shift {
        rig = rig.shifted(camera, *by)?;
    }

    make_folder_of(out)?;
    rig.save(out)?;

    println!("{} cameras, read as {}", rig.len(), calibration.format);
    print!("{}", rig.describe());
    print_notes(&calibration);
    println!("written to {}", out.display());
    Ok(Outcome::Done)
}

/// Parses `CAMERA=DU,DV`.
fn parse_shift(text: &str) -> std::result::Result<ImageShift, String> {
    let (camera, by) = text.split_once('=').ok_or_else(|| format!("expected camera=du,dv, found {text}"))?;
    Ok(ImageShift { camera: camera.to_owned(), by: Vector2::from(numbers::<2>(by, "du,dv")?) })
}
