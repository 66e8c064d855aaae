//! One pass over a mask: where the subject is, whether it is everywhere, and whether there is coverage.

// A loop over the lanes of several arrays says what happens to lane k, and becomes vector instructions as a whole.
#![allow(clippy::needless_range_loop)]

use super::Rect;
use crate::vectorised::vectorised;
use image::GrayImage;

/// Rows looked at together.
const STRIP: usize = 8;

/// What one pass over a mask tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scan {
    /// The smallest rectangle around the subject.
    pub(super) rect: Rect,
    /// Whether any byte is neither 0 nor 255.
    pub(super) has_coverage: bool,
    /// Whether every pixel is subject.
    pub(super) is_full: bool,
}

/// The least and the largest byte of each column, as signed numbers: 255 is -1 then, the subject is what is negative,
/// and coverage what is neither 0 nor -1.
#[derive(Debug, Default)]
pub(super) struct Columns {
    least: Vec<i8>,
    largest: Vec<i8>,
}

impl Columns {
    /// One pass over `mask`, in the memory of the last one.
    pub(super) fn scan(&mut self, mask: &GrayImage) -> Scan {
        let width = mask.width() as usize;
        for (columns, start) in [(&mut self.least, 0), (&mut self.largest, i8::MIN)] {
            columns.clear();
            columns.resize(width, start);
        }
        if width == 0 {
            return Scan { rect: Rect::EMPTY, has_coverage: false, is_full: true };
        }
        let Strips { first, last, has_coverage, is_full } =
            strips(mask.as_raw(), &mut self.least, &mut self.largest);
        let rows = |strip: usize| mask.as_raw()[STRIP * width * strip..].chunks_exact(width).take(STRIP);
        let (top, bottom) = (rows(first).position(holds_subject), rows(last).rposition(holds_subject));
        let is_subject = |least: &i8| *least < 0;
        let (left, right) = (self.least.iter().position(is_subject), self.least.iter().rposition(is_subject));
        let rect = match (left, right, top, bottom) {
            (Some(left), Some(right), Some(top), Some(bottom)) => Rect {
                x0: left as i32,
                y0: (STRIP * first + top) as i32,
                x1: right as i32 + 1,
                y1: (STRIP * last + bottom) as i32 + 1,
            },
            _ => Rect::EMPTY,
        };
        Scan { rect, has_coverage, is_full }
    }

    /// Bytes of memory behind it.
    pub(super) fn working_memory(&self) -> usize {
        self.least.capacity() + self.largest.capacity()
    }
}

/// What the strips of a mask tell.
struct Strips {
    /// The first and the last one that hold subject; zero where none does.
    first: usize,
    last: usize,
    has_coverage: bool,
    is_full: bool,
}

vectorised! {
    /// Lowers and raises the columns' extremes. Only above and below the subject it is asked where it begins and ends.
    fn strips(mask: &[u8], least: &mut [i8], largest: &mut [i8]) -> Strips {
        let mut strips = mask.chunks(STRIP * least.len()).enumerate();
        let (mut first, mut last) = (0, 0);
        for (k, strip) in strips.by_ref() {
            take(strip, least, largest);
            if holds_subject(strip) {
                (first, last) = (k, k);
                break;
            }
        }
        for (k, strip) in strips.by_ref().rev() {
            take(strip, least, largest);
            if holds_subject(strip) {
                last = k;
                break;
            }
        }
        for (_, strip) in strips {
            take(strip, least, largest);
        }
        let least = least.iter().fold(0, |least, &byte| byte.min(least));
        let largest = largest.iter().fold(i8::MIN, |largest, &byte| byte.max(largest));
        Strips { first, last, has_coverage: least < -1 || largest > 0, is_full: largest < 0 }
    }
}

/// Takes a strip of rows into the columns' extremes: many rows at a time, so that the columns are seldom read and
/// written.
#[inline(always)]
fn take(strip: &[u8], least: &mut [i8], largest: &mut [i8]) {
    let width = least.len();
    if strip.len() == STRIP * width {
        take_rows::<STRIP>(strip, least, largest);
    } else {
        for row in strip.chunks_exact(width) {
            take_rows::<1>(row, least, largest);
        }
    }
}

#[inline(always)]
fn take_rows<const N: usize>(rows: &[u8], least: &mut [i8], largest: &mut [i8]) {
    let width = least.len();
    let mut starts = [rows; N];
    for (n, row) in starts.iter_mut().enumerate() {
        *row = &rows[n * width..][..width];
    }
    let (least, largest) = (&mut least[..width], &mut largest[..width]);
    for k in 0..width {
        let (mut low, mut high) = (least[k], largest[k]);
        for row in starts {
            low = low.min(row[k] as i8);
            high = high.max(row[k] as i8);
        }
        (least[k], largest[k]) = (low, high);
    }
}

#[inline(always)]
fn holds_subject(rows: &[u8]) -> bool {
    rows.iter().fold(0, |any, byte| any | byte) >= super::SUBJECT
}
