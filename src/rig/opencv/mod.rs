//! OpenCV's FileStorage in YAML, XML or JSON, and plain YAML and JSON with the same keys.
//!
//! ```yaml
//! %YAML:1.0
//! ---
//! image_width: 640
//! image_height: 480
//! camera_matrix: !!opencv-matrix
//!    rows: 3
//!    cols: 3
//!    dt: d
//!    data: [ 500., 0., 319.5, 0., 500., 239.5, 0., 0., 1. ]
//! distortion_coefficients: [ -0.1, 0.01, 0., 0., 0. ]
//! rvec: [ 1.57, 0., 0. ]
//! tvec: [ 0., 1., 3. ]
//! ```
//!
//! A file is a camera; a folder of such files is a rig, and so is a folder of folders, one per camera (`folder`).
//! Other layouts are one file with a map per camera (`{"left": {"K": ...}, ...}`, possibly under `cameras`), numbered
//! keys (`K1`, `D1`, `R1`, `T1`, ...), and the pair `intrinsics.yml` and `extrinsics.yml` of OpenCV's stereo sample
//! (`M1`, `D1`, `M2`, `D2`; `R`, `T` lead from the first camera to the second; `R1`, `R2` rectify and are ignored).
//!
//! With `fisheye_model: 1`, as OpenCV's calibration sample writes it, or `fisheye: true` the coefficients are k1 k2 k3
//! k4 of the fisheye model.
//!
//! FileStorage prescribes no key names, so each part has several (`keys`). The pose is world to camera, as `solvePnP`
//! and `calibrateCamera` return it; axes x right, y down, z forward; pixel *centres* are whole numbers; lengths have
//! no unit and are taken as metres unless that is implausible. Source: the documentation of `cv::FileStorage`, of
//! OpenCV's module calib3d and of its calibration samples.

mod folder;
mod keys;

use super::document::{self, Entry, Node, Value};
use super::format::{Format, Hints, LensModel, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::length;
use super::source::{self, Source};
use crate::{Error, Result};
use keys::Keys;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::path::Path;

pub(super) const FORMAT: Format = Format { name: "OpenCV's YAML, XML or JSON", recognise, read };

/// File names that do not name a camera; such a camera is named after the folder.
const GENERIC_NAMES: &[&str] =
    &["config", "calibration", "calib", "camera", "params", "parameters", "intrinsics", "extrinsics"];

const NO_POSE: &str = "add the pose of world to camera, rvec and tvec (or R and T), from solvePnP with points whose place in \
                       the world is known";

/// The parts of a camera that a file holds.
#[derive(Debug, Clone, Default)]
struct Parts {
    k: Option<Matrix3<f64>>,
    lens: Option<RawLens>,
    size: Option<(u32, u32)>,
    rotation: Option<UnitQuaternion<f64>>,
    translation: Option<Vector3<f64>>,
}

/// The content of a file: one camera in `shared`, or several cameras and their common parts.
#[derive(Debug, Clone, Default)]
struct OpenCvFile {
    shared: Parts,
    numbered: Vec<(String, Parts)>,
    named: Vec<(String, Parts)>,
}

fn recognise(source: &Source) -> bool {
    source.text().map_or_else(|| folder::recognise(source), recognise_text)
}

fn recognise_text(text: &str) -> bool {
    let marked = ["<opencv_storage", "opencv-matrix", "%YAML:"].iter().any(|mark| text.contains(mark));
    marked || document::parse(text).is_ok_and(|document| has_cameras(&document))
}

/// Whether a plain document holds camera matrices under OpenCV's names.
fn has_cameras(document: &Node) -> bool {
    let is_camera = |node: &Node| Keys::new(node, "").matrix().is_some();
    is_camera(document)
        || !Keys::numbers(document).is_empty()
        || maps(document).any(|entry| is_camera(entry.node))
}

fn read(source: &Source, hints: &Hints) -> Result<RawCalibration> {
    let (cameras, mut notes) = match source.text() {
        Some(text) => (file(source, text)?, Vec::new()),
        None => folder::read(source)?,
    };
    notes.extend(length::as_metres(&cameras, hints)?);
    Ok(RawCalibration { cameras, pixel_centres: PixelCentres::Whole, metres_per_unit: Some(1.0), notes })
}

/// The cameras of a single file; `intrinsics` and `extrinsics` complete each other.
fn file(source: &Source, text: &str) -> Result<Vec<RawCamera>> {
    let mut contents = OpenCvFile::read(text)?;
    if let Some(other) = folder::counterpart(&source.path) {
        match source.beside(&other) {
            Some(path) => contents = contents.or(OpenCvFile::open(&path)?),
            None if source.is_in_memory() && !contents.is_complete() => return Err(source.lacks(&other, "")),
            None => {}
        }
    }
    contents.cameras(&name_of(&source.path, || source.folder_name()))
}

/// A camera's name: the file's stem, or the folder's name where the stem is generic.
fn name_of(path: &Path, folder: impl FnOnce() -> Option<String>) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if !GENERIC_NAMES.contains(&stem.to_ascii_lowercase().as_str()) {
        return stem;
    }
    folder().unwrap_or(stem)
}

