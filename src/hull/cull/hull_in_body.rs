//! A hull as seen from a body's frame: its enabled views and its work volume, and which points of a body are inside.

use super::body_view::{BodyPlacement, BodyView, MaskDilation, Volume};
use super::filter::{self, Filter, FoundPoints};
use crate::Result;
use crate::hull::Hull;
use crate::math::point_cloud::Points;
use nalgebra::Isometry3;

/// A hull, with its views as seen from the volume's frame and from a body's frame.
#[derive(Debug)]
pub(super) struct HullInBody<'a> {
    hull: &'a Hull,
    volume: Volume,
    /// The views as seen from the volume's frame; filled when the first body comes near.
    views: Vec<BodyView<'a>>,
    /// The views as seen from the frame of the last body that was queried.
    placed: Vec<BodyView<'a>>,
}

impl<'a> HullInBody<'a> {
    /// Prepares `hull`, in the memory of two lists.
    pub(super) fn new(hull: &'a Hull, [views, placed]: [Vec<BodyView<'a>>; 2]) -> Self {
        Self { hull, volume: Volume::of(hull), views, placed }
    }

    pub(super) fn into_lists(self) -> [Vec<BodyView<'a>>; 2] {
        [self.views, self.placed]
    }

    /// Adds to `found` the points of a body that are inside, or, with [`MaskDilation::OnePixel`], all but those surely
    /// outside by either edge model.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub(super) fn find(
        &mut self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        dilation: MaskDilation,
        found: &mut FoundPoints,
    ) -> Result<()> {
        // A body far from the hull's box. The micrometre covers the rounding of its middle.
        let placement = BodyPlacement::new(points, world_from_points, &self.volume)?;
        let middle = self.volume.in_world(placement.middle());
        let is_near = self.hull.may_touch(&middle, f64::from(placement.radius) + 1e-6);
        if points.is_empty() || self.hull.aabb().is_empty() || !is_near {
            return Ok(());
        }

        if self.views.is_empty() {
            let enabled = self.hull.views().iter().filter(|view| view.is_enabled());
            self.views.extend(enabled.map(|view| BodyView::new(self.hull, view, &self.volume)));
        }

        // Candidates are not cut off at the work volume: a point beyond it is rejected later, in double precision.
        let is_cut = dilation == MaskDilation::None && !self.volume.holds(&placement);
        let cut = is_cut.then_some((&self.volume, &placement));
        let may_overrule = self.hull.overrule_depth().is_some();
        let filter = Filter { dilation, unseen: self.hull.unseen(), may_overrule, cut };

        // The sphere around the body first, then its blocks and points.
        if filter::may_be_inside(&self.views, &placement, &filter) {
            self.placed.clear();
            self.placed.extend(self.views.iter().map(|view| view.seen_from(&placement)));
            filter::find(points, &self.placed, &filter, found);
        }
        Ok(())
    }
}
