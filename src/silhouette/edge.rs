//! A silhouette's edge at one of its background pixels, for contacts.

use nalgebra::{Point2, Vector2};

/// A mean vector shorter than this, in pixels, has no direction worth trusting (paper, section 4.2; design value).
pub(crate) const SHORTEST_MEAN: f64 = 0.3;

/// A silhouette's edge at one of its background pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// A point of the edge, in image coordinates.
    pub point: Point2<f64>,
    /// Unit normal in the image, from the subject to the background.
    pub normal: Vector2<f64>,
}
