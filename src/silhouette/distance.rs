//! The exact Chebyshev distance from each subject pixel to the nearest background pixel.
//!
//! ```text
//!        \ | /        a background pixel nearer in height than in width is reached by rows alone, through one of
//!     ----   ----     the three pixels above or below; any other first along its own row
//!        / | \
//! ```
//!
//! So the distance is the smaller of the way along the row and one more than the least of three neighbours, carried
//! down and then up. Within a row no pixel waits for another, and a row is a few vector instructions. The way along a
//! row comes from two ramps, one that rises from where a run of subject pixels begins and one that falls to its end.

// A loop over the lanes of several arrays says what happens to lane k, and becomes vector instructions as a whole.
#![allow(clippy::needless_range_loop)]

use super::mask_crop::{MARGIN, MaskCrop, WORD, Word};
use super::occupancy::{Occupancy, OccupancyLookup};
use crate::math::vectorised;

/// The distance where no background exists: an open border and a silhouette without an edge.
pub(crate) const NO_EDGE: u16 = u16::MAX;

/// Distances over a region, in a byte each where they fit.
#[derive(Debug, Default)]
pub(super) struct DistanceTable {
    /// Distances up to 254, four a word as they lie in memory; 255 stands for more.
    narrow: Vec<u32>,
    /// All distances, where any is larger than 254; else empty.
    wide: Vec<u16>,
}

impl DistanceTable {
    pub(super) fn fill(&mut self, region: &MaskCrop, tiles: &Occupancy) {
        let (width, height) = (region.rect().width(), region.rect().height());
        let bits = SubjectRows {
            subject: region.subject(),
            words: region.words(),
            width,
            is_open: region.is_open(),
            occupancy: tiles.lookup(),
        };
        self.wide.clear();
        if width == 0 {
            return self.narrow.clear();
        }
        self.narrow.resize((width * height + SKEWED_WIDTH) / FOUR, 0);
        transform_narrow(&bits, bytemuck::cast_slice_mut(&mut self.narrow));
        // Between two sides that are background nothing is farther away than half their distance.
        let may_be_deep = bits.is_open || width.min(height) / 2 >= usize::from(u8::MAX);
        if may_be_deep && self.narrow().contains(&u8::MAX) {
            self.wide.resize(width * height + SKEWED_WIDTH, 0);
            transform_wide(&bits, &mut self.wide);
        }
    }

    /// The distance at `index` of the region.
    #[inline(always)]
    pub(super) fn at(&self, index: usize) -> u16 {
        match self.narrow().get(index) {
            Some(&u8::MAX) => self.wide.get(index).copied().unwrap_or(NO_EDGE),
            Some(&near) => u16::from(near),
            None => 0,
        }
    }

    /// The distances with 255 for all that are larger than 254.
    pub(super) fn narrow(&self) -> &[u8] {
        bytemuck::cast_slice(&self.narrow)
    }

    /// The same, four a word.
    pub(super) fn narrow_words(&self) -> &[u32] {
        &self.narrow
    }

    /// Bytes of memory behind the tables.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.narrow.capacity() + 2 * self.wide.capacity()
    }
}

/// Pixels done at once. A loop over so many is turned into vector instructions; one over few is unrolled first, and
/// then no longer.
const BLOCK: usize = 64;

/// Pixels of a slanted block's row: enough that its vectors do not wait for one another.
const SKEWED_WIDTH: usize = 128;

/// Rows of a slanted block. It may not leave the margin.
const SKEWED_ROWS: usize = MARGIN_PX;

/// Columns and rows of background on each side.
const MARGIN_PX: usize = MARGIN as usize;

/// More pixels than any distance has.
const UNBOUNDED: usize = 1 << 20;

/// Narrow distances in a word.
const FOUR: usize = 4;

/// Subject bits, rows of so many words.
struct SubjectRows<'a> {
    occupancy: OccupancyLookup<'a>,
    subject: &'a [Word],
    words: usize,
    width: usize,
    /// Whether its rim lies beyond an open border, instead of being background.
    is_open: bool,
}

