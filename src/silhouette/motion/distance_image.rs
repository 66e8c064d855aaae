//! Signed Euclidean distances around a silhouette's edge, up to a limit, as an image for optical flow and warping.
//!
//! The distances are those of [`SignedDistance`](super::super::SignedDistance), with two differences: they are clipped
//! to [`REACH`], which makes them cheap, and coverage moves the pixels next to the edge, so that a warped edge lies as
//! exactly as the mask's. The mean distances of cells reach farther: beyond [`REACH`] they are continued from cell to
//! cell, up to [`CELL_REACH`](super::cell_means::CELL_REACH).

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::cell_means::{CELL, average_cells};
use crate::math::lanes::{round_i32, select};
use crate::math::vectorised;
use crate::silhouette::{HALF_COVERAGE, Rect, SUBJECT, Silhouette};

/// The largest distance of a pixel, in pixels.
pub(super) const REACH: i32 = 16;

/// Distances are stored in this part of a pixel, about that of a mask's bytes.
pub(super) const UNIT: f32 = 256.0;

/// A distance along a column that is too large to matter.
const FAR: u8 = REACH as u8 + 1;

/// Its square.
const FAR_SQUARED: u16 = FAR as u16 * FAR as u16;

/// Pixels of a row that are computed at once.
const BLOCK: usize = 16;

/// Columns before and after a row, as many as distances reach, that count as far from any edge.
const PAD: usize = PAD_BLOCKS * BLOCK;

/// Blocks before and after a row.
const PAD_BLOCKS: usize = (REACH as usize).div_ceil(BLOCK);

/// Distances along a row are increased by this many columns between two tests for the end.
const STRIDE: usize = 4;

/// Distances of pixels from a silhouette's edge in pixels, negative inside, clipped to [`REACH`].
///
/// The mask counts as continued beyond the image by the pixels along its border, so that the border is no edge.
#[derive(Debug, Default)]
pub(super) struct DistanceImage {
    /// The pixels that have distances; all others lie at [`REACH`] or farther. A multiple of cells.
    pub(super) rect: Rect,
    /// The distance of each pixel of `rect`, row-major, in units of one [`UNIT`]th of a pixel.
    pub(super) values: Vec<i16>,
    /// The cells that have mean distances, as pixels; all others lie at [`CELL_REACH`](super::cell_means::CELL_REACH) or farther.
    pub(super) cell_rect: Rect,
    /// Mean distances of the cells, row-major, in pixels.
    pub(super) cells: Vec<f32>,
}

/// Intermediate results.
#[derive(Debug, Default)]
pub(super) struct DistanceScratch {
    mask: Vec<u8>,
    /// Distances along columns to the nearest subject pixel and to the nearest background pixel.
    along_columns: [Vec<u8>; 2],
    /// Squares of these for one row.
    squares: [SquaresRow; 2],
    /// Mean distances of the cells of the pixels that have distances.
    means: Vec<f32>,
    /// Absolute values of mean distances, with a cell around, and those of the next step.
    spread: [Vec<f32>; 2],
}

impl DistanceImage {
    /// Computes the distances of `silhouette`, in the memory of the last ones.
    pub(super) fn fill(&mut self, silhouette: &Silhouette, scratch: &mut DistanceScratch) {
        self.rect = whole_cells(&silhouette.rect().grown(REACH));
        self.rect.x1 = self.rect.x0 + self.rect.width().next_multiple_of(BLOCK) as i32;
        let (width, height) = (self.rect.width(), self.rect.height());
        let DistanceScratch { mask, along_columns, squares, means, spread } = scratch;

        mask.resize(width * height, 0);
        for (y, row) in (self.rect.y0..).zip(mask.chunks_exact_mut(width.max(1))) {
            write_row(silhouette, self.rect.x0, y, row);
        }

        for plane in along_columns.iter_mut() {
            plane.resize(width * height, 0);
        }
        self.values.resize(width * height, 0);
        means.resize(width * height / (CELL * CELL) as usize, 0.0);
        if width > 0 {
            let [to_subject, to_background] = along_columns;
            measure_columns(mask, width, to_subject, to_background);
            measure_rows(mask, width, to_subject, to_background, squares, &mut self.values);
            average_cells(&self.values, width, means);
        }
        self.fill_cells(means, spread);
    }
}

