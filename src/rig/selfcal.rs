//! The output folder of MultiCamSelfCal (Svoboda, Martinec, Pajdla: A convenient multi-camera self-calibration for
//! virtual environments, 2005), in the form that flydra and Braid exchange as well.
//!
//! | file | holds |
//! |---|---|
//! | `camera1.Pmat.cal`, .. | a 3x4 projection matrix, world to undistorted pixels |
//! | `basename1.rad`, .. | `K11 = ..` to `K33`, `kc1 = ..` to `kc4` (k1 k2 p1 p2): the lens. None, or one a camera |
//! | `Res.dat` | width and height, a line for each camera |
//! | `camera_order.txt` | a name for each camera, one a line; else the `basename` in `configdata.m` |
//!
//! Pixel centres are whole numbers, as flydra counts. The world's scale and the matrices' signs are arbitrary (see
//! `projections`). `selfcal/lens.rs` combines matrix and lens.

mod lens;

use super::format::{Format, Hints, PixelCentres, RawCalibration, RawCamera};
use super::lines::{self, Line};
use super::matrices;
use super::projections::{Pinhole, pinholes};
use super::source::{self, Source};
use crate::{Error, Result};
use lens::FittedLens;
use nalgebra::Matrix3x4;
use std::path::{Path, PathBuf};

pub(super) const FORMAT: Format = Format { name: "MultiCamSelfCal's folder", recognise, read };

/// A lens error above this, in pixels, is noted: the reprojection error of a good calibration.
const NOTED_ERROR_PX: f64 = 0.2;

const SIZES: &str = "Res.dat";
const ORDER: &str = "camera_order.txt";

fn recognise(source: &Source) -> bool {
    source.files().iter().any(|path| matrix_number(path).is_some()) || holds_inputs(source)
}

/// Whether the folder holds the inputs of the calibration instead of its results.
fn holds_inputs(source: &Source) -> bool {
    let beside = |name| source.beside(name).is_some();
    source.text().is_none() && (beside("multicamselfcal.cfg") || beside("points.dat") && beside("IdMat.dat"))
}

/// The camera number in a file name: `3` of `camera3.Pmat.cal`.
fn matrix_number(path: &Path) -> Option<usize> {
    let name = path.file_name()?.to_str()?;
    let number = name.strip_prefix("camera").or_else(|| name.strip_prefix("Camera"))?;
    number.strip_suffix(".Pmat.cal")?.parse().ok()
}

/// The camera number in a file name: `3` of `basename3.rad`, whatever the base name.
fn lens_number(path: &Path) -> Option<usize> {
    let stem = path.file_name()?.to_str()?.strip_suffix(".rad")?;
    stem[stem.trim_end_matches(|c: char| c.is_ascii_digit()).len()..].parse().ok()
}

fn read(source: &Source, hints: &Hints) -> Result<RawCalibration> {
    let mut files: Vec<_> =
        source.files().iter().filter_map(|path| Some((matrix_number(path)?, path))).collect();
    files.sort();

    if files.is_empty() {
        return Err(Error::argument(
            "expected camera1.Pmat.cal and so on, found only what MultiCamSelfCal starts from; run it, and open the \
             folder that it writes",
        ));
    }

    if let Some(pair) = files.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let problem = format!("expected one matrix for camera {}, found two; remove one", pair[0].0);
        return Err(Error::file(pair[1].1, problem));
    }

    let numbers: Vec<_> = files.iter().map(|(number, _)| *number).collect();
    let names = names(source, &numbers)?;
    let named = names.into_iter().zip(&files).map(|(name, (_, path))| Ok((name, matrix(path)?)));
    let named = named.collect::<Result<Vec<_>>>()?;

    let (pinholes, mut notes) = pinholes(&named)?;
    let mut cameras = Vec::new();
    for (((name, _), pinhole), number) in named.into_iter().zip(pinholes).zip(&numbers) {
        cameras.push(camera(source, hints, name, &pinhole, *number, &mut notes)?);
    }
    Ok(RawCalibration { cameras, pixel_centres: PixelCentres::Whole, metres_per_unit: None, notes })
}

