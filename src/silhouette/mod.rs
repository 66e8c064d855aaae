//! One view's mask, prepared for queries: bounding rectangle, distances to the background, edge normals, and on demand
//! signed distances on both sides of the edge.
//!
//! A mask holds one byte per pixel, from 0 (background) to 255 (subject). A pixel is *subject* if its byte is at least
//! [`SUBJECT`]. The values between 0 and 255 are coverage, the fraction of the pixel that the subject covers, and
//! locate the edge inside the pixel. The [`Border`] defines what pixels beyond the image count as.

pub(crate) mod bit_image;
mod boundary;
mod cell_distance;
#[cfg(feature = "ode")]
mod components;
mod contact_edge;
mod distance;
mod edge;
mod edge_table;
mod incoming;
mod lookup;
mod mask;
mod mask_crop;
mod mask_ring;
mod mask_view;
mod motion;
mod nearest;
mod occupancy;
mod packed_mask;
mod paper_normal;
pub(crate) mod regions;
pub(crate) mod ring_search;
mod run_length;
mod signed_distance;
mod tables;
mod transposed;
mod undistort;

pub use crate::math::rect::Rect;
#[cfg(feature = "ode")]
pub(crate) use components::{Component, Components, Label};
pub(crate) use contact_edge::compute_edges;
pub(crate) use distance::NO_EDGE;
pub use edge::Edge;
pub(crate) use edge::SHORTEST_MEAN;
pub(crate) use edge_table::EdgePixel;
pub(crate) use incoming::{IncomingMask, MaskScratch};
pub(crate) use lookup::{Bits, Distances};
pub use mask::load_mask;
pub(crate) use mask_ring::{MaskRing, TimedMask};
pub use mask_view::MaskView;
pub(crate) use motion::{EdgeDistances, EdgeShift, MaskMotion, MotionChain, WarpedMask};
pub use packed_mask::PackedMask;
pub use signed_distance::SignedDistance;
pub(crate) use tables::{TableSlices, Tables};
pub(crate) use undistort::TileMask;
pub use undistort::Undistortion;

use crate::Result;
use crate::math::lanes::set_bits;
use image::GrayImage;
use mask_crop::MaskCrop;
pub(crate) use occupancy::OccupancyLookup;
use std::sync::OnceLock;

/// The smallest byte of a subject pixel: half of the pixel is covered.
pub const SUBJECT: u8 = 128;

/// The bilinear coverage at the edge, in the units of a mask's bytes.
pub const HALF_COVERAGE: f64 = 127.5;

/// What the pixels beyond the image count as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// They are background, so that the image's border is an edge of a silhouette that it cuts off.
    Background,
    /// They are unknown, and the image's border is not an edge of the silhouette. They count as subject in queries.
    Unknown,
}

/// One view's mask, prepared for queries. Any number of threads may query it at once.
///
/// Only a crop of the mask is kept: the subject's rectangle and eight pixels around it. Bytes farther out, which can
/// only be coverage below one half, count as background.
///
/// The tables for queries are derived when the mask is set. Their memory may be taken for another mask when the
/// silhouette is no longer the latest; the next query that needs them derives them again, with the same results.
#[derive(Debug)]
pub struct Silhouette {
    border: Border,
    /// The pixels of the whole image.
    image: Rect,
    /// The smallest rectangle that holds every subject pixel.
    rect: Rect,
    has_coverage: bool,
    crop: MaskCrop,
    /// The tables derived from `crop`. Empty after [`Self::take_tables`], until a query derives them again.
    tables: OnceLock<Tables>,
    /// Memory for the tables of the next mask. Its contents belong to another mask and are never read.
    recycled_tables: Option<Tables>,
}

