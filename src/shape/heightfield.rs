//! Heightfields: ground given by heights on a grid.

use super::{MIN_SIZE, REACH};
use crate::{Error, Result};
use nalgebra::{UnitQuaternion, Vector3};
use std::fmt;

/// Ground with one height at each point of a grid, in a geom's own frame, in metres. The y axis points up.
///
/// The grid is centred at the origin. Samples lie row by row: columns follow x from -width / 2 to width / 2, rows
/// follow z from -depth / 2 to depth / 2. Each cell of the grid is two triangles, divided by the diagonal from the
/// sample at its greater x to the sample at its greater z.
///
/// ```text
///        y (up)
///        |        column 0       column 1
///        o-- x     row 0 A---------B
///       /                |       / |
///      z                 |   /     |
///                  row 1 C---------D
/// ```
///
/// In a world whose z axis points up, give the geom or its body the rotation [`z_up`](Self::z_up). Geoms share a
/// heightfield through an `Arc`; see [`Shape::Heightfield`](super::Shape::Heightfield).
#[derive(Clone, PartialEq)]
pub struct Heightfield {
    heights: Vec<f64>,
    counts: [usize; 2],
    size: [f64; 2],
    thickness: f64,
    wraps: bool,
}

impl Heightfield {
    /// A heightfield of these heights, row by row, with `counts` = `[columns, rows]` and `size` = `[width, depth]`
    /// along x and z.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] unless there are at least 2 columns and 2 rows, and as many heights as both require; for
    /// heights that are not finite or beyond [`REACH`]; and for a size that is not finite or beyond [`REACH`], or less
    /// than [`MIN_SIZE`] for each cell.
    pub fn new(heights: Vec<f64>, counts: [usize; 2], size: [f64; 2]) -> Result<Self> {
        let [columns, rows] = counts;
        let samples = columns.checked_mul(rows);
        // ODE counts samples in a C int.
        let most = i32::MAX as usize;
        if columns < 2 || rows < 2 || samples.is_none_or(|samples| samples > most) {
            return Err(Error::argument(format!(
                "heightfield: expected at least 2 columns and 2 rows, and at most {most} samples, found {columns} \
                 columns and {rows} rows"
            )));
        }
        if samples != Some(heights.len()) {
            return Err(Error::argument(format!(
                "heightfield: expected {columns} x {rows} samples, row by row, found {}",
                heights.len()
            )));
        }

        for ((axis, length), count) in ["width", "depth"].into_iter().zip(size).zip(counts) {
            let name = format!("{axis} of the heightfield");
            if !(MIN_SIZE..=REACH).contains(&length) {
                return Err(Error::argument(format!(
                    "{name}: expected a length from {MIN_SIZE:e} to {REACH:e} m, found {length}"
                )));
            }
            let spacing = length / (count - 1) as f64;
            if spacing < MIN_SIZE {
                return Err(Error::argument(format!(
                    "{name}: expected at least {MIN_SIZE:e} m between two samples, found {spacing} m"
                )));
            }
        }
        Self { heights, counts, size, thickness: 0.0, wraps: false }.checked()
    }

    /// Multiplies the heights by `scale`, and then adds `offset`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for heights that are then not finite or beyond [`REACH`].
    pub fn scaled(mut self, scale: f64, offset: f64) -> Result<Self> {
        for height in &mut self.heights {
            *height = *height * scale + offset;
        }
        self.checked()
    }

    /// Sets how far the ground extends below its lowest height, which is 0 m at first. A body that has fallen below the
    /// surface is pushed up again as long as it is within this thickness.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a negative thickness, NaN, and a thickness beyond [`REACH`].
    pub fn with_thickness(mut self, thickness: f64) -> Result<Self> {
        if !(0.0..=REACH).contains(&thickness) {
            return Err(Error::argument(format!(
                "thickness of the heightfield: expected a length from 0 to {REACH} m, found {thickness}"
            )));
        }
        self.thickness = thickness;
        Ok(self)
    }

