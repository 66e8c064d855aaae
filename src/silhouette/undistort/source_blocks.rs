//! Classification of the parts of a distorted mask as uniform or mixed, in one pass over the mask.
//!
//! ```text
//!   mask                      blocks of 4 x 4 pixels     windows of 2 x 2 blocks, by their upper left block
//!   . . . . . . . . . . # #   +---+---+---+              +-------+
//!   . . . . . . . . . # # #   | . | . | x |              |  .  x |      . all background     x neither
//!   . . . . . . . . . # # #   +---+---+---+              |       |      # all subject
//!   . . . . . . . . # # # #                              +-------+
//! ```

use crate::math::vectorised;
use crate::silhouette::{MaskView, SUBJECT};
use std::ops::Range;

/// Width and height of a block in pixels.
pub(super) const BLOCK: usize = 4;

/// Bit of a class: some byte is not 255.
const NOT_FULL: u8 = 1;

/// Bit of a class: some byte is not 0.
const NOT_EMPTY: u8 = 2;

/// The class of pixels that are all 0.
pub(super) const BACKGROUND: u8 = NOT_FULL;

/// The class of pixels that are all 255.
pub(super) const FOREGROUND: u8 = NOT_EMPTY;

/// The class of all other pixels.
pub(super) const MIXED: u8 = NOT_FULL | NOT_EMPTY;

/// The sides of windows in blocks. The class of a window comes from four windows of the previous side.
pub(super) const SIDES: [usize; 6] = [1, 2, 3, 4, 8, 16];

/// Index in the table of classes that is always mixed.
pub(super) const ALWAYS_MIXED: u32 = 0;

/// Index in the table of classes for what the lens does not see.
pub(super) const UNSEEN_WINDOW: u32 = 1;

/// Indices in the table of classes before those of the mask's own windows.
const RESERVED: usize = 2;

/// The blocks of an image, and the layout of the table of classes.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlockGrid {
    /// Blocks in a row.
    across: usize,
    /// Rows of blocks.
    down: usize,
}

impl BlockGrid {
    /// The blocks of an image of this width and height.
    pub(super) fn new((width, height): (usize, usize)) -> Self {
        Self { across: width.div_ceil(BLOCK), down: height.div_ceil(BLOCK) }
    }

    /// The smallest window around the pixels `x0..=x1`, `y0..=y1`: its index in the table of classes, and the index of
    /// its side in [`SIDES`].
    pub(super) fn window(&self, (x0, y0): (usize, usize), (x1, y1): (usize, usize)) -> (u32, usize) {
        let (left, top) = (x0 / BLOCK, y0 / BLOCK);
        let side = (x1 / BLOCK - left).max(y1 / BLOCK - top) + 1;
        let fits = |&k: &usize| side <= SIDES[k] && SIDES[k] <= self.across.min(self.down);
        let Some(level) = (0..SIDES.len()).find(fits) else {
            return (ALWAYS_MIXED, 0);
        };

        // A window that would leave the image is moved inside.
        let (left, top) = (left.min(self.across - SIDES[level]), top.min(self.down - SIDES[level]));
        let place = RESERVED + level * self.count() + top * self.across + left;
        u32::try_from(place).map_or((ALWAYS_MIXED, 0), |place| (place, level))
    }

    /// Number of blocks.
    fn count(&self) -> usize {
        self.across * self.down
    }
}

/// A rectangle of blocks.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockRect {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

/// The class of every window of a mask.
#[derive(Debug, Default)]
pub(super) struct SourceBlocks {
    /// The classes of windows, by side and then row-major by the upper left block.
    classes: Vec<u8>,
    /// For each column of blocks the union of the bits of their classes.
    columns: Vec<u8>,
}

impl SourceBlocks {
    /// Classifies the windows of `mask` up to the side with index `last_level`. What the lens does not see gets the
    /// class `unseen`. Returns whether every pixel is subject.
    pub(super) fn classify(
        &mut self,
        mask: &MaskView,
        grid: &BlockGrid,
        last_level: usize,
        unseen: u8,
    ) -> bool {
        let count = grid.count();
        self.classes.resize(RESERVED + (last_level + 1) * count, 0);
        self.classes[ALWAYS_MIXED as usize] = MIXED;
        self.classes[UNSEEN_WINDOW as usize] = unseen;

        // One pass over the mask; everything after it works on a sixteenth of the bytes.
        let is_full = classify_blocks(mask, &mut self.classes[RESERVED..][..count]);

        // The windows of each side from the windows of the previous side.
        for level in 1..=last_level {
            let (smaller, larger) = self.classes[RESERVED + (level - 1) * count..].split_at_mut(count);
            enlarge(smaller, SIDES[level] - SIDES[level - 1], grid.across, &mut larger[..count]);
        }
        is_full
    }

