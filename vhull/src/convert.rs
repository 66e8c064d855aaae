//! `vhull convert`: a calibration of any known format becomes a rig file.

use crate::Outcome;
use crate::arguments::HintOptions;
use ode_visual_hull::rig::Calibration;
use ode_visual_hull::{Error, Result};
use std::path::PathBuf;

/// Write a calibration of any known format as a rig file.
///
/// Written is TOML alone, which anipose, Pose2Sim and caliscope read too.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Calibration file or folder.
    rig: PathBuf,
    /// Rig file to write; its name ends in .toml.
    out: PathBuf,
    #[command(flatten)]
    hints: HintOptions,
    /// Replace the rig file if there is one.
    #[arg(long)]
    force: bool,
}

const EXAMPLES: &str = "\
Examples:
  vhull convert cameras.xml my_recording/rig.toml
  vhull convert sparse rig.toml --unit 0.37
  vhull convert P.txt rig.toml --size 1920x1080";

pub fn run(options: &Options) -> Result<Outcome> {
    let Options { rig, out, hints, force } = options;
    if out.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("toml")) {
        return Err(Error::file(
            out,
            "expected a name that ends in .toml, the one format that is written; rename it",
        ));
    }
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
