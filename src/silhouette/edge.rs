//! The edge of a silhouette at one pixel, which gives the exit direction of contacts.

use nalgebra::{Point2, Vector2};

/// Length in pixels below which a mean vector has no reliable direction (paper, section 4.2; the value is chosen here).
pub(crate) const SHORTEST_MEAN: f64 = 0.3;

/// The edge of a silhouette near one of its background pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// A point of the edge, in image coordinates (pixels).
    pub point: Point2<f64>,
    /// Unit normal in the image, pointing from the subject to the background.
    pub normal: Vector2<f64>,
}
