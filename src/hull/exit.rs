//! Where a half-line from a point inside leaves the hull: the nearest exit over the views and the work volume.
//!
//! The view that is likely to decide walks first; of the others only those walk that might leave sooner. What comes
//! out is the same as from walking all views in step ([`sweep`](super::sweep)), bit by bit: each view walks alone
//! there too, and the first to leave ends it. Where a view does not see the point, or leaves what it sees, the policy
//! has to weigh all views, and the sweep does.

use super::image_line::ImageLine;
use super::march::{EdgeModel, March};
use super::sighting::Sightings;
use super::sweep::Sweep;
use super::view::Verdict;
use super::{Hull, Unseen};
use nalgebra::{Point3, Vector3};

impl Hull {
    /// Metres from `p`, a point inside, along the unit `direction` to where the hull ends: the nearest exit over the
    /// views and the work volume.
    pub fn exit(&self, p: &Point3<f64>, direction: &Vector3<f64>, edge: EdgeModel) -> f64 {
        self.exit_within(p, direction, edge, f64::INFINITY)
    }

    /// The same, or `most` where the exit is farther: a walk that gets so far is not finished.
    pub fn exit_within(&self, p: &Point3<f64>, direction: &Vector3<f64>, edge: EdgeModel, most: f64) -> f64 {
        Sightings::with(|sightings| {
            sightings.take(self, p);
            let nearest =
                |sighting: &&super::sighting::Sighting| f64::from(sighting.distance) * sighting.footprint;
            let first = sightings.seen.iter().min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
            let first = first.map_or(0, |sighting| sighting.index);
            self.exit_from(sightings, first, p, direction, edge, most)
        })
    }

    /// The same for a point whose sightings are known; `first` is the index of the view that is asked first.
    pub(super) fn exit_from(
        &self,
        sightings: &Sightings,
        first: usize,
        p: &Point3<f64>,
        direction: &Vector3<f64>,
        edge: EdgeModel,
        most: f64,
    ) -> f64 {
        self.exit_by_views(sightings, first, p, direction, edge, most).unwrap_or_else(|| {
            Sweep::new(self, p, direction, edge).map_or(0.0, |mut sweep| sweep.exit().t).min(most)
        })
    }

    /// View by view; `None` where the policy has to weigh them together.
    fn exit_by_views(
        &self,
        sightings: &Sightings,
        first: usize,
        p: &Point3<f64>,
        direction: &Vector3<f64>,
        edge: EdgeModel,
        most: f64,
    ) -> Option<f64> {
        let abstains = self.unseen() != Unseen::Outside;
        let blind = abstains && self.enabled_views().any(|view| view.blind_spots().is_some());
        if sightings.unseen > 0 || sightings.seen.is_empty() || blind {
            return None;
        }
        let (_, wall, _) = self.bounds().span(p, direction)?;
        let mut exit = wall.min(most);
        let others = sightings.seen.iter().filter(|sighting| sighting.index != first);
        for sighting in sightings.seen.iter().filter(|sighting| sighting.index == first).chain(others) {
            let view = &self.views()[sighting.index];
            let ahead = view.homogeneous_direction(direction);
            // Beyond an open border nothing is background, but unseen.
            let in_sight = || !abstains || sighting.stays_in(&view.silhouette().image(), &ahead, exit);
            if sighting.stays_inside(&ahead, exit) && in_sight() {
                continue;
            }
            let line = ImageLine::new(sighting.homogeneous, ahead);
            let mut march = if sighting.distance > 0 {
                March::from_inside(view, line, &sighting.at, edge)
            } else {
                March::new(view, p, direction, edge)
            };
            let left = march.leave_by(0.0, exit);
            match march.verdict() {
                Verdict::Inside => {}
                // It may be that the others suffice.
                Verdict::Unseen if abstains => return None,
                _ => exit = exit.min(left),
            }
        }
        Some(exit)
    }
}
