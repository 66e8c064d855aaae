//! The native rig file: the TOML format that anipose, Pose2Sim and caliscope write.
//!
//! ```toml
//! [cam_0]
//! name = "left"
//! size = [640, 480]
//! matrix = [[500.0, 0.0, 319.5], [0.0, 500.0, 239.5], [0.0, 0.0, 1.0]]
//! distortions = [-0.1, 0.01, 0.0, 0.0, 0.0]
//! rotation = [1.57, 0.0, 0.0]
//! translation = [0.0, 1.0, 3.0]
//! fisheye = false
//! ```
//!
//! If `fisheye` is true the distortions are k1 k2 k3 k4 of OpenCV's fisheye model, else 0, 4, 5, 8, 12 or 14
//! coefficients of its standard model. One table per camera, in the file's order; a table `metadata` and unknown keys
//! are ignored. The pose is world to camera, the rotation a Rodrigues vector, lengths are taken as metres. Pixel
//! *centres* are whole numbers in the file and pixel corners in a [`Camera`]: the principal point moves by half a
//! pixel on reading and back on writing.

use super::format::{Format, Hints, LensModel, PixelCentres, RawCalibration, RawCamera, RawLens, pixels};
use super::source::Source;
use super::{Rig, pose};
use crate::camera::{Camera, Lens};
use crate::{Error, Result};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::fmt::Write;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The offset from pixel centres at whole numbers to pixel corners at whole numbers.
const HALF_PIXEL: f64 = 0.5;

pub(super) const FORMAT: Format = Format {
    name: "TOML of anipose, Pose2Sim or caliscope",
    recognise: |source| source.text().is_some_and(|text| source.has_extension("toml") || has_a_table(text)),
    read: |source: &Source, _: &Hints| contents(source.text().unwrap_or_default()),
};

const SIZE: &str = "write size = [width, height] in pixels";
const MATRIX: &str = "write matrix = [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels";
const DISTORTIONS: &str = "write distortions = [k1, k2, p1, p2, k3], or [] for none";
const FISHEYE: &str = "write distortions = [k1, k2, k3, k4] of OpenCV's fisheye model";
const ROTATION: &str = "write the Rodrigues vector of world to camera, rotation = [rx, ry, rz]";
const TRANSLATION: &str = "write that of world to camera in metres, translation = [x, y, z]";

impl Rig {
    /// Writes a rig file that [`Rig::load`], anipose, Pose2Sim and caliscope read.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        std::fs::write(path, self.to_toml())
            .map_err(|e| Error::file(path, format!("expected to write a rig file, found: {e}")))
    }

    /// Reads a rig from the text of a rig file.
    ///
    /// # Errors
    /// Text that is not TOML, a table that is not a camera, a key that is missing or of another type or shape, a
    /// number that is not finite, an invalid rotation, and everything that [`Camera::new`] and [`Rig::new`] refuse.
    /// Messages name the line, the camera, its table and the key.
    pub fn from_toml(text: &str) -> Result<Self> {
        Ok(contents(text)?.into_rig(&Hints::default())?.0)
    }

    /// The text of a rig file. Reading it back gives the same rig except for the last digits of rotation and principal
    /// point.
    pub fn to_toml(&self) -> String {
        // Some readers sort the tables by title, so the numbers in the titles are padded to equal length.
        let digits = (self.len() - 1).to_string().len();
        let mut text = String::new();
        for (i, camera) in self.cameras().iter().enumerate() {
            let _ = write!(text, "[cam_{i:0digits$}]\n{}\n", camera_to_toml(camera));
        }
        text + "[metadata]\nadjusted = false\nerror = 0.0\n"
    }
}

/// Whether the text has a TOML table of a camera: a line that is a title, which no other format has.
fn has_a_table(text: &str) -> bool {
    let is_title = |line: &str| line.starts_with('[') && line.ends_with(']') && !line.contains([',', ' ']);
    text.lines().any(|line| is_title(line.trim())) && text.contains("matrix")
}

