//! Where a half-line from a point inside leaves the hull: the nearest exit over the views and the work volume.
//!
//! For one line all views walk in step, whatever they see. Many lines go through [`batch`](crate::hull::batch), bit by bit
//! the same: a view walks alone here too, and the first to leave ends it.

use super::interval_merge::IntervalMerge;
use crate::hull::{EdgeModel, Hull};
use nalgebra::{Point3, Vector3};

impl Hull {
    /// Metres from `p`, a point inside, along the unit `direction` to where the hull ends: the nearest exit over the
    /// views and the work volume.
    pub fn exit(&self, p: &Point3<f64>, direction: &Vector3<f64>, edge: EdgeModel) -> f64 {
        IntervalMerge::new(self, p, direction, edge).map_or(0.0, |mut sweep| sweep.exit().t)
    }

    /// Metres from `p`, a point inside, along the unit `direction` to where the hull ends ([`Self::exit`]), at most `most`.
    pub fn exit_within(&self, p: &Point3<f64>, direction: &Vector3<f64>, edge: EdgeModel, most: f64) -> f64 {
        self.exit(p, direction, edge).min(most)
    }
}
