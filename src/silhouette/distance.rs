//! The exact Chebyshev distance from each subject pixel to the nearest background pixel.
//!
//! ```text
//!        \ | /        a background pixel nearer in height than in width is reached by rows alone, through one of
//!     ----   ----     the three pixels above or below; any other first along its own row
//!        / | \
//! ```
//!
//! So the distance is the smaller of the way along the row and one more than the least of three neighbours, carried
//! down and then up. Within a row no pixel waits for another, and a row is a few vector instructions.

use super::region::{Region, WORD, Word};
use crate::vectorised::vectorised;

/// The distance where no background exists: an open border and a silhouette without an edge.
pub(super) const NO_EDGE: u16 = u16::MAX;

/// Distances over a region, in a byte each where they fit.
#[derive(Debug, Default)]
pub(super) struct DistanceTable {
    /// Distances up to 254, four a word as they lie in memory; 255 stands for more.
    narrow: Vec<u32>,
    /// All distances, where any is larger than 254; else empty.
    wide: Vec<u16>,
}

impl DistanceTable {
    pub(super) fn fill(&mut self, region: &Region) {
        let (width, height) = (region.rect().width(), region.rect().height());
        let (subject, words) = (region.subject(), region.words());
        self.narrow.clear();
        self.wide.clear();
        if width == 0 {
            return;
        }
        self.narrow.resize((width * height + BLOCK) / FOUR, 0);
        if transform_narrow(subject, words, bytemuck::cast_slice_mut(&mut self.narrow), width) == u8::MAX {
            self.wide.resize(width * height + BLOCK, 0);
            transform_wide(subject, words, &mut self.wide, width);
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

/// Narrow distances in a word.
const FOUR: usize = 4;

/// A distance's number.
trait Pixels: Copy + Ord {
    const ZERO: Self;
    fn saturating(pixels: u16) -> Self;
    fn one_more(self) -> Self;
}

impl Pixels for u8 {
    const ZERO: Self = 0;
    #[inline(always)]
    fn saturating(pixels: u16) -> Self {
        pixels.min(255) as u8
    }
    #[inline(always)]
    fn one_more(self) -> Self {
        self.saturating_add(1)
    }
}

impl Pixels for u16 {
    const ZERO: Self = 0;
    #[inline(always)]
    fn saturating(pixels: u16) -> Self {
        pixels
    }
    #[inline(always)]
    fn one_more(self) -> Self {
        self.saturating_add(1)
    }
}

vectorised! {
    fn transform_narrow(subject: &[Word], words: usize, table: &mut [u8], width: usize) -> u8 {
        transform(subject, words, table, width)
    }
}

vectorised! {
    fn transform_wide(subject: &[Word], words: usize, table: &mut [u16], width: usize) -> u16 {
        transform(subject, words, table, width)
    }
}

/// Fills `table`, rows of `width` and a block more, and returns its largest distance.
#[inline(always)]
fn transform<T: Pixels>(subject: &[Word], words: usize, table: &mut [T], width: usize) -> T {
    for (bits, start) in subject.chunks_exact(words).zip((0..).step_by(width)) {
        along_row(bits, width, &mut table[start..start + width + BLOCK]);
    }
    // What is carried down and what is carried up do not wait for each other; where they have met, each takes the
    // other's rows along.
    let height = subject.len() / words;
    for step in 1..height {
        let (before, here) = table.split_at_mut(step * width);
        carry(&before[(step - 1) * width..], &mut here[..width]);
        let (here, below) = table.split_at_mut((height - step) * width);
        carry(&below[..width], &mut here[(height - step - 1) * width..]);
    }
    table[..height * width].iter().fold(T::ZERO, |most, &distance| most.max(distance))
}

/// Takes into `here` what the row `from`, just above or below, allows.
#[inline(always)]
fn carry<T: Pixels>(from: &[T], here: &mut [T]) {
    let width = here.len();
    let inner = width - 2;
    for start in (0..inner).step_by(BLOCK) {
        // The last block overlaps the one before: what is taken twice is the same.
        let start = start.min(inner.saturating_sub(BLOCK));
        match (from[start..].first_chunk(), here[start + 1..].first_chunk_mut()) {
            (Some(from), Some(here)) if start + BLOCK <= inner => carry_block(from, here),
            _ => carry_few(&from[start..], &mut here[start + 1..width - 1]),
        }
    }
    here[0] = here[0].min(from[0].min(from[1]).one_more());
    here[width - 1] = here[width - 1].min(from[width - 1].min(from[width - 2]).one_more());
}

/// The pixels `here` from the row of those around them, which begins one earlier.
#[inline(always)]
fn carry_block<T: Pixels>(from: &[T; BLOCK + 2], here: &mut [T; BLOCK]) {
    for k in 0..BLOCK {
        here[k] = here[k].min(from[k].min(from[k + 1]).min(from[k + 2]).one_more());
    }
}

/// The same for a narrow region.
#[inline(always)]
fn carry_few<T: Pixels>(from: &[T], here: &mut [T]) {
    for (here, from) in here.iter_mut().zip(from.windows(3)) {
        *here = (*here).min(from[0].min(from[1]).min(from[2]).one_more());
    }
}

/// Distances to the nearest background pixel of the same row, for each run of subject pixels.
#[inline(always)]
fn along_row<T: Pixels>(bits: &[Word], width: usize, row: &mut [T]) {
    row[..width].fill(T::ZERO);
    let mut end = 0;
    while let Some(start) = next_bit(bits, end, 0).filter(|&start| start < width) {
        end = next_bit(bits, start, Word::MAX).map_or(width, |end| end.min(width));
        // A run at the region's side goes on beyond the image, where nothing is background.
        let open_left = if start == 0 { u16::MAX } else { 0 };
        let open_right = if end == width { u16::MAX } else { 0 };
        for at in (start..end).step_by(BLOCK) {
            let Some(block) = row.get_mut(at..at + BLOCK) else { break };
            let count = |pixels: usize| pixels.min(usize::from(u16::MAX) - BLOCK) as u16;
            let (from_start, to_end) = (count(at - start + 1), count(end - at));
            for (k, distance) in (0..).zip(block) {
                // Beyond the run's end the way there is zero, as it has to be.
                let (left, right) = ((from_start + k) | open_left, to_end.saturating_sub(k) | open_right);
                *distance = T::saturating(left.min(right));
            }
        }
    }
    // What the last block wrote beyond the row is the next one's, which comes later.
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