/// The maps in a document that may be cameras, with the cameras' names as keys.
fn maps(document: &Node) -> impl Iterator<Item = Entry<'_>> {
    let inner = document.entry("cameras").map_or(document, |entry| entry.node);
    inner.entries().filter(|entry| matches!(entry.node.value, Value::Map(_)))
}

impl OpenCvFile {
    fn open(path: &Path) -> Result<Self> {
        let file = source::read(path).and_then(|text| Self::read(&text)).map_err(|e| match e {
            Error::File { .. } => e,
            other => Error::file(path, other),
        });
        file.map(|file| file.at(path))
    }

    /// Names the file in errors about its lenses.
    fn at(mut self, path: &Path) -> Self {
        let named = self.numbered.iter_mut().chain(&mut self.named).map(|(_, parts)| parts);
        for parts in named.chain([&mut self.shared]) {
            parts.lens = parts.lens.take().map(|lens| lens.in_file(path));
        }
        self
    }

    fn read(text: &str) -> Result<Self> {
        let document = document::parse(text)?;
        let keys = Keys::new(&document, "");
        let fisheye = keys.fisheye()?;
        let shared = Parts::read(&keys, fisheye.as_ref())?;
        if shared.k.is_some() {
            return Ok(Self { shared, ..Self::default() });
        }

        let numbered = |number: String| {
            let parts = Parts::read(&Keys::new(&document, &number), fisheye.as_ref())?;
            Ok((number, parts))
        };
        let numbered = Keys::numbers(&document).into_iter().map(numbered).collect::<Result<_>>()?;

        let named = maps(&document)
            .filter(|entry| Keys::new(entry.node, "").matrix().is_some())
            .map(|entry| {
                let parts = Parts::read(&Keys::new(entry.node, ""), fisheye.as_ref());
                let parts = parts.map_err(|e| Error::camera(&entry.key, e))?;
                Ok((entry.key.into_owned(), parts))
            })
            .collect::<Result<_>>()?;

        Ok(Self { shared, numbered, named })
    }

