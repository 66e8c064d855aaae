//! A pinhole's mask by tiles of 8 x 8 pixels: uniform ones have a class and bits, the others bytes too.
//!
//! Only the tiles that the subject can reach are drawn. All others are background, and keep whatever an earlier mask
//! left in their places.

// A loop over the lanes of several arrays says what happens to lane k, and becomes vector instructions as a whole.
#![allow(clippy::needless_range_loop)]

use super::Undistortion;
use super::source_blocks::{BACKGROUND, FOREGROUND, MIXED, SourceBlocks};
use super::tile_map::{NO_PATCH, PIXELS, SIDE, TileRect, pixels_of};
use crate::math::vectorised;
use crate::silhouette::bit_image::top_bits;
use crate::silhouette::{MaskView, Rect};
use std::ops::Range;

/// The bytes of a tile, row-major.
pub(super) type Tile = [u8; PIXELS];

/// A bit for each pixel of a tile, row-major, the first in the lowest bit.
type TileBits = u64;

/// The bits of a tile's leftmost column.
const LEFTMOST: TileBits = 0x0101_0101_0101_0101;

/// Tiles whose patches are read from memory side by side.
const TILES_FETCHED: usize = 8;

/// Classes looked at together.
const CHUNK: usize = 8;

/// A pinhole's mask, drawn from the original camera's; memory for the next one.
#[derive(Debug, Default)]
pub(crate) struct TileMask {
    blocks: SourceBlocks,
    width: usize,
    height: usize,
    /// Tiles side by side.
    pub(super) across: usize,
    /// The tiles that are drawn.
    pub(super) drawn: TileRect,
    /// The class of each tile.
    classes: Vec<u8>,
    /// The subject pixels of each tile, those beyond the image too.
    pub(super) subject: Vec<TileBits>,
    /// The tiles that are not uniform, in ascending order, and scratch behind them.
    mixed: Vec<u32>,
    /// How many there are.
    mixed_count: usize,
    /// The bytes of the tiles that are not uniform, in the order of that list.
    bytes: Vec<Tile>,
    /// For each column of tiles the subject pixels of all its tiles together.
    columns: Vec<TileBits>,
    has_coverage: bool,
}

impl TileMask {
    /// Draws what the pinhole of `lens` sees of `mask`, a mask of the original camera; returns whether every pixel of
    /// that is subject, and then draws nothing.
    pub(super) fn draw(&mut self, lens: &Undistortion, mask: &MaskView, unseen_value: u8) -> bool {
        let (map, unseen) = (&lens.tile_map, if unseen_value == 0 { BACKGROUND } else { FOREGROUND });
        if self.blocks.classify(mask, &map.blocks, map.last_level, unseen) {
            return true;
        }
        let size = lens.pinhole.size();
        (self.width, self.height, self.across) = (size.0 as usize, size.1 as usize, map.across);

        // Where the unseen part is subject, tiles far from the mask's subject may hold some.
        let all = TileRect { columns: 0..map.across, rows: 0..map.windows.len() / map.across };
        self.drawn = match unseen {
            BACKGROUND => map.reached_from(&self.blocks.find_occupied(&map.blocks)),
            _ => all,
        };
        let count = map.windows.len();
        self.classes.resize(count, 0);
        self.subject.resize(count, 0);
        self.mixed.resize(count, 0);

        // Uniform tiles are filled at once; the others are listed, so that interpolating them has no branch.
        self.classify(lens, unseen);
        self.mixed_count = 0;
        for row in self.drawn.rows.clone() {
            let tiles = self.tiles_in_row(row);
            let classes = &self.classes[tiles.clone()];
            fill_uniform(classes, &mut self.subject[tiles.clone()]);
            self.mixed_count += list_mixed(classes, tiles.start as u32, &mut self.mixed[self.mixed_count..]);
        }

        self.bytes.resize(self.bytes.len().max(self.mixed_count), [0; PIXELS]);
        self.has_coverage = interpolate_mixed(lens, mask, unseen_value, self);
        false
    }

