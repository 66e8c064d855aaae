//! The exit direction of a body that is swallowed or pierced. The exit of a single sample is no guide: moving the body
//! along it brings other parts of the body into the hull.

use super::PenetratingSample;
use super::tuning::{ESCAPE_SAMPLES, HYSTERESIS};
use crate::hull::{EdgeModel, ExitRay, Hull, Scratch};
use nalgebra::Vector3;

/// The direction in which the longest exit over the penetrating samples is shortest. The candidates are the 26
/// directions to the faces, edges and corners of a cube, the mean of the samples' exit vectors, and the last step's
/// direction, which is preferred.
pub(super) fn escape_direction(
    hull: &Hull,
    penetrating: &[PenetratingSample],
    last: Option<Vector3<f64>>,
    scratch: &mut Scratch,
) -> Vector3<f64> {
    // Each candidate direction with the factor on its cost.
    let mean: Vector3<f64> = penetrating.iter().map(|sample| sample.direction * sample.depth).sum();
    let fresh = cube_directions().chain(mean.try_normalize(1e-9));
    let candidates =
        fresh.map(|direction| (direction, 1.0)).chain(last.map(|direction| (direction, HYSTERESIS)));

    let stride = penetrating.len().div_ceil(ESCAPE_SAMPLES);
    let rays = penetrating.iter().step_by(stride).map(PenetratingSample::ray).collect();
    let mut search = EscapeSearch { hull, rays, exits: Vec::new(), scratch, last_rejecting_sample: 0 };

    let mut best: Option<(Vector3<f64>, f64)> = None;
    for (direction, factor) in candidates {
        let least_cost = best.map_or(f64::INFINITY, |(_, cost)| cost);
        if let Some(cost) = search.cost(&direction, factor, least_cost) {
            best = Some((direction, cost));
        }
    }
    best.map_or(penetrating[0].direction, |(direction, _)| direction)
}

/// The samples that rate directions, and memory for their exits.
struct EscapeSearch<'a> {
    hull: &'a Hull,
    /// A ray from each sample; its direction is that of the last rating.
    rays: Vec<ExitRay>,
    exits: Vec<f64>,
    scratch: &'a mut Scratch,
    /// The sample that rejected the last direction: it is likely to reject the next one too.
    last_rejecting_sample: usize,
}

impl EscapeSearch<'_> {
    /// `factor` times the longest exit along `direction`, in metres; `None` if it is not below `least_cost`.
    fn cost(&mut self, direction: &Vector3<f64>, factor: f64, least_cost: f64) -> Option<f64> {
        let Self { hull, rays, exits, scratch, last_rejecting_sample } = self;

        // Rays need not be traced farther than this: a little more than what rejects the direction.
        let t_max = least_cost / factor * (1.0 + 1e-12);
        let rejects = |exit: f64| factor * exit >= least_cost;

        let likely = &rays[*last_rejecting_sample].point;
        if rejects(hull.exit_within(likely, direction, EdgeModel::Coverage, t_max)) {
            return None;
        }

        rays.iter_mut().for_each(|ray| ray.direction = *direction);
        hull.exits_within(rays, EdgeModel::Coverage, t_max, scratch, exits);
        let (sample, longest) = exits.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        *last_rejecting_sample = sample;
        (!rejects(*longest)).then_some(factor * longest)
    }
}

/// The 26 unit directions from a cube's centre to its faces, edges and corners.
fn cube_directions() -> impl Iterator<Item = Vector3<f64>> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all =
        steps().flat_map(move |x| steps().flat_map(move |y| steps().map(move |z| Vector3::new(x, y, z))));
    all.filter_map(|v| v.try_normalize(0.5))
}
