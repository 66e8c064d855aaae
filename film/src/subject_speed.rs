//! How fast the real subject moves, by the motion of its silhouettes.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::Hull;

/// Distance between the points at which the speed is sampled, in metres: less than the thickness of an arm.
const PITCH: f64 = 0.06;

/// The part of the points that are slower than the subject's fastest part. A foot has 3 % of a person's points; a wrong
/// velocity takes one or two of 400.
const SLOWER_POINTS: f64 = 0.99;

/// The speed of the fastest part of the subject in m/s: the 99th percentile of [`Hull::velocity`] over the points of a
/// grid that lie just inside `hull`. `None` where no velocity is known.
pub(crate) fn fastest_part(hull: &Hull) -> Option<f64> {
    let speeds = points_near_surface(hull).filter_map(|point| hull.velocity(&point));
    quantile(speeds.map(|velocity| velocity.norm()).collect(), SLOWER_POINTS)
}

/// The points of the grid that are inside, with a neighbour that is not.
fn points_near_surface(hull: &Hull) -> impl Iterator<Item = Point3<f64>> {
    let aabb = hull.aabb();
    let counts = ((aabb.max - aabb.min) / PITCH).map(|count| count.ceil().max(0.0) as usize);
    let point = move |k: usize| -> Point3<f64> {
        let cell = [k % counts.x, k / counts.x % counts.y, k / counts.x / counts.y];
        aabb.min + Vector3::from(cell.map(|i| i as f64 + 0.5)) * PITCH
    };

    let neighbours = |p: Point3<f64>| {
        [0, 1, 2].map(|axis| Vector3::ith(axis, PITCH)).into_iter().flat_map(move |step| [p + step, p - step])
    };
    let is_near_surface =
        move |p: &Point3<f64>| hull.inside(p) && neighbours(*p).any(|neighbour| !hull.inside(&neighbour));
    (0..counts.product()).map(point).filter(is_near_surface)
}

/// The value that a part `p` of `values`, 0 to 1, does not exceed; `None` without values.
pub(crate) fn quantile(mut values: Vec<f64>, p: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some(values[(p * last as f64).round() as usize])
}