/// A distance's number.
trait DistanceInt: Copy + Ord {
    const ZERO: Self;
    fn one_more(self) -> Self;
    /// Distances along a row to the end of a run of subject pixels, for a block that begins `after` pixels behind the
    /// run's first pixel and `before` pixels before its end.
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

/// 0 to 255, and 255 for a block.
const RISING: [u8; 256 + BLOCK] = {
    let mut ramp = [255; 256 + BLOCK];
    let mut k = 0;
    while k < 255 {
        ramp[k] = k as u8;
        k += 1;
    }
    ramp
};

/// Where in [`FALLING`] the ramp has come down to zero.
const FALLING_END: usize = 255 + BLOCK;

/// 255 for a block, 255 to 0, and 0 for a block.
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

/// Fills `table`.
#[inline(always)]
fn transform<T: DistanceInt>(bits: &SubjectRows, table: &mut [T]) {
    let height = bits.subject.len() / bits.words;
    if bits.is_open {
        return transform_open(bits, table, height);
    }
    for y in 0..height {
        row_pass(bits, y, table);
    }
    // The last group begins early where there are not enough rows: what is taken twice is the same.
    let last = height - 2 - SKEWED_ROWS;
    for y in (MARGIN_PX - 1..height - MARGIN_PX).step_by(SKEWED_ROWS).map(|y| y.min(last)) {
        raster_pass(bits, table, y, 1);
    }
    for y in (MARGIN_PX - 1..height - MARGIN_PX).step_by(SKEWED_ROWS).map(|y| y.min(last)) {
        raster_pass(bits, table, height - 1 - y, -1);
    }
}

/// Takes into [`GROUP`] rows what the row before them allows, `from`, and what each allows the next, downwards where
/// `sign` is 1 and upwards where it is -1.
///
/// ```text
///             aaaaaaaabbbbbbbb        a: the first block; it moves left by a pixel a row, so that what a pixel waits
///            aaaaaaaabbbbbbbb            for, the three above it, is the block's last row as it is, moved by one
///           aaaaaaaabbbbbbbb             pixel and by two, and never leaves the processor's registers
/// ```
///
/// Blocks reach into the margin on both sides, through it into the next row, and take there what is true as well. The
/// margin itself is background, and remains so.
#[inline(always)]
fn raster_pass<T: DistanceInt>(bits: &SubjectRows, table: &mut [T], from: usize, sign: isize) {
    let width = bits.width;
    let (top, bottom) =
        if sign > 0 { (from + 1, from + 1 + SKEWED_ROWS) } else { (from - SKEWED_ROWS, from) };
    for column in (MARGIN_PX..width - MARGIN_PX + SKEWED_ROWS).step_by(SKEWED_WIDTH) {
        let (left, right) = (column - SKEWED_ROWS, column + SKEWED_WIDTH);
        if !bits.occupancy.any_occupied([left as u32, top as u32], [right as u32, bottom as u32]) {
            continue;
        }
        let mut at = from * width + column;
        let Some(&(mut row)) = table[at..].first_chunk::<SKEWED_WIDTH>() else { return };
        let mut left = [table[at - 1], table[at - 2]];
        for _ in 0..SKEWED_ROWS {
            at = at.wrapping_add_signed(sign * width as isize - 1);
            let [mut one, mut two] = left;
            left = [table[at - 1], table[at - 2]];
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

/// The same where the region reaches beyond an open border, and its rim is not background.
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

/// Takes into the row `here` what the row `from`, just above or below, allows.
#[inline(always)]
fn raster_row<T: DistanceInt>(from: &[T], here: &mut [T]) {
    let last = here.len() - 1;
    for (here, from) in here[1..].iter_mut().zip(from.windows(3)) {
        *here = (*here).min(from[0].min(from[1]).min(from[2]).one_more());
    }
    here[0] = here[0].min(from[0].min(from[1]).one_more());
    here[last] = here[last].min(from[last].min(from[last - 1]).one_more());
}

/// Fills row `y` with distances to the nearest background pixel of the same row. What the last block writes beyond it
/// is the next row's, which comes later.
#[inline(always)]
fn row_pass<T: DistanceInt>(bits: &SubjectRows, y: usize, table: &mut [T]) {
    let (width, row) = (bits.width, &bits.subject[y * bits.words..(y + 1) * bits.words]);
    let table = &mut table[y * width..];
    let mut end = 0;
    while end < width {
        let start = next_bit(row, end, 0).unwrap_or(width).min(width);
        for at in (end..start).step_by(BLOCK) {
            let Some(block) = table[at..].first_chunk_mut() else { break };
            *block = [T::ZERO; BLOCK];
        }
        end = next_bit(row, start, Word::MAX).unwrap_or(width).min(width);
        for at in (start..end).step_by(BLOCK) {
            let Some(block) = table[at..].first_chunk_mut() else { break };
            // A run at the region's side goes on beyond the image, where nothing is background.
            let after = if start == 0 { UNBOUNDED } else { at - start };
            let before = if end == width { UNBOUNDED } else { end - at };
            T::along(after, before, block);
        }
    }
}

/// The first set bit of `bits ^ flip` from `from` on.
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
