//! The exact Euclidean distance transform (Felzenszwalb and Huttenlocher 2012), in time linear in the number of pixels.
//!
//! In each column, only the pixel of the other kind that is nearest to a row matters for that row. One pass upwards and
//! one downwards find these pixels for all columns at once. Along the row, the squared distance to such a pixel is a
//! parabola, and the squared distance to the nearest one is the lower envelope of the parabolas. The envelope is found
//! separately for each run of pixels of one kind: the pixels at its ends are of the other kind, and no pixel beyond
//! them is nearer.

use super::super::mask_crop::WORD;
use super::super::{Border, Rect, Silhouette};
use crate::math::vectorised;
use std::ops::Range;

/// Number of rows to the nearest pixel of the other kind in a column without one. It leaves room to add a number of
/// rows.
const NONE: i32 = 1 << 30;

/// A background pixel.
pub(super) const BACKGROUND: u8 = 0;

/// A subject pixel of the image.
pub(super) const SUBJECT: u8 = 1;

/// A pixel beyond an unknown border: it counts as subject, but no distance is measured to it.
const BEYOND: u8 = 2;

/// The kind of each pixel of a rectangle: [`BACKGROUND`], [`SUBJECT`] or [`BEYOND`].
pub(super) struct Kinds<'a> {
    pub(super) silhouette: &'a Silhouette,
    pub(super) domain: Rect,
}

impl Kinds<'_> {
    /// Writes the kinds of row `j` of the rectangle.
    #[inline(always)]
    pub(super) fn fill_row(&self, j: i32, row: &mut [u8]) {
        let (silhouette, image) = (self.silhouette, self.silhouette.image());
        let columns = |x0: i32, x1: i32| {
            let column = |x: i32| (x.clamp(self.domain.x0, self.domain.x1) - self.domain.x0) as usize;
            column(x0)..column(x1)
        };

        row.fill(if silhouette.border() == Border::Unknown { BEYOND } else { BACKGROUND });
        if (image.y0..image.y1).contains(&j) {
            row[columns(image.x0, image.x1)].fill(BACKGROUND);
        }

        let subject = silhouette.rect();
        if (subject.y0..subject.y1).contains(&j) {
            let pixels = row[columns(subject.x0, subject.x1)].chunks_mut(WORD);
            for (i, pixels) in (subject.x0..).step_by(WORD).zip(pixels) {
                let bits = silhouette.crop.rows_from(i, j).row(0);
                pixels.iter_mut().enumerate().for_each(|(k, kind)| *kind = (bits >> k & 1) as u8);
            }
        }
    }
}

/// Memory of a transform.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    /// The kinds of one row.
    kinds: Vec<u8>,
    /// For each column the number of rows since the pass met a subject pixel.
    since_subject: Vec<i32>,
    /// For each column the number of rows since the pass met a background pixel.
    since_background: Vec<i32>,
    /// For each pixel the number of rows to the nearest pixel of the other kind in its column: over the columns of the
    /// domain and the rows of the distances.
    rows: Vec<i32>,
    envelope: Vec<Parabola>,
}

impl Scratch {
    /// Sets the number of columns of the domain and of rows of the distances.
    fn resize(&mut self, columns: usize, rows: usize) {
        self.kinds.resize(columns, BACKGROUND);
        self.rows.clear();
        self.rows.resize(columns * rows, i32::MAX);
    }

    /// Starts a pass, which has not met any pixel yet.
    fn restart(&mut self) {
        for since in [&mut self.since_subject, &mut self.since_background] {
            since.clear();
            since.resize(self.kinds.len(), NONE);
        }
    }
}

vectorised! {
    /// Computes `values`, the distances of the pixels of `rect`, row-major.
    pub(super) fn transform(kinds: &Kinds, rect: &Rect, values: &mut [f32], scratch: &mut Scratch) {
        let domain = kinds.domain;
        let width = domain.width();
        scratch.resize(width, rect.height());
        let first = (rect.x0 - domain.x0) as usize;

        // Upwards: the nearest pixels below each row.
        scratch.restart();
        for j in (rect.y0..domain.y1).rev() {
            kinds.fill_row(j, &mut scratch.kinds);
            count_rows(scratch, row_of(rect, j, width));
        }

        // Downwards: the nearest pixels above each row, which completes it.
        scratch.restart();
        for j in domain.y0..rect.y1 {
            kinds.fill_row(j, &mut scratch.kinds);
            count_rows(scratch, row_of(rect, j, width));
            if j >= rect.y0 {
                let row = &mut values[rect.index(rect.x0, j)..][..rect.width()];
                let start = (j - rect.y0) as usize * width;
                squares(&scratch.kinds, &scratch.rows[start..start + width], &mut scratch.envelope, first, row);
                row.iter_mut().for_each(|value| *value = (value.abs().sqrt() - 0.5).copysign(*value));
            }
        }
    }
}

