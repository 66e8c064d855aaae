//! `vhull convert`: a calibration of any known format becomes a rig file.

use crate::Outcome;
use ode_visual_hull::rig::{Calibration, Hints};
use ode_visual_hull::{Error, Result};
use std::path::PathBuf;

/// Write a calibration of any known format as a rig file in TOML.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Calibration file or folder.
    rig: PathBuf,
    /// Rig file to write.
    out: PathBuf,
    /// Metres per unit of length of the calibration, instead of its format's own.
    #[arg(long, value_name = "METRES")]
    unit: Option<f64>,
    /// Size of the images, where the calibration does not tell.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Replace the rig file if there is one.
    #[arg(long)]
    force: bool,
}

pub fn run(options: &Options) -> Result<Outcome> {
    let Options { rig, out, unit, size, force } = options;
    if out.exists() && !force {
        return Err(Error::file(out, "expected no file yet, found one; choose another name or give --force"));
    }
    let hints = Hints { size: *size, metres_per_unit: *unit };
    let calibration = Calibration::load(rig, &hints)?;
    calibration.rig.save(out)?;
    println!("{} cameras, read as {}", calibration.rig.len(), calibration.format);
    print!("{}", calibration.rig.describe());
    for note in &calibration.notes {
        println!("note: {note}");
    }
    println!("written to {}", out.display());
    Ok(Outcome::Done)
}

fn parse_size(text: &str) -> std::result::Result<(u32, u32), String> {
    let numbers = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    numbers.ok_or_else(|| format!("expected two numbers as in 640x480, found {text}"))
}
