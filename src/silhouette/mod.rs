//! One view's mask, prepared for queries: bounding rectangle, distance to the background, edge normals.
//!
//! A mask holds one byte a pixel, 0 background .. 255 subject; a pixel is *subject* where its byte is at least
//! [`SUBJECT`]. The values between are coverage, the fraction of the pixel that the subject covers, and put the edge
//! inside the pixel. What lies beyond the image is decided by the [`Border`].

mod contact_edge;
mod derived;
mod distance;
mod edge;
mod mask;
mod nearest;
mod neighbours;
mod rect;
mod region;
mod scan;
mod tiles;
mod turned;
mod undistort;

pub(crate) use contact_edge::compute_edges;
pub(crate) use derived::Derived;
pub use edge::Edge;
pub(crate) use edge::EdgePixel;
pub use mask::load_mask;
pub use rect::Rect;
pub(crate) use undistort::TileMask;
pub use undistort::Undistortion;

use crate::Result;
use image::GrayImage;
use region::Region;
pub(crate) use region::{LOW, Word};
use scan::{Columns, Scan};
pub(crate) use tiles::{Lookup, Tiles};
use turned::Turned;

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
    Open,
}

/// What is prepared of a silhouette: tables over its rectangle and some pixels around, row-major.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tables<'a> {
    /// Column and row of the first pixel.
    pub(crate) corner: (i32, i32),
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Words in a row of bits.
    pub(crate) words: usize,
    /// Subject pixels, 32 a word, the first in the lowest bit.
    pub(crate) subject: &'a [Word],
    /// Subject pixels and those around each.
    pub(crate) near: &'a [Word],
    turned: &'a Turned,
    /// Chebyshev distances; 255 for all that are larger than 254.
    pub(crate) distance: &'a [u8],
    /// The same, four a word as they lie in memory.
    pub(crate) distance_words: &'a [u32],
    pub(crate) tiles: &'a Tiles,
}

impl<'a> Tables<'a> {
    /// Subject pixels by columns, column-major, and how many words a column has.
    pub(crate) fn columns(&self) -> (&'a [Word], usize) {
        self.turned.columns(self.subject, self.words)
    }
}

/// One view's mask, prepared. Immutable while it is shared, so that any number of threads may ask it.
///
/// What is kept of the mask are the subject's rectangle and eight pixels around it. Bytes farther out, which can only
/// be coverage below one half, count as background.
#[derive(Debug)]
pub struct Silhouette {
    border: Border,
    image: Rect,
    rect: Rect,
    has_coverage: bool,
    region: Region,
    derived: Derived,
    /// Whether what is derived is at hand, and not lent to another silhouette.
    is_whole: bool,
    columns: Columns,
}

