//! Options that several verbs share, and parsers of their values.

use clap::ValueEnum;
use nalgebra::Point3;
use ode_visual_hull::hull::{Aabb, HullData, Unseen};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::{Calibration, Hints, Rig};
use ode_visual_hull::{Error, MissingHint, Result};
use std::ops::Range;
use std::path::Path;

/// The calibration of a recording, in its folder.
pub const RIG: &str = "rig.toml";

/// What a calibration file may lack.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct HintOptions {
    /// Metres per unit of length of the calibration, instead of its format's own.
    #[arg(long, value_name = "METRES", value_parser = parse_length)]
    pub unit: Option<f64>,
    /// Size of the images, where the calibration does not state it.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
}

impl HintOptions {
    /// Loads the calibration at `path`, or that of the recording there, completed by these options.
    pub fn load(self, path: &Path) -> Result<Calibration> {
        let own = path.join(RIG);
        Calibration::load(
            if own.is_file() { &own } else { path },
            &Hints { size: self.size, metres_per_unit: self.unit },
        )
        .map_err(|e| hinted(e, "that is"))
    }
}

/// Opens the recording in folder `dir`.
pub fn open_recording(dir: &Path) -> Result<Recording> {
    Recording::open(dir).map_err(|e| match e {
        Error::File { path, problem } if path == dir.join(RIG) && !path.exists() => {
            let problem = format!("{problem}: vhull convert CALIBRATION {}", path.display());
            Error::File { path, problem }
        }
        other => other,
    })
}

/// Prints the notes that the reader of a calibration left.
pub fn print_notes(calibration: &Calibration) {
    for note in &calibration.notes {
        println!("note: {note}");
    }
    if calibration.is_unit_doubtful {
        println!("note: {} says otherwise", option(MissingHint::MetresPerUnit));
    }
}

/// `error`, with the option that helps where a calibration lacks something; `with` introduces the option.
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

/// The work volume, and how points count that a camera does not see.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct VolumeOptions {
    /// Work volume, in metres [default: around the spot that the cameras look at, as far as they stand from it].
    #[arg(
        long,
        value_name = "X0,X1,Y0,Y1,Z0,Z1",
        value_parser = parse_bounds,
        allow_hyphen_values = true
    )]
    pub bounds: Option<Aabb>,
    /// How points count that lie outside a camera's image.
    #[arg(long, value_enum, default_value_t = UnseenPolicy::Outside)]
    pub unseen: UnseenPolicy,
}

impl VolumeOptions {
    /// The work volume of the options, else the one that follows from the cameras.
    pub fn of(&self, rig: &Rig) -> Result<Aabb> {
        self.bounds.map_or_else(|| rig.work_volume(), Ok)
    }

    /// Adds the cameras to `data` and sets the work volume.
    pub fn prepare(&self, data: &HullData, rig: &Rig) -> Result<()> {
        data.add_views(rig.cameras())?;
        data.set_unseen(self.unseen.into())?;
        data.set_bounds(self.of(rig)?)
    }
}

/// [`Unseen`] by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnseenPolicy {
    /// As outside the hull.
    Outside,
    /// Not at all: the camera abstains. Two cameras must see a point of the hull.
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

/// Parses a work volume, six numbers with commas between them.
pub fn parse_bounds(text: &str) -> std::result::Result<Aabb, String> {
    let [x0, x1, y0, y1, z0, z1] = numbers(text, "x0,x1,y0,y1,z0,z1")?;
    Aabb::new(Point3::new(x0, y0, z0), Point3::new(x1, y1, z1)).map_err(|error| error.to_string())
}

/// Parses an image's width and height.
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

/// Parses a number above zero.
pub fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|&number: &f64| number.is_finite() && number > 0.0);
    number.ok_or_else(|| format!("expected a number above zero, found {text}"))
}

/// Parses a rate in images a second, above zero.
pub fn parse_rate(text: &str) -> std::result::Result<f64, String> {
    parse_positive(text).map_err(|_| format!("expected a positive number of images a second, found {text}"))
}

/// Parses frames from A up to but not B, as `A..B`. Without A the range starts at frame 0, without B it has no end.
pub fn parse_frames(text: &str) -> std::result::Result<Range<u32>, String> {
    let number = |part: &str, open: u32| if part.is_empty() { Some(open) } else { part.parse().ok() };
    let range = text.split_once("..").and_then(|(a, b)| Some(number(a, 0)?..number(b, u32::MAX)?));
    range
        .filter(|range| !range.is_empty())
        .ok_or_else(|| format!("expected A..B with A below B, as in 20..60, 20.. or ..60, found {text}"))
}

/// Writes a range of frames as [`parse_frames`] reads it.
pub fn shown_frames(range: &Range<u32>) -> String {
    let end = if range.end == u32::MAX { String::new() } else { range.end.to_string() };
    format!("{}..{end}", range.start)
}

/// Parses `N` finite numbers with commas between them; `named` names them in messages.
pub fn numbers<const N: usize>(text: &str, named: &str) -> std::result::Result<[f64; N], String> {
    let parse = |part: &str| part.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let numbers = numbers.ok_or_else(|| format!("expected numbers between commas, {named}, found {text}"))?;
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