/// The smallest rectangle of whole cells around `rect`.
pub(super) fn whole_cells(rect: &Rect) -> Rect {
    if rect.is_empty() {
        return Rect::EMPTY;
    }
    let (down, up) = (|x: i32| x.div_euclid(CELL) * CELL, |x: i32| -((-x).div_euclid(CELL) * CELL));
    Rect { x0: down(rect.x0), y0: down(rect.y0), x1: up(rect.x1), y1: up(rect.y1) }
}

/// Writes the mask's bytes from column `x0` of row `y` on, continued beyond the image.
fn write_row(silhouette: &Silhouette, x0: i32, y: i32, row: &mut [u8]) {
    let image = silhouette.image;
    let y = y.clamp(image.y0, image.y1 - 1);
    let kept = silhouette.crop.rect().intersection(&image);
    row.fill(0);
    if kept.y0 > y || y >= kept.y1 {
        return;
    }

    let (first, end) = ((kept.x0 - x0) as usize, (kept.x1 - x0) as usize);
    silhouette.crop.write_row(kept.x0, y, &mut row[first..end]);
    if kept.x0 == image.x0 {
        let border = row[first];
        row[..first].fill(border);
    }
    if kept.x1 == image.x1 {
        let border = row[end - 1];
        row[end..].fill(border);
    }
}

vectorised! {
    /// Measures the distance of each pixel to the nearest subject pixel of its column, and to the nearest background
    /// pixel, up to [`FAR`].
    fn measure_columns(mask: &[u8], width: usize, to_subject: &mut [u8], to_background: &mut [u8]) {
        for (plane, wants_subject) in [(to_subject, true), (to_background, false)] {
            // Downwards: the distance to the nearest one above.
            for (x, &byte) in mask[..width].iter().enumerate() {
                plane[x] = select((byte >= SUBJECT) == wants_subject, 0, FAR);
            }
            for (y, row) in mask.chunks_exact(width).enumerate().skip(1) {
                let (above, own) = plane[(y - 1) * width..][..2 * width].split_at_mut(width);
                for x in 0..width {
                    let is_wanted = (row[x] >= SUBJECT) == wants_subject;
                    own[x] = select(is_wanted, 0, (above[x] + 1).min(FAR));
                }
            }

            // Upwards: the smaller of that and one more than the distance below.
            for y in (0..(plane.len() / width).saturating_sub(1)).rev() {
                let (own, below) = plane[y * width..][..2 * width].split_at_mut(width);
                for x in 0..width {
                    own[x] = own[x].min(below[x] + 1);
                }
            }
        }
    }
}

vectorised! {
    /// Computes signed distances from distances along columns: the least of the sums of squares along the row. The width
    /// is a multiple of blocks.
    fn measure_rows(
        mask: &[u8],
        width: usize,
        to_subject: &[u8],
        to_background: &[u8],
        rows: &mut [SquaresRow; 2],
        values: &mut [i16],
    ) {
        let blocks = width / BLOCK;
        for (y, values) in values.chunks_exact_mut(width).enumerate() {
            let range = y * width..(y + 1) * width;
            let mask = mask[range.clone()].as_chunks::<BLOCK>().0;
            rows[0].fill(&to_subject[range.clone()]);
            rows[1].fill(&to_background[range]);

            for (block, values) in values.as_chunks_mut::<BLOCK>().0.iter_mut().enumerate().take(blocks) {
                // Most blocks are far from any edge.
                let [outside, inside] = [&rows[0], &rows[1]];
                if outside.is_far(block) {
                    *values = [(REACH as f32 * UNIT) as i16; BLOCK];
                } else if inside.is_far(block) {
                    *values = [(-REACH as f32 * UNIT) as i16; BLOCK];
                } else {
                    write_values(&mask[block], &outside.least(block), &inside.least(block), values);
                }
            }
        }
    }
}

