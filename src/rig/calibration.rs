//! Detects the format of a calibration file and turns its content into a rig, by rules that hold for all formats.

use super::format::{Format, Hints, PixelCentres, RawCalibration, RawCamera};
use super::length::{self, FARTHEST};
use super::source::Source;
use super::{
    Rig, colmap, easymocap, kalibr, matrices, middlebury, nerfstudio, opencv, panoptic, qualisys, ros,
    selfcal, toml, voxelpose,
};
use crate::camera::{Camera, Lens};
use crate::{Error, MissingHint, Result};
use nalgebra::Isometry3;
use std::path::Path;

/// A rig read from a file, with its format and notes.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The cameras.
    pub rig: Rig,
    /// The name of the file's format, for messages.
    pub format: &'static str,
    /// What to know before trusting the rig: units that were assumed, cameras left out, a mirrored world. One sentence
    /// each.
    pub notes: Vec<String>,
    /// Whether one of the notes questions the unit of length; [`Hints::metres_per_unit`] settles it.
    pub is_unit_doubtful: bool,
}

/// All formats; the first that recognises a file reads it. OpenCV's and bare numbers come last: the former has no
/// distinctive keys, the latter no keys at all.
const FORMATS: &[Format] = &[
    toml::FORMAT,
    colmap::FORMAT,
    selfcal::FORMAT,
    middlebury::FORMAT,
    qualisys::FORMAT,
    panoptic::FORMAT,
    voxelpose::FORMAT,
    nerfstudio::FORMAT,
    kalibr::FORMAT,
    easymocap::FORMAT,
    ros::FORMAT,
    opencv::FORMAT,
    matrices::FORMAT,
];

/// Plausible focal lengths, in image widths: fields of view from 158 to 0.6 degrees.
const FOCAL_LENGTHS: std::ops::RangeInclusive<f64> = 0.1..=100.0;

/// The note on a rig whose cameras all stand below z = 0.
const UPSIDE_DOWN: &str = "every camera stands below z = 0: does z point down?";

/// The name of a calibration in memory that was given none.
const NAMELESS: &str = "calibration";

/// The end of the note on a rig too large for metres.
const HARDLY_METRES: &str = "are these metres? else give the metres per unit";

impl Calibration {
    /// Reads a calibration file or folder. The content, not the name, determines the format. [`parse`](Self::parse)
    /// reads a file's bytes from memory.
    ///
    /// # Errors
    /// A file that cannot be read or is of no known format; an image size or a scale that neither the file nor `hints`
    /// gives; an invalid pose, an implausible focal length, and everything that [`Camera::new`] and [`Rig::new`]
    /// refuse. The message starts with the path.
    pub fn load(path: impl AsRef<Path>, hints: &Hints) -> Result<Self> {
        Self::read(&Source::open(path.as_ref())?, hints)
    }

    /// Reads a calibration of a single file from its bytes, for example received over a network or embedded with
    /// `include_bytes!`. The result equals that of [`load`](Self::load) for a file of this name and content with no
    /// other file beside it.
    ///
    /// `name` replaces the path in messages; an empty name becomes `calibration`. The content determines the format,
    /// except that a name ending in `.toml` selects TOML. In formats that name a camera after its file, `name` is that
    /// file's name, and may have folders before it. Nothing is read from disk.
    ///
    /// # Errors
    /// Bytes that are not UTF-8; one part of a calibration that consists of several files, as COLMAP's, EasyMocap's
    /// and ROS's do: the message names the missing file, and [`load`](Self::load) reads them together; otherwise all
    /// errors of [`load`](Self::load). The message starts with `name`.
    ///
    /// ```
    /// use ode_visual_hull::rig::{Calibration, Hints};
    ///
    /// // Two projection matrices, world to image: a line for each camera, its name before the 12 numbers.
    /// let bytes = b"left 500 0 320 960 0 500 240 720 0 0 1 3\n\
    ///               right 480 0 320 900 0 480 240 700 0 0 1 3\n";
    /// let hints = Hints { size: Some((640, 480)), metres_per_unit: Some(1.0) };
    /// let calibration = Calibration::parse("studio.txt", bytes, &hints)?;
    /// assert_eq!(calibration.format, "plain 3x4 matrices");
    /// assert_eq!(calibration.rig.cameras()[1].name(), "right");
    ///
    /// // This format does not hold the size of the images: without a hint that is an error.
    /// let error = Calibration::parse("studio.txt", bytes, &Hints::default()).unwrap_err().to_string();
    /// assert!(error.starts_with("studio.txt: camera \"left\": expected to know the size of its images"));
    /// # Ok::<(), ode_visual_hull::Error>(())
    /// ```
    pub fn parse(name: &str, bytes: &[u8], hints: &Hints) -> Result<Self> {
        let name = if name.is_empty() { NAMELESS } else { name };
        Self::read(&Source::in_memory(name, bytes)?, hints)
    }

