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

// A loop over the lanes of several arrays says what happens to lane k, and becomes vector instructions as a whole.
#![allow(clippy::needless_range_loop)]

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
    /// Scratch.
    row: Vec<u8>,
}

impl DistanceTable {
    pub(super) fn fill(&mut self, region: &Region) {
        let (width, height) = (region.rect().width(), region.rect().height());
        let bits = Bits { subject: region.subject(), words: region.words(), width };
        // The regions of this view's masks differ little: little is set to zero only to be overwritten.
        self.narrow.resize(width * height / FOUR, 0);
        self.wide.clear();
        if width == 0 {
            return;
        }
        self.row.resize(width + BLOCK, 0);
        if transform_narrow(&bits, bytemuck::cast_slice_mut(&mut self.narrow), &mut self.row) == u8::MAX {
            self.wide.resize(width * height, 0);
            transform_wide(&bits, &mut self.wide, &mut vec![0; width + BLOCK]);
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
        4 * self.narrow.capacity() + 2 * self.wide.capacity() + self.row.capacity()
    }
}

/// Pixels done at once. A loop over so many is turned into vector instructions; one over few is unrolled first, and
/// then no longer.
const BLOCK: usize = 64;

/// Narrow distances in a word.
const FOUR: usize = 4;

/// Subject bits, rows of so many words.
struct Bits<'a> {
    subject: &'a [Word],
    words: usize,
    width: usize,
}

/// A distance's number.
trait Pixels: Copy + Ord {
    const ZERO: Self;
    fn one_more(self) -> Self;
    /// Distances along a row to the end of a run of subject pixels, for a block that begins `after` pixels behind the
    /// run's first pixel and `before` pixels before its end.
    fn along(after: isize, before: isize, block: &mut [Self; BLOCK]);
}

impl Pixels for u8 {
    const ZERO: Self = 0;
    #[inline(always)]
    fn one_more(self) -> Self {
        self.saturating_add(1)
    }
    #[inline(always)]
    fn along(after: isize, before: isize, block: &mut [Self; BLOCK]) {
        let rising = (after + 1).clamp(-(BLOCK as isize), 255) + BLOCK as isize;
        let falling = FALLING_END - before.clamp(0, FALLING_END);
        let (rising, falling) =
            (RISING[rising as usize..].first_chunk(), FALLING[falling as usize..].first_chunk());
        if let (Some(rising), Some(falling)) = (rising, falling) {
            let (rising, falling): (&[u8; BLOCK], &[u8; BLOCK]) = (rising, falling);
            for k in 0..BLOCK {
                block[k] = rising[k].min(falling[k]);
            }
        }
    }
}

/// No pixels for a block, 0 to 255, and 255 for a block.
const RISING: [u8; 256 + 2 * BLOCK] = {
    let mut ramp = [0; 256 + 2 * BLOCK];
    let mut k = BLOCK;
    while k < ramp.len() {
        ramp[k] = if k - BLOCK < 255 { (k - BLOCK) as u8 } else { 255 };
        k += 1;
    }
    ramp
};

/// Where in [`FALLING`] the ramp has come down to zero.
const FALLING_END: isize = 255 + BLOCK as isize;

/// 255 for a block, 255 to 0, and no pixels for a block.
const FALLING: [u8; 256 + 2 * BLOCK] = {
    let mut ramp = RISING;
    let mut k = 0;
    while k < ramp.len() {
        ramp[k] = RISING[ramp.len() - 1 - k];
        k += 1;
    }
    ramp
};

impl Pixels for u16 {
    const ZERO: Self = 0;
    #[inline(always)]
    fn one_more(self) -> Self {
        self.saturating_add(1)
    }
    #[inline(always)]
    fn along(after: isize, before: isize, block: &mut [Self; BLOCK]) {
        let clamp = |pixels: isize| pixels.clamp(0, u16::MAX as isize) as u16;
        for (k, distance) in (0..).zip(block) {
            *distance = clamp(after.saturating_add(1 + k)).min(clamp(before.saturating_sub(k)));
        }
    }
}

vectorised! {
    fn transform_narrow(bits: &Bits, table: &mut [u8], row: &mut [u8]) -> u8 {
        transform(bits, table, row)
    }
}

vectorised! {
    fn transform_wide(bits: &Bits, table: &mut [u16], row: &mut [u16]) -> u16 {
        transform(bits, table, row)
    }
}

/// Fills `table` and returns its largest distance; `row`, a block longer than a row, is scratch.
///
/// What is carried down and what is carried up do not wait for each other; where they have met, each takes the other's
/// rows along.
#[inline(always)]
fn transform<T: Pixels>(bits: &Bits, table: &mut [T], row: &mut [T]) -> T {
    let (width, height) = (bits.width, table.len() / bits.width);
    let mut most = [T::ZERO; BLOCK];
    for step in 0..height {
        let (above, here) = table.split_at_mut(step * width);
        let above = above.len().checked_sub(width).map(|start| &above[start..]);
        let (down, up) = (step, height - 1 - step);
        if down <= up {
            along_row(bits.row(down), width, row);
            meet(above, row, &mut here[..width]);
        } else {
            carry(above, &mut here[..width], &mut most);
        }
        let (here, below) = table.split_at_mut((up + 1) * width);
        let below = below.get(..width);
        let here = &mut here[up * width..];
        if down < up {
            along_row(bits.row(up), width, row);
            meet(below, row, here);
        } else {
            carry(below, here, &mut most);
        }
    }
    most.into_iter().fold(T::ZERO, T::max)
}