impl Silhouette {
    /// Prepares `mask`. Any image is accepted; an empty or a full one simply has no edge.
    pub fn new(mask: &GrayImage, border: Border) -> Self {
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
            region: Region::default(),
            derived: Derived::default(),
            is_whole: true,
            columns: Columns::default(),
        }
    }

    /// Prepares another mask in the memory of the last one.
    pub fn refill(&mut self, mask: &GrayImage, border: Border) {
        let scan = self.columns.scan(mask);
        self.take_scanned(mask, scan, border);
    }

    /// Prepares another mask in the memory of the last one, unless every pixel of it is subject: whether it did so.
    pub(crate) fn refill_unless_full(&mut self, mask: &GrayImage, border: Border) -> bool {
        let scan = self.columns.scan(mask);
        if !scan.is_full {
            self.take_scanned(mask, scan, border);
        }
        !scan.is_full
    }

    /// Prepares what the pinhole of `lens` sees of a mask, unless every pixel of that is subject: whether it did so.
    ///
    /// # Errors
    /// A mask of another size than the original camera's image.
    pub(crate) fn refill_undistorted(
        &mut self,
        mask: &GrayImage,
        lens: &Undistortion,
        border: Border,
        tiles: &mut TileMask,
    ) -> Result<bool> {
        if lens.draw(mask, region::value_beyond(border), tiles)? {
            return Ok(false);
        }
        (self.image, self.rect) = (tiles.image(), tiles.find_rect());
        (self.border, self.has_coverage) = (border, tiles.has_coverage());
        self.region.fill_from_tiles(tiles, &self.rect, border);
        self.derived.fill(&self.region);
        self.is_whole = true;
        Ok(true)
    }

    fn take_scanned(&mut self, mask: &GrayImage, scan: Scan, border: Border) {
        self.image = Rect::of_image(mask.width(), mask.height());
        (self.border, self.rect, self.has_coverage) = (border, scan.rect, scan.has_coverage);
        self.region.fill(mask, &scan, border);
        self.derived.fill(&self.region);
        self.is_whole = true;
    }

    /// Gives away the memory of what is derived. Nothing but [`Self::restore`] and [`Self::refill`] may be asked then.
    pub(crate) fn lend(&mut self) -> Option<Derived> {
        std::mem::take(&mut self.is_whole).then(|| std::mem::take(&mut self.derived))
    }

    /// Memory for what is derived of the next mask.
    pub(crate) fn borrow(&mut self, memory: Derived) {
        self.derived = memory;
    }

    /// Derives again what was lent.
    pub(crate) fn restore(&mut self) {
        if !std::mem::replace(&mut self.is_whole, true) {
            self.derived.fill(&self.region);
        }
    }

    /// Bytes of memory for what is prepared, beside the mask's own bytes.
    pub fn working_memory(&self) -> usize {
        self.region.working_memory() + self.derived.working_memory() + self.columns.working_memory()
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
        match self.region.byte(i, j) {
            Some(byte) => byte,
            None if self.border == Border::Open && !self.image.contains(i, j) => 255,
            None => 0,
        }
    }

    /// Whether pixel `(i, j)` is subject.
    pub fn is_subject(&self, i: i32, j: i32) -> bool {
        match self.region.is_subject(i, j) {
            Some(is_subject) => is_subject,
            None => self.border == Border::Open && !self.image.contains(i, j),
        }
    }

    /// Pixels (Chebyshev) from `(i, j)` to the nearest background pixel: 0 where it is background itself,
    /// [`u16::MAX`] where there is none.
    pub fn distance(&self, i: i32, j: i32) -> u16 {
        if self.rect.contains(i, j) {
            self.derived.distances.at(self.region.rect().index(i, j))
        } else if self.border == Border::Open && !self.image.contains(i, j) {
            distance::NO_EDGE
        } else {
            0
        }
    }

    /// The distance at a place of the table.
    #[inline]
    pub(crate) fn distance_at(&self, place: usize) -> u16 {
        self.derived.distances.at(place)
    }

    /// The tables themselves, for queries of many points.
    pub(crate) fn tables(&self) -> Tables<'_> {
        let rect = self.region.rect();
        Tables {
            corner: (rect.x0, rect.y0),
            width: rect.width(),
            height: rect.height(),
            words: self.region.words(),
            subject: self.region.subject(),
            near: self.derived.neighbours.near(),
            turned: &self.derived.turned,
            distance: self.derived.distances.narrow(),
            distance_words: self.derived.distances.narrow_words(),
            tiles: &self.derived.tiles,
        }
    }

    /// Coverage at image position `(u, v)`, 0 to 255, bilinear between pixel centres.
    pub fn coverage(&self, u: f64, v: f64) -> f64 {
        let (i, j) = ((u - 0.5).floor(), (v - 0.5).floor());
        let (x, y) = (u - 0.5 - i, v - 0.5 - j);
        let [c00, c10, c01, c11] = self.cell(i as i32, j as i32);
        (c00 * (1.0 - x) + c10 * x) * (1.0 - y) + (c01 * (1.0 - x) + c11 * x) * y
    }

    /// The bytes at the corners of the bilinear cell between the centres of pixels `(i, j)` and `(i + 1, j + 1)`.
    pub(crate) fn cell(&self, i: i32, j: i32) -> [f64; 4] {
        let bytes = match (self.region.row::<2>(i, j), self.region.row::<2>(i, j + 1)) {
            (Some([a, b]), Some([c, d])) => [a, b, c, d],
            _ => [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| self.value(i, j)),
        };
        bytes.map(f64::from)
    }

    /// The background pixels with a subject pixel beside, above or below, row-major.
    pub fn edge_pixels(&self) -> impl Iterator<Item = (i32, i32)> {
        let rect = self.region.rect();
        let words = self.region.words().max(1);
        let subject = |i, j| self.rect.contains(i, j) && self.is_subject(i, j);
        let beside = move |(i, j): (i32, i32)| {
            subject(i - 1, j) || subject(i + 1, j) || subject(i, j - 1) || subject(i, j + 1)
        };
        let word = move |(k, &word): (usize, &Word)| {
            let (x, y) = (rect.x0 + (k % words * region::WORD) as i32, rect.y0 + (k / words) as i32);
            (0..region::WORD as i32).filter(move |bit| word >> bit & 1 == 1).map(move |bit| (x + bit, y))
        };
        // The table holds pixels beside an open border too, which is no edge.
        self.derived.neighbours.edges().iter().enumerate().flat_map(word).filter(move |&pixel| beside(pixel))
    }
}

#[cfg(test)]
mod tests;
