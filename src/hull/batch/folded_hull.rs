//! A hull folded for a call: its enabled views and its work volume, and which points of a body are inside.

use super::super::Hull;
use super::super::points::Points;
use super::fold::{Folded, Posed, Volume};
use super::inside::{self, Found, Within};
use crate::Result;
use nalgebra::Isometry3;

/// A hull as points of the volume's frame see it.
#[derive(Debug)]
pub(super) struct FoldedHull<'a> {
    pub(super) hull: &'a Hull,
    pub(super) volume: Volume,
    /// Folded once a body comes near.
    pub(super) views: Vec<Folded<'a>>,
    /// The views as the body asked last sees them.
    posed: Vec<Folded<'a>>,
}

impl<'a> FoldedHull<'a> {
    /// Folds `hull` in the memory of two lists.
    pub(super) fn new(hull: &'a Hull, [views, posed]: [Vec<Folded<'a>>; 2]) -> Self {
        Self { hull, volume: Volume::of(hull), views, posed }
    }

    pub(super) fn into_lists(self) -> [Vec<Folded<'a>>; 2] {
        [self.views, self.posed]
    }

    /// Finds the points inside, or, with [`Within::NearSubject`], of all but those surely outside by any
    /// edge model.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub(super) fn find(
        &mut self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        within: Within,
        found: &mut Found,
    ) -> Result<Posed> {
        let posed = Posed::new(points, world_from_points, &self.volume)?;
        let middle = self.volume.in_world(posed.middle());
        let is_near = self.hull.may_touch(&middle, f64::from(posed.radius) + 1e-6);
        if points.is_empty() || self.hull.aabb().is_empty() || !is_near {
            return Ok(posed);
        }
        if self.views.is_empty() {
            let enabled = self.hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
            self.views.extend(enabled.map(|(index, view)| Folded::new(view, index, &self.volume)));
        }
        if !self.hull.every_view_tells() {
            let inside = |&place: &u32| {
                let p = self.volume.in_world(posed.place(points.at(place as usize)));
                within == Within::NearSubject || self.hull.inside(&p)
            };
            found.places.extend((0..points.len() as u32).filter(inside));
            return Ok(posed);
        }
        if !inside::may_be_seen(&self.views, &posed, within) {
            return Ok(posed);
        }
        self.posed.clear();
        self.posed.extend(self.views.iter().map(|view| view.seen_from(&posed)));
        let cut = within == Within::Subject && !self.volume.holds(&posed);
        let cut = cut.then_some((&self.volume, &posed));
        inside::find(points, &self.posed, cut, within, found);
        Ok(posed)
    }
}