    /// Finds the class of each tile that is drawn; what the lens does not see has the class `unseen`.
    fn classify(&mut self, lens: &Undistortion, unseen: u8) {
        let (map, blocks) = (&lens.tile_map, &self.blocks);
        for row in self.drawn.rows.clone() {
            let tiles = self.tiles_in_row(row);
            let windows = map.windows[tiles.clone()].iter();
            for (class, &window) in self.classes[tiles].iter_mut().zip(windows) {
                *class = blocks.class(window);
            }
        }

        // A tile of which a part is unseen is uniform only if the rest is as the unseen part.
        for &(column, row) in &map.partly_seen {
            let (column, row) = (column as usize, row as usize);
            if self.drawn.columns.contains(&column) && self.drawn.rows.contains(&row) {
                self.classes[row * map.across + column] |= unseen;
            }
        }
    }

    /// The tiles that are not uniform, in ascending order, and the bytes of each.
    pub(super) fn mixed(&self) -> impl Iterator<Item = (usize, &Tile)> {
        self.mixed[..self.mixed_count].iter().map(|&tile| tile as usize).zip(&self.bytes)
    }

    /// The class of each tile that is drawn in a row of tiles, from the leftmost one on.
    #[inline(always)]
    pub(super) fn classes_in_row(&self, row: usize) -> &[u8] {
        &self.classes[self.tiles_in_row(row)]
    }

    /// The tiles that are drawn in a row of tiles.
    #[inline(always)]
    fn tiles_in_row(&self, row: usize) -> Range<usize> {
        let first = row * self.across;
        first + self.drawn.columns.start..first + self.drawn.columns.end
    }

    /// The image's pixels.
    pub(in crate::silhouette) fn image(&self) -> Rect {
        Rect::of_image(self.width as u32, self.height as u32)
    }

    /// Whether any byte of the image is neither 0 nor 255.
    pub(in crate::silhouette) fn has_coverage(&self) -> bool {
        self.has_coverage
    }

    /// The smallest rectangle around the subject.
    pub(in crate::silhouette) fn find_rect(&mut self) -> Rect {
        let TileRect { columns, rows } = self.drawn.clone();
        if columns.is_empty() || rows.is_empty() {
            return Rect::EMPTY;
        }
        self.columns.clear();
        self.columns.resize(columns.len(), 0);

        // The tiles drawn, and how far the image reaches, from the upper left one of them on.
        let (x0, y0) = (SIDE * columns.start, SIDE * rows.start);
        let size = (self.width.min(SIDE * columns.end) - x0, self.height.min(SIDE * rows.end) - y0);
        let subject = &self.subject[rows.start * self.across + columns.start..];
        let (first_row, last_row) = take_extremes(subject, self.across, size, &mut self.columns);

        // The outermost columns of tiles that hold subject, and in each the outermost column of pixels.
        let column = |bits: &TileBits| (0..SIDE).fold(0, |any, row| any | (bits >> (SIDE * row)) as u8);
        let left = self.columns.iter().position(|&bits| bits != 0);
        let right = self.columns.iter().rposition(|&bits| bits != 0);
        let (Some(left), Some(right)) = (left, right) else {
            return Rect::EMPTY;
        };
        let first = column(&self.columns[left]).trailing_zeros();
        let last = u8::BITS - column(&self.columns[right]).leading_zeros();
        Rect {
            x0: (x0 + SIDE * left) as i32 + first as i32,
            y0: (y0 + first_row) as i32,
            x1: (x0 + SIDE * right) as i32 + last as i32,
            y1: (y0 + last_row) as i32 + 1,
        }
    }
}

vectorised! {
    /// Writes the bits of uniform tiles; those of the others mean nothing yet.
    fn fill_uniform(classes: &[u8], subject: &mut [TileBits]) {
        for (&class, subject) in classes.iter().zip(subject) {
            *subject = TileBits::from(class == FOREGROUND).wrapping_neg();
        }
    }
}

