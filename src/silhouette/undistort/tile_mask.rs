//! A pinhole's mask in tiles of 8 x 8 pixels. Each tile has a class and bits; tiles that are not uniform also have
//! bytes.
//!
//! Only the tiles that the subject can reach are drawn. All others are background, and their entries in the tables
//! still hold values of earlier masks.

// Loops over the lanes of several arrays by index become vector instructions.
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

/// Tiles whose patches are fetched from memory at once.
const TILES_FETCHED: usize = 8;

/// Classes that are compared at once.
const CHUNK: usize = 8;

/// A pinhole's mask that is drawn from a mask of the original camera. Its memory is reused for the next mask.
#[derive(Debug, Default)]
pub(crate) struct TileMask {
    blocks: SourceBlocks,
    width: usize,
    height: usize,
    /// Tiles in a row.
    pub(super) across: usize,
    /// The tiles that are drawn.
    pub(super) drawn: TileRect,
    /// The class of each tile.
    classes: Vec<u8>,
    /// The subject pixels of each tile, also beyond the image.
    pub(super) subject: Vec<TileBits>,
    /// The tiles that are not uniform, ascending: the first `mixed_count` elements. The others are scratch memory.
    mixed: Vec<u32>,
    /// Number of tiles that are not uniform.
    mixed_count: usize,
    /// The bytes of the tiles that are not uniform, in the order of `mixed`.
    bytes: Vec<Tile>,
    /// For each column of tiles the union of the subject pixels of its tiles.
    columns: Vec<TileBits>,
    has_coverage: bool,
}

impl TileMask {
    /// Draws `mask`, a mask of the original camera, as the pinhole of `lens` sees it. Returns `true`, and draws
    /// nothing, if every pixel of `mask` is subject.
    pub(super) fn draw(&mut self, lens: &Undistortion, mask: &MaskView, unseen_value: u8) -> bool {
        let (map, unseen) = (&lens.tile_map, if unseen_value == 0 { BACKGROUND } else { FOREGROUND });
        if self.blocks.classify(mask, &map.blocks, map.last_level, unseen) {
            return true;
        }

        let size = lens.pinhole.size();
        (self.width, self.height, self.across) = (size.0 as usize, size.1 as usize, map.across);

        // If unseen pixels count as subject, tiles far from the mask's subject may hold subject too.
        let all = TileRect { columns: 0..map.across, rows: 0..map.windows.len() / map.across };
        self.drawn = match unseen {
            BACKGROUND => map.reached_from(&self.blocks.find_occupied(&map.blocks)),
            _ => all,
        };

        let count = map.windows.len();
        self.classes.resize(count, 0);
        self.subject.resize(count, 0);
        self.mixed.resize(count, 0);

        // Uniform tiles are filled here, and the others are listed, so that the loop that interpolates has no branch.
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

    /// Sets the class of each tile that is drawn. What the lens does not see has the class `unseen`.
    fn classify(&mut self, lens: &Undistortion, unseen: u8) {
        let (map, blocks) = (&lens.tile_map, &self.blocks);
        for row in self.drawn.rows.clone() {
            let tiles = self.tiles_in_row(row);
            let windows = map.windows[tiles.clone()].iter();
            for (class, &window) in self.classes[tiles].iter_mut().zip(windows) {
                *class = blocks.class(window);
            }
        }

        // A tile with unseen pixels is uniform only if the others have the same value.
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

    /// The class of each tile that is drawn in a row of tiles, from left to right.
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

    /// Computes the smallest rectangle around the subject.
    pub(in crate::silhouette) fn find_rect(&mut self) -> Rect {
        let TileRect { columns, rows } = self.drawn.clone();
        if columns.is_empty() || rows.is_empty() {
            return Rect::EMPTY;
        }
        self.columns.clear();
        self.columns.resize(columns.len(), 0);

        // The first pixel of the drawn tiles, and their size in pixels within the image.
        let (x0, y0) = (SIDE * columns.start, SIDE * rows.start);
        let size = (self.width.min(SIDE * columns.end) - x0, self.height.min(SIDE * rows.end) - y0);
        let subject = &self.subject[rows.start * self.across + columns.start..];
        let (first_row, last_row) = take_extremes(subject, self.across, size, &mut self.columns);

        // The outermost columns of tiles with subject, and in each the outermost column of pixels.
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
    /// Writes the bits of uniform tiles. The bits of other tiles are set later.
    fn fill_uniform(classes: &[u8], subject: &mut [TileBits]) {
        for (&class, subject) in classes.iter().zip(subject) {
            *subject = TileBits::from(class == FOREGROUND).wrapping_neg();
        }
    }
}

/// Writes the tiles that are not uniform to `mixed`, and returns their number. `start` is the tile of the first class.
fn list_mixed(classes: &[u8], start: u32, mixed: &mut [u32]) -> usize {
    let mut count = 0;
    let mut list = |classes: &[u8], first: u32| {
        // Every tile is written, and a uniform one is overwritten by the next: that avoids a branch that is hard to
        // predict.
        for (&class, tile) in classes.iter().zip(first..) {
            mixed[count] = tile;
            count += usize::from(class == MIXED);
        }
    };

    // Chunks of uniform tiles alone are skipped: a mixed class has both bits.
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
    /// Interpolates the tiles that are not uniform. Returns whether any of them has coverage.
    fn interpolate_mixed(lens: &Undistortion, mask: &MaskView, unseen_value: u8, drawn: &mut TileMask) -> bool {
        let map = &lens.tile_map;
        let mut coverage = [0; PIXELS];
        let groups = drawn.mixed[..drawn.mixed_count].chunks(TILES_FETCHED).zip(drawn.bytes.chunks_mut(TILES_FETCHED));
        for (tiles, bytes) in groups {
            // Most patches are not in the cache: several cache misses overlap.
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

            // A loop of its own, since the bytes of a tile cannot be read back at once after they are written.
            for (&tile, bytes) in tiles.iter().zip(&*bytes) {
                for k in 0..PIXELS {
                    // After adding 1, only 0 and 255 have no bit above the lowest.
                    coverage[k] |= bytes[k].wrapping_add(1) >> 1;
                }
                drawn.subject[tile as usize] = subject_of(bytes);
            }
        }
        coverage != [0; PIXELS]
    }
}

/// Interpolates a tile without a patch, pixel by pixel.
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
    /// Unites the tiles of each column in `columns`, as far as they lie in the first `size` pixels. Returns the first
    /// and the last row of pixels with subject; zeros if there is none. Rows of tiles begin `across` tiles apart.
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

            // The last column of tiles may reach beyond the image.
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