    /// Repeats the field endlessly along x and z. The last column and row then stand for the first ones, so that their
    /// own heights are not used.
    pub fn wrapped(mut self) -> Self {
        self.wraps = true;
        self
    }

    /// The rotation for a world whose z axis points up: columns then follow x, rows follow -y, and heights are along z.
    /// Seen from above, the samples lie as the pixels of an image do.
    pub fn z_up() -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2)
    }

    /// The heights, row by row, after scale and offset.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The number of columns and of rows.
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// The width along x and the depth along z.
    pub fn size(&self) -> [f64; 2] {
        self.size
    }

    /// How far the ground extends below its lowest height.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Whether the field repeats endlessly.
    pub fn wraps(&self) -> bool {
        self.wraps
    }

    /// Refuses heights that are not finite or beyond [`REACH`].
    fn checked(self) -> Result<Self> {
        let columns = self.counts[0];
        match self.heights.iter().position(|height| !(-REACH..=REACH).contains(height)) {
            None => Ok(self),
            Some(index) => Err(Error::argument(format!(
                "heightfield: expected finite heights of at most {REACH} m, found {} in column {} of row {}",
                self.heights[index],
                index % columns,
                index / columns
            ))),
        }
    }
}

impl fmt::Debug for Heightfield {
    /// Without the heights, which would make messages too long to read.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Heightfield")
            .field("counts", &self.counts)
            .field("size", &self.size)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(result: Result<Heightfield>, expected: &str) {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(expected), "expected {expected:?} in {message:?}");
    }

    #[test]
    fn counts_that_do_not_fit_the_samples_are_refused() {
        let flat = |samples, counts| Heightfield::new(vec![0.0; samples], counts, [1.0, 1.0]);
        refused(flat(6, [2, 2]), "expected 2 x 2 samples, row by row, found 6");
        refused(flat(1, [1, 1]), "at least 2 columns and 2 rows");
        refused(flat(2, [2, 1]), "found 2 columns and 1 rows");
        refused(flat(0, [0, 0]), "at least 2 columns");
        refused(flat(0, [usize::MAX, 2]), "at most 2147483647 samples");
        assert!(flat(6, [2, 3]).is_ok());
    }

    #[test]
    fn sizes_out_of_range_are_refused() {
        let sized = |size| Heightfield::new(vec![0.0; 6], [3, 2], size);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 2.0 * REACH] {
            refused(sized([bad, 1.0]), "width of the heightfield: expected a length");
            refused(sized([1.0, bad]), "depth of the heightfield: expected a length");
        }
        refused(sized([1.9e-6, 1.0]), "between two samples");
        assert!(sized([REACH, 1e-6]).is_ok());
    }

    #[test]
    fn heights_and_thickness_that_are_not_finite_are_refused() {
        let with = |height| Heightfield::new(vec![0.0, 0.0, 0.0, 0.0, height, 0.0], [3, 2], [1.0, 1.0]);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1 * REACH] {
            refused(with(bad), "in column 1 of row 1");
            refused(with(1.0).unwrap().scaled(bad, 0.0), "expected finite heights");
            refused(with(1.0).unwrap().scaled(1.0, bad), "expected finite heights");
            refused(with(1.0).unwrap().with_thickness(bad), "thickness of the heightfield");
        }
        refused(with(1.0).unwrap().with_thickness(-0.1), "thickness of the heightfield");
    }

    #[test]
    fn scale_and_offset_apply_to_the_samples_in_this_order() {
        let field = Heightfield::new(vec![0.0, 1.0, 2.0, 3.0], [2, 2], [1.0, 1.0]).unwrap();
        assert_eq!(field.scaled(-2.0, 5.0).unwrap().heights(), [5.0, 3.0, 1.0, -1.0]);
    }

    #[test]
    fn the_rotation_for_z_up_turns_y_up_and_keeps_x() {
        let turn = Heightfield::z_up();
        assert!((turn * Vector3::y() - Vector3::z()).norm() < 1e-15);
        assert!((turn * Vector3::z() + Vector3::y()).norm() < 1e-15);
        assert_eq!(turn * Vector3::x(), Vector3::x());
    }
}