/// One camera: its matrix combined with the lens and the size in the files beside it.
fn camera(
    source: &Source,
    hints: &Hints,
    name: String,
    pinhole: &Pinhole,
    number: usize,
    notes: &mut Vec<String>,
) -> Result<RawCamera> {
    let size = size(source, number)?;
    let lens = match lens_file(source, number)? {
        Some(path) => lens::read(&source::read(&path)?).map_err(|e| Error::file(&path, e))?,
        None => FittedLens::none(&pinhole.k),
    };

    let (lens, misfit) = lens.behind(&pinhole.k, size.or(hints.size));
    if misfit.rms_px > NOTED_ERROR_PX {
        notes.push(format!(
            "camera {name}: matrix and .rad file have different intrinsic parameters; the lens that stands for both \
             is off by {:.1} px on average, {:.1} px at most; undistort the images beforehand if that is too much",
            misfit.rms_px, misfit.max_px
        ));
    }

    Ok(RawCamera {
        name,
        size,
        k: lens.k,
        lens: lens.distortion.into(),
        rotation: pinhole.cam_from_world.rotation,
        translation: pinhole.cam_from_world.translation.vector,
    })
}

fn matrix(path: &Path) -> Result<Matrix3x4<f64>> {
    matrices::only_matrix(&source::read(path)?).map_err(|e| Error::file(path, e))
}

/// The `.rad` file of a camera; `None` where no camera has one.
fn lens_file(source: &Source, number: usize) -> Result<Option<PathBuf>> {
    let mut lenses = source.files().iter().filter(|path| lens_number(path).is_some()).peekable();
    if lenses.peek().is_none() {
        return Ok(None);
    }
    let found: Vec<_> = lenses.filter(|path| lens_number(path) == Some(number)).collect();
    match found[..] {
        [path] => Ok(Some(path.clone())),
        _ => Err(Error::argument(format!(
            "expected one .rad file for camera {number}, as others have theirs, found {}; the matrices are for \
             undistorted pixels, so add the lens of each",
            found.len()
        ))),
    }
}

fn size(source: &Source, number: usize) -> Result<Option<(u32, u32)>> {
    let Some(path) = source.beside(SIZES) else { return Ok(None) };
    let text = source::read(&path)?;
    numbered(&text, number).and_then(|line| line.size(0)).map(Some).map_err(|e| Error::file(&path, e))
}

/// The line of `text` that belongs to the camera `number`, counted from 1.
fn numbered(text: &str, number: usize) -> Result<Line<'_>> {
    let found = lines::lines(text).count();
    lines::lines(text).nth(number.wrapping_sub(1)).ok_or_else(|| {
        Error::argument(format!(
            "expected a line for camera {number}, found {found}; add a line for each camera"
        ))
    })
}

/// The cameras' names: from `camera_order.txt`, else the base name in `configdata.m` with the number.
fn names(source: &Source, numbers: &[usize]) -> Result<Vec<String>> {
    if let Some(path) = source.beside(ORDER) {
        let text = source::read(&path)?;
        let lines = numbers.iter().map(|&number| numbered(&text, number)).collect::<Result<Vec<_>>>();
        let lines = lines.map_err(|e| Error::file(&path, e))?;
        lines::distinct(lines.iter().map(|line| line.text), |i| lines[i].number)
            .map_err(|e| Error::file(&path, e))?;
        return Ok(lines.iter().map(|line| line.text.to_owned()).collect());
    }
    let configured = source.beside("configdata.m").map(|path| source::read(&path)).transpose()?;
    let base = configured.as_deref().and_then(base_name).unwrap_or("camera");
    Ok(numbers.iter().map(|number| format!("{base}{number}")).collect())
}

/// The `config.files.basename = '..'` of a `configdata.m`, where it has a single one.
fn base_name(text: &str) -> Option<&str> {
    let set = lines::lines(text).filter(|line| line.text.starts_with("config.files.basename"));
    let mut values = set.filter_map(|line| line.text.split('\'').nth(1));
    values.next().filter(|_| values.next().is_none())
}

#[cfg(test)]
pub(super) mod tests;
