//! The values of a calibration as numbers, matrices, rotations, lenses and sizes.

use super::super::format::{LensModel, RawLens, pixels};
use super::super::pose;
use super::{Node, Value};
use crate::{Error, Result};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::borrow::Cow;
use std::fmt::Display;

/// Longer Rodrigues vectors are not in radians: solvers stay within a turn or two.
const LONGEST_TURN: f64 = 4.0 * std::f64::consts::PI;

/// How far the last row of a 4x4 motion may be from 0 0 0 1, for rounding in products of motions.
const LAST_ROW_TOLERANCE: f64 = 1e-9;

/// A key with its value.
#[derive(Debug, Clone)]
pub(in crate::rig) struct Entry<'a> {
    /// The path from the map in which the search began: `K`, or `cameras[2].K`.
    pub(in crate::rig) key: Cow<'a, str>,
    pub(in crate::rig) node: &'a Node,
}

/// The numbers of a matrix, row by row, or of a list, which is a column.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::rig) struct Numbers {
    pub(in crate::rig) values: Vec<f64>,
    pub(in crate::rig) rows: usize,
    pub(in crate::rig) columns: usize,
}

impl<'a> Entry<'a> {
    /// An error about this value that names its line.
    pub(in crate::rig) fn fail(&self, problem: impl Display) -> Error {
        self.fail_at(self.node, problem)
    }

    /// The place of this value for messages, such as `line 5, \`K\``.
    pub(in crate::rig) fn place(&self) -> String {
        format!("line {}, `{}`", self.node.line, self.key)
    }

    /// The entry called `key` of this map; `None` for other values.
    pub(in crate::rig) fn entry(&self, key: &str) -> Option<Self> {
        let inner = self.node.entry(key)?;
        Some(Self { key: format!("{}.{key}", self.key).into(), ..inner })
    }

    /// The entry called `key`; else an error that lists the existing keys and ends in `next_step`.
    pub(in crate::rig) fn require(&self, key: &str, next_step: &str) -> Result<Self> {
        self.entry(key).ok_or_else(|| self.fail(self.node.missing(key, next_step)))
    }

    /// The items of this list.
    pub(in crate::rig) fn items(&self) -> Result<Vec<Self>> {
        let Value::Sequence(items) = &self.node.value else {
            return Err(self.fail(format!("expected a list, found {}; write one", self.node.outline())));
        };
        let item = |(i, node)| Self { key: format!("{}[{i}]", self.key).into(), node };
        Ok(items.iter().enumerate().map(item).collect())
    }

