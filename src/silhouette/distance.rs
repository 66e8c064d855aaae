//! The exact Chebyshev distance from each subject pixel to the nearest background pixel, by two raster passes
//! (Rosenfeld and Pfaltz 1966).
//!
//! ```text
//!        \ | /        the nearest background pixel lies either in the pixel's own row, or is reached through one of
//!     ----   ----     the three pixels above or one of the three pixels below
//!        / | \
//! ```
//!
//! So the distance is the smaller of the distance along the row and one more than the least distance of three
//! neighbours; the neighbours above are used in a pass downwards, those below in a pass upwards. No pixel depends on
//! another pixel of its row, so a row takes a few vector instructions. The distances along a row are the minimum of two
//! ramps, one that rises from the first pixel of a run of subject pixels and one that falls to its last.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::mask_crop::{MARGIN, MaskCrop, WORD, Word};
use super::occupancy::{Occupancy, OccupancyLookup};
use crate::math::vectorised;

/// The distance where there is no background at all: in a mask that is all subject, with an unknown border.
pub(crate) const NO_EDGE: u16 = u16::MAX;

/// Chebyshev distances over a crop in pixels, row-major, in one byte each where they fit.
#[derive(Debug, Default)]
pub(super) struct DistanceTable {
    /// Distances up to 254, four per word in the order of memory; 255 stands for all above.
    narrow: Vec<u32>,
    /// All distances if any is larger than 254; otherwise empty.
    wide: Vec<u16>,
}

impl DistanceTable {
    /// Computes the distances of `crop`, whose `occupancy` lets it skip empty parts.
    pub(super) fn fill(&mut self, crop: &MaskCrop, occupancy: &Occupancy) {
        let (width, height) = (crop.rect().width(), crop.rect().height());
        let bits = SubjectRows {
            subject: crop.subject(),
            words: crop.words(),
            width,
            is_open: crop.is_open(),
            occupancy: occupancy.lookup(),
        };

        self.wide.clear();
        if width == 0 {
            return self.narrow.clear();
        }
        self.narrow.resize((width * height + SKEWED_WIDTH) / FOUR, 0);
        transform_narrow(&bits, bytemuck::cast_slice_mut(&mut self.narrow));

        // Between two sides of background no distance exceeds half of their separation.
        let may_be_deep = bits.is_open || width.min(height) / 2 >= usize::from(u8::MAX);
        if may_be_deep && self.narrow().contains(&u8::MAX) {
            self.wide.resize(width * height + SKEWED_WIDTH, 0);
            transform_wide(&bits, &mut self.wide);
        }
    }

    /// The distance at a row-major index of the crop; 0 beyond the end.
    #[inline(always)]
    pub(super) fn at(&self, index: usize) -> u16 {
        match self.narrow().get(index) {
            Some(&u8::MAX) => self.wide.get(index).copied().unwrap_or(NO_EDGE),
            Some(&distance) => u16::from(distance),
            None => 0,
        }
    }

    /// The distances as bytes; 255 stands for all above 254. Bytes after the last row are padding.
    pub(super) fn narrow(&self) -> &[u8] {
        bytemuck::cast_slice(&self.narrow)
    }

    /// [`Self::narrow`] as words of four distances.
    pub(super) fn narrow_words(&self) -> &[u32] {
        &self.narrow
    }

    /// Bytes of memory of the tables.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.narrow.capacity() + 2 * self.wide.capacity()
    }
}

/// Pixels of a row that are written at once. The compiler vectorises a loop of this length; a short one it unrolls, and
/// then does not vectorise.
const BLOCK: usize = 64;

/// Columns of a skewed tile: enough vectors that the latency of one hides behind the others.
const SKEWED_WIDTH: usize = 128;

/// Rows of a skewed tile. A tile is shifted by as many columns from its first row to its last, and the margin is this
/// wide.
const SKEWED_ROWS: usize = MARGIN_PX;

/// Columns and rows of background on each side of a crop.
const MARGIN_PX: usize = MARGIN as usize;

/// Stands for the distance to an end of a run that is not known, in pixels: larger than any distance.
const UNBOUNDED: usize = 1 << 20;

/// Narrow distances in a word.
const FOUR: usize = 4;

/// The subject bits of a crop.
struct SubjectRows<'a> {
    occupancy: OccupancyLookup<'a>,
    subject: &'a [Word],
    /// Words in a row.
    words: usize,
    /// Pixels in a row.
    width: usize,
    /// Whether the crop reaches beyond an unknown border, so that its rim is not all background.
    is_open: bool,
}