/// The first distances of a row: the lesser of those `along` it and those that the row `from`, above or below, allows.
#[inline(always)]
fn meet<T: Pixels>(from: Option<&[T]>, along: &[T], here: &mut [T]) {
    let width = here.len();
    let Some(from) = from else { return here.copy_from_slice(&along[..width]) };
    for start in blocks(width) {
        let source = (from[start..].first_chunk(), along[start + 1..].first_chunk());
        match (source, here[start + 1..width - 1].first_chunk_mut()) {
            ((Some(from), Some(along)), Some(here)) => meet_block(from, along, here),
            _ => meet_few(&from[start..], &along[start + 1..], &mut here[start + 1..width - 1]),
        }
    }
    here[0] = along[0].min(from[0].min(from[1]).one_more());
    here[width - 1] = along[width - 1].min(from[width - 1].min(from[width - 2]).one_more());
}

/// Where blocks begin that cover a row but for its first and last pixel. The last one overlaps the one before: what is
/// taken twice is the same.
#[inline(always)]
fn blocks(width: usize) -> impl Iterator<Item = usize> {
    (0..width - 2).step_by(BLOCK).map(move |start| start.min((width - 2).saturating_sub(BLOCK)))
}

#[inline(always)]
fn meet_block<T: Pixels>(from: &[T; BLOCK + 2], along: &[T; BLOCK], here: &mut [T; BLOCK]) {
    for k in 0..BLOCK {
        here[k] = along[k].min(from[k].min(from[k + 1]).min(from[k + 2]).one_more());
    }
}

/// The same for a narrow region.
#[inline(always)]
fn meet_few<T: Pixels>(from: &[T], along: &[T], here: &mut [T]) {
    for ((here, along), from) in here.iter_mut().zip(along).zip(from.windows(3)) {
        *here = (*along).min(from[0].min(from[1]).min(from[2]).one_more());
    }
}

/// Takes into `here` what the row `from`, just above or below, allows, and into `most` how large its distances are.
#[inline(always)]
fn carry<T: Pixels>(from: Option<&[T]>, here: &mut [T], most: &mut [T; BLOCK]) {
    let width = here.len();
    let Some(from) = from else { return };
    for start in blocks(width) {
        match (from[start..].first_chunk(), here[start + 1..width - 1].first_chunk_mut()) {
            (Some(from), Some(here)) => carry_block(from, here, most),
            _ => carry_few(&from[start..], &mut here[start + 1..width - 1], most),
        }
    }
    here[0] = here[0].min(from[0].min(from[1]).one_more());
    here[width - 1] = here[width - 1].min(from[width - 1].min(from[width - 2]).one_more());
    most[0] = most[0].max(here[0]).max(here[width - 1]);
}

/// The pixels `here` from the row of those around them, which begins one earlier.
#[inline(always)]
fn carry_block<T: Pixels>(from: &[T; BLOCK + 2], here: &mut [T; BLOCK], most: &mut [T; BLOCK]) {
    for k in 0..BLOCK {
        here[k] = here[k].min(from[k].min(from[k + 1]).min(from[k + 2]).one_more());
        most[k] = most[k].max(here[k]);
    }
}

/// The same for a narrow region.
#[inline(always)]
fn carry_few<T: Pixels>(from: &[T], here: &mut [T], most: &mut [T; BLOCK]) {
    for ((here, from), most) in here.iter_mut().zip(from.windows(3)).zip(most) {
        *here = (*here).min(from[0].min(from[1]).min(from[2]).one_more());
        *most = (*most).max(*here);
    }
}

/// Distances to the nearest background pixel of the same row.
#[inline(always)]
fn along_row<T: Pixels>(bits: &[Word], width: usize, row: &mut [T]) {
    let mut done = 0;
    loop {
        let start = next_bit(bits, done, 0).unwrap_or(width).min(width);
        let end = next_bit(bits, start, Word::MAX).unwrap_or(width).min(width);
        for at in (done..end).step_by(BLOCK) {
            let Some(block) = row[at..].first_chunk_mut() else { break };
            // A run at the region's side goes on beyond the image, where nothing is background.
            let after = if start == 0 { isize::MAX - BLOCK as isize } else { at as isize - start as isize };
            let before = if end == width { isize::MAX } else { (end - at) as isize };
            T::along(after, before, block);
        }
        done = end;
        if done == width {
            return;
        }
    }
}

impl Bits<'_> {
    #[inline(always)]
    fn row(&self, y: usize) -> &[Word] {
        &self.subject[y * self.words..(y + 1) * self.words]
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