    pub(in crate::rig) fn text(&self) -> Result<&'a str> {
        match &self.node.value {
            Value::Scalar(text) if !text.is_empty() => Ok(text),
            _ => Err(self.fail(format!("expected a word, found {}; write one", self.node.outline()))),
        }
    }

    pub(in crate::rig) fn is_true(&self) -> bool {
        matches!(&self.node.value, Value::Scalar(text) if text.eq_ignore_ascii_case("true"))
    }

    /// A single finite number.
    pub(in crate::rig) fn number(&self) -> Result<f64> {
        let found = self.numbers()?;
        match found.values[..] {
            [number] => Ok(number),
            _ => Err(self.fail(format!("expected a single number, found {found}; write one"))),
        }
    }

    /// The finite numbers of an OpenCV matrix (`rows`, `cols`, `dt`, `data`), of a list, or of a list of rows.
    pub(in crate::rig) fn numbers(&self) -> Result<Numbers> {
        let numbers = match &self.node.value {
            Value::Map(_) => self.opencv_matrix()?,
            Value::Sequence(items) if items.iter().any(|item| matches!(item.value, Value::Sequence(_))) => {
                self.rows(items)?
            }
            Value::Sequence(items) => {
                let values = items.iter().map(|item| self.number_at(item)).collect::<Result<Vec<_>>>()?;
                Numbers { rows: values.len(), columns: 1, values }
            }
            Value::Scalar(_) => Numbers { values: vec![self.number_at(self.node)?], rows: 1, columns: 1 },
        };

        match numbers.values.iter().find(|x| !x.is_finite()) {
            Some(bad) => Err(self.fail(format!("expected finite numbers, found {bad}; calibrate again"))),
            None => Ok(numbers),
        }
    }

    /// A matrix of the given shape, row by row, or a list of as many numbers.
    pub(in crate::rig) fn matrix(&self, rows: usize, columns: usize) -> Result<Vec<f64>> {
        let found = self.numbers()?;
        let list = found.columns == 1 && found.rows == rows * columns;
        if (found.rows, found.columns) == (rows, columns) || list {
            return Ok(found.values);
        }
        Err(self.fail(format!("expected {rows} x {columns} numbers, found {found}; calibrate again")))
    }

    pub(in crate::rig) fn matrix3(&self) -> Result<Matrix3<f64>> {
        Ok(Matrix3::from_row_slice(&self.matrix(3, 3)?))
    }

    /// Exactly `N` numbers, in a row or a column.
    pub(in crate::rig) fn array<const N: usize>(&self) -> Result<[f64; N]> {
        let found = self.numbers()?;
        <[f64; N]>::try_from(found.values.as_slice())
            .map_err(|_| self.fail(format!("expected {N} numbers, found {found}; calibrate again")))
    }

    /// Three numbers, in a row or a column.
    pub(in crate::rig) fn vector3(&self) -> Result<Vector3<f64>> {
        Ok(self.array::<3>()?.into())
    }

    /// A rotation, as a 3x3 matrix or as a Rodrigues vector in radians.
    pub(in crate::rig) fn rotation(&self) -> Result<UnitQuaternion<f64>> {
        let found = self.numbers()?;
        if found.values.len() != 3 {
            return self.rotation_matrix(&self.matrix3()?);
        }
        let vector = Vector3::from_column_slice(&found.values);
        if vector.norm() > LONGEST_TURN {
            let problem = "expected a Rodrigues vector in radians, found one of length";
            return Err(self.fail(format!("{problem} {:.1}; convert it from degrees", vector.norm())));
        }
        Ok(UnitQuaternion::from_scaled_axis(vector))
    }

    /// A rotation and a translation from a 4x4 matrix or its upper three rows.
    pub(in crate::rig) fn motion(&self) -> Result<(UnitQuaternion<f64>, Vector3<f64>)> {
        let found = self.numbers()?;
        let m = &found.values;
        if found.columns != 4 || !matches!(found.rows, 3 | 4) {
            return Err(self.fail(format!("expected 3 x 4 or 4 x 4 numbers, found {found}; calibrate again")));
        }

        let off = |(x, expected): (&f64, f64)| (x - expected).abs() > LAST_ROW_TOLERANCE;
        if m[12..].iter().zip([0.0, 0.0, 0.0, 1.0]).any(off) {
            return Err(
                self.fail(format!("expected the last row 0 0 0 1, found {:?}; transpose it", &m[12..]))
            );
        }

        let matrix = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
        Ok((self.rotation_matrix(&matrix)?, Vector3::new(m[3], m[7], m[11])))
    }

    /// The lens of this model, with this list as its coefficients in OpenCV's order.
    pub(in crate::rig) fn lens(&self, model: LensModel) -> Result<RawLens> {
        let coefficients = self.numbers()?.values;
        RawLens::new(model, &coefficients, self.place())
            .map_err(|e| self.fail(format!("{e}; calibrate again")))
    }

    /// A whole number of pixels, as the side of an image.
    pub(in crate::rig) fn pixels(&self) -> Result<u32> {
        let found = self.number()?;
        pixels(found).ok_or_else(|| {
            self.fail(format!("expected a whole number from 1 to 65535, found {found}; give pixels"))
        })
    }

    /// Width and height, in pixels.
    pub(in crate::rig) fn size(&self) -> Result<(u32, u32)> {
        let Numbers { values, .. } = self.numbers()?;
        match values.iter().copied().map(pixels).collect::<Option<Vec<_>>>().as_deref() {
            Some(&[width, height]) => Ok((width, height)),
            _ => Err(self.fail(format!(
                "expected width and height, whole numbers from 1 to 65535, found {values:?}; give pixels"
            ))),
        }
    }

    fn rotation_matrix(&self, matrix: &Matrix3<f64>) -> Result<UnitQuaternion<f64>> {
        pose::rotation(matrix).map_err(|problem| self.fail(problem))
    }

    fn number_at(&self, node: &Node) -> Result<f64> {
        let number = match &node.value {
            Value::Scalar(text) => number(text),
            _ => None,
        };
        number.ok_or_else(|| {
            self.fail_at(node, format!("expected a number, found {}; check the file", node.outline()))
        })
    }

    /// The numbers of a list of rows of equal length.
    fn rows(&self, items: &[Node]) -> Result<Numbers> {
        let mut numbers = Numbers { values: Vec::new(), rows: items.len(), columns: 0 };
        for (i, item) in items.iter().enumerate() {
            let row = match &item.value {
                Value::Sequence(row) => row.as_slice(),
                _ => std::slice::from_ref(item),
            };
            if i > 0 && row.len() != numbers.columns {
                let (expected, found) = (numbers.columns, row.len());
                let problem = format!(
                    "expected rows of {expected} numbers like the first, found {found}; calibrate again"
                );
                return Err(self.fail_at(item, problem));
            }

            numbers.columns = row.len();
            for value in row {
                numbers.values.push(self.number_at(value)?);
            }
        }
        Ok(numbers)
    }

    fn opencv_matrix(&self) -> Result<Numbers> {
        let step = "write rows, cols, dt and data";
        let part = |key| {
            self.entry(key).ok_or_else(|| {
                self.fail(format!("expected a matrix with `{key}`, found {}; {step}", self.node.outline()))
            })
        };
        let count = |key| -> Result<usize> {
            let entry = part(key)?;
            let number = entry.number_at(entry.node)?;
            let whole = number.fract() == 0.0 && (0.0..1e6).contains(&number);
            whole
                .then_some(number as usize)
                .ok_or_else(|| entry.fail(format!("expected a count, found {number}; {step}")))
        };

        let (rows, columns) = (count("rows")?, count("cols")?);
        let data = part("data")?;
        let values = match &data.node.value {
            Value::Sequence(items) => {
                items.iter().map(|item| data.number_at(item)).collect::<Result<Vec<_>>>()?
            }
            Value::Scalar(text) if text.is_empty() => Vec::new(),
            _ => vec![data.number_at(data.node)?],
        };

        let columns = columns * self.channels();
        // A product that overflows matches no number of values either.
        if rows.checked_mul(columns) != Some(values.len()) {
            return Err(self.fail(format!(
                "expected {rows} x {columns} numbers as rows and cols say, found {} in data; the file may be cut off",
                values.len()
            )));
        }

        Ok(Numbers { values, rows, columns })
    }

    /// An error about a part of this value that names the part's line.
    fn fail_at(&self, node: &Node, problem: impl Display) -> Error {
        Error::argument(format!("line {}, `{}`: {problem}", node.line, self.key))
    }

    /// Numbers per element: `dt: "3d"` holds three.
    fn channels(&self) -> usize {
        let Some(Value::Scalar(dt)) = self.node.entry("dt").map(|dt| &dt.node.value) else { return 1 };
        let digits: String = dt.chars().take_while(char::is_ascii_digit).collect();
        digits.parse().unwrap_or(1).min(1024)
    }
}

/// Parses a number in YAML's or JSON's notation, including NaN and infinities.
fn number(text: &str) -> Option<f64> {
    let lower = text.to_ascii_lowercase();
    match lower.trim_start_matches(['+', '-']) {
        ".nan" => Some(f64::NAN),
        ".inf" => Some(if lower.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY }),
        _ => lower.parse().ok(),
    }
}

impl Display for Numbers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.rows, self.columns) {
            (1, 1) => write!(f, "a single number"),
            (rows, 1) => write!(f, "{rows}"),
            (rows, columns) => write!(f, "{rows} x {columns}"),
        }
    }
}
