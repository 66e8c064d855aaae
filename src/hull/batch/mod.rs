//! Exit directions and exits of many points at once.
//!
//! ```text
//!   points ─► projection ─► nearest edge ─► normal ─► exit
//!             all views     the view that decides     all views
//! ```
//!
//! The [`EdgeModel`] selects the result. With [`EdgeModel::Coverage`] it is what contacts use: the contact normal, and
//! the exit at the coverage edge. With [`EdgeModel::Pixel`] it is the paper's response: binary masks, 5x5 normals, and
//! the exit at a pixel's border.
//!
//! Each step processes a block of points side by side. It does the arithmetic of [`Hull::exit_vector`],
//! [`Hull::respond`] and [`Hull::exit_within`] in the same order, and so returns the same bits. Rare cases are left to
//! the single queries: traversals along the rim of a silhouette's rectangle, and exits before which a view may lose
//! sight of the point.

// Loops over lanes index several arrays by k: this is the form that the compiler vectorises.
#![allow(clippy::needless_range_loop)]

mod directions;
mod edge_query;
mod exits;
mod image_lines;
mod line_walk;
mod nearest_edge;
mod overruled;
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

/// One number for each point of a block.
type Wide = [f64; LANES];

/// A point inside, and the direction in which it leaves the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ExitRay {
    pub(crate) point: Point3<f64>,
    /// Unit length.
    pub(crate) direction: Vector3<f64>,
    /// Index of the view that gave the direction, which is likely to give the exit too; once the exit has been
    /// computed, of the view that gave it.
    pub(crate) view: usize,
    /// Whether a view is overruled at the point. The single queries trace such rays.
    pub(crate) overrules: bool,
}

/// Memory that batches reuse. It holds no results.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    kernels: Vec<ViewKernel<'static>>,
    block: PointBlock,
    queries: EdgeQueries,
    exits: ExitFinder,
}

impl Hull {
    /// Finds the points that are inside by `edge`, and their exit directions. Writes their indices in `points` to
    /// `places` and their rays to `rays`, in order. It may stop after `min_count` of them.
    pub(crate) fn exit_rays(
        &self,
        points: &[Point3<f64>],
        edge: EdgeModel,
        min_count: usize,
        scratch: &mut Scratch,
        places: &mut Vec<usize>,
        rays: &mut Vec<ExitRay>,
    ) {
        places.clear();
        rays.clear();

        scratch.with_kernels(self, edge, |batch| {
            for (chunk, first) in points.chunks(LANES).zip((0..).step_by(LANES)) {
                if rays.len() >= min_count {
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

    /// Writes to `exits` what [`Self::exit_within`] returns for each of `rays`, whose points are inside by `edge`, and
    /// to each ray the view that gave its exit.
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
        if rays.iter().any(|ray| ray.overrules) {
            return self.exits_with_overruled(rays, edge, t_max, scratch, exits);
        }
        scratch.with_kernels(self, edge, |batch| {
            batch.exits.find(self, batch.kernels, rays, t_max, exits);
        });
    }

    /// [`Self::exits_within`] where views are overruled at some of the points.
    fn exits_with_overruled(
        &self,
        rays: &mut [ExitRay],
        edge: EdgeModel,
        t_max: f64,
        scratch: &mut Scratch,
        exits: &mut Vec<f64>,
    ) {
        let (mut others, mut of_others) =
            (rays.iter().filter(|ray| !ray.overrules).copied().collect::<Vec<_>>(), Vec::new());
        self.exits_within(&mut others, edge, t_max, scratch, &mut of_others);

        let mut others = others.into_iter().zip(of_others).peekable();
        for ray in rays {
            exits.push(match others.next_if(|_| !ray.overrules) {
                Some((other, exit)) => {
                    *ray = other;
                    exit
                }
                None => self.exit_within(&ray.point, &ray.direction, edge, t_max),
            });
        }
    }

    /// Adds to `kept` the indices of the `rays` whose exits do not provably lie before their `t`, in metres. It may
    /// prove slightly fewer of them than [`Self::provably_exits_before`].
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

    /// Whether the exit of `ray` provably lies before `t` metres, because some view sees background there. The view
    /// that is likely to give the exit is tested first. This takes one look-up a view, where an exit takes a traversal.
    pub(crate) fn provably_exits_before(&self, ray: &ExitRay, edge: EdgeModel, t: f64) -> bool {
        if ray.overrules {
            return false;
        }
        let end = ray.point + ray.direction * t;
        let others = self.views().iter().enumerate().filter(|(k, view)| *k != ray.view && view.is_enabled());
        provably_outside(&self.views()[ray.view], &end, edge)
            || others.into_iter().any(|(_, view)| provably_outside(view, &end, edge))
    }
}

/// Whether a view sees background at `p`, regardless of rounding in the projection.
fn provably_outside(view: &View, p: &Point3<f64>, edge: EdgeModel) -> bool {
    /// Far more than rounding, in pixels.
    const ROUNDING_PX: f64 = 1e-6;

    let silhouette = view.silhouette();
    let Some(at) = view.project(p) else { return false };
    let (i, j) = floor_pixel(at.u, at.v);
    let (x, y) = (at.u - f64::from(i), at.v - f64::from(j));
    let off_border = |x: f64| x > ROUNDING_PX && x < 1.0 - ROUNDING_PX;

    if !view.sees(i, j) || !off_border(x) || !off_border(y) {
        false
    } else if edge == EdgeModel::Coverage && silhouette.has_coverage() {
        // Between subject pixels alone coverage is at least one half.
        silhouette.distance(i, j) <= 1
            && silhouette.coverage(at.u, at.v) < HALF_COVERAGE - 255.0 * ROUNDING_PX
    } else {
        silhouette.distance(i, j) == 0
    }
}

vectorised! {
    /// Adds the points of a block that are inside to `rays`, and to the queries of the views that decide. Returns a bit
    /// mask of these points.
    fn find_inside(batch: &mut Batch, points: &[Point3<f64>], rays: &mut Vec<ExitRay>) -> u32 {
        let Batch { hull, kernels, block, queries, .. } = batch;
        block.place(points.len(), |k| points[k]);
        let inside = block.within(hull.bounds(), u32::MAX >> (LANES - points.len()));
        let inside = if hull.culls.frustum_box { block.within(hull.aabb(), inside) } else { inside };
        let may_overrule = hull.overrule_depth().is_some();
        let (inside, outside) = block.project_if_inside(kernels, hull.unseen(), may_overrule, inside);
        if inside == 0 { 0 } else { queries.add(hull, kernels, block, (inside, outside), rays) }
    }
}

/// A hull whose views are ready for a batch, and the memory of the batch.
struct Batch<'a> {
    hull: &'a Hull,
    kernels: &'a [ViewKernel<'a>],
    block: &'a mut PointBlock,
    queries: &'a mut EdgeQueries,
    exits: &'a mut ExitFinder,
}

impl Scratch {
    /// Runs `query` with the kernels of the hull's enabled views.
    fn with_kernels(&mut self, hull: &Hull, edge: EdgeModel, query: impl FnOnce(&mut Batch)) {
        let mut kernels: Vec<ViewKernel> = std::mem::take(&mut self.kernels);
        let enabled = hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
        kernels.extend(enabled.map(|(index, view)| ViewKernel::new(hull, index, view, edge)));
        let Self { block, queries, exits, .. } = self;
        query(&mut Batch { hull, kernels: &kernels, block, queries, exits });
        self.kernels = recycle(kernels);
    }
}

#[cfg(test)]
mod tests;