/// Lists the tiles that are not uniform, of which the one of the first class is `start`, and counts them.
fn list_mixed(classes: &[u8], start: u32, mixed: &mut [u32]) -> usize {
    let mut count = 0;
    let mut list = |classes: &[u8], first: u32| {
        // Each tile is written, and the next one in its place if it is uniform: no branch that is hard to predict.
        for (&class, tile) in classes.iter().zip(first..) {
            mixed[count] = tile;
            count += usize::from(class == MIXED);
        }
    };
    let (chunks, rest) = classes.as_chunks::<CHUNK>();
    for (chunk, first) in chunks.iter().zip((start..).step_by(CHUNK)) {
        let classes = u64::from_le_bytes(*chunk);
        if classes & (classes >> 1) & LEFTMOST != 0 {
            list(chunk, first);
        }
    }
    list(rest, start + (classes.len() - rest.len()) as u32);
    count
}

vectorised! {
    /// Interpolates the tiles that are not uniform; returns whether any has coverage.
    fn interpolate_mixed(lens: &Undistortion, mask: &MaskView, unseen_value: u8, drawn: &mut TileMask) -> bool {
        let map = &lens.tile_map;
        let mut coverage = [0; PIXELS];
        let groups = drawn.mixed[..drawn.mixed_count].chunks(TILES_FETCHED).zip(drawn.bytes.chunks_mut(TILES_FETCHED));
        for (tiles, bytes) in groups {
            // Few of the patches are in the cache, and each alone would be waited for.
            for &tile in tiles {
                map.patches[tile as usize].fetch();
            }
            for (&tile, bytes) in tiles.iter().zip(&mut *bytes) {
                let k = tile as usize;
                *bytes = match map.sources[k] {
                    NO_PATCH => interpolate_each(lens, mask, unseen_value, k),
                    source => map.patches[k].interpolate(mask, source, unseen_value),
                };
            }

            // Not straight after each tile, whose bytes are still being written then.
            for (&tile, bytes) in tiles.iter().zip(&*bytes) {
                for k in 0..PIXELS {
                    // One more makes 255 and 0 the only bytes without a bit above the lowest.
                    coverage[k] |= bytes[k].wrapping_add(1) >> 1;
                }
                drawn.subject[tile as usize] = subject_of(bytes);
            }
        }
        coverage != [0; PIXELS]
    }
}

/// The bytes of a tile whose pixels are spread too far over the original for a patch.
#[inline(never)]
fn interpolate_each(lens: &Undistortion, mask: &MaskView, unseen_value: u8, tile: usize) -> Tile {
    let (width, height) = lens.pinhole.size();
    pixels_of(tile, lens.tile_map.across).map(|(x, y)| match x < width as usize && y < height as usize {
        true => lens.taps[y * width as usize + x].value(mask, unseen_value),
        false => unseen_value,
    })
}

/// The subject pixels of a tile.
#[inline(always)]
fn subject_of(bytes: &Tile) -> TileBits {
    let (rows, mut packed) = (bytes.as_chunks().0, [0; SIDE]);
    for k in 0..SIDE {
        packed[k] = top_bits(&rows[k]);
    }
    TileBits::from_le_bytes(packed)
}

vectorised! {
    /// Unites the tiles of each column in `columns`, as far as they lie in the first `size` pixels; returns the first
    /// and the last row of pixels with subject, zero where none has any. `across` tiles on lies the next row's.
    fn take_extremes(
        subject: &[TileBits],
        across: usize,
        size: (usize, usize),
        columns: &mut [TileBits],
    ) -> (usize, usize) {
        let last_column = columns.len() - 1;
        let in_last_column = LEFTMOST * (0xff >> (SIDE * columns.len() - size.0));
        let (mut first_row, mut last_row) = (None, 0);
        for (row, tiles) in subject.chunks(across).take(size.1.div_ceil(SIDE)).enumerate() {
            let beyond = (SIDE * (row + 1)).saturating_sub(size.1);
            let in_image = TileBits::MAX >> (SIDE * beyond);
            let mut any = 0;
            for (column, &tile) in columns[..last_column].iter_mut().zip(tiles) {
                *column |= tile & in_image;
                any |= tile;
            }
            let last = tiles[last_column] & in_last_column;
            columns[last_column] |= last & in_image;

            any = (any | last) & in_image;
            if any != 0 {
                first_row = first_row.or(Some(SIDE * row + any.trailing_zeros() as usize / SIDE));
                last_row = SIDE * (row + 1) - 1 - any.leading_zeros() as usize / SIDE;
            }
        }
        (first_row.unwrap_or(0), last_row)
    }
}
