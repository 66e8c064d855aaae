//! EasyMocap's pair `intri.yml` and `extri.yml`.
//!
//! ```yaml
//! names: [ "left", "right" ]                 # in both
//! K_left: !!opencv-matrix ...                # intri: 3x3, pixels
//! dist_left: !!opencv-matrix ...             # intri: k1 k2 p1 p2 k3, optional (or D_left)
//! H_left: 480                                # intri: optional, as W_left
//! R_left: !!opencv-matrix ...                # extri: Rodrigues vector
//! Rot_left: !!opencv-matrix ...              # extri: the same as a matrix, optional
//! T_left: !!opencv-matrix ...                # extri: 3x1
//! ```
//!
//! OpenCV's YAML with a key per camera and part, opened as the folder that holds both files, or as either of them. The
//! pose is world to camera, `x_cam = R x_world + T`, so the camera centre is `-R^T T`; lengths have the unit of the
//! checkerboard that was used, metres by EasyMocap's documentation; the world's z is up. Pixel *centres* are whole
//! numbers. Source: EasyMocap's documentation of calibration and its camera files.

use super::document::{self, Entry, Node};
use super::format::{Format, Hints, LensModel, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::length;
use super::source::{self, Source};
use crate::{Error, Result};
use nalgebra::UnitQuaternion;
use std::path::{Path, PathBuf};

pub(super) const FORMAT: Format = Format { name: "EasyMocap's intri.yml and extri.yml", recognise, read };

/// The largest angle in degrees between the two forms of a rotation, which are written with six digits or more.
const MOST_DEGREES_APART: f64 = 0.1;

/// One of the two files.
struct File {
    path: PathBuf,
    document: Node,
}

fn recognise(source: &Source) -> bool {
    let is_part = |text: &str| {
        let starts = |line: &str| ["K_", "Rot_", "R_", "T_"].iter().any(|key| line.starts_with(key));
        text.lines().any(|line| line.starts_with("names:")) && text.lines().any(starts)
    };
    match source.text() {
        Some(text) => is_part(text),
        None => [source.beside("intri.yml"), source.beside("extri.yml")].iter().any(Option::is_some),
    }
}

fn read(source: &Source, hints: &Hints) -> Result<RawCalibration> {
    let (intri, extri) = (file(source, "intri", "extri", "K_")?, file(source, "extri", "intri", "T_")?);
    let cameras =
        names(&intri)?.iter().map(|name| camera(name, &intri, &extri)).collect::<Result<Vec<_>>>()?;
    let mut notes = length::as_metres(&cameras, hints)?;
    for name in names(&extri).unwrap_or_default() {
        if !cameras.iter().any(|camera| camera.name == name) {
            notes.push(format!(
                "extri.yml has a pose of camera {name} but intri.yml has no lens; it is left out"
            ));
        }
    }
    Ok(RawCalibration { cameras, pixel_centres: PixelCentres::Whole, metres_per_unit: Some(1.0), notes })
}

/// Finds the file of one half (`intri` or `extri`): the opened file if it holds keys with the prefix `key`, else its
/// counterpart beside it, such as `extri_new.yml` for `intri_new.yml`.
fn file(source: &Source, half: &str, other: &str, key: &str) -> Result<File> {
    if let Some(text) = source.text().filter(|text| text.lines().any(|line| line.starts_with(key))) {
        return File::new(&source.path, text);
    }

    let own = source.text().and(source.path.file_stem()).unwrap_or_default().to_string_lossy();
    let stem = if own.contains(other) { own.replacen(other, half, 1) } else { half.to_owned() };
    let Some(path) = ["yml", "yaml"].iter().find_map(|ending| source.beside(&format!("{stem}.{ending}")))
    else {
        let holds = match half {
            "extri" => "the poses, R_ and T_ of each camera",
            _ => "the lenses, K_ of each camera",
        };
        return Err(source.lacks(&format!("{stem}.yml"), &format!("put it there: it holds {holds}")));
    };

    File::new(&path, &source::read(&path)?)
}

fn names(file: &File) -> Result<Vec<String>> {
    let list = file.document.require("names", "list the cameras' names").and_then(|list| list.items());
    let name = |item: Entry| Ok(item.text()?.to_owned());
    list.and_then(|items| items.into_iter().map(name).collect()).map_err(|e| file.fail(e))
}

fn camera(name: &str, intri: &File, extri: &File) -> Result<RawCamera> {
    let lens = |key: &str| intri.document.entry(&format!("{key}_{name}"));
    let in_intri = |e| intri.fail(Error::camera(name, e));
    let in_extri = |e| extri.fail(Error::camera(name, e));

    // Intrinsics and pose are in different files; an error names its own.
    let k = intri.document.require(&format!("K_{name}"), "calibrate its lens, or take it out of `names`");
    let k = k.and_then(|entry| entry.matrix3()).map_err(in_intri)?;
    let distortion = lens("dist").or(lens("D")).map(|entry| entry.lens(LensModel::OpenCv));
    let distortion = distortion.transpose().map_err(in_intri)?;
    let size = size(lens("W"), lens("H")).map_err(in_intri)?;

    let rotation = rotation(name, &extri.document).map_err(in_extri)?;
    let translation = extri.document.require(&format!("T_{name}"), "calibrate where it stands");
    let translation = translation.and_then(|entry| entry.vector3()).map_err(in_extri)?;

    let lens = distortion.unwrap_or_else(RawLens::none);
    Ok(RawCamera { name: name.to_owned(), size, k, lens, rotation, translation })
}

/// Width and height in pixels; `None` where one is absent or both are -1, which stands for unknown.
fn size(width: Option<Entry>, height: Option<Entry>) -> Result<Option<(u32, u32)>> {
    let (Some(width), Some(height)) = (width, height) else { return Ok(None) };
    if [width.numbers()?, height.numbers()?].iter().all(|numbers| numbers.values == [-1.0]) {
        return Ok(None);
    }
    Ok(Some((width.pixels()?, height.pixels()?)))
}

/// The rotation of a camera; if both the matrix and the vector exist they have to agree.
fn rotation(name: &str, extri: &Node) -> Result<UnitQuaternion<f64>> {
    let (matrix, vector) = (extri.entry(&format!("Rot_{name}")), extri.entry(&format!("R_{name}")));
    let Some(matrix) = matrix else {
        return extri.require(&format!("R_{name}"), "calibrate where it stands")?.rotation();
    };

    let rotation = matrix.rotation()?;
    if let Some(vector) = vector {
        let apart = vector.rotation()?.angle_to(&rotation).to_degrees();
        if apart > MOST_DEGREES_APART {
            let problem =
                format!("expected the same rotation as in R_{name}, found one {apart:.2} degrees off it");
            return Err(matrix.fail(format!("{problem}; remove the one that is wrong")));
        }
    }

    Ok(rotation)
}

impl File {
    fn new(path: &Path, text: &str) -> Result<Self> {
        let document = document::parse(text).map_err(|e| Error::file(path, e))?;
        Ok(Self { path: path.to_owned(), document })
    }

    fn fail(&self, problem: Error) -> Error {
        Error::file(&self.path, problem)
    }
}

#[cfg(test)]
pub(super) mod tests;
