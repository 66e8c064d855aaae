//! A filter in single precision that finds which of many points may be inside.
//!
//! ```text
//!   body ─► sphere around it ─► spheres around blocks of its points ─► points
//!           tested against each view's occupancy, distances and bits
//! ```
//!
//! It gives the results of [`Hull::inside`](super::Hull::inside), but projects points from their own frame straight
//! into the images, in single precision: a point whose image lies within a few ten-thousandths of a pixel of a pixel's
//! border may be counted to the neighbouring pixel. Contacts do not depend on that, since they use the filter only to
//! discard points that are surely outside by either edge model.

// Loops over lanes index several arrays by k: this is the form that the compiler vectorises.
#![allow(clippy::needless_range_loop)]

mod body_view;
mod filter;
mod hull_in_body;

use super::Hull;
use crate::Result;
use crate::math::point_cloud::Points;
use crate::recycle::recycle;
use body_view::BodyView;
use body_view::MaskDilation;
use filter::FoundPoints;
use hull_in_body::HullInBody;
use nalgebra::Isometry3;

/// Memory that queries reuse. It holds the points found last.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    lists: [Vec<BodyView<'static>>; 2],
    found: FoundPoints,
}

impl Scratch {
    /// The places, in the blocks, of the points that are inside, ascending.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub(super) fn find_inside(
        &mut self,
        hull: &Hull,
        points: &Points,
        world_from_points: &Isometry3<f64>,
    ) -> Result<&[u32]> {
        self.with_hull(hull, |hull, found| {
            found.places.clear();
            hull.find(points, world_from_points, MaskDilation::None, found)
        })?;

        // Of the points that one view sees outside, those are inside where it is overruled.
        if hull.overrule_depth().is_some() {
            let is_inside = |place: usize| hull.inside(&(world_from_points * points.at(place)));
            self.found.places.retain(|&place| is_inside(place as usize));
        }
        Ok(&self.found.places)
    }

    /// Calls `visit` for each of `bodies` that has points that may be inside by some edge model: with the body's index,
    /// its points, and the places of those points in the blocks. Bodies in a pose that is not finite are skipped.
    pub(super) fn each_candidate<'b>(
        &mut self,
        hull: &Hull,
        bodies: impl Iterator<Item = (&'b Points, Isometry3<f64>)>,
        mut visit: impl FnMut(usize, &'b Points, &[u32]),
    ) {
        self.with_hull(hull, |hull, found| {
            for (body, (points, world_from_points)) in bodies.enumerate() {
                found.places.clear();

                let is_finite = hull.find(points, &world_from_points, MaskDilation::OnePixel, found).is_ok();
                if is_finite && !found.places.is_empty() {
                    visit(body, points, &found.places);
                }
            }
        });
    }

    /// Runs `query` with `hull` as bodies see it.
    fn with_hull<R>(&mut self, hull: &Hull, query: impl FnOnce(&mut HullInBody, &mut FoundPoints) -> R) -> R {
        let lists = std::mem::take(&mut self.lists).map(recycle);
        let mut hull = HullInBody::new(hull, lists);
        let result = query(&mut hull, &mut self.found);
        self.lists = hull.into_lists().map(recycle);
        result
    }
}

#[cfg(test)]
mod tests;