/// Reads all tables except `metadata`, in the file's order.
fn contents(text: &str) -> Result<RawCalibration> {
    let document = DeTable::parse(text).map_err(|e| {
        let line = e.span().map_or(1, |span| line_of(text, span.start));
        Error::argument(format!("line {line}: expected TOML, found: {}", e.message()))
    })?;

    // The parser sorts the tables by title.
    let mut tables: Vec<_> = document.get_ref().iter().collect();
    tables.sort_by_key(|(title, _)| title.span().start);
    let cameras = tables
        .into_iter()
        .filter(|(title, _)| title.get_ref().as_ref() != "metadata")
        .map(|(title, value)| CameraTable::new(text, title.get_ref(), value)?.camera())
        .collect::<Result<Vec<_>>>()?;

    Ok(RawCalibration {
        cameras,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(1.0),
        notes: Vec::new(),
    })
}

fn camera_to_toml(camera: &Camera) -> String {
    let name = toml::Value::from(camera.name());
    let (width, height) = camera.size();

    let mut k = *camera.intrinsics();
    k[(0, 2)] -= HALF_PIXEL;
    k[(1, 2)] -= HALF_PIXEL;
    let row = |r: usize| [k[(r, 0)], k[(r, 1)], k[(r, 2)]];

    let fisheye = matches!(camera.lens(), Lens::Fisheye(_));
    let distortions = match camera.lens() {
        // anipose, Pose2Sim and caliscope expect at least five coefficients.
        Lens::OpenCv(lens) => &lens.coefficients()[..lens.shortest().len().max(5)],
        Lens::Fisheye(lens) => lens.coefficients(),
    };
    let pose = camera.cam_from_world();
    let rotation: [f64; 3] = pose.rotation.scaled_axis().into();
    let translation: [f64; 3] = pose.translation.vector.into();
    // Rust's debug form of a float is the shortest text that reads back to the same bits, and valid TOML.
    format!(
        "name = {name}\nsize = [{width}, {height}]\nmatrix = {:?}\ndistortions = {distortions:?}\n\
         rotation = {rotation:?}\ntranslation = {translation:?}\nfisheye = {fisheye}\n",
        [row(0), row(1), row(2)]
    )
}

/// The line of a byte offset, from 1.
fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&b| b == b'\n').count()
}

/// One camera's table, with the context for its error messages.
struct CameraTable<'a> {
    text: &'a str,
    title: &'a str,
    /// The byte offset of the table in the text.
    start: usize,
    name: String,
    entries: &'a DeTable<'a>,
}

/// The numbers of a possibly nested array, row by row.
struct Numbers {
    values: Vec<f64>,
    shape: Vec<usize>,
}

impl<'a> CameraTable<'a> {
    fn new(text: &'a str, title: &'a str, value: &'a Spanned<DeValue<'a>>) -> Result<Self> {
        let start = value.span().start;
        let DeValue::Table(entries) = value.get_ref() else {
            return Err(Error::argument(format!(
                "line {}, key `{title}`: expected only tables, one per camera, found {}; move the key to [metadata]",
                line_of(text, start),
                found(value.get_ref())
            )));
        };

        let mut table = Self { text, title, start, name: title.to_owned(), entries };
        if let Some(name) = table.entry("name") {
            table.name = match name.get_ref() {
                DeValue::String(name) => name.to_string(),
                other => {
                    let problem = format!("expected a string, found {}; write name = \"...\"", found(other));
                    return Err(table.fail("name", problem));
                }
            };
        }
        Ok(table)
    }

    fn camera(&self) -> Result<RawCamera> {
        let size = self.size()?;
        let k = Matrix3::from_row_slice(&self.numbers_of_shape("matrix", &[3, 3], MATRIX)?);
        let lens = self.lens()?;
        let rotation = self.rotation()?;
        let translation =
            Vector3::from_column_slice(&self.numbers_of_length("translation", 3, TRANSLATION)?);
        Ok(RawCamera { name: self.name.clone(), size: Some(size), k, lens, rotation, translation })
    }

    /// The lens by `fisheye` and `distortions`.
    fn lens(&self) -> Result<RawLens> {
        let (model, next_step) = match self.entry("fisheye").map(Spanned::get_ref) {
            None | Some(DeValue::Boolean(false)) => (LensModel::OpenCv, DISTORTIONS),
            Some(DeValue::Boolean(true)) => (LensModel::Fisheye, FISHEYE),
            Some(other) => {
                return Err(self.fail("fisheye", format!("expected true or false, found {}", found(other))));
            }
        };

        let coefficients = self.numbers("distortions", next_step)?.values;
        RawLens::new(model, &coefficients, self.place("distortions"))
            .map_err(|e| self.fail("distortions", format!("{e}; {next_step}")))
    }

