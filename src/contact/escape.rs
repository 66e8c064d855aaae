//! The exit direction of a body that is swallowed or pierced. None of its samples can tell: wherever the exit of a single
//! sample leads, the body follows with more of itself inside.

use super::PenetratingSample;
use super::tuning::{ESCAPE_SAMPLES, HYSTERESIS};
use crate::hull::{EdgeModel, ExitRay, Hull, Scratch};
use nalgebra::Vector3;

/// The direction whose longest exit over the penetrating samples is shortest: among the 26 to the faces, edges and
/// corners of a cube, the mean of the samples' exit vectors, and the last step's.
pub(super) fn escape_direction(
    hull: &Hull,
    penetrating: &[PenetratingSample],
    last: Option<Vector3<f64>>,
    scratch: &mut Scratch,
) -> Vector3<f64> {
    let stride = penetrating.len().div_ceil(ESCAPE_SAMPLES);
    let mean: Vector3<f64> = penetrating.iter().map(|sample| sample.direction * sample.depth).sum();
    let fresh = cube_directions().chain(mean.try_normalize(1e-9));
    let candidates =
        fresh.map(|direction| (direction, 1.0)).chain(last.map(|direction| (direction, HYSTERESIS)));
    let asked = penetrating.iter().step_by(stride);
    let rays = asked.map(PenetratingSample::ray).collect();
    let mut search = EscapeSearch { hull, rays, exits: Vec::new(), scratch, last_rejecting_sample: 0 };
    let mut best: Option<(Vector3<f64>, f64)> = None;
    for (direction, factor) in candidates {
        let least = best.map_or(f64::INFINITY, |(_, least)| least);
        if let Some(cost) = search.cost(&direction, factor, least) {
            best = Some((direction, cost));
        }
    }
    best.map_or(penetrating[0].direction, |(direction, _)| direction)
}

/// The longest exits of the samples asked.
struct EscapeSearch<'a> {
    hull: &'a Hull,
    rays: Vec<ExitRay>,
    exits: Vec<f64>,
    scratch: &'a mut Scratch,
    /// The sample that rejected the last direction: it is likely to reject the next one too.
    last_rejecting_sample: usize,
}

impl EscapeSearch<'_> {
    /// `factor` times the longest exit along `direction`; `None` where it is not below `least`.
    fn cost(&mut self, direction: &Vector3<f64>, factor: f64, least: f64) -> Option<f64> {
        let Self { hull, rays, exits, scratch, last_rejecting_sample } = self;
        // Beyond this a walk need not go on: a little more than what rejects the direction.
        let enough = least / factor * (1.0 + 1e-12);
        let rejects = |exit: f64| factor * exit >= least;
        let likely = &rays[*last_rejecting_sample].point;
        if rejects(hull.exit_within(likely, direction, EdgeModel::Pixel, enough)) {
            return None;
        }
        rays.iter_mut().for_each(|ray| ray.direction = *direction);
        hull.exits_within(rays, EdgeModel::Pixel, enough, scratch, exits);
        let (place, longest) = exits.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        *last_rejecting_sample = place;
        (!rejects(*longest)).then_some(factor * longest)
    }
}

fn cube_directions() -> impl Iterator<Item = Vector3<f64>> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all =
        steps().flat_map(move |x| steps().flat_map(move |y| steps().map(move |z| Vector3::new(x, y, z))));
    all.filter_map(|v| v.try_normalize(0.5))
}