/// The range of row `j` in a table of `width` columns over the rows of `rect`; empty for a row outside `rect`.
#[inline(always)]
fn row_of(rect: &Rect, j: i32, width: usize) -> Range<usize> {
    if j < rect.y0 || j >= rect.y1 {
        return 0..0;
    }
    let start = (j - rect.y0) as usize * width;
    start..start + width
}

/// Advances a pass by one row, whose kinds are `scratch.kinds`. Updates the range `row` of `scratch.rows`, which is
/// empty for a row without distances.
#[inline(always)]
fn count_rows(scratch: &mut Scratch, row: Range<usize>) {
    let Scratch { kinds, since_subject, since_background, rows, .. } = scratch;
    for ((since, kind), other) in since_subject.iter_mut().zip(&*kinds).zip(&mut *since_background) {
        *since = if *kind == SUBJECT { 0 } else { *since + 1 };
        *other = if *kind == BACKGROUND { 0 } else { *other + 1 };
    }

    let sinces = since_subject.iter().zip(since_background);
    for ((nearest, kind), (subject, background)) in rows[row].iter_mut().zip(&*kinds).zip(sinces) {
        *nearest = (*nearest).min(if *kind == BACKGROUND { *subject } else { *background });
    }
}

/// The squared distance from the pixels of a row to the nearest pixel of the other kind in one column.
#[derive(Debug, Clone, Copy)]
struct Parabola {
    /// The column.
    x: i64,
    /// The squared distance in the column itself.
    least: i64,
}

impl Parabola {
    /// The squared distance from column `x` of the row.
    #[inline(always)]
    fn at(&self, x: i64) -> i64 {
        (x - self.x).pow(2) + self.least
    }

    /// Whether, at every column, the parabola `left` or the parabola `right` is no larger than `self`.
    #[inline(always)]
    fn is_hidden(&self, left: &Self, right: &Self) -> bool {
        let (a, b) = (self.x - left.x, right.x - self.x);
        (a + b) * (self.least - a * b) >= b * left.least + a * right.least
    }
}

/// Fills `row` with squared distances, negative inside. Its first pixel is pixel `first` of `kinds`. `rows` holds the
/// number of rows to the nearest pixel of the other kind in each column.
#[inline(always)]
fn squares(kinds: &[u8], rows: &[i32], envelope: &mut Vec<Parabola>, first: usize, row: &mut [f32]) {
    let mut end = 0;
    for run in kinds.chunk_by(|a, b| (*a == BACKGROUND) == (*b == BACKGROUND)) {
        let start = end;
        end += run.len();
        let (from, to) = (start.max(first), end.min(first + row.len()));
        if from >= to {
            continue;
        }

        // The pixels at both ends of the run, if they are of the other kind, and one pixel of each column between.
        envelope.clear();
        let is_other = |x: usize| kinds.get(x).is_some_and(|&kind| kind != BEYOND);
        if is_other(start.wrapping_sub(1)) {
            envelope.push(Parabola { x: start as i64 - 1, least: 0 });
        }
        for (x, &rows) in (start..).zip(&rows[start..end]) {
            if rows < NONE {
                add(envelope, Parabola { x: x as i64, least: i64::from(rows).pow(2) });
            }
        }
        if is_other(end) {
            add(envelope, Parabola { x: end as i64, least: 0 });
        }

        // The part of the run that has distances.
        let sign = if kinds[start] == BACKGROUND { 1.0 } else { -1.0 };
        write(envelope, from, sign, &mut row[from - first..to - first]);
    }
}

/// Adds the parabola `next`, which is to the right of all others, to a lower envelope.
#[inline(always)]
fn add(envelope: &mut Vec<Parabola>, next: Parabola) {
    while let [.., left, last] = envelope[..]
        && last.is_hidden(&left, &next)
    {
        envelope.pop();
    }
    envelope.push(next);
}

/// Writes the envelope's values times `sign` from column `from` on; infinite values if it has no parabola.
#[inline(always)]
fn write(envelope: &[Parabola], from: usize, sign: f32, row: &mut [f32]) {
    let Some((&(mut least), mut right)) = envelope.split_first() else {
        return row.fill(sign * f32::INFINITY);
    };
    for (x, value) in (from as i64..).zip(row) {
        while let Some((next, rest)) = right.split_first()
            && next.at(x) <= least.at(x)
        {
            (least, right) = (*next, rest);
        }
        *value = sign * least.at(x) as f32;
    }
}
