//! Warping of distance images along a flow into a mask.
//!
//! Most of a mask is decided by cells: where both images are farther from their edges than the flow is long, a cell is
//! background or subject at all times between the two masks. Of the other cells, those whose warped mean distance is
//! larger than any of their pixels can lie from it are decided as a whole. Only the pixels of the rest, a few on both
//! sides of the edge, are warped one by one.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::cell_means::CELL;
use super::distance_image::whole_cells;
use super::flow::FlowView;
use super::mix::{Mix, Term};
use super::sampling::PIXELS;
use crate::math::lanes::{round_i32, select};
use crate::math::vectorised;
use crate::silhouette::bit_image::{BitImage, WORD};
use crate::silhouette::{PackedMask, Rect};

/// No distance of a cell's pixels differs by more from the interpolated mean distance at the cell's centre, in pixels:
/// a pixel is at most 2.1 px from the centre, and the mean is over pixels up to 6 px away, most of them much nearer.
pub(super) const SPREAD: f32 = 3.6;

/// Pixels from the centre of a cell's first pixel to the cell's centre, along either axis.
const TO_CENTRE: f32 = 0.5 * CELL as f32 - 0.5;

/// The change of the flow per pixel from which on a cell's pixels are read one by one: below it they lie less than a pixel
/// from a straight block, over which distances change as along their gradient.
const MOST_BENT: f32 = 0.25;

/// A cell whose pixels have to be warped one by one.
#[derive(Debug, Clone, Copy)]
struct EdgeCell {
    /// The column of its first pixel.
    x: i32,
    /// The flow at the cell's centre, and its change per pixel to the right and down.
    flow: [f32; 2],
    slope: [[f32; 2]; 2],
}

/// A cell that the edge crosses.
#[derive(Debug, Clone, Copy)]
struct MixedCell {
    /// The column of its first pixel.
    x: usize,
    /// The bytes of its pixels, row by row.
    bytes: [[u8; CELL as usize]; CELL as usize],
}

/// What is known of a cell; as wide as a distance, so that a row is decided in a few vector instructions.
type CellState = u32;

/// The cell has to be warped.
const UNKNOWN: CellState = 0;

/// All of its pixels are background.
const BACKGROUND: CellState = 1;

/// All of its pixels are subject.
const INSIDE: CellState = 2;

/// Cells that are warped at once.
const LANES: usize = 16;

/// Memory for warping.
#[derive(Debug, Default)]
pub(crate) struct WarpScratch {
    /// Added to [`SPREAD`]: a test decides all pixels one by one.
    #[cfg(test)]
    pub(super) more_spread: f32,
    /// What is known of a row's cells without a warp.
    states: Vec<CellState>,
    /// The weighted sums of its cells' distances.
    sums: Vec<f32>,
    /// Indices of its unknown cells.
    unknown: Vec<u32>,
    edge_cells: Vec<EdgeCell>,
    /// Those of them that are neither background nor subject as a whole.
    mixed: Vec<MixedCell>,
}

impl WarpScratch {
    /// The mean distance up to which a cell is decided pixel by pixel.
    #[inline(always)]
    fn spread(&self) -> f32 {
        #[cfg(test)]
        return SPREAD + self.more_spread;
        #[cfg(not(test))]
        SPREAD
    }
}

/// Writes the mask of the weighted sum of `terms` to the pixels of `rect`, which is a multiple of cells; all others are
/// background.
pub(super) fn warp(
    terms: &[Term],
    mix: Mix,
    flow: &FlowView,
    rect: &Rect,
    size: (u32, u32),
    mask: &mut PackedMask,
    scratch: &mut WarpScratch,
) {
    mask.restart(size);
    let rect = rect.intersection(&whole_cells(&Rect::of_image(size.0, size.1)));
    if !rect.is_empty() {
        match *terms {
            [one] => warp_one(&[one], mix, flow, &rect, mask, scratch),
            [one, other] => warp_two(&[one, other], mix, flow, &rect, mask, scratch),
            _ => unreachable!("one or two images are warped"),
        }
    }
    mask.close_mask();
}

