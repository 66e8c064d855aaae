//! The window search (paper, section 4.2): the view whose silhouette edge is nearest to a point inside.

use super::projection::{ViewSample, ViewSamples};
use crate::camera::Pixel;
use crate::hull::{Hull, View};

/// The silhouette edge nearest to a point, found by the window search.
#[derive(Debug, Clone, Copy)]
pub struct NearestEdge<'a> {
    /// The view that the edge belongs to.
    pub view: &'a View,
    /// The projection of the point into that view.
    pub a: Pixel,
    /// The background pixel nearest to it, to which the paper's point `b` projects.
    pub b: (i32, i32),
}

impl Hull {
    /// The silhouette edge nearest to `p`, a point inside; `None` if no view has an edge.
    ///
    /// The window of view i at iteration k has a half-width of `1 + floor(k d_max / d_i)` pixels, where `d_i` is the
    /// metres that a pixel covers at p and `d_max` the largest `d_i`. The view whose window is the first to hold
    /// background decides. Of several at one iteration, whose windows have grown to the same metres but for whole pixels, the
    /// one with the nearest background in metres decides, the first of those where that is equal to 1e-9. The distance tables give
    /// this k without an iteration.
    pub fn nearest_edge(&self, p: &nalgebra::Point3<f64>) -> Option<NearestEdge<'_>> {
        ViewSamples::with(|samples| {
            samples.project(self, p);
            self.nearest_edge_among(samples)
        })
    }

    /// The result of [`Self::nearest_edge`] for a point whose projections are known.
    pub(super) fn nearest_edge_among(&self, samples: &ViewSamples) -> Option<NearestEdge<'_>> {
        let (decisive, half) = deciding_window(samples)?;
        let (i, j) = decisive.pixel;
        let view = &self.views()[decisive.index];
        let b = view.silhouette().nearest_background(i, j, half)?;
        Some(NearestEdge { view, a: decisive.at, b })
    }
}

/// The view that decides the window search, and the half-width of its window in pixels.
pub(in crate::hull) fn deciding_window(samples: &ViewSamples) -> Option<(&ViewSample, i32)> {
    let d_max = samples.counting().map(|sample| sample.footprint).fold(0.0, f64::max);

    // The smallest iteration over the views, and its view.
    let mut first: Option<(i64, f64, &ViewSample)> = None;
    for sample in samples.counting() {
        let growth = d_max / sample.footprint;
        if first.is_some_and(|(k, ..)| !reaches(k, growth, sample.distance)) {
            continue;
        }
        if let Some(k) = first_iteration(sample.distance, growth) {
            let extent = extent(f64::from(sample.distance), sample.footprint);
            if first.is_none_or(|(least, of_first, _)| k < least || extent < (1.0 - ROUNDING) * of_first) {
                first = Some((k, extent, sample));
            }
        }
    }

    let (k, _, decisive) = first?;
    Some((decisive, window_half_width(k, d_max / decisive.footprint)))
}

/// Half-width of the window at iteration `k`, in pixels, where `growth` is `d_max / d_i` of the view.
pub(in crate::hull) fn window_half_width(k: i64, growth: f64) -> i32 {
    // `as` rounds down for k >= 0. The result for k = -1, the point's own pixel, does not matter.
    1 + (k as f64 * growth) as i32
}

/// Where the nearest background of two views is as far from a point but for rounding, as in a rig with mirror symmetry, the
/// first of them decides: this part of a distance counts as rounding.
pub(in crate::hull) const ROUNDING: f64 = 1e-9;

/// Half-width in metres of the smallest window around a pixel that holds background at the Chebyshev distance `distance`, where
/// a pixel covers `footprint` metres.
#[inline(always)]
pub(in crate::hull) fn extent(distance: f64, footprint: f64) -> f64 {
    (distance + 0.5) * footprint
}

/// Whether the window at iteration `k` reaches a pixel at the Chebyshev distance `distance`: whether
/// `1 + floor(k growth) >= distance`. At k = -1 the window is the point's own pixel.
fn reaches(k: i64, growth: f64, distance: u16) -> bool {
    if distance == 0 { k >= -1 } else { k as f64 * growth >= f64::from(distance) - 1.0 }
}

/// The smallest k whose window reaches a pixel at the Chebyshev distance `distance`: -1 if the point's own pixel is
/// background; `None` if there is no background.
fn first_iteration(distance: u16, growth: f64) -> Option<i64> {
    match distance {
        0 => Some(-1),
        u16::MAX => None,
        _ => {
            // The closed form, corrected where the division rounded.
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
