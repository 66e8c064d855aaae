//! Options shared by several subcommands, and parsers of the values of options.

use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::{Calibration, Hints};
use ode_visual_hull::{Error, MissingHint, Result};
use ode_visual_hull_film::{parse_positive, parse_size};
use std::path::Path;

/// File name of the calibration in the folder of a recording.
pub const RIG: &str = "rig.toml";

/// What a calibration file may lack: the unit of length and the size of the images.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct HintOptions {
    /// Metres per unit of length of the calibration [default: as its format defines].
    #[arg(long, value_name = "METRES", value_parser = parse_length)]
    pub unit: Option<f64>,
    /// Size of the images, for calibrations that do not hold it.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
}

impl HintOptions {
    /// Reads the calibration at `path`, or that recording's rig file, completed by these options.
    pub fn load(self, path: &Path) -> Result<Calibration> {
        let rig_file = path.join(RIG);
        let path = if rig_file.is_file() { &rig_file } else { path };
        let hints = Hints { size: self.size, metres_per_unit: self.unit };
        Calibration::load(path, &hints).map_err(|e| hinted(e, "that is"))
    }
}

/// Opens the recording in folder `dir`; the error for a missing rig file names `vhull convert`.
pub fn open_recording(dir: &Path) -> Result<Recording> {
    Recording::open(dir).map_err(|e| match e {
        Error::File { path, problem } if path == dir.join(RIG) && !path.exists() => {
            let problem = format!("{problem}: vhull convert CALIBRATION {}", path.display());
            Error::File { path, problem }
        }
        other => other,
    })
}

/// Prints the notes of a calibration, and the option for a doubtful unit of length.
pub fn print_notes(calibration: &Calibration) {
    for note in &calibration.notes {
        println!("note: {note}");
    }
    if calibration.is_unit_doubtful {
        println!("note: set another unit with {}", option(MissingHint::MetresPerUnit));
    }
}

/// Appends the option that supplies a missing hint to `error`, joined by `with`; other errors are returned as they are.
pub fn hinted(error: Error, with: &str) -> Error {
    match error {
        Error::MissingHint { what, error } => Error::argument(format!("{error}: {with} {}", option(what))),
        other => other,
    }
}

fn option(what: MissingHint) -> &'static str {
    match what {
        MissingHint::Size => "--size WIDTHxHEIGHT",
        MissingHint::MetresPerUnit => "--unit METRES",
        _ => "--help",
    }
}

/// Parses a length in metres above zero.
pub fn parse_length(text: &str) -> std::result::Result<f64, String> {
    parse_positive(text).map_err(|_| format!("expected a number of metres above zero, found {text}"))
}
