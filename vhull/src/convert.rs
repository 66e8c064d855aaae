//! `vhull convert`: a calibration of any known format becomes a rig file.

use crate::Outcome;
use crate::arguments::HintOptions;
use ode_visual_hull::rig::Calibration;
use ode_visual_hull::{Error, Result};
use std::path::PathBuf;

/// Write a calibration of any known format as a rig file in TOML.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Calibration file or folder.
    rig: PathBuf,
    /// Rig file to write.
    out: PathBuf,
    #[command(flatten)]
    hints: HintOptions,
    /// Replace the rig file if there is one.
    #[arg(long)]
    force: bool,
}

pub fn run(options: &Options) -> Result<Outcome> {
    let Options { rig, out, hints, force } = options;
    if out.exists() && !force {
        return Err(Error::file(out, "expected no file yet, found one; choose another name or give --force"));
    }
    let calibration = Calibration::load(rig, &hints.hints())?;
    calibration.rig.save(out)?;
    println!("{} cameras, read as {}", calibration.rig.len(), calibration.format);
    print!("{}", calibration.rig.describe());
    for note in &calibration.notes {
        println!("note: {note}");
    }
    println!("written to {}", out.display());
    Ok(Outcome::Done)
}
