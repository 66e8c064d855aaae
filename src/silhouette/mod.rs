//! One view's mask, prepared for queries: bounding rectangle, distance to the background, edge normals.
//!
//! A mask holds one byte a pixel, 0 background .. 255 subject; a pixel is *subject* where its byte is at least
//! [`SUBJECT`]. The values between are coverage, the fraction of the pixel that the subject covers, and put the edge
//! inside the pixel. What lies beyond the image is decided by the [`Border`].

mod distance;
mod edge;
mod mask;
mod rect;
mod undistort;

pub use edge::Edge;
pub use mask::load_mask;
pub use rect::Rect;
pub use undistort::Undistortion;

use image::GrayImage;

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

/// One view's mask, prepared. Immutable, so that any number of threads may ask it.
#[derive(Debug)]
pub struct Silhouette {
    mask: GrayImage,
    border: Border,
    image: Rect,
    rect: Rect,
    has_coverage: bool,
    /// Chebyshev distance in pixels to the nearest background pixel, row-major over `rect`.
    distance: Vec<u16>,
    edges: edge::EdgeTable,
}

impl Silhouette {
    /// Prepares `mask`. Any image is accepted; an empty or a full one simply has no edge.
    pub fn new(mask: GrayImage, border: Border) -> Self {
        let image = Rect::of_image(mask.width(), mask.height());
        let rect = subject_rect(&mask);
        let is_subject = |i: i32, j: i32| mask.get_pixel(i as u32, j as u32).0[0] >= SUBJECT;
        let distance = distance::chebyshev(&image, &rect, border, is_subject);
        let has_coverage = mask.as_raw().iter().any(|&byte| byte != 0 && byte != 255);
        let mut silhouette =
            Self { mask, border, image, rect, has_coverage, distance, edges: edge::EdgeTable::default() };
        silhouette.edges = edge::EdgeTable::of(&silhouette);
        silhouette
    }

    /// The mask as it was given.
    pub fn mask(&self) -> &GrayImage {
        &self.mask
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
        if self.image.contains(i, j) {
            self.mask.as_raw()[self.image.index(i, j)]
        } else {
            match self.border {
                Border::Background => 0,
                Border::Open => 255,
            }
        }
    }

    /// Whether pixel `(i, j)` is subject.
    pub fn is_subject(&self, i: i32, j: i32) -> bool {
        self.value(i, j) >= SUBJECT
    }

    /// Pixels (Chebyshev) from `(i, j)` to the nearest background pixel: 0 where it is background itself,
    /// [`u16::MAX`] where there is none.
    pub fn distance(&self, i: i32, j: i32) -> u16 {
        if self.rect.contains(i, j) {
            self.distance[self.rect.index(i, j)]
        } else if self.border == Border::Open && !self.image.contains(i, j) {
            distance::NO_EDGE
        } else {
            0
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
        [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| f64::from(self.value(i, j)))
    }

    /// The background pixel nearest to `(i, j)` (Euclidean, then row-major) within the window of half-width `half`.
    pub fn nearest_background(&self, i: i32, j: i32, half: i32) -> Option<(i32, i32)> {
        let first = i32::from(self.distance(i, j));
        if first == 0 {
            return Some((i, j));
        }
        let mut best: Option<(i64, i32, i32)> = None;
        let mut ring = first;
        // A ring at Chebyshev radius r holds nothing nearer than r, so the search ends where r exceeds the best.
        while ring <= half && best.is_none_or(|(squared, ..)| i64::from(ring).pow(2) <= squared) {
            let candidates = ring_pixels(i, j, ring).filter(|&(x, y)| !self.is_subject(x, y));
            let nearest = candidates.map(|(x, y)| (squared_distance(i, j, x, y), y, x)).min();
            best = best.into_iter().chain(nearest).min();
            ring += 1;
        }
        best.map(|(_, y, x)| (x, y))
    }

    /// The contact normal and edge point at background pixel `(i, j)`, computed once a pixel.
    pub fn edge(&self, i: i32, j: i32) -> Option<Edge> {
        self.edges.get(self, i, j)
    }

    /// The background pixels with a subject pixel beside, above or below, row-major.
    pub fn edge_pixels(&self) -> impl Iterator<Item = (i32, i32)> {
        self.edges.pixels()
    }
}

fn squared_distance(i: i32, j: i32, x: i32, y: i32) -> i64 {
    (i64::from(x) - i64::from(i)).pow(2) + (i64::from(y) - i64::from(j)).pow(2)
}

/// The pixels at Chebyshev distance `radius` from `(i, j)`.
fn ring_pixels(i: i32, j: i32, radius: i32) -> impl Iterator<Item = (i32, i32)> {
    let rows = (i - radius..=i + radius).flat_map(move |x| [(x, j - radius), (x, j + radius)]);
    let columns = (j - radius + 1..j + radius).flat_map(move |y| [(i - radius, y), (i + radius, y)]);
    rows.chain(columns)
}

fn subject_rect(mask: &GrayImage) -> Rect {
    let mut rect = Rect { x0: i32::MAX, y0: i32::MAX, x1: i32::MIN, y1: i32::MIN };
    for (j, row) in mask.rows().enumerate() {
        let subject = |byte: &image::Luma<u8>| byte.0[0] >= SUBJECT;
        let mut columns = row.enumerate().filter(|(_, byte)| subject(byte)).map(|(i, _)| i as i32);
        if let Some(first) = columns.next() {
            let last = columns.next_back().unwrap_or(first);
            rect.x0 = rect.x0.min(first);
            rect.x1 = rect.x1.max(last + 1);
            rect.y0 = rect.y0.min(j as i32);
            rect.y1 = j as i32 + 1;
        }
    }
    if rect.is_empty() { Rect::EMPTY } else { rect }
}

#[cfg(test)]
mod tests;
