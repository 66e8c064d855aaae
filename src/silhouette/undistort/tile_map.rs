//! The positions of a pinhole image's pixels in the original image, by tiles of 8 x 8 pixels.
//!
//! The pixels of a tile come from a small window of the original's blocks. If the window is uniform, which takes one
//! look-up, so is the tile. Otherwise the tile is interpolated from a patch of the original, which is copied first.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::source_blocks::{BLOCK, BlockGrid, BlockRect, UNSEEN_WINDOW};
use super::{FULL, Tap, UNSEEN};
use crate::silhouette::MaskView;
use std::ops::Range;

/// Width and height of a tile in pixels.
pub(super) const SIDE: usize = 8;

/// Number of pixels in a tile.
pub(super) const PIXELS: usize = SIDE * SIDE;

/// Width of a patch in pixels.
const PATCH_WIDTH: usize = 16;

/// Height of a patch in pixels. Indices into a patch are bytes; those of a sixteenth row stand for unseen pixels.
const PATCH_HEIGHT: usize = 15;

/// The index into a patch for what the lens does not see.
const UNSEEN_PLACE: u8 = (PATCH_WIDTH * PATCH_HEIGHT) as u8;

/// The bytes of a patch and of the rows after it, which hold the right and lower neighbours of the last indices.
const PATCH_BYTES: usize = PATCH_WIDTH * (PATCH_HEIGHT + 3);

/// The tiles of a pinhole image, row-major. Tiles at the right and lower border may reach beyond the image, where all
/// pixels are unseen.
#[derive(Debug, Clone)]
pub(super) struct TileMap {
    /// Tiles in a row.
    pub(super) across: usize,
    pub(super) blocks: BlockGrid,
    /// The index of the largest side of all windows.
    pub(super) last_level: usize,
    /// For each tile the index of its window in the table of classes.
    pub(super) windows: Vec<u32>,
    /// Column and row of each tile that the lens sees only in part.
    pub(super) partly_seen: Vec<(u32, u32)>,
    /// For each column of tiles its source columns of blocks.
    columns: Vec<Range<usize>>,
    /// For each row of tiles its source rows of blocks.
    rows: Vec<Range<usize>>,
    /// For each tile the column and row in the original of its patch's first pixel, or [`NO_PATCH`].
    pub(super) sources: Vec<Source>,
    pub(super) patches: Vec<Patch>,
}

/// A rectangle of tiles.
#[derive(Debug, Clone, Default)]
pub(super) struct TileRect {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

/// The source of a tile without a patch: a patch is too small for the tile's pixels in the original.
pub(super) const NO_PATCH: Source = [u16::MAX; 2];

/// Column and row of a pixel of the original.
type Source = [u16; 2];

/// The positions of a tile's pixels in a patch of the original. It fills three cache lines and is aligned to them, as
/// in large images the patches of a frame's outlines are read from main memory.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Patch {
    /// For each pixel of the tile the index into the patch of the upper left of the four pixels around its position.
    places: [u8; PIXELS],
    /// Distance of each position to the right of that pixel's centre, in pixels times [`FULL`].
    right: [u8; PIXELS],
    /// Distance of each position below that pixel's centre, in pixels times [`FULL`].
    below: [u8; PIXELS],
}

/// The bounding rectangle of the pixels that some taps are interpolated from. Both corners are included.
#[derive(Debug, Clone, Copy)]
struct Extent {
    low: (usize, usize),
    high: (usize, usize),
}

impl TileMap {
    /// The tiles of a pinhole image of `size` pixels, whose `taps` refer to an original of `original` pixels.
    pub(super) fn new(taps: &[Tap], size: (u32, u32), original: (u32, u32)) -> Self {
        let [size, original] = [size, original].map(|(width, height)| (width as usize, height as usize));
        let (across, down) = (size.0.div_ceil(SIDE), size.1.div_ceil(SIDE));
        let mut map = Self {
            across,
            blocks: BlockGrid::new(original),
            last_level: 0,
            windows: Vec::with_capacity(across * down),
            partly_seen: Vec::new(),
            columns: vec![0..0; across],
            rows: vec![0..0; down],
            sources: Vec::with_capacity(across * down),
            patches: Vec::with_capacity(across * down),
        };

        // Pixels of tiles beyond the image are unseen.
        for tile in 0..across * down {
            let taps = pixels_of(tile, across).map(|(x, y)| match x < size.0 && y < size.1 {
                true => taps[y * size.0 + x],
                false => Tap { upper_left: UNSEEN, right: 0, below: 0 },
            });
            map.push(&taps, original);
        }
        map
    }

    /// Appends the tile with these taps.
    fn push(&mut self, taps: &[Tap; PIXELS], original: (usize, usize)) {
        let (column, row) = (self.patches.len() % self.across, self.patches.len() / self.across);
        let seen = taps.iter().filter(|tap| tap.upper_left != UNSEEN);
        if (1..PIXELS).contains(&seen.clone().count()) {
            self.partly_seen.push((column as u32, row as u32));
        }

        // The window and the patch cover all pixels that the tile is interpolated from.
        let places = seen.map(|tap| tap.upper_left.map(usize::from)).map(|[x, y]| (x, y));
        let (window, source, patch) = match Extent::around(places, original) {
            Some(extent) => {
                let (window, level) = self.blocks.window(extent.low, extent.high);
                self.last_level = self.last_level.max(level);
                extend(&mut self.columns[column], extent.low.0 / BLOCK..extent.high.0 / BLOCK + 1);
                extend(&mut self.rows[row], extent.low.1 / BLOCK..extent.high.1 / BLOCK + 1);
                let (source, patch) =
                    Patch::new(taps, &extent, original).unwrap_or((NO_PATCH, Patch::UNSEEN));
                (window, source, patch)
            }
            None => (UNSEEN_WINDOW, NO_PATCH, Patch::UNSEEN),
        };
        self.windows.push(window);
        self.sources.push(source);
        self.patches.push(patch);
    }