    fn size(&self) -> Result<(u32, u32)> {
        let size = self.numbers_of_length("size", 2, SIZE)?;
        match (pixels(size[0]), pixels(size[1])) {
            (Some(width), Some(height)) => Ok((width, height)),
            _ => {
                let problem = format!("expected whole numbers from 1 to 65535, found {size:?}; {SIZE}");
                Err(self.fail("size", problem))
            }
        }
    }

    /// The rotation, from a Rodrigues vector or, as in some files, a matrix.
    fn rotation(&self) -> Result<UnitQuaternion<f64>> {
        let Numbers { values, shape } = self.numbers("rotation", ROTATION)?;
        if values.len() == 3 {
            return Ok(UnitQuaternion::from_scaled_axis(Vector3::from_column_slice(&values)));
        }
        if shape != [3, 3] {
            let problem = format!("expected 3 numbers or 3 x 3, found {}; {ROTATION}", shape_text(&shape));
            return Err(self.fail("rotation", problem));
        }
        let matrix = Matrix3::from_row_slice(&values);
        pose::rotation(&matrix).map_err(|problem| self.fail("rotation", problem))
    }

    fn numbers_of_length(&self, key: &str, length: usize, next_step: &str) -> Result<Vec<f64>> {
        let Numbers { values, shape } = self.numbers(key, next_step)?;
        if values.len() == length {
            return Ok(values);
        }
        let problem = format!("expected {length} numbers, found {}; {next_step}", shape_text(&shape));
        Err(self.fail(key, problem))
    }

    fn numbers_of_shape(&self, key: &str, expected: &[usize], next_step: &str) -> Result<Vec<f64>> {
        let Numbers { values, shape } = self.numbers(key, next_step)?;
        if shape == expected {
            return Ok(values);
        }
        let (expected, shape) = (shape_text(expected), shape_text(&shape));
        Err(self.fail(key, format!("expected {expected} numbers, found {shape}; {next_step}")))
    }

    fn numbers(&self, key: &str, next_step: &str) -> Result<Numbers> {
        let Some(entry) = self.entry(key) else {
            return Err(self.fail(key, format!("expected this key, found none; {next_step}")));
        };
        let mut values = Vec::new();
        let shape = flatten(entry.get_ref(), &mut values)
            .map_err(|problem| self.fail(key, format!("{problem}; {next_step}")))?;
        if let Some(bad) = values.iter().find(|x| !x.is_finite()) {
            return Err(self.fail(key, format!("expected finite numbers, found {bad}; calibrate again")));
        }
        Ok(Numbers { values, shape })
    }

    fn entry(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.entries.iter().find(|(name, _)| name.get_ref().as_ref() == key).map(|(_, value)| value)
    }

    fn fail(&self, key: &str, problem: impl std::fmt::Display) -> Error {
        Error::camera(&self.name, format!("{}: {problem}", self.place(key)))
    }

    /// The place of a key for messages; the start of the table if there is no such key.
    fn place(&self, key: &str) -> String {
        let line = line_of(self.text, self.entry(key).map_or(self.start, |value| value.span().start));
        format!("line {line}, table [{}], key `{key}`", self.title)
    }
}

/// Appends the numbers of `value`, row by row, and returns its shape: `[]` for a number, `[2, 3]` for two rows of
/// three.
fn flatten(value: &DeValue, into: &mut Vec<f64>) -> std::result::Result<Vec<usize>, String> {
    let number = match value {
        DeValue::Array(array) => {
            let mut shape = None;
            for element in array.iter() {
                let inner = flatten(element.get_ref(), into)?;
                if *shape.get_or_insert_with(|| inner.clone()) != inner {
                    return Err("expected rows of equal length, found different ones".into());
                }
            }
            let mut full_shape = vec![array.iter().count()];
            full_shape.extend(shape.unwrap_or_default());
            return Ok(full_shape);
        }
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64)
        }
        _ => None,
    };

    into.push(number.ok_or_else(|| format!("expected numbers, found {}", found(value)))?);
    Ok(Vec::new())
}

fn found(value: &DeValue) -> String {
    match value {
        DeValue::Integer(integer) => format!("integer {}", integer.as_str()),
        other => format!("a value of type {}", other.type_str()),
    }
}

fn shape_text(shape: &[usize]) -> String {
    if shape.is_empty() {
        return "a single number".into();
    }
    shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ")
}

#[cfg(test)]
pub(super) mod tests;
