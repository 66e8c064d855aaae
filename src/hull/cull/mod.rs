//! Which of many points may be inside: a filter in single precision.
//!
//! ```text
//!   body ─► sphere around it ─► spheres around blocks of its points ─► points
//!           and each view's tiles, distances, bits
//! ```
//!
//! The same answers as [`Hull::inside`](super::Hull::inside), but from the points' frame straight to the images in
//! single precision: a point whose image lies within a few ten-thousandths of a pixel of a pixel's border may count to
//! the other side. Contacts do not rest on that: they use it to leave out what is surely outside by any edge model.

// Loops over the lanes of several arrays say what happens to lane k: it is what the compiler turns into vectors.
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
use filter::Found;
use hull_in_body::HullInBody;
use nalgebra::Isometry3;

/// Memory that is used again and again; it holds what was found last.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    lists: [Vec<BodyView<'static>>; 2],
    found: Found,
}

impl Scratch {
    /// The places in their blocks of the points that are inside, ascending.
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
        Ok(&self.found.places)
    }

    /// Tells `take`, of each of `bodies` by its place, the places in their blocks of the points that may be inside by any
    /// edge model. It is told nothing of bodies that have none, and of those in a pose that is not finite.
    pub(super) fn each_candidate<'b>(
        &mut self,
        hull: &Hull,
        bodies: impl Iterator<Item = (&'b Points, Isometry3<f64>)>,
        mut take: impl FnMut(usize, &'b Points, &[u32]),
    ) {
        self.with_hull(hull, |hull, found| {
            for (body, (points, world_from_points)) in bodies.enumerate() {
                found.places.clear();
                let is_finite = hull.find(points, &world_from_points, MaskDilation::OnePixel, found).is_ok();
                if is_finite && !found.places.is_empty() {
                    take(body, points, &found.places);
                }
            }
        });
    }

    /// Runs `ask` on `hull` as bodies see it.
    fn with_hull<R>(&mut self, hull: &Hull, ask: impl FnOnce(&mut HullInBody, &mut Found) -> R) -> R {
        let lists = std::mem::take(&mut self.lists).map(recycle);
        let mut hull = HullInBody::new(hull, lists);
        let answer = ask(&mut hull, &mut self.found);
        self.lists = hull.into_lists().map(recycle);
        answer
    }
}

#[cfg(test)]
mod tests;