vectorised! {
    /// [`warp_rows`] of one image.
    fn warp_one(terms: &[Term; 1], mix: Mix, flow: &FlowView, rect: &Rect, mask: &mut PackedMask, scratch: &mut WarpScratch) {
        warp_rows(terms, mix, flow, rect, mask, scratch);
    }
}

vectorised! {
    /// [`warp_rows`] of two images.
    fn warp_two(terms: &[Term; 2], mix: Mix, flow: &FlowView, rect: &Rect, mask: &mut PackedMask, scratch: &mut WarpScratch) {
        warp_rows(terms, mix, flow, rect, mask, scratch);
    }
}

/// Warps row by row of cells.
#[inline(always)]
fn warp_rows<const N: usize>(
    terms: &[Term; N],
    mix: Mix,
    flow: &FlowView,
    rect: &Rect,
    mask: &mut PackedMask,
    scratch: &mut WarpScratch,
) {
    for y in (rect.y0..rect.y1).step_by(CELL as usize) {
        foretell_cells(terms, mix, flow, rect, y, scratch);
        decide_unknown_cells(terms, mix, flow, rect, y, scratch);

        let WarpScratch { states, edge_cells, mixed, .. } = scratch;
        mixed.clear();
        for cell in edge_cells.iter() {
            let bytes = warp_pixels(terms, mix, cell, y);
            if bytes == [[u8::MAX; CELL as usize]; CELL as usize] {
                states[(cell.x - rect.x0) as usize / CELL as usize] = INSIDE;
            } else if bytes != [[0; CELL as usize]; CELL as usize] {
                mixed.push(MixedCell { x: cell.x as usize, bytes });
            }
        }
        write_cells(rect, y, states, mask.subject_mut());
        write_pixels(mixed, y, mask);
    }
}

/// Finds the cells of a row of `rect` that are so far from the edges of all images that the flow cannot bring an edge to
/// them.
#[inline(always)]
fn foretell_cells<const N: usize>(
    terms: &[Term; N],
    mix: Mix,
    flow: &FlowView,
    rect: &Rect,
    y: i32,
    scratch: &mut WarpScratch,
) {
    let spread = scratch.spread();
    let WarpScratch { states, sums, unknown, .. } = scratch;
    let columns = rect.width() / CELL as usize;
    states.clear();
    states.resize(columns, UNKNOWN);
    unknown.clear();
    let origin = flow.rect();
    let (left, right) = (rect.x0.max(origin.x0), rect.x1.min(origin.x1));
    if let Some(row) = flow.row((y - origin.y0).div_euclid(CELL))
        && left < right
    {
        let first = (left - origin.x0) as usize / CELL as usize;
        let count = (right - left) as usize / CELL as usize;
        let states = &mut states[(left - rect.x0) as usize / CELL as usize..][..count];
        // Along a vector of length f, the distance of a cell changes by at most f times this.
        let change = match mix {
            Mix::Sum => terms.iter().map(|term| term.weight * term.along_flow.abs()).sum(),
            Mix::Agreement => 1.0,
        };
        sums.clear();
        sums.resize(count, 0.0);
        let sums = &mut sums[..count];
        let images: [&[f32]; N] =
            std::array::from_fn(|k| &row.distances[usize::from(terms[k].is_later)][first..][..count]);
        for x in 0..count {
            let mut distances = [0.0; N];
            for k in 0..N {
                distances[k] = images[k][x];
            }
            sums[x] = mix.of_cell(terms, distances);
        }
        let (right, down) = (&row.right[first..][..count], &row.down[first..][..count]);
        for x in 0..count {
            let margin = change * (right[x].abs() + down[x].abs()) + spread;
            let state = select(sums[x] > margin, BACKGROUND, UNKNOWN);
            states[x] = select(sums[x] < -margin, INSIDE, state);
        }
    }

    for (k, &state) in states.iter().enumerate() {
        if state == UNKNOWN {
            unknown.push(k as u32);
        }
    }
}

