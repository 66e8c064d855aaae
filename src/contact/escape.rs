//! The way out for a body that is swallowed or pierced: none of its samples can tell, since wherever a sample's own
//! way out leads, the body follows with more of itself inside.

use super::Colliding;
use crate::hull::{EdgeModel, Hull, Memory, Start};
use nalgebra::Vector3;

/// The last step's way out counts as this much shorter, so that the body does not dither between two.
const LOYALTY: f64 = 0.3;

/// At most this many samples are asked, evenly over their order.
const MOST_ASKED: usize = 64;

/// The direction whose longest exit over the colliding samples is shortest: among the 26 to the faces, edges and
/// corners of a cube, the samples' mean way out, and the last step's.
pub(super) fn direction(
    hull: &Hull,
    colliding: &[Colliding],
    last: Option<Vector3<f64>>,
    memory: &mut Memory,
) -> Vector3<f64> {
    let stride = colliding.len().div_ceil(MOST_ASKED);
    let mean: Vector3<f64> = colliding.iter().map(|sample| sample.direction * sample.depth).sum();
    let fresh = cube_directions().chain(mean.try_normalize(1e-9));
    let candidates =
        fresh.map(|direction| (direction, 1.0)).chain(last.map(|direction| (direction, LOYALTY)));
    let asked = colliding.iter().step_by(stride);
    let start = |&Colliding { point, direction, view, .. }: &Colliding| Start { point, direction, view };
    let mut search =
        Search { hull, starts: asked.map(start).collect(), exits: Vec::new(), memory, witness: 0 };
    let mut best: Option<(Vector3<f64>, f64)> = None;
    for (direction, factor) in candidates {
        let least = best.map_or(f64::INFINITY, |(_, least)| least);
        if let Some(rated) = search.rated(&direction, factor, least) {
            best = Some((direction, rated));
        }
    }
    best.map_or(colliding[0].direction, |(direction, _)| direction)
}

/// The longest exits of the samples asked.
struct Search<'a> {
    hull: &'a Hull,
    starts: Vec<Start>,
    exits: Vec<f64>,
    memory: &'a mut Memory,
    /// The sample that ruled the last direction out: it is likely to rule out the next one too.
    witness: usize,
}

impl Search<'_> {
    /// `factor` times the longest exit along `direction`; `None` where it is not below `least`.
    fn rated(&mut self, direction: &Vector3<f64>, factor: f64, least: f64) -> Option<f64> {
        let Self { hull, starts, exits, memory, witness } = self;
        // Beyond this a walk need not go on: a little more than what rules the direction out.
        let enough = least / factor * (1.0 + 1e-12);
        let rules_out = |exit: f64| factor * exit >= least;
        if rules_out(hull.exit_within(&starts[*witness].point, direction, EdgeModel::Pixel, enough)) {
            return None;
        }
        starts.iter_mut().for_each(|start| start.direction = *direction);
        hull.exits_within(starts, EdgeModel::Pixel, enough, memory, exits);
        let (place, longest) = exits.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        *witness = place;
        (!rules_out(*longest)).then_some(factor * longest)
    }
}

fn cube_directions() -> impl Iterator<Item = Vector3<f64>> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all =
        steps().flat_map(move |x| steps().flat_map(move |y| steps().map(move |z| Vector3::new(x, y, z))));
    all.filter_map(|v| v.try_normalize(0.5))
}