    fn read(source: &Source, hints: &Hints) -> Result<Self> {
        let Some(format) = FORMATS.iter().find(|format| (format.recognise)(source)) else {
            return Err(Error::file(&source.path, unknown(source)));
        };

        // Readers that open several files name the file themselves.
        let with_path = |e| match e {
            Error::File { .. } => e,
            other => Error::file(&source.path, other),
        };

        let calibration = (format.read)(source, hints).and_then(|calibration| calibration.into_rig(hints));
        let (rig, notes) = calibration.map_err(|e| match e {
            Error::MissingHint { what, error } => Error::missing_hint(what, with_path(*error)),
            other => with_path(other),
        })?;

        let is_unit_doubtful = notes.iter().any(|note| note == length::NOTE || note.ends_with(HARDLY_METRES));
        Ok(Self { rig, format: format.name, notes, is_unit_doubtful })
    }
}

impl RawCalibration {
    /// The rig, in metres and with pixel corners at whole numbers, and the notes.
    pub(super) fn into_rig(self, hints: &Hints) -> Result<(Rig, Vec<String>)> {
        let scale = hints.metres_per_unit.or(self.metres_per_unit).ok_or_else(|| {
            let problem = "expected to know the unit of length, found a format whose worlds have any scale; give the \
                           metres per unit";
            Error::missing_hint(MissingHint::MetresPerUnit, Error::argument(problem))
        })?;
        if !(scale.is_finite() && scale > 0.0) {
            return Err(Error::argument(format!(
                "expected a positive number of metres per unit, found {scale}"
            )));
        }

        let cameras = self.cameras.into_iter().map(|found| found.camera(self.pixel_centres, scale, hints));
        let rig = Rig::new(cameras.collect::<Result<_>>()?)?;

        // Implausible worlds are still read: a note tells what to check.
        let mut notes = self.notes;
        if rig.cameras().iter().all(|camera| camera.centre().z < 0.0) {
            notes.push(UPSIDE_DOWN.into());
        }

        let distances = rig.cameras().iter().map(|camera| camera.centre().coords.norm());
        let farthest = distances.fold(0.0, f64::max);
        if hints.metres_per_unit.is_none() && farthest > FARTHEST {
            notes.push(format!("a camera stands {farthest:.0} m from the world's origin: {HARDLY_METRES}"));
        }

        Ok((rig, notes))
    }
}

impl RawCamera {
    /// Scales the pose to metres, moves the pixel origin to the corner, and checks the focal lengths.
    fn camera(self, centres: PixelCentres, metres_per_unit: f64, hints: &Hints) -> Result<Camera> {
        let Self { name, size, mut k, lens, rotation, translation } = self;
        let Some(size) = size.or(hints.size) else {
            let problem = "expected to know the size of its images, found a file without it; give width and \
                           height";
            return Err(Error::missing_hint(MissingHint::Size, Error::camera(name, problem)));
        };

        if centres == PixelCentres::Whole {
            k[(0, 2)] += 0.5;
            k[(1, 2)] += 0.5;
        }

        let translation = translation * metres_per_unit;
        let pose = Isometry3::from_parts(translation.into(), rotation);
        let pinhole = Camera::new(name, size, k, Lens::none(), pose)?;

        // A focal length in millimetres or a wrong image size shows here.
        let focal_lengths = [0, 1].map(|axis| k[(axis, axis)] / f64::from(size.0));
        if let Some(bad) = focal_lengths.iter().find(|length| !FOCAL_LENGTHS.contains(*length)) {
            let problem = format!(
                "expected a focal length of 0.1 to 100 image widths, found {bad:.3e}; check its unit (pixels) and the \
                 size of the images, {} x {}",
                size.0, size.1
            );
            return Err(Error::camera(pinhole.name(), problem));
        }

        pinhole.with_lens(lens.lens).map_err(|e| lens.error_at_place(e))
    }
}

/// The error text for a file that no format recognises.
fn unknown(source: &Source) -> String {
    let names: Vec<_> = FORMATS.iter().map(|format| format.name).collect();
    let found = match source.text() {
        Some(text) => match text.lines().map(str::trim).find(|line| !line.is_empty()) {
            Some(line) => format!("a file that begins \"{}\"", line.chars().take(40).collect::<String>()),
            None => "an empty file".into(),
        },
        None if source.files().is_empty() => "a folder without files".into(),
        None => format!("a folder of {} files that is none of them", source.files().len()),
    };

    let next = match source.text() {
        Some(_) => "convert it to one of these",
        None => "check the path, or give the calibration's own file",
    };
    format!("expected a calibration ({}), found {found}; {next}", names.join(", "))
}

#[cfg(test)]
mod tests;
