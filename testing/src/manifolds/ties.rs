//! Ties, in which an order decides by definition: two views whose nearest background is equally far from a point, and two
//! samples that are equally deep.

use super::NANOMETRE;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::hull::{EdgeModel, Hull, View};
use ode_visual_hull::sample::Samples;

/// Whether two hulls of the same views in different orders give a sample of the body the edges of different
/// views, and the smallest windows of both that hold background have the same size in metres.
pub(super) fn of_views(hulls: [&Hull; 2], samples: &Samples, pose: &Isometry3<f64>) -> bool {
    samples.points().iter().any(|sample| {
        let point = pose * sample.point;
        if !hulls[0].inside_by(&point, EdgeModel::Coverage) {
            return false;
        }
        let deciding = hulls.map(|hull| hull.nearest_edge(&point).map(|nearest| nearest.view));
        let [Some(a), Some(b)] = deciding else { return false };
        let extents = [a, b].map(|view| window_extent(view, &point));
        let [Some(of_a), Some(of_b)] = extents else { return false };
        a.name() != b.name() && (of_a - of_b).abs() <= NANOMETRE
    })
}

/// Half-width in metres, at the point, of the smallest window around the view's pixel that holds background.
fn window_extent(view: &View, point: &Point3<f64>) -> Option<f64> {
    let (i, j) = view.pixel(point)?;
    Some((f64::from(view.silhouette().distance(i, j)) + 0.5) * pixel_size(view, point)?)
}

/// Metres that a pixel of the view covers at a point; `None` where the view does not see it.
fn pixel_size(view: &View, point: &Point3<f64>) -> Option<f64> {
    view.pixel(point)?;
    let at = view.project(point)?;
    let beside = |right: f64, down: f64| view.camera().unproject(at.u + right, at.v + down, at.depth);
    let step = |right: f64, down: f64| Some((beside(right, down)? - beside(0.0, 0.0)?).norm());
    Some(step(1.0, 0.0)?.min(step(0.0, 1.0)?))
}

/// Whether two of the samples inside are equally deep along their own exit directions, but for rounding.
pub(super) fn of_samples(hull: &Hull, samples: &Samples, pose: &Isometry3<f64>) -> bool {
    let depth = |point: Point3<f64>| hull.exit_vector(&point).map(|exit| exit.depth);
    let mut depths: Vec<f64> =
        samples.points().iter().filter_map(|sample| depth(pose * sample.point)).collect();
    depths.sort_by(f64::total_cmp);
    depths.windows(2).any(|pair| pair[1] - pair[0] <= NANOMETRE)
}