    /// The smallest rectangle around the blocks that are not all 0.
    pub(super) fn find_occupied(&mut self, grid: &BlockGrid) -> BlockRect {
        self.columns.clear();
        self.columns.resize(grid.across, 0);
        let rows = unite(&self.classes[RESERVED..][..grid.count()], &mut self.columns);

        let is_occupied = |class: &u8| class & NOT_EMPTY != 0;
        let left = self.columns.iter().position(is_occupied).unwrap_or(0);
        let right = self.columns.iter().rposition(is_occupied).map_or(left, |last| last + 1);
        BlockRect { columns: left..right, rows }
    }

    /// The class of the window with an index from [`BlockGrid::window`].
    #[inline(always)]
    pub(super) fn class(&self, place: u32) -> u8 {
        self.classes[place as usize]
    }
}

vectorised! {
    /// Writes the class of each block. Returns whether every pixel is subject.
    fn classify_blocks(mask: &MaskView, classes: &mut [u8]) -> bool {
        let width = mask.size().0 as usize;
        let (across, whole) = (width.div_ceil(BLOCK), width / BLOCK);
        let mut common = u32::MAX;
        let last = mask.size().1 as usize - 1;
        for (top, classes) in (0..).step_by(BLOCK).zip(classes.chunks_exact_mut(across)) {
            // The lowest blocks may have fewer rows: there the last row is repeated.
            let four = [0, 1, 2, 3].map(|down| mask.row((top + down).min(last)));

            // The four bytes of a block's row are one word.
            let words = four.map(|row| &row.as_chunks::<BLOCK>().0[..whole]);
            let inner = &mut classes[..whole];
            let mut common_here = u32::MAX;
            for k in 0..whole {
                let [a, b, c, d] = words.map(|row| u32::from_ne_bytes(row[k]));
                let (any, every) = (a | b | c | d, a & b & c & d);
                inner[k] = class_of(any, every);
                common_here &= every;
            }
            common &= common_here;

            // The rightmost block may be narrower.
            let rest = || four.iter().flat_map(|row| &row[BLOCK * whole..]).map(|&byte| u32::from(byte) * 0x0101_0101);
            if whole < across {
                let (any, every) = (rest().fold(0, |any, word| any | word), rest().fold(u32::MAX, |every, word| every & word));
                classes[whole] = class_of(any, every);
                common &= every;
            }
        }
        let tops = u32::from_ne_bytes([SUBJECT; 4]);
        common & tops == tops
    }
}

vectorised! {
    /// Unites the classes of each column in `columns`. Returns the range from the first to the last occupied row.
    fn unite(classes: &[u8], columns: &mut [u8]) -> Range<usize> {
        let mut occupied = 0..0;
        for (row, classes) in classes.chunks_exact(columns.len()).enumerate() {
            let mut any = 0;
            for (column, &class) in columns.iter_mut().zip(classes) {
                *column |= class;
                any |= class;
            }
            if any & NOT_EMPTY != 0 {
                occupied = if occupied.is_empty() { row } else { occupied.start }..row + 1;
            }
        }
        occupied
    }
}

/// The class of pixels, given the union (`any`) and the intersection (`every`) of the bits of their bytes.
#[inline(always)]
fn class_of(any: u32, every: u32) -> u8 {
    (u8::from(every != u32::MAX) * NOT_FULL) | (u8::from(any != 0) * NOT_EMPTY)
}

vectorised! {
    /// Writes the classes of windows that are `by` blocks wider and higher than those in `smaller`. Classes of windows
    /// that leave the image are wrong; no tile uses them.
    fn enlarge(smaller: &[u8], by: usize, across: usize, larger: &mut [u8]) {
        let count = smaller.len().saturating_sub(by * across + by);
        let shifted = [0, by, by * across, by * across + by].map(|shift| &smaller[shift.min(smaller.len())..]);
        if count == 0 {
            return;
        }

        let [a, b, c, d] = shifted.map(|classes| &classes[..count]);
        let larger = &mut larger[..count];
        for k in 0..count {
            larger[k] = a[k] | b[k] | c[k] | d[k];
        }
    }
}
