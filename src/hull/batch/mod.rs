//! Many points at once: the directions in which they leave the hull, and how far that is.
//!
//! ```text
//!   points ─► projection ─► nearest edge ─► normal ─► exit
//!             all views     the view that decides     all views
//! ```
//!
//! Two questions are answered. By [`EdgeModel::Coverage`] it is that of contacts: the contact normal, and exits at the
//! coverage edge. By [`EdgeModel::Pixel`] it is the paper's: binary masks, 5x5 normals, exits at pixels' borders.
//!
//! The arithmetic is that of [`Hull::push`], [`Hull::respond`] and [`Hull::exit_within`] in the same order, so that
//! the same bits come out; many points go through each step side by side. What is rare goes the single query's way:
//! walks along the rim of a silhouette's rectangle, and exits before which a view may lose sight of the point.

// Loops over the lanes of several arrays say what happens to lane k: it is what the compiler turns into vectors.
#![allow(clippy::needless_range_loop)]

mod exits;
mod image_lines;
mod line_walk;
mod nearest_edge;
mod projection;
mod rejection;

use super::{EdgeModel, Hull, View};
use crate::camera::floor_pixel;
use crate::math::lanes::set_bits;
use crate::math::point_cloud::LANES;
use crate::math::vectorised;
use crate::recycle::recycle;
use crate::silhouette::HALF_COVERAGE;
use exits::ExitFinder;
use nalgebra::{Point3, Vector3};
use nearest_edge::EdgeQueries;
use projection::{PointBlock, ViewKernel};

/// One number of each point of a block.
type Wide = [f64; LANES];

/// A point inside, and the direction in which it is to leave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ExitRay {
    pub(crate) point: Point3<f64>,
    /// Unit length.
    pub(crate) direction: Vector3<f64>,
    /// Index of the view that is likely to decide how far that is: the one that gave the direction.
    pub(crate) view: usize,
}

/// Memory that batches use again and again; it holds no answer.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    kernels: Vec<ViewKernel<'static>>,
    block: PointBlock,
    queries: EdgeQueries,
    exits: ExitFinder,
}

impl Hull {
    /// Finds the directions in which those of `points` leave that are inside by `edge`: writes their places to `places`
    /// and their rays to `rays`, in their order; those of the first `most` at least.
    pub(crate) fn exit_rays(
        &self,
        points: &[Point3<f64>],
        edge: EdgeModel,
        most: usize,
        scratch: &mut Scratch,
        places: &mut Vec<usize>,
        rays: &mut Vec<ExitRay>,
    ) {
        places.clear();
        rays.clear();
        scratch.with_kernels(self, edge, |batch| {
            for (chunk, first) in points.chunks(LANES).zip((0..).step_by(LANES)) {
                if rays.len() >= most {
                    break;
                }
                let inside = find_inside(batch, chunk, rays);
                for k in set_bits(inside) {
                    places.push(first + k);
                }
            }
            batch.queries.find_directions(batch.kernels, edge, rays);
        });
    }

    /// Writes to `exits` [`Self::exit_within`] of each of `rays`, whose points are inside by `edge`; and to the rays
    /// the views that decided.
    pub(crate) fn exits_within(
        &self,
        rays: &mut [ExitRay],
        edge: EdgeModel,
        t_max: f64,
        scratch: &mut Scratch,
        exits: &mut Vec<f64>,
    ) {
        exits.clear();
        if rays.is_empty() {
            return;
        }
        scratch.with_kernels(self, edge, |batch| {
            batch.exits.find(self, batch.kernels, rays, t_max, exits);
        });
    }

    /// Adds the places of those of `rays` to `kept` whose exits do not provably lie before their `t` metres:
    /// [`Self::provably_exits_before`] for many, which may leave a few more in doubt.
    pub(crate) fn keep_unless_proven(
        &self,
        rays: &[ExitRay],
        t: &[f64],
        edge: EdgeModel,
        scratch: &mut Scratch,
        kept: &mut Vec<usize>,
    ) {
        scratch.with_kernels(self, edge, |batch| {
            let mut first = 0;
            let chunks = rays.chunks(LANES).zip(t.chunks(LANES));
            for ((rays, t), base) in chunks.zip((0..).step_by(LANES)) {
                rejection::keep(batch.kernels, rays, t, base, &mut first, kept);
            }
        });
    }

    /// Whether the exit of `ray` provably lies before `t` metres, since some view sees background there. The view that
    /// is likely to decide is asked first. This costs a look-up in each view, where an exit costs a walk.
    pub(crate) fn provably_exits_before(&self, ray: &ExitRay, edge: EdgeModel, t: f64) -> bool {
        let end = ray.point + ray.direction * t;
        let others = self.views().iter().enumerate().filter(|(k, view)| *k != ray.view && view.is_enabled());
        provably_outside(&self.views()[ray.view], &end, edge)
            || others.into_iter().any(|(_, view)| provably_outside(view, &end, edge))
    }
}

/// Whether a view sees background at `p`, however its place is rounded.
fn provably_outside(view: &View, p: &Point3<f64>, edge: EdgeModel) -> bool {
    /// Far more than rounding, in pixels.
    const ROUNDING_PX: f64 = 1e-6;
    let silhouette = view.silhouette();
    let Some(at) = view.project(p) else { return false };
    let (i, j) = floor_pixel(at.u, at.v);
    let (x, y) = (at.u - f64::from(i), at.v - f64::from(j));
    let within = |x: f64| x > ROUNDING_PX && x < 1.0 - ROUNDING_PX;
    if !view.sees(i, j) || !within(x) || !within(y) {
        false
    } else if edge == EdgeModel::Coverage && silhouette.has_coverage() {
        // Between subject pixels alone coverage is one half at least.
        silhouette.distance(i, j) <= 1
            && silhouette.coverage(at.u, at.v) < HALF_COVERAGE - 255.0 * ROUNDING_PX
    } else {
        silhouette.distance(i, j) == 0
    }
}

vectorised! {
    /// Adds those of a block of points that are inside to `rays`, and to the queries of the view that decides; which
    /// these are.
    fn find_inside(batch: &mut Batch, points: &[Point3<f64>], rays: &mut Vec<ExitRay>) -> u32 {
        let Batch { hull, kernels, block, queries, .. } = batch;
        block.place(points.len(), |k| points[k]);
        let inside = block.within(hull.bounds(), u32::MAX >> (LANES - points.len()));
        let inside = if hull.culls.frustum_box { block.within(hull.aabb(), inside) } else { inside };
        let inside = block.project_if_inside(kernels, hull.unseen(), inside);
        if inside == 0 { 0 } else { queries.add(kernels, block, inside, rays) }
    }
}

/// A hull that is asked, and what the answers are worked out in.
struct Batch<'a> {
    hull: &'a Hull,
    kernels: &'a [ViewKernel<'a>],
    block: &'a mut PointBlock,
    queries: &'a mut EdgeQueries,
    exits: &'a mut ExitFinder,
}

impl Scratch {
    /// Runs `ask` on what of the hull's views every point needs.
    fn with_kernels(&mut self, hull: &Hull, edge: EdgeModel, ask: impl FnOnce(&mut Batch)) {
        let mut kernels: Vec<ViewKernel> = std::mem::take(&mut self.kernels);
        let enabled = hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
        kernels.extend(enabled.map(|(index, view)| ViewKernel::new(hull, index, view, edge)));
        let Self { block, queries, exits, .. } = self;
        ask(&mut Batch { hull, kernels: &kernels, block, queries, exits });
        self.kernels = recycle(kernels);
    }
}

#[cfg(test)]
mod tests;