/// Decides the unknown cells of a row by their warped mean distances, and lists those that have to be decided pixel by
/// pixel.
#[inline(always)]
fn decide_unknown_cells<const N: usize>(
    terms: &[Term; N],
    mix: Mix,
    flow: &FlowView,
    rect: &Rect,
    y: i32,
    scratch: &mut WarpScratch,
) {
    let spread = scratch.spread();
    let WarpScratch { states, unknown, edge_cells, .. } = scratch;
    edge_cells.clear();
    let origin = flow.rect();
    let (row, half) = ((y - origin.y0).div_euclid(CELL), 0.5 * CELL as f32);
    let to_later = terms[N - 1].along_flow;
    for group in unknown.chunks(LANES) {
        let (mut left, mut u, mut v) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for (k, &cell) in group.iter().enumerate() {
            let x = rect.x0 + CELL * cell as i32;
            let [right, down] = flow.of_cell((x - origin.x0).div_euclid(CELL), row);
            (left[k], u[k], v[k]) = (x as f32, to_later * right, to_later * down);
        }
        // The flow is known where the later image shows the subject, which is not where it is now.
        for k in 0..LANES {
            (u[k], v[k]) = (left[k] + half + u[k], y as f32 + half + v[k]);
        }
        let motions = flow.at_many(&u, &v);

        let mut distances = [[0.0; LANES]; N];
        for (term, distances) in terms.iter().zip(&mut distances) {
            let (mut u, mut v) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                u[k] = left[k] + half + term.along_flow * motions[0][k];
                v[k] = y as f32 + half + term.along_flow * motions[1][k];
            }
            *distances = term.image.sample_cells(&u, &v);
        }
        let mut means = [0.0; LANES];
        for k in 0..LANES {
            let mut of_cell = [0.0; N];
            for n in 0..N {
                of_cell[n] = distances[n][k];
            }
            means[k] = mix.of_cell(terms, of_cell);
        }

        for (k, &cell) in group.iter().enumerate() {
            states[cell as usize] = select(means[k] < 0.0, INSIDE, BACKGROUND);
            if means[k].abs() <= spread {
                let x = rect.x0 + CELL * cell as i32;
                let column = (x - origin.x0).div_euclid(CELL);
                let motion = [motions[0][k], motions[1][k]];
                states[cell as usize] = UNKNOWN;
                edge_cells.push(EdgeCell { x, flow: motion, slope: slope(flow, column, row) });
            }
        }
    }
}

/// Sets the bits of a row of cells that are subject as a whole.
#[inline(always)]
fn write_cells(rect: &Rect, y: i32, states: &[CellState], bits: &mut BitImage) {
    let (height, stride, last_word) = (bits.height() as i32, bits.stride(), bits.last_word());
    let first = y as usize * stride;
    for (k, &state) in states.iter().enumerate() {
        if state == INSIDE {
            let x = rect.x0 as usize + CELL as usize * k;
            bits.words_mut()[first + x / WORD] |= 0b1111 << (x % WORD);
        }
    }
    bits.words_mut()[first + stride - 1] &= last_word;
    for y in y + 1..(y + CELL).min(height) {
        bits.words_mut().copy_within(first..first + stride, y as usize * stride);
    }
}

/// The change of the flow per pixel to the right and down, at a cell.
#[inline(always)]
fn slope(flow: &FlowView, column: i32, row: i32) -> [[f32; 2]; 2] {
    let [left, right] = [flow.of_cell(column - 1, row), flow.of_cell(column + 1, row)];
    let [above, below] = [flow.of_cell(column, row - 1), flow.of_cell(column, row + 1)];
    let change = |from: [f32; 2], to: [f32; 2]| [0, 1].map(|k| (to[k] - from[k]) / (2.0 * CELL as f32));
    [change(left, right), change(above, below)]
}

