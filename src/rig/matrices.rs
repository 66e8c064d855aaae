//! Plain projection matrices: world to image, 3x4, of any scale and either sign.
//!
//! ```text
//! # left
//! 500 0 320 960
//! 0 500 240 720
//! 0 0 1 3
//! right 480 0 320 900 0 480 240 700 0 0 1 3
//! ```
//!
//! A camera is three rows of four numbers, or twelve numbers in a line; brackets, commas and semicolons are ignored.
//! Its name stands before the numbers in the line, or is the last line before them, as a comment (`#`, `%`, `//`) or
//! not; cameras without a name are called camera0, camera1 and so on. A folder of `.txt` files with one matrix each is
//! read too; its cameras are named after the files. Lengths are taken as metres, pixel centres as whole numbers,
//! without distortion; the format has no image sizes.

use super::format::{Format, Hints, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::length;
use super::lines::{self, Line, is_number};
use super::projections::pinholes;
use super::source::{self, Source};
use crate::{Error, Result};
use nalgebra::Matrix3x4;
use std::path::Path;

pub(super) const FORMAT: Format = Format { name: "plain 3x4 matrices", recognise, read };

const ROWS: &str = "write three rows of four numbers for each camera, or twelve numbers in a line";

/// A matrix, its label and its place in a file.
struct Named {
    /// The line of the first row, from 1.
    line: usize,
    name: Option<String>,
    matrix: Matrix3x4<f64>,
}

fn recognise(source: &Source) -> bool {
    match source.text() {
        Some(text) => holds_a_matrix(text),
        None => text_files(source).any(|path| source::read(path).is_ok_and(|text| holds_a_matrix(&text))),
    }
}

/// Whether the first line of numbers is a matrix row or a whole matrix, with at most one name before it.
fn holds_a_matrix(text: &str) -> bool {
    let text = without_brackets(text);
    let mut lines = lines::lines(&text).filter(|line| !is_comment(line));
    let first = lines.find(|line| line.words.iter().filter(|word| is_number(word)).count() > 1);
    first.is_some_and(|line| {
        let numbers = line.words.iter().filter(|word| is_number(word)).count();
        let names = line.words.len() - numbers;
        names == 0 && matches!(numbers, 4 | 12) || names == 1 && !is_number(line.words[0]) && numbers == 12
    })
}

/// The `.txt` files of a folder.
fn text_files(source: &Source) -> impl Iterator<Item = &Path> {
    let is_text =
        |path: &&Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("txt"));
    source.files().iter().map(|path| path.as_path()).filter(is_text)
}

fn read(source: &Source, hints: &Hints) -> Result<RawCalibration> {
    let mut notes = Vec::new();
    if hints.metres_per_unit.is_none() {
        notes.push(length::NOTE.into());
    }

    let named = match source.text() {
        Some(text) => of_a_file(text)?,
        None => of_a_folder(source, &mut notes)?,
    };

    let (pinholes, turned) = pinholes(&named)?;
    notes.extend(turned);

    let camera = |((name, _), pinhole): ((String, Matrix3x4<f64>), super::projections::Pinhole)| RawCamera {
        name,
        size: None,
        k: pinhole.k,
        lens: RawLens::none(),
        rotation: pinhole.cam_from_world.rotation,
        translation: pinhole.cam_from_world.translation.vector,
    };
    let cameras = named.into_iter().zip(pinholes).map(camera).collect();
    Ok(RawCalibration { cameras, pixel_centres: PixelCentres::Whole, metres_per_unit: Some(1.0), notes })
}

/// All matrices of one file, with their names.
fn of_a_file(text: &str) -> Result<Vec<(String, Matrix3x4<f64>)>> {
    let found = matrices(text)?;
    let name = |(i, found): (usize, Named)| {
        let name = found.name.unwrap_or_else(|| format!("camera{i}"));
        (found.line, (name, found.matrix))
    };
    let (lines, named): (Vec<usize>, Vec<_>) = found.into_iter().enumerate().map(name).unzip();
    lines::distinct(named.iter().map(|(name, _)| name.as_str()), |i| lines[i])?;
    Ok(named)
}

/// One matrix per `.txt` file, named after the file; files without a matrix are noted.
fn of_a_folder(source: &Source, notes: &mut Vec<String>) -> Result<Vec<(String, Matrix3x4<f64>)>> {
    let mut named = Vec::new();
    for path in text_files(source) {
        let text = source::read(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !holds_a_matrix(&text) {
            notes.push(format!("{name}.txt is left out: it holds no matrix"));
            continue;
        }
        named.push((name, only_matrix(&text).map_err(|e| Error::file(path, e))?));
    }
    Ok(named)
}

/// The only matrix of a file; MultiCamSelfCal's files are read by it too.
pub(super) fn only_matrix(text: &str) -> Result<Matrix3x4<f64>> {
    match &matrices(text)?[..] {
        [one] => Ok(one.matrix),
        more => {
            Err(Error::argument(format!("expected one 3x4 matrix, found {}; keep one in a file", more.len())))
        }
    }
}

/// All matrices of a text, with their labels.
fn matrices(text: &str) -> Result<Vec<Named>> {
    let text = without_brackets(text);
    let (mut found, mut rows, mut name) = (Vec::new(), Vec::<f64>::new(), None);
    let mut start = 0;

    for line in lines::lines(&text) {
        let numbers = line.words.iter().filter(|word| is_number(word)).count();
        let label = is_comment(&line) || numbers < 2;
        if label || rows.is_empty() {
            start = line.number;
        }

        // A label is only allowed between matrices, where `rows` is empty.
        match (rows.len(), label) {
            (0, true) => name = Some(label_text(line.text)),
            (_, true) => return Err(incomplete(&line, rows.len())),
            (0, false) if line.words.len() >= 12 => {
                let named = !is_number(line.words[0]);
                let own = named.then(|| label_text(line.words[0]));
                rows.extend(line.numbers::<12>(usize::from(named), ROWS)?);
                name = own.or(name);
            }
            _ => rows.extend(line.numbers::<4>(0, ROWS)?),
        }

        if rows.len() == 12 {
            let name = name.take().filter(|name: &String| !name.is_empty());
            found.push(Named { line: start, name, matrix: Matrix3x4::from_row_slice(&rows) });
            rows.clear();
        }
    }

    // A matrix must not end in the middle.
    match lines::lines(&text).last() {
        Some(line) if !rows.is_empty() => Err(incomplete(&line, rows.len())),
        _ => Ok(found),
    }
}

fn incomplete(line: &Line, numbers: usize) -> Error {
    line.fail(format!(
        "expected three rows of four numbers before the next camera, found {}; {ROWS}",
        numbers / 4
    ))
}

fn without_brackets(text: &str) -> String {
    text.replace(['[', ']', '(', ')', ',', ';'], " ")
}

fn is_comment(line: &Line) -> bool {
    line.text.starts_with(['#', '%']) || line.text.starts_with("//")
}

/// The label in a line: `left` of `# left:` and of `left =`.
fn label_text(text: &str) -> String {
    text.trim_start_matches(['#', '%', '/']).trim_end_matches([':', '=', ' ']).trim().to_owned()
}

#[cfg(test)]
pub(super) mod tests;
