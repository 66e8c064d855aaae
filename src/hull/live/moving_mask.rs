//! A silhouette that is warped to a time between two masks of its view or after them.

use super::preparation::ViewCalibration;
use crate::silhouette::{Border, EdgeDistances, MaskMotion, MotionChain, Silhouette, WarpedMask};
use std::sync::Arc;

/// A silhouette that is being warped to a time, without holding a lock.
#[derive(Debug)]
pub(super) struct MovingMask {
    pub(super) calibration: Arc<ViewCalibration>,
    pub(super) motion: Arc<MaskMotion>,
    /// `None` where the silhouette stands still, since the next mask is late.
    pub(super) chain: Option<Arc<MotionChain>>,
    pub(super) s: f64,
    pub(super) time: f64,
    pub(super) border: Border,
    pub(super) silhouette: Arc<Silhouette>,
}

impl MovingMask {
    /// Warps the silhouette.
    pub(super) fn warp(&mut self) {
        if Arc::get_mut(&mut self.silhouette).is_none() {
            self.silhouette = Arc::new(Silhouette::blank(self.border));
        }
        let Some(silhouette) = Arc::get_mut(&mut self.silhouette) else {
            unreachable!("a new silhouette has one owner");
        };
        let ViewCalibration { pinhole, visible, .. } = &*self.calibration;
        WarpedMask::with_scratch(|memory| {
            let mask = self.motion.warp(self.s, pinhole.size(), memory);
            if let Some(visible) = visible {
                mask.hide(visible.subject(), self.border == Border::Unknown);
            }
            silhouette.refill_packed(mask, self.border);
        });
    }
}

/// The distances of a mask, in the memory of others unless these are shared.
pub(super) fn distances_of(silhouette: &Silhouette, mut memory: Arc<EdgeDistances>) -> Arc<EdgeDistances> {
    match Arc::get_mut(&mut memory) {
        Some(distances) => distances.fill(silhouette),
        None => {
            let mut distances = EdgeDistances::default();
            distances.fill(silhouette);
            memory = Arc::new(distances);
        }
    }
    memory
}

/// The motion between two masks, in the memory of another unless that is shared.
pub(super) fn motion_between(
    earlier: Arc<EdgeDistances>,
    later: Arc<EdgeDistances>,
    mut memory: Arc<MaskMotion>,
) -> Arc<MaskMotion> {
    match Arc::get_mut(&mut memory) {
        Some(motion) => motion.fill(earlier, later),
        None => {
            let mut motion = MaskMotion::default();
            motion.fill(earlier, later);
            memory = Arc::new(motion);
        }
    }
    memory
}
