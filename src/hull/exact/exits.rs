//! Where many points inside leave the hull: the nearest exit over the views and the work volume.
//!
//! ```text
//!   wall ─► view by view, the points it is likely to decide: walk
//!        ─► view by view, all others: those surely subject up to the exit so far stay, the rest walk
//! ```

use super::super::Hull;
use super::super::lanes::{bits, either};
use super::super::points::LANES;
use super::sight::Field;
use super::walk::{Lines, Walkers};
use super::{Start, Wide};
use crate::vectorised::vectorised;

/// Points on their way, in blocks of as many as are asked together; the last block is filled up with its last point.
#[derive(Debug, Default)]
pub(super) struct Exits {
    blocks: Vec<Block>,
    /// By the view that is likely to decide: the places of the points.
    first: Vec<Vec<u32>>,
    lines: Lines,
    walkers: Walkers,
}

/// Where points are, and where they go.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) point: [Wide; 3],
    pub(super) direction: [Wide; 3],
    /// The place of each point's first view among the fields.
    first: [u32; LANES],
    /// How many points are no filling.
    count: usize,
}

impl Exits {
    /// Writes to `exits` the exits of `starts`, at most `most`.
    pub(super) fn find(
        &mut self,
        hull: &Hull,
        fields: &[Field],
        starts: &[Start],
        most: f64,
        exits: &mut Vec<f64>,
    ) {
        self.take(fields, starts);
        exits.clear();
        // Filled up as the blocks are.
        exits.resize(self.blocks.len() * LANES, most);
        for (block, exits) in self.blocks.iter().zip(exits.chunks_exact_mut(LANES)) {
            lower_to_wall(hull, block, exits);
        }
        for (place, field) in fields.iter().enumerate() {
            walk_first(field, self, place, exits);
        }
        for (place, field) in fields.iter().enumerate() {
            walk_others(field, self, place, exits);
        }
        exits.truncate(starts.len());
    }

    fn take(&mut self, fields: &[Field], starts: &[Start]) {
        let Self { blocks, first, .. } = self;
        first.resize_with(first.len().max(fields.len()), Vec::new);
        first.iter_mut().for_each(Vec::clear);
        blocks.clear();
        for (chunk, base) in starts.chunks(LANES).zip((0..).step_by(LANES)) {
            let mut block = Block::empty(chunk.len());
            for k in 0..LANES {
                let Start { point, direction, view } = chunk[k.min(chunk.len() - 1)];
                let place = fields.iter().position(|field| field.index == view).unwrap_or(0);
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
}

vectorised! {
    /// Walks the points through the view at `place` that is likely to decide them.
    fn walk_first(field: &Field, memory: &mut Exits, place: usize, exits: &mut [f64]) {
        let Exits { blocks, first, lines, walkers } = memory;
        for points in first[place].chunks(LANES) {
            let mut block = Block::empty(points.len());
            for k in 0..LANES {
                let point = points[k.min(points.len() - 1)] as usize;
                let (from, lane) = (&blocks[point / LANES], point % LANES);
                for axis in 0..3 {
                    block.point[axis][k] = from.point[axis][lane];
                    block.direction[axis][k] = from.direction[axis][lane];
                }
                (lines.point[k], lines.limit[k]) = (point as u32, exits[point]);
            }
            lines.sight(field, &block);
            walkers.set_out(field, lines, u32::MAX >> (LANES - points.len()), exits);
        }
        walkers.arrive(field, exits);
    }
}

vectorised! {
    /// Walks all other points through it, unless it surely sees them inside up to their exits so far.
    fn walk_others(field: &Field, memory: &mut Exits, place: usize, exits: &mut [f64]) {
        let Exits { blocks, lines, walkers, .. } = memory;
        for (k, block) in blocks.iter().enumerate() {
            let base = k * LANES;
            for lane in 0..LANES {
                (lines.point[lane], lines.limit[lane]) = ((base + lane) as u32, exits[base + lane]);
            }
            lines.sight(field, block);
            let mut others = [0; LANES];
            for lane in 0..LANES {
                others[lane] = u32::from(block.first[lane] != place as u32);
            }
            let others = bits(&others) & (u32::MAX >> (LANES - block.count));
            let doubtful = others & !lines.stay_inside(field);
            walkers.set_out(field, lines, doubtful, exits);
        }
        walkers.arrive(field, exits);
    }
}

vectorised! {
    /// Lowers exits to the side of the work volume.
    fn lower_to_wall(hull: &Hull, block: &Block, exits: &mut [f64]) {
        let bounds = hull.bounds();
        for axis in 0..3 {
            let (min, max) = (bounds.min[axis], bounds.max[axis]);
            for k in 0..LANES {
                let (at, ahead) = (block.point[axis][k], block.direction[axis][k]);
                let t = (either(ahead > 0.0, max, min) - at) / ahead;
                exits[k] = either((ahead != 0.0) & (t < exits[k]), t, exits[k]);
            }
        }
    }
}

impl Block {
    fn empty(count: usize) -> Self {
        Self { point: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3], first: [0; LANES], count }
    }
}
