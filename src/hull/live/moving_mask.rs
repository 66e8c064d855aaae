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
    /// Whether the silhouette is warped already.
    pub(super) is_warped: bool,
}

/// The silhouette that was warped last in a view: it is likely to be asked for again at its time.
#[derive(Debug)]
pub(super) struct LastWarped {
    motion: Arc<MaskMotion>,
    s: f64,
    silhouette: Arc<Silhouette>,
}

/// Silhouettes whose times differ by less than this, in times between the two masks, are equal: edges move by less than a
/// hundredth of a pixel.
const SAME_TIME: f64 = 1e-4;

impl LastWarped {
    /// The silhouette, if it is that of `motion` at `s`.
    pub(super) fn at(&self, motion: &Arc<MaskMotion>, s: f64) -> Option<Arc<Silhouette>> {
        let is_same = Arc::ptr_eq(&self.motion, motion) && (self.s - s).abs() < SAME_TIME;
        is_same.then(|| self.silhouette.clone())
    }

    /// Whether `mask` shows this very silhouette.
    pub(super) fn is_shown_by(&self, mask: &MovingMask) -> bool {
        Arc::ptr_eq(&self.silhouette, &mask.silhouette)
    }

    /// The silhouette, whatever it shows.
    pub(super) fn into_silhouette(self) -> Arc<Silhouette> {
        self.silhouette
    }
}

impl MovingMask {
    /// Warps the silhouette, unless it is warped already.
    pub(super) fn warp(&mut self) {
        if std::mem::replace(&mut self.is_warped, true) {
            return;
        }
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

    /// The warped silhouette, to be kept.
    pub(super) fn to_last_warped(&self) -> LastWarped {
        LastWarped { motion: self.motion.clone(), s: self.s, silhouette: self.silhouette.clone() }
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
