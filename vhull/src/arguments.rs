//! Options shared by several subcommands, and parsers of the values of options.

use clap::ValueEnum;
use nalgebra::Point3;
use ode_visual_hull::hull::{Aabb, HullData, Unseen};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::{Calibration, Hints, Rig};
use ode_visual_hull::{Error, MissingHint, Result};
use std::ops::Range;
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

/// The work volume, and how a camera decides points that it does not see.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct VolumeOptions {
    /// Work volume, in metres [default: around the point that the cameras look at, sized by their distance from it].
    #[arg(
        long,
        value_name = "X0,X1,Y0,Y1,Z0,Z1",
        value_parser = parse_bounds,
        allow_hyphen_values = true
    )]
    pub bounds: Option<Aabb>,
    /// How a camera decides points outside its image.
    #[arg(long, value_enum, default_value_t = UnseenPolicy::Outside)]
    pub unseen: UnseenPolicy,
}

impl VolumeOptions {
    /// The work volume of `--bounds`, by default the one derived from the cameras' poses.
    pub fn of(&self, rig: &Rig) -> Result<Aabb> {
        self.bounds.map_or_else(|| rig.work_volume(), Ok)
    }

    /// Adds the cameras of `rig` to `data` and sets its work volume and its policy for unseen points.
    pub fn prepare(&self, data: &HullData, rig: &Rig) -> Result<()> {
        data.add_views(rig.cameras())?;
        data.set_unseen(self.unseen.into())?;
        data.set_bounds(self.of(rig)?)
    }
}

/// Values of `--unseen`; see [`Unseen`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnseenPolicy {
    /// Points outside the image are outside the hull.
    Outside,
    /// The camera does not decide them; at least two cameras must see a point of the hull.
    Abstain,
}

impl From<UnseenPolicy> for Unseen {
    fn from(policy: UnseenPolicy) -> Self {
        match policy {
            UnseenPolicy::Outside => Self::Outside,
            UnseenPolicy::Abstain => Self::ABSTAIN,
        }
    }
}

/// Parses a work volume, six numbers in metres separated by commas.
pub fn parse_bounds(text: &str) -> std::result::Result<Aabb, String> {
    let [x0, x1, y0, y1, z0, z1] = numbers(text, "x0,x1,y0,y1,z0,z1")?;
    Aabb::new(Point3::new(x0, y0, z0), Point3::new(x1, y1, z1)).map_err(|error| error.to_string())
}

/// Parses width and height of an image in pixels, as `640x480`.
pub fn parse_size(text: &str) -> std::result::Result<(u32, u32), String> {
    let numbers = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    numbers
        .filter(|&(w, h)| w > 0 && h > 0)
        .ok_or_else(|| format!("expected two whole numbers above zero as in 640x480, found {text}"))
}

/// Parses a length in metres above zero.
pub fn parse_length(text: &str) -> std::result::Result<f64, String> {
    parse_positive(text).map_err(|_| format!("expected a number of metres above zero, found {text}"))
}

/// Parses a finite number above zero.
pub fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|&number: &f64| number.is_finite() && number > 0.0);
    number.ok_or_else(|| format!("expected a number above zero, found {text}"))
}

/// Parses a frame rate in images per second, above zero.
pub fn parse_rate(text: &str) -> std::result::Result<f64, String> {
    parse_positive(text).map_err(|_| format!("expected a positive number of images per second, found {text}"))
}

/// Parses a half-open range of frames, `A..B`. A defaults to 0, B to `u32::MAX`, which stands for all that follow.
pub fn parse_frames(text: &str) -> std::result::Result<Range<u32>, String> {
    let number = |part: &str, open: u32| if part.is_empty() { Some(open) } else { part.parse().ok() };
    let range = text.split_once("..").and_then(|(a, b)| Some(number(a, 0)?..number(b, u32::MAX)?));
    range
        .filter(|range| !range.is_empty())
        .ok_or_else(|| format!("expected A..B with A below B, as in 20..60, 20.. or ..60, found {text}"))
}

/// Formats a range of frames so that [`parse_frames`] reads it again.
pub fn shown_frames(range: &Range<u32>) -> String {
    let end = if range.end == u32::MAX { String::new() } else { range.end.to_string() };
    format!("{}..{end}", range.start)
}

/// Parses `N` finite numbers separated by commas; `named` lists their names for the error.
pub fn numbers<const N: usize>(text: &str, named: &str) -> std::result::Result<[f64; N], String> {
    let parse = |part: &str| part.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let numbers =
        numbers.ok_or_else(|| format!("expected numbers separated by commas, {named}, found {text}"))?;
    let count = numbers.len();
    numbers.try_into().map_err(|_| format!("expected {N} numbers, {named}, found {count}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_end_of_a_range_of_frames_may_be_left_out() {
        for (text, range) in [("3..7", 3..7), ("3..", 3..u32::MAX), ("..7", 0..7), ("..", 0..u32::MAX)] {
            assert_eq!(parse_frames(&shown_frames(&range)), Ok(range.clone()));
            assert_eq!(parse_frames(text), Ok(range));
        }
        for bad in ["", "3", "7..3", "3..3", "a..b", "-1..3", "1..2..3"] {
            assert!(parse_frames(bad).unwrap_err().contains(&format!("found {bad}")), "{bad}");
        }
    }
}
