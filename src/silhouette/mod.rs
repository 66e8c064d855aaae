//! One view's mask, prepared for queries: bounding rectangle, distance to the background, edge normals; and on demand
//! signed distances from its edge on both sides.
//!
//! A mask holds one byte a pixel, 0 background .. 255 subject; a pixel is *subject* where its byte is at least
//! [`SUBJECT`]. The values between are coverage, the fraction of the pixel that the subject covers, and put the edge
//! inside the pixel. What lies beyond the image is decided by the [`Border`].

pub(crate) mod bit_image;
mod boundary;
mod cell_distance;
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
mod nearest;
mod occupancy;
mod packed_mask;
mod paper_normal;
pub(crate) mod ring_search;
mod run_length;
mod signed_distance;
mod tables;
mod transposed;
mod undistort;

pub use crate::math::rect::Rect;
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
pub use packed_mask::PackedMask;
pub use signed_distance::SignedDistance;
pub(crate) use tables::{TableSlices, Tables};
pub(crate) use undistort::TileMask;
pub use undistort::Undistortion;

use crate::Result;
use image::GrayImage;
use mask_crop::MaskCrop;
pub(crate) use mask_crop::Word;
pub(crate) use occupancy::OccupancyLookup;
use std::sync::OnceLock;

/// A pixel is subject from this byte upwards: covered by half or more.
pub const SUBJECT: u8 = 128;

/// The bilinear coverage at which the edge lies, in the units of a mask's bytes.
pub const HALF_COVERAGE: f64 = 127.5;

/// What the pixels beyond the image count as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// Background: the image's border cuts the silhouette off.
    Background,
    /// Nothing is known there: the image's border is no edge of the silhouette.
    Unknown,
}

/// One view's mask, prepared. Immutable while it is shared, so that any number of threads may ask it.
///
/// What is kept of the mask are the subject's rectangle and eight pixels around it. Bytes farther out, which can only
/// be coverage below one half, count as background.
///
/// Its tables are derived from these bits with the mask. Their memory may be taken for another mask once the silhouette
/// is past; the first query that needs them afterwards derives them again, with the same answers.
#[derive(Debug)]
pub struct Silhouette {
    border: Border,
    image: Rect,
    rect: Rect,
    has_coverage: bool,
    crop: MaskCrop,
    /// What follows from `region`. Not there after [`Self::take_tables`], until a query derives it again.
    tables: OnceLock<Tables>,
    /// Memory for the tables of the next mask. It holds those of another mask, which are never looked up.
    recycled_tables: Option<Tables>,
}