/// Squared distances along columns for the pixels of a row.
#[derive(Debug, Default)]
struct SquaresRow {
    /// With [`PAD`] columns before and after the row, which are far.
    squares: Vec<u16>,
    /// Whether a pixel of each block is near, with [`PAD_BLOCKS`] before and after the row.
    is_near: Vec<bool>,
}

impl SquaresRow {
    /// Fills the row.
    #[inline(always)]
    fn fill(&mut self, distances: &[u8]) {
        let blocks = distances.as_chunks::<BLOCK>().0;
        self.squares.resize(distances.len() + 2 * PAD, 0);
        self.squares[..PAD].fill(FAR_SQUARED);
        self.squares[PAD + distances.len()..].fill(FAR_SQUARED);
        self.is_near.resize(blocks.len() + 2 * PAD_BLOCKS, false);
        self.is_near[PAD_BLOCKS + blocks.len()..].fill(false);
        let squares = self.squares[PAD..].as_chunks_mut::<BLOCK>().0;
        for ((squares, distances), is_near) in
            squares.iter_mut().zip(blocks).zip(&mut self.is_near[PAD_BLOCKS..])
        {
            for k in 0..BLOCK {
                squares[k] = u16::from(distances[k]) * u16::from(distances[k]);
            }
            *is_near = distances != &[FAR; BLOCK];
        }
    }

    /// Whether all pixels of a block are far.
    #[inline(always)]
    fn is_far(&self, block: usize) -> bool {
        self.is_near[block..=block + 2 * PAD_BLOCKS].iter().all(|is_near| !is_near)
    }

    /// The least squared distances of a block's pixels, up to [`FAR_SQUARED`].
    #[inline(always)]
    fn least(&self, block: usize) -> [u16; BLOCK] {
        let mut least = [0; BLOCK];
        let Some(window) = self.squares[block * BLOCK..].first_chunk::<{ 2 * PAD + BLOCK }>() else {
            return least;
        };
        least.copy_from_slice(&window[PAD..][..BLOCK]);
        for first in (1..=REACH as usize).step_by(STRIDE) {
            if (first * first) as u16 >= largest_of(&least) {
                break;
            }
            for distance in first..first + STRIDE {
                let (left, right) = (&window[PAD - distance..][..BLOCK], &window[PAD + distance..][..BLOCK]);
                let added = (distance * distance) as u16;
                for k in 0..BLOCK {
                    least[k] = least[k].min(left[k].min(right[k]) + added);
                }
            }
        }
        least
    }
}

/// The largest of the lanes.
#[inline(always)]
fn largest_of(lanes: &[u16; BLOCK]) -> u16 {
    let mut largest = *lanes;
    let mut half = BLOCK / 2;
    while half > 0 {
        for k in 0..half {
            largest[k] = largest[k].max(largest[k + half]);
        }
        half /= 2;
    }
    largest[0]
}

/// Writes the signed distances of a block. `outside` holds the squared distances to subject, `inside` to background.
#[inline(always)]
fn write_values(
    mask: &[u8; BLOCK],
    outside: &[u16; BLOCK],
    inside: &[u16; BLOCK],
    values: &mut [i16; BLOCK],
) {
    for k in 0..BLOCK {
        let byte = i32::from(mask[k]);
        let is_subject = byte >= i32::from(SUBJECT);
        // One of the two is zero.
        let square = i32::from(inside[k].max(outside[k]));
        let distance = (square as f32).sqrt() - 0.5;
        let distance = select(distance < REACH as f32, distance, REACH as f32);
        let signed = select(is_subject, -distance, distance);

        // Next to the edge, coverage tells how far away it is. No distance is rounded to zero, which has no sign.
        let covered = (HALF_COVERAGE as f32 - byte as f32) * (1.0 / 255.0);
        let value = round_i32(select(square == 1, covered, signed) * UNIT);
        values[k] = select(is_subject, value.min(-1), value.max(1)) as i16;
    }
}
