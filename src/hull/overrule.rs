//! Views that are overruled at a point: one sees it as background, or as much nearer to the edge than all others do.
//!
//! The depth of a point in a view is its Chebyshev distance to the background there, in metres at the point. Where the
//! least depth lies at least [`Hull::overrule_depth`] below that of every other view, the view with the least depth
//! abstains. The hull so defined holds the plain one; its depth at a point is the larger of the least depth over the
//! views, and of the second least less `overrule_depth`.

use super::Hull;
use super::query::ViewSamples;
use nalgebra::Point3;

/// The least number of other views that overrule one: the hull of two is much larger than their subject.
pub(super) const LEAST_OTHERS: usize = 3;

/// A view that is overruled at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overruled {
    /// Index of the view.
    pub(super) view: usize,
    /// How much of the way to the exit from the hull of the other views remains, where that ends as the depth falls to
    /// [`Hull::overrule_depth`].
    pub(super) share: f64,
}

impl Hull {
    /// The view that is overruled at `p`.
    pub(super) fn overruled_at(&self, p: &Point3<f64>) -> Option<Overruled> {
        self.overrule_depth()?;
        ViewSamples::with(|samples| {
            samples.project(self, p);
            samples.overruled
        })
    }

    /// Whether a view is overruled at `p`.
    pub(crate) fn overrules_at(&self, p: &Point3<f64>) -> bool {
        self.overruled_at(p).is_some()
    }

    /// The view that is overruled at a point whose projections are known.
    pub(super) fn overruled_among(&self, samples: &ViewSamples) -> Option<Overruled> {
        let enough = self.overrule_depth()?;
        if samples.visible.len() <= LEAST_OTHERS {
            return None;
        }

        let (mut shallowest, mut least, mut second) = (&samples.visible[0], f64::INFINITY, f64::INFINITY);
        for sample in &samples.visible {
            let depth = f64::from(sample.distance) * sample.footprint;
            if depth < least {
                (shallowest, least, second) = (sample, depth, least);
            } else if depth < second {
                second = depth;
            }
        }

        let (i, j) = shallowest.pixel;
        let is_overruled = second - least >= enough && self.views()[shallowest.index].sees(i, j);
        is_overruled.then(|| Overruled { view: shallowest.index, share: (second - enough) / second })
    }
}

#[cfg(test)]
mod tests;
