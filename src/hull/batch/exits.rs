//! Where many rays leave the hull: the nearest exit over the views and the work volume.
//!
//! ```text
//!   work volume ─► each view, the rays it is likely to decide: traverse
//!               ─► each view, the other rays: traverse, unless surely subject up to the exit so far
//!               ─► rays of which a view may lose or gain sight before the exit: traverse all views in step
//! ```

use super::ExitRay;
use super::image_lines::{ImageLines, RayBlock};
use super::line_walk::{NearestExits, RayQueue};
use super::projection::ViewKernel;
use crate::hull::{EdgeModel, Hull};
use crate::math::lanes::{lane_mask, select};
use crate::math::point_cloud::LANES;
use crate::math::vectorised;

/// The rays of a batch and the state of their traversals.
#[derive(Debug, Default)]
pub(super) struct ExitFinder {
    /// The rays in blocks. The last block is padded with its last ray.
    blocks: Vec<RayBlock>,
    /// For each kernel the indices of the rays that its view is likely to decide.
    first: Vec<Vec<u32>>,
    /// For each ray, in metres, up to where the views that see its point surely keep sight of it, and the others do not
    /// gain it.
    sight_ends: Vec<f64>,
    /// For each ray the index of the kernel of the view that gives its exit so far.
    deciders: Vec<u32>,
    lines: ImageLines,
    queue: RayQueue,
}

impl ExitFinder {
    /// Writes to `exits` the exits of `rays`, in metres and at most `t_max`, and to each ray the view that gave its
    /// exit.
    pub(super) fn find(
        &mut self,
        hull: &Hull,
        kernels: &[ViewKernel],
        rays: &mut [ExitRay],
        t_max: f64,
        exits: &mut Vec<f64>,
    ) {
        self.fill_blocks(kernels, rays);

        // One exit for each lane of the blocks, first from the work volume.
        exits.clear();
        exits.resize(self.blocks.len() * LANES, t_max);
        self.sight_ends.clear();
        self.sight_ends.resize(exits.len(), f64::INFINITY);
        for (block, exits) in self.blocks.iter().zip(exits.chunks_exact_mut(LANES)) {
            lower_to_bounds(hull, block, exits);
        }

        // Likely views first, so that most of the others can be skipped.
        self.queue.restart();
        let mut deciders = std::mem::take(&mut self.deciders);
        deciders.clear();
        for block in &self.blocks {
            deciders.extend_from_slice(&block.first);
        }
        let mut nearest = NearestExits { exits, deciders: &mut deciders };
        for place in 0..kernels.len() {
            trace_likely_view(kernels, place, self, &mut nearest);
        }
        self.queue.drain(kernels, &mut nearest);
        for place in 0..kernels.len() {
            trace_other_views(kernels, place, self, &mut nearest);
        }
        self.queue.drain(kernels, &mut nearest);

        exits.truncate(rays.len());
        rays.iter_mut().zip(&deciders).for_each(|(ray, &place)| ray.view = kernels[place as usize].index);
        self.deciders = deciders;
        if let Some(first) = kernels.first() {
            self.retrace_beyond_sight(hull, rays, first.edge, t_max, exits);
        }
    }

    /// Puts the rays into blocks, and their indices into the lists of the views that are likely to decide.
    fn fill_blocks(&mut self, kernels: &[ViewKernel], rays: &[ExitRay]) {
        let Self { blocks, first, .. } = self;
        first.resize_with(first.len().max(kernels.len()), Vec::new);
        first.iter_mut().for_each(Vec::clear);
        blocks.clear();

        for (chunk, base) in rays.chunks(LANES).zip((0..).step_by(LANES)) {
            let mut block = RayBlock::empty(chunk.len());
            for k in 0..LANES {
                let ExitRay { point, direction, view, .. } = chunk[k.min(chunk.len() - 1)];
                let place = kernels.iter().position(|kernel| kernel.index == view).unwrap_or(0);
                for axis in 0..3 {
                    (block.point[axis][k], block.direction[axis][k]) = (point[axis], direction[axis]);
                }
                block.first[k] = place as u32;
                if k < chunk.len() {
                    first[place].push(base + k as u32);
                }
            }
            blocks.push(block);
        }
    }

    /// Computes again, by the single query, the exits that lie beyond the end of sight. There the policy for views that
    /// do not see a point decides.
    fn retrace_beyond_sight(
        &self,
        hull: &Hull,
        rays: &[ExitRay],
        edge: EdgeModel,
        t_max: f64,
        exits: &mut [f64],
    ) {
        for ((ray, sight_end), exit) in rays.iter().zip(&self.sight_ends).zip(exits) {
            if *exit > *sight_end {
                *exit = hull.exit_within(&ray.point, &ray.direction, edge, t_max);
            }
        }
    }
}

vectorised! {
    /// Traverses the view of the kernel at `place` along the rays that it is likely to decide.
    fn trace_likely_view(kernels: &[ViewKernel], place: usize, finder: &mut ExitFinder, nearest: &mut NearestExits) {
        let ExitFinder { blocks, first, lines, queue, sight_ends, .. } = finder;
        for points in first[place].chunks(LANES) {
            // The rays are gathered into a block of their own.
            let mut block = RayBlock::empty(points.len());
            for k in 0..LANES {
                let point = points[k.min(points.len() - 1)] as usize;
                let (from, lane) = (&blocks[point / LANES], point % LANES);
                for axis in 0..3 {
                    block.point[axis][k] = from.point[axis][lane];
                    block.direction[axis][k] = from.direction[axis][lane];
                }
                (lines.point[k], lines.t_max[k]) = (point as u32, nearest.exits[point]);
            }

            let visible = lines.project(&kernels[place], &block, sight_ends);
            queue.push(kernels, place, lines, visible & (u32::MAX >> (LANES - points.len())), nearest);
        }
    }
}

vectorised! {
    /// Traverses the view of the kernel at `place` along the rays that it is not likely to decide, except for those
    /// that it surely sees inside up to their exits so far.
    fn trace_other_views(kernels: &[ViewKernel], place: usize, finder: &mut ExitFinder, nearest: &mut NearestExits) {
        let ExitFinder { blocks, lines, queue, sight_ends, .. } = finder;
        for (k, block) in blocks.iter().enumerate() {
            let base = k * LANES;
            for lane in 0..LANES {
                (lines.point[lane], lines.t_max[lane]) = ((base + lane) as u32, nearest.exits[base + lane]);
            }

            let kernel = &kernels[place];
            let visible = lines.project(kernel, block, sight_ends);
            let mut others = [0; LANES];
            for lane in 0..LANES {
                others[lane] = u32::from(block.first[lane] != place as u32);
            }
            let others = lane_mask(&others) & (u32::MAX >> (LANES - block.count)) & visible;

            // The cheaper test first.
            let mut unresolved = others & !lines.stay_inside(kernel);
            if unresolved != 0 {
                unresolved &= !lines.end_inside(kernel);
            }
            queue.push(kernels, place, lines, unresolved, nearest);
        }
    }
}

vectorised! {
    /// Lowers the exits of a block's rays to where they leave the work volume.
    fn lower_to_bounds(hull: &Hull, block: &RayBlock, exits: &mut [f64]) {
        let bounds = hull.bounds();
        for axis in 0..3 {
            let (min, max) = (bounds.min[axis], bounds.max[axis]);
            for k in 0..LANES {
                let (at, direction) = (block.point[axis][k], block.direction[axis][k]);
                let t = (select(direction > 0.0, max, min) - at) / direction;
                exits[k] = select((direction != 0.0) & (t < exits[k]), t, exits[k]);
            }
        }
    }
}
