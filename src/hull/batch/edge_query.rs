//! A point inside, in the view that decides its window search.

use super::projection::ViewKernel;
use crate::hull::query::towards;
use crate::silhouette::Edge;
use crate::silhouette::ring_search::NEAR;
use nalgebra::Point2;

/// Index of the list of points whose background is near.
pub(super) const NEAR_LIST: usize = 0;
/// Index of the list of points whose background is farther away.
pub(super) const FAR_LIST: usize = 1;
/// Index of the list of points whose search may reach beyond an open border.
pub(super) const OPEN_LIST: usize = 2;

/// A point, as projected into the view that decides.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeQuery {
    /// Index of the point's ray.
    pub(super) ray: u32,
    pub(super) pixel: (i32, i32),
    /// Chebyshev distance to the background, in pixels: half-width of the first window that holds any.
    pub(super) first: i32,
    /// Half-width of the window in which the nearest background is searched for, in pixels.
    pub(super) half: i32,
}

impl EdgeQuery {
    /// Index of the list that the query belongs to.
    #[inline(always)]
    pub(super) fn list(&self, kernel: &ViewKernel) -> usize {
        // The nearest background lies within sqrt(2) times the Chebyshev distance.
        let reach = self.first + self.first / 2 + 1;
        if !kernel.is_closed && !kernel.view.silhouette().keeps_window(self.pixel, reach) {
            OPEN_LIST
        } else if self.first > NEAR {
            FAR_LIST
        } else {
            NEAR_LIST
        }
    }

    /// The background pixel nearest to the point, found by the search of the single query.
    pub(super) fn find_nearest_scalar(&self, kernel: &ViewKernel) -> (i32, i32) {
        let (i, j) = self.pixel;
        kernel.view.silhouette().nearest_background(i, j, self.half).unwrap_or(self.pixel)
    }

    /// The replacement of an edge without a normal: a line through pixel `(i, j)` across the offset from the point's
    /// pixel.
    #[inline(always)]
    pub(super) fn edge_towards(&self, (i, j): (i32, i32)) -> Edge {
        Edge {
            point: Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5),
            normal: towards(i - self.pixel.0, j - self.pixel.1),
        }
    }
}
