//! Signed Euclidean distances of pixels from a silhouette's edge.
//!
//! ```text
//!      .     .     .     #     #     #     .          . background, # subject
//!     2.5   1.5   0.5  -0.5  -1.5  -0.5   0.5         the edge lies half-way between two pixel centres
//! ```

mod near;
mod transform;

use super::{Border, Rect, Silhouette};
use near::NearScratch;
use transform::{Kinds, Scratch, transform};

/// Euclidean distances of pixels from a silhouette's edge, in pixels: negative inside, positive outside, never 0.
///
/// The distance of a background pixel is the distance from its centre to the nearest centre of a subject pixel, less
/// half a pixel. A subject pixel has the negative of the distance to the nearest background pixel, less half a pixel.
/// So the pixels on both sides of an edge have -0.5 and 0.5. Coverage only matters by which pixels are subject.
///
/// The nearest pixel may lie outside the rectangle of the distances. With [`Border::Background`] it may be background
/// beyond the image. With [`Border::Unknown`] the image's border is not an edge: pixels beyond it count as subject, but
/// distances of background pixels are not measured to them.
///
/// If there is no pixel of the other kind, the distance is [`f32::INFINITY`] for background (an empty mask) and
/// [`f32::NEG_INFINITY`] for subject (a full mask with an unknown border).
///
/// ```
/// use image::{GrayImage, Luma};
/// use ode_visual_hull::silhouette::{Border, Silhouette};
///
/// // The left half of the image is subject.
/// let mask = GrayImage::from_fn(8, 8, |i, _| Luma([if i < 4 { 255 } else { 0 }]));
/// let silhouette = Silhouette::new(&mask, Border::Unknown);
/// let distance = silhouette.signed_distance(&silhouette.image());
/// assert_eq!((distance.at(0, 3), distance.at(3, 3), distance.at(4, 3), distance.at(6, 3)), (-3.5, -0.5, 0.5, 2.5));
/// assert_eq!(distance.sample(4.0, 3.5), 0.0, "the edge lies between pixels 3 and 4");
/// ```
#[derive(Debug, Clone)]
pub struct SignedDistance {
    rect: Rect,
    /// Row-major over `rect`.
    values: Vec<f32>,
    scratch: Scratch,
}

impl Silhouette {
    /// Computes the distances of the pixels of `rect` from the silhouette's edge, negative inside. `rect` may reach
    /// beyond the image.
    pub fn signed_distance(&self, rect: &Rect) -> SignedDistance {
        let mut distance = SignedDistance::default();
        distance.refill(self, rect);
        distance
    }

    /// As [`signed_distance`](Self::signed_distance), but distances of more than [`SignedDistance::NEAR`] pixels, and infinite
    /// ones, are that long: much faster.
    pub fn signed_distance_near_edge(&self, rect: &Rect) -> SignedDistance {
        let mut distance = SignedDistance { rect: *rect, ..SignedDistance::default() };
        distance.values.resize(rect.width() * rect.height(), 0.0);
        if !rect.is_empty() {
            let kinds = Kinds { silhouette: self, domain: domain(self, rect) };
            near::transform(&kinds, rect, &mut distance.values, &mut NearScratch::default());
        }
        distance
    }
}

impl Default for SignedDistance {
    /// Distances of no pixels.
    fn default() -> Self {
        Self { rect: Rect::EMPTY, values: Vec::new(), scratch: Scratch::default() }
    }
}

impl SignedDistance {
    /// The longest distance that [`Silhouette::signed_distance_near_edge`] tells, in pixels.
    pub const NEAR: f32 = near::LONGEST;

    /// Computes the distances of the pixels of `rect` from the edge of `silhouette`, in the memory of the last
    /// distances.
    pub fn refill(&mut self, silhouette: &Silhouette, rect: &Rect) {
        self.rect = if rect.is_empty() { Rect::EMPTY } else { *rect };
        self.values.clear();
        self.values.resize(self.rect.width() * self.rect.height(), 0.0);
        if !self.rect.is_empty() {
            let kinds = Kinds { silhouette, domain: domain(silhouette, rect) };
            transform(&kinds, &self.rect, &mut self.values, &mut self.scratch);
        }
    }

    /// The rectangle of pixels whose distances are known.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// The distances in pixels, row-major over [`Self::rect`].
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The distance of pixel `(i, j)` in pixels. A pixel outside the rectangle has the distance of the rectangle's
    /// nearest pixel. The distance is infinite if the rectangle is empty.
    pub fn at(&self, i: i32, j: i32) -> f32 {
        let (i, j) = (i.min(self.rect.x1 - 1).max(self.rect.x0), j.min(self.rect.y1 - 1).max(self.rect.y0));
        self.values.get(self.rect.index(i, j)).copied().unwrap_or(f32::INFINITY)
    }

    /// The distance at image position `(u, v)` in pixels, bilinear between pixel centres. A position beyond the
    /// rectangle's outermost centres is moved to the nearest position between them.
    pub fn sample(&self, u: f64, v: f64) -> f64 {
        let clamp = |x: f64, first: i32, end: i32| (x - 0.5).min(f64::from(end) - 1.0).max(f64::from(first));
        let (u, v) = (clamp(u, self.rect.x0, self.rect.x1), clamp(v, self.rect.y0, self.rect.y1));

        let (i, j) = (u.floor(), v.floor());
        let at = |di: i32, dj: i32| f64::from(self.at(i as i32 + di, j as i32 + dj));
        let upper = mix(at(0, 0), at(1, 0), u - i);
        let lower = mix(at(0, 1), at(1, 1), u - i);
        mix(upper, lower, v - j)
    }
}

/// Linear interpolation from `from` to `to`, which may be infinite, at the fraction `t`.
fn mix(from: f64, to: f64, t: f64) -> f64 {
    if t == 0.0 || from == to { from } else { from * (1.0 - t) + to * t }
}

/// A rectangle that holds the nearest pixel of the other kind to each pixel of `rect`.
fn domain(silhouette: &Silhouette, rect: &Rect) -> Rect {
    // All subject pixels lie in the subject's rectangle, and no background pixel beyond its rim of one pixel is nearer
    // to a subject pixel than the rim is.
    let edge = match silhouette.border() {
        _ if silhouette.rect().is_empty() => silhouette.image(),
        Border::Background => silhouette.rect().grown(1),
        Border::Unknown => silhouette.rect().grown(1).intersection(&silhouette.image()),
    };
    if edge.is_empty() { *rect } else { rect.union(&edge) }
}

#[cfg(test)]
mod tests;
