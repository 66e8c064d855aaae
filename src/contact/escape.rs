//! The way out for a body that is swallowed or pierced: none of its samples can tell, since wherever a sample's own
//! way out leads, the body follows with more of itself inside.

use super::Colliding;
use crate::hull::{EdgeModel, Hull};
use nalgebra::Vector3;

/// The last step's way out counts as this much shorter, so that the body does not dither between two.
const LOYALTY: f64 = 0.3;

/// At most this many samples are asked, evenly over their order.
const MOST_ASKED: usize = 64;

/// The direction whose longest exit over the colliding samples is shortest: among the 26 to the faces, edges and
/// corners of a cube, the samples' mean way out, and the last step's.
pub(super) fn direction(hull: &Hull, colliding: &[Colliding], last: Option<Vector3<f64>>) -> Vector3<f64> {
    let stride = colliding.len().div_ceil(MOST_ASKED);
    let longest_exit = |direction: &Vector3<f64>| {
        let exits = colliding.iter().step_by(stride);
        exits.map(|sample| hull.exit(&sample.point, direction, EdgeModel::Pixel)).fold(0.0, f64::max)
    };
    let mean: Vector3<f64> = colliding.iter().map(|sample| sample.push.direction * sample.push.depth).sum();
    let fresh = cube_directions().chain(mean.try_normalize(1e-9));
    let candidates =
        fresh.map(|direction| (direction, 1.0)).chain(last.map(|direction| (direction, LOYALTY)));
    let rated = candidates.map(|(direction, factor)| (direction, factor * longest_exit(&direction)));
    let shortest = rated.min_by(|a, b| a.1.total_cmp(&b.1));
    shortest.map_or(colliding[0].push.direction, |(direction, _)| direction)
}

fn cube_directions() -> impl Iterator<Item = Vector3<f64>> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all =
        steps().flat_map(move |x| steps().flat_map(move |y| steps().map(move |z| Vector3::new(x, y, z))));
    all.filter_map(|v| v.try_normalize(0.5))
}