    /// The smallest rectangle that holds every tile with a source in `blocks`.
    pub(super) fn reached_from(&self, blocks: &BlockRect) -> TileRect {
        let reached = |ranges: &[Range<usize>], blocks: &Range<usize>| {
            let meets = |range: &Range<usize>| range.start < blocks.end && blocks.start < range.end;
            let first = ranges.iter().position(meets).unwrap_or(0);
            first..ranges.iter().rposition(meets).map_or(first, |last| last + 1)
        };
        TileRect { columns: reached(&self.columns, &blocks.columns), rows: reached(&self.rows, &blocks.rows) }
    }
}

/// Extends `range` to include `other`.
fn extend(range: &mut Range<usize>, other: Range<usize>) {
    let start = if range.end == 0 { other.start } else { range.start.min(other.start) };
    *range = start..range.end.max(other.end);
}

/// The pixels of a tile, row-major.
pub(super) fn pixels_of(tile: usize, across: usize) -> [(usize, usize); PIXELS] {
    let (x, y) = (tile % across * SIDE, tile / across * SIDE);
    std::array::from_fn(|k| (x + k % SIDE, y + k / SIDE))
}

impl Extent {
    /// The extent of the pixels at `places` and of their right and lower neighbours in the image; `None` if there are
    /// no places.
    fn around(places: impl Iterator<Item = (usize, usize)>, (width, height): (usize, usize)) -> Option<Self> {
        let ranges = places
            .map(|(x, y)| (x, y, x, y))
            .reduce(|a, b| (a.0.min(b.0), a.1.min(b.1), a.2.max(b.2), a.3.max(b.3)));
        let (x0, y0, x1, y1) = ranges?;
        Some(Self { low: (x0, y0), high: ((x1 + 1).min(width - 1), (y1 + 1).min(height - 1)) })
    }
}

impl Patch {
    /// The patch of a tile that the lens does not see.
    const UNSEEN: Self = Self { places: [UNSEEN_PLACE; PIXELS], right: [0; PIXELS], below: [0; PIXELS] };

    /// The patch of a tile, and its first pixel in the original; `None` if the extent does not fit a patch.
    fn new(taps: &[Tap; PIXELS], extent: &Extent, (width, height): (usize, usize)) -> Option<(Source, Self)> {
        // The whole patch lies in the image.
        let left = extent.low.0.min(width.checked_sub(PATCH_WIDTH)?);
        let top = extent.low.1.min(height.checked_sub(PATCH_HEIGHT)?);
        if extent.high.0 >= left + PATCH_WIDTH || extent.high.1 >= top + PATCH_HEIGHT {
            return None;
        }

        let mut patch = Self::UNSEEN;
        for (k, tap) in taps.iter().enumerate().filter(|(_, tap)| tap.upper_left != UNSEEN) {
            // A distance of a whole pixel is carried to the index, so that the rest is less than one and fits a byte.
            let (x, right) = carried(usize::from(tap.upper_left[0]) - left, tap.right);
            let (y, below) = carried(usize::from(tap.upper_left[1]) - top, tap.below);
            patch.places[k] = (y * PATCH_WIDTH + x) as u8;
            (patch.right[k], patch.below[k]) = (right, below);
        }
        Some(([left as u16, top as u16], patch))
    }

    /// Brings the patch into the cache.
    #[inline(always)]
    pub(super) fn fetch(&self) {
        std::hint::black_box((self.places[0], self.right[0], self.below[0]));
    }

    /// The interpolated bytes of the tile, whose patch begins with pixel `source` of `mask`. The arithmetic is that of
    /// [`Tap::interpolate`].
    #[inline(always)]
    pub(super) fn interpolate(&self, mask: &MaskView, source: Source, unseen_value: u8) -> [u8; PIXELS] {
        let (bytes, stride, [left, top]) = (mask.bytes(), mask.stride(), source.map(usize::from));
        let mut patch = [unseen_value; PATCH_BYTES];
        let rows = patch.as_chunks_mut::<PATCH_WIDTH>().0.iter_mut().take(PATCH_HEIGHT);
        for (row, start) in rows.zip((top * stride + left..).step_by(stride)) {
            row.copy_from_slice(&bytes[start..start + PATCH_WIDTH]);
        }

        // One load of four bytes, for which there is a gather instruction, holds two adjacent pixels.
        let load = |place: usize| {
            u32::from_le_bytes([patch[place], patch[place + 1], patch[place + 2], patch[place + 3]])
        };
        let mut bytes = [0; PIXELS];
        for k in 0..PIXELS {
            let (place, right, below) =
                (usize::from(self.places[k]), u32::from(self.right[k]), u32::from(self.below[k]));
            // First along the rows, then between them. A negative difference wraps, and the sum wraps back.
            let mix = |pair: u32| (pair & 0xff) * (FULL - right) + (pair >> 8 & 0xff) * right;
            let (upper, lower) = (mix(load(place)), mix(load(place + PATCH_WIDTH)));
            let sum = (upper * FULL).wrapping_add(lower.wrapping_sub(upper).wrapping_mul(below));
            bytes[k] = ((sum + FULL * FULL / 2) / (FULL * FULL)) as u8;
        }
        bytes
    }
}

/// Carries whole pixels from the distance `beyond` to `pixel`. The distances are in pixels times [`FULL`].
fn carried(pixel: usize, beyond: u16) -> (usize, u8) {
    let full = FULL as u16;
    (pixel + usize::from(beyond / full), (beyond % full) as u8)
}
