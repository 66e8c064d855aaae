//! The motion of a silhouette from one mask to the next: optical flow between their signed distances, and the
//! silhouettes between the two masks and after the second, which are warped along it.
//!
//! ```text
//!   masks ─► distance images ─► flow ─► warped distances ─► a mask like any other
//! ```
//!
//! `D(t) = (1 - s) D0(p + s f) + s D1(p - (1 - s) f)` between the masks, where s is 0 at the earlier and 1 at the later
//! one, and `D(t) = D1(p + a f)` a frames ahead of the later one. f leads from the later mask back to the earlier one.

mod cell_means;
mod distance_image;
mod flow;
mod level;
mod mix;
mod moving_edge;
mod patch;
mod sampling;
mod shift;
mod warp;

use super::{PackedMask, Silhouette};
use crate::recycle::{keep_scratch, take_scratch};
use distance_image::{DistanceImage, DistanceScratch};
use flow::{Flow, FlowScratch, MAX_AHEAD};
use mix::{Mix, Term};
pub(crate) use shift::{EdgeShift, MotionChain};
use std::cell::Cell;
use std::sync::Arc;
use warp::{WarpScratch, warp};

/// The distances of one mask of a view.
#[derive(Debug, Default)]
pub(crate) struct EdgeDistances(DistanceImage);

/// The motion of a view's silhouette between two masks.
#[derive(Debug, Default)]
pub(crate) struct MaskMotion {
    earlier: Arc<EdgeDistances>,
    later: Arc<EdgeDistances>,
    flow: Flow,
}

/// A warped silhouette, and memory for warping others.
#[derive(Debug, Default)]
pub(crate) struct WarpedMask {
    mask: PackedMask,
    scratch: WarpScratch,
}

// Memory of a thread, not of a view: it stays in the processor's caches from one view to the next.
thread_local! {
    static DISTANCES: Cell<Option<Box<DistanceScratch>>> = const { Cell::new(None) };
    static FLOW: Cell<Option<Box<FlowScratch>>> = const { Cell::new(None) };
    static WARPED: Cell<Option<Box<WarpedMask>>> = const { Cell::new(None) };
}

impl EdgeDistances {
    /// Computes the distances of a silhouette, in the memory of the last ones.
    pub(crate) fn fill(&mut self, silhouette: &Silhouette) {
        let mut scratch = take_scratch(&DISTANCES);
        self.0.fill(silhouette, &mut scratch);
        keep_scratch(&DISTANCES, scratch);
    }
}

impl MaskMotion {
    /// Computes the motion between two masks, in the memory of the last one.
    pub(crate) fn fill(&mut self, earlier: Arc<EdgeDistances>, later: Arc<EdgeDistances>) {
        let mut scratch = take_scratch(&FLOW);
        self.flow.fill(&earlier.0, &later.0, &mut scratch);
        keep_scratch(&FLOW, scratch);
        (self.earlier, self.later) = (earlier, later);
    }

    /// Takes the earlier mask's distances, as memory for another mask's; the motion is to be filled anew.
    pub(crate) fn take_earlier(&mut self) -> Arc<EdgeDistances> {
        std::mem::replace(&mut self.earlier, self.later.clone())
    }

    /// Warps the mask of `size` pixels at `s` from 0, the earlier mask, to 1, the later one; above 1 it lies ahead of the
    /// later one.
    pub(crate) fn warp<'m>(
        &self,
        s: f64,
        size: (u32, u32),
        memory: &'m mut WarpedMask,
    ) -> &'m mut PackedMask {
        let WarpedMask { mask, scratch } = memory;
        let (s, ahead) = (s as f32, (s as f32 - 1.0).max(0.0));
        let (earlier, later) = (&self.earlier.0, &self.later.0);
        if ahead > 0.0 {
            // The subject may leave the rectangle in which its flow is known.
            let rect = self.flow.rect().grown((self.flow.longest().min(MAX_AHEAD) * ahead).ceil() as i32);
            let rect = distance_image::whole_cells(&rect);
            let terms = [Term { image: later, is_later: true, weight: 1.0, along_flow: ahead }];
            warp(&terms, Mix::Sum, &self.flow.ahead(), &rect, size, mask, scratch);
        } else {
            let terms = [
                Term { image: earlier, is_later: false, weight: 1.0 - s, along_flow: s },
                Term { image: later, is_later: true, weight: s, along_flow: s - 1.0 },
            ];
            warp(&terms, Mix::Sum, &self.flow.between(), &self.flow.rect(), size, mask, scratch);
        }
        mask
    }

    /// The later mask, of `size` pixels, averaged with the earlier one where the flow leads and the two agree, by their
    /// signed distances: `weight` is that of the later one, from 0 to 1.
    pub(crate) fn average<'m>(
        &self,
        weight: f64,
        size: (u32, u32),
        memory: &'m mut WarpedMask,
    ) -> &'m mut PackedMask {
        let WarpedMask { mask, scratch } = memory;
        let weight = weight as f32;
        let (earlier, later) = (&self.earlier.0, &self.later.0);
        let terms = [
            Term { image: earlier, is_later: false, weight: 1.0 - weight, along_flow: 1.0 },
            Term { image: later, is_later: true, weight, along_flow: 0.0 },
        ];
        warp(&terms, Mix::Agreement, &self.flow.between(), &self.flow.rect(), size, mask, scratch);
        mask
    }

    /// Replaces the later mask's distances by those of its average.
    pub(crate) fn replace_later(&mut self, later: Arc<EdgeDistances>) {
        self.flow.replace_later(&later.0);
        self.later = later;
    }
}

impl WarpedMask {
    /// Runs `work` on memory that belongs to the thread.
    pub(crate) fn with_scratch<R>(work: impl FnOnce(&mut Self) -> R) -> R {
        let mut memory = take_scratch(&WARPED);
        let result = work(&mut memory);
        keep_scratch(&WARPED, memory);
        result
    }
}

#[cfg(test)]
mod tests;
