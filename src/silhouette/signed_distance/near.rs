//! The distances near the edge alone: a distance transform whose every step is a vector instruction.
//!
//! In each column, the number of rows to the nearest pixel of each kind is counted upwards and downwards, up to the reach.
//! Along the row, the squared distance to the nearest pixel is the least of `dx² + rows²` over the columns within the reach.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::transform::{BACKGROUND, Kinds, SUBJECT};
use crate::math::vectorised;
use crate::silhouette::Rect;

/// Columns to either side, and rows above and below, in which the nearest pixel is looked for.
const REACH: usize = 24;

/// The distance that all have which are longer. Half a pixel less than the shortest distance that may be missed, since the edge
/// lies half-way between two pixels.
pub(super) const LONGEST: f32 = REACH as f32;

/// Columns within reach that are looked at together: a divisor of their number.
const AT_ONCE: usize = 7;

/// A number of rows beyond the reach.
const FAR: u8 = REACH as u8 + 1;

/// The numbers of rows from the pixels of a row to the nearest pixel of each kind, or [`FAR`].
#[derive(Debug, Clone, Default)]
struct RowsTo {
    subject: Vec<u8>,
    background: Vec<u8>,
}

/// Memory of the transform.
#[derive(Debug, Clone, Default)]
pub(super) struct NearScratch {
    kinds: Vec<u8>,
    /// Of the pass in its current row.
    since: RowsTo,
    /// Of all rows, from below.
    below: RowsTo,
    /// The squares of the numbers of rows, with columns beyond both ends.
    squares: [Vec<i16>; 2],
    /// The least squared distances of the pixels of a row.
    least: [Vec<i16>; 2],
}

impl RowsTo {
    fn reset(&mut self, count: usize) {
        for rows in [&mut self.subject, &mut self.background] {
            rows.clear();
            rows.resize(count, FAR);
        }
    }

    /// Goes on by one row, whose pixels are of these kinds.
    #[inline(always)]
    fn advance(&mut self, kinds: &[u8]) {
        for (rows, kind) in self.subject.iter_mut().zip(kinds) {
            *rows = if *kind == SUBJECT { 0 } else { (*rows + 1).min(FAR) };
        }
        for (rows, kind) in self.background.iter_mut().zip(kinds) {
            *rows = if *kind == BACKGROUND { 0 } else { (*rows + 1).min(FAR) };
        }
    }
}

vectorised! {
    /// Computes `values`, the distances of the pixels of `rect`, row-major.
    pub(super) fn transform(kinds: &Kinds, rect: &Rect, values: &mut [f32], scratch: &mut NearScratch) {
        let NearScratch { kinds: row, since, below, squares, least } = scratch;
        let width = kinds.domain.width();
        let reach = REACH as i32;
        row.resize(width, BACKGROUND);
        below.reset(width * rect.height());

        // Upwards: the nearest pixels below each row.
        since.reset(width);
        for j in (rect.y0..kinds.domain.y1.min(rect.y1 + reach)).rev() {
            kinds.fill_row(j, row);
            since.advance(row);
            if j < rect.y1 {
                let start = (j - rect.y0) as usize * width;
                below.subject[start..start + width].copy_from_slice(&since.subject);
                below.background[start..start + width].copy_from_slice(&since.background);
            }
        }

        // Downwards: the nearest pixels above each row, which completes it.
        since.reset(width);
        for j in kinds.domain.y0.max(rect.y0 - reach)..rect.y1 {
            kinds.fill_row(j, row);
            since.advance(row);
            if j >= rect.y0 {
                let start = (j - rect.y0) as usize * width;
                let at = start..start + width;
                square(&since.subject, &below.subject[at.clone()], &mut squares[0]);
                square(&since.background, &below.background[at], &mut squares[1]);
                let first = (rect.x0 - kinds.domain.x0) as usize;
                let values = &mut values[rect.index(rect.x0, j)..][..rect.width()];
                distances(&row[first..], [&squares[0][first..], &squares[1][first..]], least, values);
            }
        }
    }
}

/// Writes the squares of the lesser ones of two numbers of rows, and those of [`FAR`] beyond both ends.
#[inline(always)]
fn square(above: &[u8], below: &[u8], squares: &mut Vec<i16>) {
    squares.clear();
    squares.resize(above.len() + 2 * REACH, i16::from(FAR) * i16::from(FAR));
    let squares = &mut squares[REACH..][..above.len()];
    for k in 0..squares.len() {
        let rows = i16::from(above[k].min(below[k]));
        squares[k] = rows * rows;
    }
}

/// Writes the distances of a row's pixels, which are of these kinds; the squares begin [`REACH`] columns before them.
#[inline(always)]
fn distances(kinds: &[u8], squares: [&[i16]; 2], least: &mut [Vec<i16>; 2], values: &mut [f32]) {
    for (least, squares) in least.iter_mut().zip(squares) {
        least.clear();
        least.resize(values.len(), i16::MAX);
        for first in (0..=2 * REACH).step_by(AT_ONCE) {
            lessen(least, &squares[first..], first);
        }
    }

    let count = values.len();
    let (kinds, to_subject, to_background) = (&kinds[..count], &least[0][..count], &least[1][..count]);
    for k in 0..count {
        // Masks in place of branches become vector instructions.
        let is_background = -i16::from(kinds[k] == BACKGROUND);
        let square = to_subject[k] & is_background | to_background[k] & !is_background;
        let distance = (f32::from(square).sqrt() - 0.5).min(LONGEST);
        values[k] = distance * f32::from(1 | !is_background);
    }
}

/// Lessens squared distances to those by way of [`AT_ONCE`] columns, of which the first is column `first` of those in reach.
#[inline(always)]
fn lessen(least: &mut [i16], squares: &[i16], first: usize) {
    let count = least.len();
    let (mut columns, mut across) = ([squares; AT_ONCE], [0; AT_ONCE]);
    for column in 0..AT_ONCE {
        columns[column] = &squares[column..][..count];
        across[column] = ((first + column) as i16 - REACH as i16).pow(2);
    }
    for k in 0..count {
        let mut least_here = least[k];
        for column in 0..AT_ONCE {
            least_here = least_here.min(columns[column][k] + across[column]);
        }
        least[k] = least_here;
    }
}