impl Silhouette {
    /// Prepares `mask`. Any image is accepted; an empty or a full mask may have no edge.
    pub fn new<'a>(mask: impl Into<MaskView<'a>>, border: Border) -> Self {
        let mut silhouette = Self::blank(border);
        silhouette.refill(mask, border);
        silhouette
    }

    /// A silhouette of an image without pixels.
    pub(crate) fn blank(border: Border) -> Self {
        Self {
            border,
            image: Rect::EMPTY,
            rect: Rect::EMPTY,
            has_coverage: false,
            crop: MaskCrop::default(),
            tables: OnceLock::new(),
            recycled_tables: None,
        }
    }

    /// Prepares another mask in the memory of the last one.
    pub fn refill<'a>(&mut self, mask: impl Into<MaskView<'a>>, border: Border) {
        self.refill_packed(&PackedMask::new(mask), border);
    }

    /// Prepares another mask, which is packed already, in the memory of the last one.
    pub fn refill_packed(&mut self, mask: &PackedMask, border: Border) {
        self.fill_crop(|silhouette| {
            let (width, height) = mask.size();
            (silhouette.image, silhouette.rect) = (Rect::of_image(width, height), mask.rect());
            (silhouette.border, silhouette.has_coverage) = (border, mask.has_coverage());
            silhouette.crop.fill(mask, border);
        });
    }

    /// Prepares a mask of the original camera as the pinhole camera of `lens` would see it. Returns `false`, and leaves
    /// the silhouette as it is, if every pixel of the mask is subject.
    ///
    /// # Errors
    /// If the mask's size is not that of the original camera's image.
    pub(crate) fn refill_undistorted(
        &mut self,
        mask: &MaskView,
        lens: &Undistortion,
        border: Border,
        tiles: &mut TileMask,
    ) -> Result<bool> {
        if lens.draw(mask, mask_crop::value_beyond(border), tiles)? {
            return Ok(false);
        }

        self.fill_crop(|silhouette| {
            (silhouette.image, silhouette.rect) = (tiles.image(), tiles.find_rect());
            (silhouette.border, silhouette.has_coverage) = (border, tiles.has_coverage());
            silhouette.crop.fill_from_tiles(tiles, &silhouette.rect, border);
        });
        Ok(true)
    }

    /// Replaces the mask by `fill`, and derives the tables of the new one.
    fn fill_crop(&mut self, fill: impl FnOnce(&mut Self)) {
        // The tables are taken out first, so that they never belong to another mask than the crop.
        let tables = self.tables.take().or_else(|| self.recycled_tables.take());
        fill(self);

        // The thread that sets the mask derives the tables, so that no query of the latest frame waits for them.
        let mut tables = tables.unwrap_or_default();
        tables.fill(&self.crop);
        self.tables = OnceLock::from(tables);
    }

    /// Takes the tables out, as memory for another mask's tables. The next query derives them again.
    pub(crate) fn take_tables(&mut self) -> Option<Tables> {
        self.tables.take()
    }

    /// Keeps `tables` as memory for the tables of the next mask.
    pub(crate) fn recycle_tables(&mut self, tables: Tables) {
        self.recycled_tables = Some(tables);
    }

    /// The tables, which are derived here if they have been taken out. A loop over many points fetches them once.
    #[inline(always)]
    fn derived_tables(&self) -> &Tables {
        self.tables.get_or_init(|| Tables::new(&self.crop))
    }

    /// Bytes of memory of the silhouette, without the mask's own bytes.
    pub fn working_memory(&self) -> usize {
        let tables = self.tables.get().into_iter().chain(&self.recycled_tables);
        let tables: usize = tables.map(Tables::working_memory).sum();
        self.crop.working_memory() + tables
    }

    /// The mask, with zeros outside the part that is kept.
    pub(crate) fn to_mask(&self) -> GrayImage {
        GrayImage::from_fn(self.image.x1 as u32, self.image.y1 as u32, |i, j| {
            image::Luma([self.value(i as i32, j as i32)])
        })
    }

    /// The pixels of the whole image.
    pub fn image(&self) -> Rect {
        self.image
    }

    /// The smallest rectangle that holds every subject pixel.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// What pixels beyond the image count as.
    pub fn border(&self) -> Border {
        self.border
    }

    /// Whether any byte of the mask lies strictly between 0 and 255, so that edges are located inside their pixels.
    pub fn has_coverage(&self) -> bool {
        self.has_coverage
    }

    /// The byte of pixel `(i, j)`. Beyond the image it is 0, or 255 with [`Border::Unknown`].
    pub fn value(&self, i: i32, j: i32) -> u8 {
        match self.crop.byte(i, j) {
            Some(byte) => byte,
            None if self.border == Border::Unknown && !self.image.contains(i, j) => 255,
            None => 0,
        }
    }

    /// Whether pixel `(i, j)` is subject, or lies beyond an unknown border.
    pub fn is_subject(&self, i: i32, j: i32) -> bool {
        match self.crop.is_subject(i, j) {
            Some(is_subject) => is_subject,
            None => self.border == Border::Unknown && !self.image.contains(i, j),
        }
    }

    /// Whether the 32 pixels of row `j` from column `i` on are subject, the first in the lowest bit. Bits of pixels beyond
    /// the image may be set.
    #[cfg(feature = "ode")]
    fn subject_word(&self, i: i32, j: i32) -> u32 {
        let crop = self.crop.rect();
        if !crop.contains(i, j) {
            return (0..32).fold(0, |word, k| word | u32::from(self.is_subject(i + k, j)) << k);
        }
        let within = u32::try_from(crop.x1 - i).unwrap_or(0).min(32);
        self.crop.rows_from(i, j).row(0) & u32::MAX >> (32 - within)
    }

    /// Whether the crop lies within the image, so that a line out of the subject meets background before the image's
    /// border.
    pub(crate) fn is_framed_by_background(&self) -> bool {
        let crop = self.crop.rect();
        crop.intersection(&self.image) == crop
    }

    /// Whether the window of half-width `reach` around pixel `(i, j)` lies in the crop.
    pub(crate) fn keeps_window(&self, (i, j): (i32, i32), reach: i32) -> bool {
        let crop = self.crop.rect();
        crop.contains(i - reach, j - reach) && crop.contains(i + reach, j + reach)
    }

    /// Chebyshev distance in pixels from pixel `(i, j)` to the nearest background pixel: 0 if it is background itself,
    /// [`u16::MAX`] if there is no background.
    pub fn distance(&self, i: i32, j: i32) -> u16 {
        if self.rect.contains(i, j) {
            self.derived_tables().distances.at(self.crop.rect().index(i, j))
        } else if self.border == Border::Unknown && !self.image.contains(i, j) {
            NO_EDGE
        } else {
            0
        }
    }

    /// [`Self::distance`] of a pixel of the crop, given by its row-major index.
    #[inline]
    pub(crate) fn distance_at(&self, index: usize) -> u16 {
        self.derived_tables().distances.at(index)
    }

    /// The distance of the cell between four pixel centres, given by the row-major index of its upper left pixel.
    #[cold]
    pub(crate) fn cell_distance_at(&self, index: usize) -> u16 {
        let tables = self.derived_tables();
        tables.cell_distances.at(index, &tables.distances)
    }

    /// The table of contact edges.
    fn edge_table(&self) -> &edge_table::EdgeTable {
        &self.derived_tables().edges
    }

    /// The tables as slices, for queries of many points.
    pub(crate) fn tables(&self) -> TableSlices<'_> {
        self.derived_tables().slices(&self.crop)
    }

    /// Coverage at image position `(u, v)` in pixels, from 0 to 255, bilinear between pixel centres.
    #[inline]
    pub fn coverage(&self, u: f64, v: f64) -> f64 {
        // `f64::floor` is a function call in code for processors without SSE 4.1, which this is compiled for.
        let floor = |x: f64| {
            let towards_zero = f64::from(x as i32);
            if towards_zero > x { towards_zero - 1.0 } else { towards_zero }
        };
        let (i, j) = (floor(u - 0.5), floor(v - 0.5));
        let (x, y) = (u - 0.5 - i, v - 0.5 - j);

        let [c00, c10, c01, c11] = self.cell(i as i32, j as i32);
        (c00 * (1.0 - x) + c10 * x) * (1.0 - y) + (c01 * (1.0 - x) + c11 * x) * y
    }

    /// The bytes at the corners of the bilinear cell between the centres of pixels `(i, j)` and `(i + 1, j + 1)`.
    #[inline]
    pub(crate) fn cell(&self, i: i32, j: i32) -> [f64; 4] {
        let bytes = match (self.crop.row::<2>(i, j), self.crop.row::<2>(i, j + 1)) {
            (Some([a, b]), Some([c, d])) => [a, b, c, d],
            _ => [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| self.value(i, j)),
        };
        bytes.map(f64::from)
    }

    /// The background pixels with a subject pixel to the left, right, above or below, row-major.
    pub fn edge_pixels(&self) -> impl Iterator<Item = (i32, i32)> {
        self.edge_pixels_in(self.crop.rect())
    }

    /// The [`Self::edge_pixels`] in `window`.
    pub(crate) fn edge_pixels_in(&self, window: Rect) -> impl Iterator<Item = (i32, i32)> {
        const WORD: i32 = mask_crop::WORD as i32;
        let rect = self.crop.rect();
        let window = window.intersection(&rect);
        let words = self.crop.words();
        let boundary = self.derived_tables().boundary.boundary_pixels();
        let columns = (window.x0 - rect.x0) / WORD..(window.x1 - rect.x0 + WORD - 1) / WORD;
        let pixels = (window.y0..window.y1).flat_map(move |y| {
            let row = (y - rect.y0) as usize * words;
            columns.clone().flat_map(move |k| {
                let x = rect.x0 + k * WORD;
                set_bits(boundary[row + k as usize]).map(move |bit| (x + bit as i32, y))
            })
        });

        // The table also holds the pixels along an unknown border, which is not an edge.
        let is_subject = |i, j| self.rect.contains(i, j) && self.is_subject(i, j);
        let is_edge = move |&(i, j): &(i32, i32)| {
            is_subject(i - 1, j) || is_subject(i + 1, j) || is_subject(i, j - 1) || is_subject(i, j + 1)
        };
        pixels.filter(move |&(x, _)| window.x0 <= x && x < window.x1).filter(is_edge)
    }
}

#[cfg(test)]
mod tests;
