//! Ties, in which an order decides by definition: two views whose windows reach background in the same
//! iteration of the window search, and two samples that are equally deep.

use super::NANOMETRE;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::hull::{EdgeModel, Hull, View};
use ode_visual_hull::sample::Samples;

/// Whether two hulls of the same views in different orders give a sample of the body the edges of different
/// views, and the windows of both reach background in one iteration.
pub(super) fn of_views(hulls: [&Hull; 2], samples: &Samples, pose: &Isometry3<f64>) -> bool {
    samples.points().iter().any(|sample| {
        let point = pose * sample.point;
        if !hulls[0].inside_by(&point, EdgeModel::Coverage) {
            return false;
        }
        let deciding = hulls.map(|hull| hull.nearest_edge(&point).map(|nearest| nearest.view));
        let [Some(a), Some(b)] = deciding else { return false };
        // A view that is overruled at the point does not count.
        let overruled =
            hulls[0].views().iter().filter(|_| hulls[0].overrule_depth().is_some()).map(View::name);
        a.name() != b.name()
            && overruled.map(Some).chain([None]).any(|left_out| {
                let [a, b] = [a, b].map(|view| iteration(hulls[0], left_out, view, &point));
                a.is_some() && a == b
            })
    })
}

/// The iteration of the window search (paper, section 4.2) in which the view's window first holds background,
/// where all views count but the one that is left out.
fn iteration(hull: &Hull, left_out: Option<&str>, view: &View, point: &Point3<f64>) -> Option<u32> {
    let seen = hull.views().iter().filter(|view| view.is_enabled() && left_out != Some(view.name()));
    let largest = seen.filter_map(|view| pixel_size(view, point)).fold(0.0, f64::max);
    let (i, j) = view.pixel(point)?;
    let (distance, growth) = (view.silhouette().distance(i, j), largest / pixel_size(view, point)?);
    if distance == 0 {
        return Some(0);
    }
    // The same as in the search but for rounding: growth is 1 for views that are equally far away.
    (0..u32::from(u16::MAX))
        .find(|&k| 1.0 + (f64::from(k) * growth + NANOMETRE).floor() >= f64::from(distance))
        .map(|k| k + 1)
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