/// The integer type of a table of distances, which saturates.
trait DistanceInt: Copy + Ord {
    const ZERO: Self;
    fn one_more(self) -> Self;
    /// Writes the distances of a block of pixels to the nearer end of their run of subject pixels. The block begins
    /// `after` pixels after the run's first pixel and `before` pixels before its end.
    fn along(after: usize, before: usize, block: &mut [Self; BLOCK]);
}

impl DistanceInt for u8 {
    const ZERO: Self = 0;
    #[inline(always)]
    fn one_more(self) -> Self {
        self.saturating_add(1)
    }
    #[inline(always)]
    fn along(after: usize, before: usize, block: &mut [Self; BLOCK]) {
        let rising = RISING[(after + 1).min(255)..].first_chunk::<BLOCK>();
        let falling = FALLING[FALLING_END - before.min(FALLING_END)..].first_chunk::<BLOCK>();
        if let (Some(rising), Some(falling)) = (rising, falling) {
            for k in 0..BLOCK {
                block[k] = rising[k].min(falling[k]);
            }
        }
    }
}

/// A ramp from 0 to 255, followed by a block of 255.
const RISING: [u8; 256 + BLOCK] = {
    let mut ramp = [255; 256 + BLOCK];
    let mut k = 0;
    while k < 255 {
        ramp[k] = k as u8;
        k += 1;
    }
    ramp
};

/// The index at which the ramp in [`FALLING`] reaches 0.
const FALLING_END: usize = 255 + BLOCK;

/// A block of 255, followed by a ramp from 255 to 0 and a block of 0.
const FALLING: [u8; FALLING_END + BLOCK] = {
    let mut ramp = [0; FALLING_END + BLOCK];
    let mut k = 0;
    while k < FALLING_END {
        ramp[k] = RISING[FALLING_END - k];
        k += 1;
    }
    ramp
};

impl DistanceInt for u16 {
    const ZERO: Self = 0;
    #[inline(always)]
    fn one_more(self) -> Self {
        self.saturating_add(1)
    }
    #[inline(always)]
    fn along(after: usize, before: usize, block: &mut [Self; BLOCK]) {
        for (k, distance) in block.iter_mut().enumerate() {
            *distance = (after + 1 + k).min(before.saturating_sub(k)).min(usize::from(Self::MAX)) as Self;
        }
    }
}

vectorised! {
    fn transform_narrow(bits: &SubjectRows, table: &mut [u8]) {
        transform(bits, table);
    }
}

vectorised! {
    fn transform_wide(bits: &SubjectRows, table: &mut [u16]) {
        transform(bits, table);
    }
}

/// Computes all distances.
#[inline(always)]
fn transform<T: DistanceInt>(bits: &SubjectRows, table: &mut [T]) {
    let height = bits.subject.len() / bits.words;
    if bits.is_open {
        return transform_open(bits, table, height);
    }

    for y in 0..height {
        row_pass(bits, y, table);
    }

    // The last group of rows starts earlier if too few remain: to process a row twice changes nothing.
    let last = height - 2 - SKEWED_ROWS;
    for y in (MARGIN_PX - 1..height - MARGIN_PX).step_by(SKEWED_ROWS).map(|y| y.min(last)) {
        raster_pass(bits, table, y, 1);
    }
    for y in (MARGIN_PX - 1..height - MARGIN_PX).step_by(SKEWED_ROWS).map(|y| y.min(last)) {
        raster_pass(bits, table, height - 1 - y, -1);
    }
}

