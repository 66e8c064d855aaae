//! The traversals of all views along one half-line, merged in the order in which verdicts change: where the half-line
//! enters and leaves the hull.

use super::view_traversal::ViewTraversal;
use crate::hull::{EdgeModel, Hull, Verdict, View};
use nalgebra::{Point3, Vector3};

/// Where a half-line crosses the hull's surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing<'a> {
    /// Metres along the half-line.
    pub(super) t: f64,
    /// The view whose silhouette has its edge there; `None` on a face of the work volume.
    pub(super) view: Option<&'a View>,
    /// The outward normal of the face of the work volume; zero at an exit through a silhouette's edge.
    pub(super) face: Vector3<f64>,
}

/// The state of a traversal of a half-line through the whole hull.
pub(super) struct IntervalMerge<'a> {
    hull: &'a Hull,
    traversals: Vec<ViewTraversal<'a>>,
    /// Metres traversed so far.
    t: f64,
    /// Index of the traversal that changed last.
    latest: Option<usize>,
    /// Where the half-line enters the work volume, and the outward normal of the face there.
    bounds_entry: (f64, Vector3<f64>),
    bounds_exit: f64,
    direction: Vector3<f64>,
    origin: Point3<f64>,
}

impl<'a> IntervalMerge<'a> {
    /// The traversal at the origin, through all enabled views but for the one at `left_out`; `None` where the half-line
    /// misses the work volume.
    pub(super) fn new(
        hull: &'a Hull,
        left_out: Option<usize>,
        origin: &Point3<f64>,
        direction: &Vector3<f64>,
        edge: EdgeModel,
    ) -> Option<Self> {
        let (entry, bounds_exit, normal) = hull.bounds().span(origin, direction)?;
        let counts = |index: usize, view: &View| view.is_enabled() && left_out != Some(index);
        let views = hull.views().iter().enumerate().filter(|(index, view)| counts(*index, view));
        let traversals = views.map(|(_, view)| ViewTraversal::new(view, origin, direction, edge)).collect();
        let (direction, origin) = (*direction, *origin);
        let bounds_entry = (entry, normal);
        Some(Self { hull, traversals, t: 0.0, latest: None, bounds_entry, bounds_exit, direction, origin })
    }

    /// Advances to the first point from here on that is inside; `None` if there is none.
    pub(super) fn entry(&mut self) -> Option<Crossing<'a>> {
        self.advance_to(self.bounds_entry.0);
        self.latest = None;
        while !self.inside() {
            if !self.advance() {
                return None;
            }
        }
        let view = self.latest.map(|k| self.traversals[k].view());
        Some(Crossing { t: self.t, view, face: self.bounds_entry.1 })
    }

    /// Advances to the first point from here on that is not inside.
    pub(super) fn exit(&mut self) -> Crossing<'a> {
        while self.inside() {
            if !self.advance() {
                let (_, face) = self.hull.bounds().exit(&self.origin, &self.direction);
                return Crossing { t: self.bounds_exit, view: None, face };
            }
        }
        Crossing { t: self.t, view: self.latest_view(), face: Vector3::zeros() }
    }

    /// Whether the hull contains the half-line just after `t`.
    fn inside(&self) -> bool {
        let count = |verdict: Verdict| self.traversals.iter().filter(|one| one.verdict() == verdict).count();
        let (inside, outside) = (count(Verdict::Inside), count(Verdict::Outside));
        self.hull.unseen().decides_inside(inside, outside, self.traversals.len())
    }

    /// The view that changed last; before any change, the first that does not see the point inside.
    fn latest_view(&self) -> Option<&'a View> {
        let at_start = || self.traversals.iter().position(|one| one.verdict() != Verdict::Inside);
        self.latest.or_else(at_start).map(|k| self.traversals[k].view())
    }

    /// Advances all traversals to `t`, if it lies ahead.
    fn advance_to(&mut self, t: f64) {
        while self.soonest().is_some_and(|k| self.traversals[k].until() <= t) {
            self.advance();
        }
        self.t = self.t.max(t);
    }

    /// Steps the traversal whose verdict may change soonest; false if the half-line leaves the work volume before that.
    fn advance(&mut self) -> bool {
        let Some(k) = self.soonest() else { return false };
        let traversal = &mut self.traversals[k];
        if traversal.until() >= self.bounds_exit {
            return false;
        }
        self.t = self.t.max(traversal.until());
        traversal.step();
        self.latest = Some(k);
        true
    }

    /// Index of the traversal whose verdict may change soonest; ties go to the first view.
    fn soonest(&self) -> Option<usize> {
        let until = |k: usize| self.traversals[k].until();
        (0..self.traversals.len()).min_by(|&a, &b| until(a).total_cmp(&until(b)))
    }
}
