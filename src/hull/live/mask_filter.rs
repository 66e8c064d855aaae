//! Corrections of noisy masks, before silhouettes are made from them.

use crate::{Error, Result};

/// Corrections of the masks of a [`HullData`](super::HullData), for segmentations that flicker.
///
/// Each is off by default. [`segment::Cleanup`](crate::segment::Cleanup) corrects single masks in more ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaskFilter {
    /// Holes of fewer pixels than this are filled, in pixels of area. Default 0: none. 2000 heals specks and the holes
    /// of a segmentation at VGA, and closes the gap between a person's arm and side where that is small.
    pub smallest_hole_px: u32,
    /// The weight of a new mask against the filtered last one, above 0 to 1. Default 1: no filter.
    ///
    /// An exponential filter of the signed distances from the edge, along the flow from mask to mask. With weight w it
    /// reduces independent noise of the edge to the root of w / (2 - w) of it: to 0.58 with one half, 0.42 with 0.3, as far
    /// as it varies within 30 pixels along the edge. What moves as a whole moves along the flow and does not lag. What the flow cannot follow, such as a part that appears, lags by
    /// (1 - w) / w masks on average.
    pub new_weight: f64,
}

impl Default for MaskFilter {
    fn default() -> Self {
        Self { smallest_hole_px: 0, new_weight: 1.0 }
    }
}

impl MaskFilter {
    /// # Errors
    /// A weight that is not above 0 and at most 1.
    pub(super) fn check(&self) -> Result<()> {
        if self.new_weight > 0.0 && self.new_weight <= 1.0 {
            return Ok(());
        }
        Err(Error::argument(format!(
            "weight of a new mask: expected a number above 0 and at most 1, found {}; 1 switches the filter off",
            self.new_weight
        )))
    }

    /// Whether masks are averaged over time.
    pub(super) fn averages(&self) -> bool {
        self.new_weight < 1.0
    }
}
