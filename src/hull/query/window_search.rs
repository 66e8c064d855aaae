//! The window search (paper, section 4.2): which view's silhouette edge is nearest to a point inside.

use super::projection::{ViewSample, ViewSamples};
use crate::camera::Pixel;
use crate::hull::{Hull, View};

/// The silhouette edge nearest to a point, by the search over growing windows.
#[derive(Debug, Clone, Copy)]
pub struct NearestEdge<'a> {
    /// The view that decides.
    pub view: &'a View,
    /// Where the point appears in it.
    pub a: Pixel,
    /// The background pixel that is the projection of the paper's `b`.
    pub b: (i32, i32),
}

impl Hull {
    /// The nearest edge to `p`, a point inside; `None` where no view knows of one.
    ///
    /// View i's window at iteration k has half-width `1 + floor(k d_max / d_i)` pixels, with `d_i` the metres that a
    /// pixel covers at p; the first k at which some window holds background decides, the first view among equals.
    /// The distance table says without a search at which k that is.
    pub fn nearest_edge(&self, p: &nalgebra::Point3<f64>) -> Option<NearestEdge<'_>> {
        ViewSamples::with(|sightings| {
            sightings.project(self, p);
            self.nearest_edge_among(sightings)
        })
    }

    /// The edge nearest to a point inside, by the window search ([`Self::nearest_edge`]), from how the views see it.
    pub(super) fn nearest_edge_among(&self, sightings: &ViewSamples) -> Option<NearestEdge<'_>> {
        let d_max = sightings.seen.iter().map(|sighting| sighting.footprint).fold(0.0, f64::max);
        let mut first: Option<(i64, &ViewSample)> = None;
        for sighting in &sightings.seen {
            let growth = d_max / sighting.footprint;
            // Only a view that comes in sooner takes over.
            if first.is_some_and(|(sooner, _)| !reaches(sooner - 1, growth, sighting.distance)) {
                continue;
            }
            if let Some(k) = first_iteration(sighting.distance, growth) {
                first = Some((k, sighting));
            }
        }
        let (k, found) = first?;
        let half = window_half_width(k, d_max / found.footprint);
        let (i, j) = found.pixel;
        let view = &self.views()[found.index];
        let b = view.silhouette().nearest_background(i, j, half)?;
        Some(NearestEdge { view, a: found.at, b })
    }
}

/// Half-width of the window at iteration `k`, in pixels.
pub(in crate::hull) fn window_half_width(k: i64, growth: f64) -> i32 {
    // Rounds down: what is negative is the window at k = -1, which is not looked at.
    1 + (k as f64 * growth) as i32
}

/// Whether the window at iteration `k` reaches a pixel `distance` away: its half-width less one is the whole number
/// below `k growth`. At k = -1 it is the point's own pixel.
fn reaches(k: i64, growth: f64, distance: u16) -> bool {
    if distance == 0 { k >= -1 } else { k as f64 * growth >= f64::from(distance) - 1.0 }
}

/// The smallest k whose window reaches a pixel `distance` away; -1 where the point's own pixel is background;
/// `None` where there is no background.
fn first_iteration(distance: u16, growth: f64) -> Option<i64> {
    match distance {
        0 => Some(-1),
        u16::MAX => None,
        _ => {
            // The closed form, put right where the division rounded.
            let mut k = ((f64::from(distance) - 1.0) / growth) as i64;
            while !reaches(k, growth, distance) {
                k += 1;
            }
            while k > 0 && reaches(k - 1, growth, distance) {
                k -= 1;
            }
            Some(k)
        }
    }
}