/// Updates [`SKEWED_ROWS`] rows, each from the row before it, starting after row `from`: downwards if `sign` is 1,
/// upwards if it is -1. The rows are processed in tiles by skewed (wavefront) tiling.
///
/// ```text
///             aaaaaaaabbbbbbbb      a: the first tile, b: the second one. A tile moves left by one pixel per row.
///            aaaaaaaabbbbbbbb          The three pixels above a pixel are then in the tile's previous row, at the
///           aaaaaaaabbbbbbbb           same offset and the two before it, and that row stays in registers.
/// ```
///
/// Tiles reach into the margins and through them into the adjacent row. The updates there are valid too, as margins are
/// background and stay 0.
#[inline(always)]
fn raster_pass<T: DistanceInt>(bits: &SubjectRows, table: &mut [T], from: usize, sign: isize) {
    let width = bits.width;
    let (top, bottom) =
        if sign > 0 { (from + 1, from + 1 + SKEWED_ROWS) } else { (from - SKEWED_ROWS, from) };
    for column in (MARGIN_PX..width - MARGIN_PX + SKEWED_ROWS).step_by(SKEWED_WIDTH) {
        // A tile of background alone needs no update.
        let (left, right) = (column - SKEWED_ROWS, column + SKEWED_WIDTH);
        if !bits.occupancy.any_occupied([left as u32, top as u32], [right as u32, bottom as u32]) {
            continue;
        }

        // `row` is the tile's part of the previous row, and `before` holds the two distances to the left of it.
        let mut at = from * width + column;
        let Some(&(mut row)) = table[at..].first_chunk::<SKEWED_WIDTH>() else { return };
        let mut before = [table[at - 1], table[at - 2]];
        for _ in 0..SKEWED_ROWS {
            at = at.wrapping_add_signed(sign * width as isize - 1);
            let [mut one, mut two] = before;
            before = [table[at - 1], table[at - 2]];
            let Some(here) = table[at..].first_chunk_mut::<SKEWED_WIDTH>() else { return };
            let mut next = *here;
            for k in 0..SKEWED_WIDTH {
                next[k] = next[k].min(row[k].min(one).min(two).one_more());
                (one, two) = (row[k], one);
            }
            *here = next;
            row = next;
        }
    }
}

/// Computes all distances of a crop that reaches beyond an unknown border, row by row. Its rim is not background, so
/// that tiles must not cross it.
#[inline(always)]
fn transform_open<T: DistanceInt>(bits: &SubjectRows, table: &mut [T], height: usize) {
    let width = bits.width;
    for y in 0..height {
        row_pass(bits, y, table);
    }

    for y in 1..height {
        let (above, here) = table.split_at_mut(y * width);
        raster_row(&above[(y - 1) * width..], &mut here[..width]);
    }

    for y in (1..height).rev() {
        let (above, below) = table.split_at_mut(y * width);
        raster_row(&below[..width], &mut above[(y - 1) * width..]);
    }
}

/// Updates the row `here` from the row `from`, directly above or below it.
#[inline(always)]
fn raster_row<T: DistanceInt>(from: &[T], here: &mut [T]) {
    let last = here.len() - 1;
    for (here, from) in here[1..].iter_mut().zip(from.windows(3)) {
        *here = (*here).min(from[0].min(from[1]).min(from[2]).one_more());
    }
    here[0] = here[0].min(from[0].min(from[1]).one_more());
    here[last] = here[last].min(from[last].min(from[last - 1]).one_more());
}

/// Fills row `y` with the distances to the nearest background pixel of the row. The last block may write into the next
/// row, which is filled later.
#[inline(always)]
fn row_pass<T: DistanceInt>(bits: &SubjectRows, y: usize, table: &mut [T]) {
    let (width, row) = (bits.width, &bits.subject[y * bits.words..(y + 1) * bits.words]);
    let table = &mut table[y * width..];

    let mut end = 0;
    while end < width {
        // The background before the next run of subject pixels.
        let start = next_bit(row, end, 0).unwrap_or(width).min(width);
        for at in (end..start).step_by(BLOCK) {
            let Some(block) = table[at..].first_chunk_mut() else { break };
            *block = [T::ZERO; BLOCK];
        }

        // The run itself. At a side of the crop it continues beyond the image, where nothing is background.
        end = next_bit(row, start, Word::MAX).unwrap_or(width).min(width);
        for at in (start..end).step_by(BLOCK) {
            let Some(block) = table[at..].first_chunk_mut() else { break };
            let after = if start == 0 { UNBOUNDED } else { at - start };
            let before = if end == width { UNBOUNDED } else { end - at };
            T::along(after, before, block);
        }
    }
}

/// The index of the first set bit of `bits ^ flip` from index `from` on.
#[inline(always)]
fn next_bit(bits: &[Word], from: usize, flip: Word) -> Option<usize> {
    let mut k = from / WORD;
    let mut word = (bits.get(k)? ^ flip) & (Word::MAX << (from % WORD));
    while word == 0 {
        k += 1;
        word = bits.get(k)? ^ flip;
    }
    Some(k * WORD + word.trailing_zeros() as usize)
}
