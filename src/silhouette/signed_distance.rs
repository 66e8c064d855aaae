//! How far pixels lie from a silhouette's edge, on both of its sides.
//!
//! ```text
//!      .     .     .     #     #     #     .          . background, # subject
//!     2.5   1.5   0.5  -0.5  -1.5  -0.5   0.5         the edge lies half-way between two centres
//! ```
//!
//! The transform is exact and takes time linear in the pixels. Of each column only the pixel of the other kind nearest
//! to a row counts there; one pass upwards and one downwards find it in all columns at once. Along the row each of these
//! pixels is a parabola, and the lower envelope of all of them is the squared distance (Felzenszwalb and Huttenlocher
//! 2012). It is found for each run of one kind by itself: the pixels at its ends are of the other kind, and nothing
//! beyond them is nearer.

use super::mask_crop::WORD;
use super::{Border, Rect, Silhouette};
use crate::math::vectorised;
use std::ops::Range;

/// Rows to the nearest pixel of the other kind where a column has none. Rows can be added to it.
const NONE: i32 = 1 << 30;

/// Euclidean distances of pixels from a silhouette's edge, in pixels: negative inside, positive outside, never 0.
///
/// Of a background pixel it is the distance from its centre to the nearest centre of a subject pixel, less half a pixel;
/// of a subject pixel, negative, that to the nearest background pixel likewise. So the pixels on both sides of an edge
/// have -0.5 and 0.5. Coverage makes no difference except by which pixels are subject.
///
/// The nearest pixel may lie outside the rectangle that is measured. With [`Border::Background`] it may be background
/// beyond the image. With [`Border::Unknown`] the image's border is no edge: pixels beyond it count as subject, but are
/// the nearest subject of no pixel.
///
/// Where there is no pixel of the other kind, the distance is [`f32::INFINITY`] for background (an empty mask) and
/// [`f32::NEG_INFINITY`] for subject (a full mask with an open border).
///
/// ```
/// use image::{GrayImage, Luma};
/// use ode_visual_hull::silhouette::{Border, Silhouette};
///
/// // The left half of the image is subject.
/// let mask = GrayImage::from_fn(8, 8, |i, _| Luma([if i < 4 { 255 } else { 0 }]));
/// let silhouette = Silhouette::new(&mask, Border::Unknown);
/// let distance = silhouette.signed_distance(&silhouette.image());
/// assert_eq!((distance.at(0, 3), distance.at(3, 3), distance.at(4, 3), distance.at(6, 3)), (-3.5, -0.5, 0.5, 2.5));
/// assert_eq!(distance.sample(4.0, 3.5), 0.0, "the edge lies between the pixels");
/// ```
#[derive(Debug, Clone)]
pub struct SignedDistance {
    rect: Rect,
    /// Row-major over `rect`.
    values: Vec<f32>,
    scratch: Scratch,
}

impl Silhouette {
    /// Distances of the pixels of `rect` from the silhouette's edge, negative inside. `rect` may reach beyond the image.
    pub fn signed_distance(&self, rect: &Rect) -> SignedDistance {
        let mut distance = SignedDistance::default();
        distance.refill(self, rect);
        distance
    }
}

impl Default for SignedDistance {
    /// Distances of no pixels.
    fn default() -> Self {
        Self { rect: Rect::EMPTY, values: Vec::new(), scratch: Scratch::default() }
    }
}

impl SignedDistance {
    /// Measures the pixels of `rect` from the edge of `silhouette`, in the memory of the last distances.
    pub fn refill(&mut self, silhouette: &Silhouette, rect: &Rect) {
        self.rect = if rect.is_empty() { Rect::EMPTY } else { *rect };
        self.values.clear();
        self.values.resize(self.rect.width() * self.rect.height(), 0.0);
        if !self.rect.is_empty() {
            let kinds = Kinds { silhouette, domain: domain(silhouette, rect) };
            transform(&kinds, &self.rect, &mut self.values, &mut self.scratch);
        }
    }

    /// The pixels that have a distance.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// The distances in pixels, row-major over [`Self::rect`].
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The distance of pixel `(i, j)` in pixels; outside the rectangle that of its nearest pixel. Infinite where the
    /// rectangle is empty.
    pub fn at(&self, i: i32, j: i32) -> f32 {
        let (i, j) = (i.min(self.rect.x1 - 1).max(self.rect.x0), j.min(self.rect.y1 - 1).max(self.rect.y0));
        self.values.get(self.rect.index(i, j)).copied().unwrap_or(f32::INFINITY)
    }

    /// The distance at image position `(u, v)` in pixels, bilinear between pixel centres; outside the rectangle's
    /// outermost centres that of the nearest position between them.
    pub fn sample(&self, u: f64, v: f64) -> f64 {
        let clamp = |x: f64, first: i32, end: i32| (x - 0.5).min(f64::from(end) - 1.0).max(f64::from(first));
        let (u, v) = (clamp(u, self.rect.x0, self.rect.x1), clamp(v, self.rect.y0, self.rect.y1));
        let (i, j) = (u.floor(), v.floor());
        let at = |di: i32, dj: i32| f64::from(self.at(i as i32 + di, j as i32 + dj));
        let upper = mix(at(0, 0), at(1, 0), u - i);
        let lower = mix(at(0, 1), at(1, 1), u - i);
        mix(upper, lower, v - j)
    }
}