impl Silhouette {
    /// Prepares `mask`. Any image is accepted; an empty or a full one simply has no edge.
    pub fn new<'a>(mask: impl Into<MaskView<'a>>, border: Border) -> Self {
        let mut silhouette = Self::blank(border);
        silhouette.refill(mask, border);
        silhouette
    }

    /// A silhouette of no image at all.
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

    /// Prepares another mask, packed already, in the memory of the last one.
    pub fn refill_packed(&mut self, mask: &PackedMask, border: Border) {
        self.fill_region(|silhouette| {
            let (width, height) = mask.size();
            (silhouette.image, silhouette.rect) = (Rect::of_image(width, height), mask.rect());
            (silhouette.border, silhouette.has_coverage) = (border, mask.has_coverage());
            silhouette.crop.fill(mask, border);
        });
    }

    /// Prepares what the pinhole of `lens` sees of a mask, unless every pixel of that is subject: whether it did so.
    ///
    /// # Errors
    /// A mask of another size than the original camera's image.
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
        self.fill_region(|silhouette| {
            (silhouette.image, silhouette.rect) = (tiles.image(), tiles.find_rect());
            (silhouette.border, silhouette.has_coverage) = (border, tiles.has_coverage());
            silhouette.crop.fill_from_tiles(tiles, &silhouette.rect, border);
        });
        Ok(true)
    }

    /// Takes up other bits by `fill`, and derives their tables.
    fn fill_region(&mut self, fill: impl FnOnce(&mut Self)) {
        // Taken out first, so that tables and bits never are those of different masks.
        let tables = self.tables.take().or_else(|| self.recycled_tables.take());
        fill(self);

        // Derived here, on the thread that brings the mask, so that no query of the newest frame waits.
        let mut tables = tables.unwrap_or_default();
        tables.fill(&self.crop);
        self.tables = OnceLock::from(tables);
    }

    /// Takes the tables out, as memory for those of another mask. The next query derives them again.
    pub(crate) fn take_tables(&mut self) -> Option<Tables> {
        self.tables.take()
    }

    /// Keeps `tables` as memory for those of the next mask, which [`Self::refill`] prepares.
    pub(crate) fn recycle_tables(&mut self, tables: Tables) {
        self.recycled_tables = Some(tables);
    }

    /// The tables, derived here where they have been taken out. A loop over many points fetches them once.
    #[inline(always)]
    fn derived_tables(&self) -> &Tables {
        self.tables.get_or_init(|| Tables::new(&self.crop))
    }

    /// Bytes of memory for what is prepared, beside the mask's own bytes.
    pub fn working_memory(&self) -> usize {
        let tables = self.tables.get().into_iter().chain(&self.recycled_tables);
        let tables: usize = tables.map(Tables::working_memory).sum();
        self.crop.working_memory() + tables
    }

    /// The mask, as far as it is kept.
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

    /// What the pixels beyond the image count as.
    pub fn border(&self) -> Border {
        self.border
    }

    /// Whether any byte lies strictly between 0 and 255, so that edges are known inside their pixels.
    pub fn has_coverage(&self) -> bool {
        self.has_coverage
    }

    /// The byte of pixel `(i, j)`; beyond the image 0 or, where the border is open, 255.
    pub fn value(&self, i: i32, j: i32) -> u8 {
        match self.crop.byte(i, j) {
            Some(byte) => byte,
            None if self.border == Border::Unknown && !self.image.contains(i, j) => 255,
            None => 0,
        }
    }

    /// Whether pixel `(i, j)` is subject.
    pub fn is_subject(&self, i: i32, j: i32) -> bool {
        match self.crop.is_subject(i, j) {
            Some(is_subject) => is_subject,
            None => self.border == Border::Unknown && !self.image.contains(i, j),
        }
    }

    /// Whether the image holds all that is kept of the mask, so that lines out of the subject come to background first.
    pub(crate) fn is_framed_by_background(&self) -> bool {
        let region = self.crop.rect();
        region.intersection(&self.image) == region
    }

    /// Whether the window of half-width `reach` around pixel `(i, j)` lies in what is kept of the mask.
    pub(crate) fn keeps_window(&self, (i, j): (i32, i32), reach: i32) -> bool {
        let region = self.crop.rect();
        region.contains(i - reach, j - reach) && region.contains(i + reach, j + reach)
    }

    /// Pixels (Chebyshev) from `(i, j)` to the nearest background pixel: 0 where it is background itself,
    /// [`u16::MAX`] where there is none.
    pub fn distance(&self, i: i32, j: i32) -> u16 {
        if self.rect.contains(i, j) {
            self.derived_tables().distances.at(self.crop.rect().index(i, j))
        } else if self.border == Border::Unknown && !self.image.contains(i, j) {
            NO_EDGE
        } else {
            0
        }
    }

    /// The distance at a place of the table.
    #[inline]
    pub(crate) fn distance_at(&self, place: usize) -> u16 {
        self.derived_tables().distances.at(place)
    }

    /// The distance of the square between four pixel centres whose upper left pixel is at a place of the table.
    #[cold]
    pub(crate) fn cell_distance_at(&self, place: usize) -> u16 {
        let tables = self.derived_tables();
        tables.cell_distances.at(place, &tables.distances)
    }

    /// The table of contact edges.
    fn edge_table(&self) -> &edge_table::EdgeTable {
        &self.derived_tables().edges
    }

    /// The tables as slices, for queries of many points.
    pub(crate) fn tables(&self) -> TableSlices<'_> {
        self.derived_tables().slices(&self.crop)
    }

    /// Coverage at image position `(u, v)`, 0 to 255, bilinear between pixel centres.
    #[inline]
    pub fn coverage(&self, u: f64, v: f64) -> f64 {
        // `f64::floor` is a call on processors without SSE 4.1, the least that is built for.
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

    /// The background pixels with a subject pixel beside, above or below, row-major.
    pub fn edge_pixels(&self) -> impl Iterator<Item = (i32, i32)> {
        let rect = self.crop.rect();
        let words = self.crop.words().max(1);
        let subject = |i, j| self.rect.contains(i, j) && self.is_subject(i, j);
        let beside = move |(i, j): (i32, i32)| {
            subject(i - 1, j) || subject(i + 1, j) || subject(i, j - 1) || subject(i, j + 1)
        };
        let word = move |(k, &word): (usize, &Word)| {
            let (x, y) = (rect.x0 + (k % words * mask_crop::WORD) as i32, rect.y0 + (k / words) as i32);
            (0..mask_crop::WORD as i32).filter(move |bit| word >> bit & 1 == 1).map(move |bit| (x + bit, y))
        };
        // The table holds pixels beside an open border too, which is no edge.
        self.derived_tables()
            .boundary
            .boundary_pixels()
            .iter()
            .enumerate()
            .flat_map(word)
            .filter(move |&pixel| beside(pixel))
    }
}

#[cfg(test)]
mod tests;