    /// Fills the missing parts from `other`.
    fn or(mut self, other: Self) -> Self {
        self.shared = self.shared.or(&other.shared);
        for (into, from) in [(&mut self.numbered, other.numbered), (&mut self.named, other.named)] {
            for (name, parts) in from {
                match into.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, known)) => *known = known.clone().or(&parts),
                    None => into.push((name, parts)),
                }
            }
        }
        self
    }

    /// Whether the file holds no part of a camera.
    fn is_empty(&self) -> bool {
        let Parts { k, rotation, translation, .. } = &self.shared;
        let any = k.is_some() || rotation.is_some() || translation.is_some();
        !any && self.numbered.is_empty() && self.named.is_empty()
    }

    /// Whether the file alone defines its cameras completely.
    fn is_complete(&self) -> bool {
        self.cameras("").is_ok()
    }

    /// The cameras of the file; a single one is called `name`.
    fn cameras(&self, name: &str) -> Result<Vec<RawCamera>> {
        let Self { shared, numbered, named } = self;
        if !named.is_empty() {
            return named.iter().map(|(name, parts)| parts.clone().sized(shared.size).found(name)).collect();
        }

        let numbered: Vec<_> = numbered.iter().filter(|(_, parts)| parts.k.is_some()).collect();
        let placed = numbered.iter().any(|(_, parts)| parts.translation.is_some());
        let stereo = numbered.len() == 2 && shared.translation.is_some() && !placed;

        // A stereo pair has one pose, from the first camera to the second.
        let of_number = |(i, (number, parts)): (usize, &&(String, Parts))| {
            let mut parts = parts.clone().sized(shared.size);
            if stereo {
                let first = i == 0;
                parts.rotation = if first { Some(UnitQuaternion::identity()) } else { shared.rotation };
                parts.translation = if first { Some(Vector3::zeros()) } else { shared.translation };
            }
            parts.found(number)
        };

        match numbered.is_empty() {
            true => Ok(vec![shared.clone().found(name)?]),
            false => numbered.iter().enumerate().map(of_number).collect(),
        }
    }
}

impl Parts {
    /// Reads the parts of one camera. `fisheye` is the mark for all cameras of the file; the camera's own takes
    /// precedence.
    fn read(keys: &Keys, fisheye: Option<&Entry>) -> Result<Self> {
        let own = keys.fisheye()?;
        let fisheye = own.as_ref().or(fisheye);
        let model = fisheye.map_or(LensModel::OpenCv, |_| LensModel::Fisheye);
        let mut parts = Self {
            k: keys.matrix().map(|entry| entry.matrix3()).transpose()?,
            lens: keys.distortion().map(|entry| entry.lens(model)).transpose()?,
            size: keys.size()?,
            rotation: keys.rotation().map(|entry| entry.rotation()).transpose()?,
            translation: keys.translation().map(|entry| entry.vector3()).transpose()?,
        };

        if let (Some(entry), Some(_), None) = (fisheye, parts.k, &parts.lens) {
            return Err(entry.fail(
                "expected a fisheye with its coefficients, found none under their usual names; call them \
                 distortion_coefficients, or D",
            ));
        }

        if let Some(entry) = keys.motion() {
            let (rotation, translation) = entry.motion()?;
            parts.rotation = parts.rotation.or(Some(rotation));
            parts.translation = parts.translation.or(Some(translation));
        }
        Ok(parts)
    }

    /// Fills the missing parts from `other`.
    fn or(self, other: &Self) -> Self {
        Self {
            k: self.k.or(other.k),
            lens: self.lens.or_else(|| other.lens.clone()),
            size: self.size.or(other.size),
            rotation: self.rotation.or(other.rotation),
            translation: self.translation.or(other.translation),
        }
    }

    /// Fills a missing image size.
    fn sized(mut self, size: Option<(u32, u32)>) -> Self {
        self.size = self.size.or(size);
        self
    }

    /// The camera called `name`, if matrix, rotation and translation are known.
    fn found(self, name: &str) -> Result<RawCamera> {
        let Some(k) = self.k else {
            let problem =
                "expected a camera matrix, found none under its usual names; call it camera_matrix, or K";
            return Err(Error::camera(name, problem));
        };

        let (Some(rotation), Some(translation)) = (self.rotation, self.translation) else {
            let found = match (self.rotation, self.translation) {
                (None, None) => "neither",
                (Some(_), _) => "a rotation alone",
                _ => "a translation alone",
            };
            let problem = format!("expected a rotation and a translation, found {found}; {NO_POSE}");
            return Err(Error::camera(name, problem));
        };

        let lens = self.lens.unwrap_or_else(RawLens::none);
        Ok(RawCamera { name: name.to_owned(), size: self.size, k, lens, rotation, translation })
    }
}

#[cfg(test)]
pub(super) mod tests;
