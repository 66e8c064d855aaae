//! All views' walks along one half-line, merged in the order of their changes: where the hull begins and ends on it.

use super::line_walk::MaskTraversal;
use crate::hull::{EdgeModel, Hull, Verdict, View};
use nalgebra::{Point3, Vector3};

/// Where a half-line crosses the hull's surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing<'a> {
    pub(super) t: f64,
    /// The view whose silhouette ends there; `None` at the side of the work volume.
    pub(super) view: Option<&'a View>,
    /// The outward normal of the work volume's side, where that ends the hull.
    pub(super) wall: Vector3<f64>,
}

/// A walk along a half-line through the whole hull.
pub(super) struct IntervalMerge<'a> {
    hull: &'a Hull,
    marches: Vec<MaskTraversal<'a>>,
    t: f64,
    latest: Option<usize>,
    wall_entry: (f64, Vector3<f64>),
    wall_exit: f64,
    direction: Vector3<f64>,
    origin: Point3<f64>,
}

impl<'a> IntervalMerge<'a> {
    /// `None` where the half-line misses the work volume.
    pub(super) fn new(
        hull: &'a Hull,
        origin: &Point3<f64>,
        direction: &Vector3<f64>,
        edge: EdgeModel,
    ) -> Option<Self> {
        let (entry, exit, normal) = hull.bounds().span(origin, direction)?;
        let marches =
            hull.enabled_views().map(|view| MaskTraversal::new(view, origin, direction, edge)).collect();
        let (direction, origin) = (*direction, *origin);
        let wall_entry = (entry, normal);
        Some(Self { hull, marches, t: 0.0, latest: None, wall_entry, wall_exit: exit, direction, origin })
    }

    /// The first point from here on that the hull contains.
    pub(super) fn entry(&mut self) -> Option<Crossing<'a>> {
        self.advance_to(self.wall_entry.0);
        self.latest = None;
        while !self.inside() {
            if !self.advance() {
                return None;
            }
        }
        let view = self.latest.map(|k| self.marches[k].view());
        Some(Crossing { t: self.t, view, wall: self.wall_entry.1 })
    }

    /// The first point from here on that the hull does not contain.
    pub(super) fn exit(&mut self) -> Crossing<'a> {
        while self.inside() {
            if !self.advance() {
                let (_, wall) = self.hull.bounds().exit(&self.origin, &self.direction);
                return Crossing { t: self.wall_exit, view: None, wall };
            }
        }
        Crossing { t: self.t, view: self.latest_view(), wall: Vector3::zeros() }
    }

    fn inside(&self) -> bool {
        let count = |wanted: Verdict| self.marches.iter().filter(|march| march.verdict() == wanted).count();
        let (inside, outside) = (count(Verdict::Inside), count(Verdict::Outside));
        self.hull.unseen().decides_inside(inside, outside, self.marches.len())
    }

    /// The view that changed last; before any change, the first that does not see the point inside.
    fn latest_view(&self) -> Option<&'a View> {
        let unmoved = || self.marches.iter().position(|march| march.verdict() != Verdict::Inside);
        self.latest.or_else(unmoved).map(|k| self.marches[k].view())
    }

    fn advance_to(&mut self, t: f64) {
        while self.soonest().is_some_and(|k| self.marches[k].until() <= t) {
            self.advance();
        }
        self.t = self.t.max(t);
    }

    /// Steps the view whose verdict may change soonest; false where the work volume ends before that.
    fn advance(&mut self) -> bool {
        let Some(k) = self.soonest() else { return false };
        let march = &mut self.marches[k];
        if march.until() >= self.wall_exit {
            return false;
        }
        self.t = self.t.max(march.until());
        march.step();
        self.latest = Some(k);
        true
    }

    /// Ties go to the first view.
    fn soonest(&self) -> Option<usize> {
        (0..self.marches.len()).min_by(|&a, &b| self.marches[a].until().total_cmp(&self.marches[b].until()))
    }
}