/// The distances that the pixels of a cell, whose first row is `y`, have by one image.
///
/// The pixels come from a block that is a little bent, as the flow changes from pixel to pixel. Where it hardly is, they are
/// read as from a straight one, and moved along the gradient: whole rows are read, in place of single pixels.
#[inline(always)]
fn distances_of_pixels(term: &Term, cell: &EdgeCell, y: i32) -> [f32; PIXELS] {
    let bend = cell.slope.map(|change| change.map(|change| term.along_flow * change));
    let (mut right, mut down) = ([0.0; PIXELS], [0.0; PIXELS]);
    for k in 0..PIXELS {
        let (i, j) = (k % CELL as usize, k / CELL as usize);
        let (dx, dy) = (i as f32 - TO_CENTRE, j as f32 - TO_CENTRE);
        right[k] = bend[0][0] * dx + bend[1][0] * dy;
        down[k] = bend[0][1] * dx + bend[1][1] * dy;
    }

    let u = cell.x as f32 + 0.5 + term.along_flow * cell.flow[0];
    let v = y as f32 + 0.5 + term.along_flow * cell.flow[1];
    let most = bend.iter().flatten().fold(0.0, |most: f32, change| most.max(change.abs()));
    if most < MOST_BENT
        && let Some(straight) = term.image.sample_block(u, v)
    {
        let [mut distances, along_row, along_column] = straight;
        for k in 0..PIXELS {
            distances[k] += along_row[k] * right[k] + along_column[k] * down[k];
        }
        return distances;
    }

    for k in 0..PIXELS {
        right[k] += u + (k % CELL as usize) as f32;
        down[k] += v + (k / CELL as usize) as f32;
    }
    term.image.sample_many(&right, &down)
}

/// The bytes of the pixels of a cell, whose first row is `y`.
#[inline(always)]
fn warp_pixels<const N: usize>(
    terms: &[Term; N],
    mix: Mix,
    cell: &EdgeCell,
    y: i32,
) -> [[u8; CELL as usize]; CELL as usize] {
    const SIDE: usize = CELL as usize;
    let mut distances = [[0.0; PIXELS]; N];
    for (term, distances) in terms.iter().zip(&mut distances) {
        *distances = distances_of_pixels(term, cell, y);
    }

    let mut bytes = [[0; SIDE]; SIDE];
    for k in 0..PIXELS {
        let mut of_pixel = [0.0; N];
        for n in 0..N {
            of_pixel[n] = distances[n][k];
        }
        let byte = 127.5 - 255.0 * mix.distance(terms, of_pixel);
        let byte = select(byte > 0.0, byte, 0.0);
        bytes[k / SIDE][k % SIDE] = round_i32(select(byte < 255.0, byte, 255.0)) as u8;
    }
    bytes
}

/// Writes the bytes of the listed cells, whose first row is `y`.
#[inline(always)]
fn write_pixels(cells: &[MixedCell], y: i32, mask: &mut PackedMask) {
    let (width, height) = mask.size();
    let (stride, last_word) = (mask.subject().stride(), mask.subject().last_word());
    for row in 0..CELL.min(height as i32 - y) as usize {
        let y = y as usize + row;
        let mut coverage = mask.coverage_of_row(y, CELL as usize * cells.len());
        for cell in cells {
            for (k, &byte) in cell.bytes[row].iter().enumerate() {
                let is_partial = (byte != 0) & (byte != u8::MAX) & (cell.x + k < width as usize);
                coverage.push_if(is_partial, cell.x + k, byte);
            }
        }
        coverage.close();

        let words = &mut mask.subject_mut().words_mut()[y * stride..][..stride];
        for cell in cells {
            // The highest bit of a byte tells whether its pixel is subject.
            let all = u32::from_le_bytes(cell.bytes[row]);
            let bits = u64::from((all >> 7 & 0x0101_0101).wrapping_mul(0x0102_0408) >> 24 & 0b1111);
            words[cell.x / WORD] |= bits << (cell.x % WORD);
        }
        words[stride - 1] &= last_word;
    }
}