/// The value between `from` and `to` at the fraction `t` of the way, also where values are infinite.
fn mix(from: f64, to: f64, t: f64) -> f64 {
    if t == 0.0 || from == to { from } else { from * (1.0 - t) + to * t }
}

/// The pixels among which the nearest of the other kind is found for each pixel of `rect`.
fn domain(silhouette: &Silhouette, rect: &Rect) -> Rect {
    // No pixel outside needs to be looked at: the closest pixel inside is of the same kind, since all around the subject
    // is background, and it is nearer.
    let edge = match silhouette.border() {
        _ if silhouette.rect().is_empty() => silhouette.image(),
        Border::Background => silhouette.rect().grown(1),
        Border::Unknown => silhouette.rect().grown(1).intersection(&silhouette.image()),
    };
    if edge.is_empty() { *rect } else { rect.union(&edge) }
}

/// A pixel that belongs to the background.
const BACKGROUND: u8 = 0;

/// A subject pixel of the image.
const SUBJECT: u8 = 1;

/// A pixel beyond an open border: it counts as subject, but no distance ends there.
const BEYOND: u8 = 2;

/// What each pixel of a rectangle is: background, subject, or beyond an open border.
struct Kinds<'a> {
    silhouette: &'a Silhouette,
    domain: Rect,
}

impl Kinds<'_> {
    /// The kinds of row `j`.
    #[inline(always)]
    fn fill_row(&self, j: i32, row: &mut [u8]) {
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
struct Scratch {
    /// The kinds of one row.
    kinds: Vec<u8>,
    /// Of each column, rows since a pass came to a subject pixel and since it came to a background pixel.
    since_subject: Vec<i32>,
    since_background: Vec<i32>,
    /// Of each pixel of the rows of the distances, rows to the nearest pixel of the other kind in its column.
    rows: Vec<i32>,
    envelope: Vec<Parabola>,
}

impl Scratch {
    /// Makes room for so many columns, and for the distances of so many rows.
    fn resize(&mut self, columns: usize, rows: usize) {
        self.kinds.resize(columns, BACKGROUND);
        self.rows.clear();
        self.rows.resize(columns * rows, i32::MAX);
    }

    /// Starts a pass: no column has come to a pixel yet.
    fn restart(&mut self) {
        for since in [&mut self.since_subject, &mut self.since_background] {
            since.clear();
            since.resize(self.kinds.len(), NONE);
        }
    }
}

vectorised! {
    /// Fills `values`, the distances of the pixels of `rect`.
    fn transform(kinds: &Kinds, rect: &Rect, values: &mut [f32], scratch: &mut Scratch) {
        let domain = kinds.domain;
        let width = domain.width();
        scratch.resize(width, rect.height());
        let first = (rect.x0 - domain.x0) as usize;

        scratch.restart();
        for j in (rect.y0..domain.y1).rev() {
            kinds.fill_row(j, &mut scratch.kinds);
            count_rows(scratch, row_of(rect, j, width));
        }

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

/// Where row `j` lies in a table of so many columns over the rows of `rect`; empty outside.
#[inline(always)]
fn row_of(rect: &Rect, j: i32, width: usize) -> Range<usize> {
    if j < rect.y0 || j >= rect.y1 {
        return 0..0;
    }
    let start = (j - rect.y0) as usize * width;
    start..start + width
}

/// Goes on to the row whose pixels are `scratch.kinds`, and enters the pixels passed so far into `row` of
/// `scratch.rows`, which may be empty.
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

/// The squared distance along a row from the pixel of the other kind that is nearest in column `x`.
#[derive(Debug, Clone, Copy)]
struct Parabola {
    x: i64,
    least: i64,
}

impl Parabola {
    #[inline(always)]
    fn at(&self, x: i64) -> i64 {
        (x - self.x).pow(2) + self.least
    }

    /// Whether `self` is nowhere less than one on its left and one on its right.
    #[inline(always)]
    fn is_hidden(&self, left: &Self, right: &Self) -> bool {
        let (a, b) = (self.x - left.x, right.x - self.x);
        (a + b) * (self.least - a * b) >= b * left.least + a * right.least
    }
}

/// Fills `row` with squared distances, negative inside; its first pixel is pixel `first` of `kinds`, and `rows` tells how
/// far the nearest pixel of the other kind lies in each column.
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

        let sign = if kinds[start] == BACKGROUND { 1.0 } else { -1.0 };
        write(envelope, from, sign, &mut row[from - first..to - first]);
    }
}

/// Adds the parabola `next`, on the right of all others, to a lower envelope.
#[inline(always)]
fn add(envelope: &mut Vec<Parabola>, next: Parabola) {
    while let [.., left, last] = envelope[..]
        && last.is_hidden(&left, &next)
    {
        envelope.pop();
    }
    envelope.push(next);
}

/// The envelope's values with a sign from column `from` on; infinite where it has no parabola.
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

#[cfg(test)]
mod tests;
