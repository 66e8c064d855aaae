//! Hulls at a simulation's own time.

use super::{HullData, check_time};
use crate::hull::live::moving_mask::MovingMask;
use crate::hull::{Hull, Motion};
use crate::side_by_side::side_by_side;
use crate::{Error, Result};
use std::sync::Arc;

impl HullData {
    /// The hull at `time` seconds of the simulation's clock, which is that of the frames: see [`Motion`].
    ///
    /// A silhouette is warped for this time alone, and kept until another time is asked for: a simulation that waits for its
    /// next step may [prepare](Self::prepare_motion) that step before. Views are late as at the time that the hull shows, but no
    /// later than in the latest frame.
    ///
    /// # Errors
    /// No frame yet; a time that is not finite.
    pub fn in_motion(&self, motion: Motion, time: f64) -> Result<Arc<Hull>> {
        self.warped(motion, time, |masks| masks.iter_mut().flatten().for_each(MovingMask::warp))
    }

    /// Warps the silhouettes of all views for [`in_motion`](Self::in_motion) of this time, side by side on as many threads as
    /// there are processors: for a simulation that has to meet the time at which its next step is due.
    ///
    /// # Errors
    /// All errors of [`in_motion`](Self::in_motion).
    pub fn prepare_motion(&self, motion: Motion, time: f64) -> Result<()> {
        let warp = |masks: &mut [Option<MovingMask>]| {
            let unwarped = masks.iter_mut().flatten().filter(|mask| !mask.is_warped);
            // Warping cannot fail.
            let _ = side_by_side(unwarped, |mask| {
                mask.warp();
                Ok(())
            });
        };
        self.warped(motion, time, warp).map(drop)
    }

    /// The hull of [`in_motion`](Self::in_motion), whose masks `warp` warps.
    fn warped(
        &self,
        motion: Motion,
        time: f64,
        warp: impl FnOnce(&mut [Option<MovingMask>]),
    ) -> Result<Arc<Hull>> {
        check_time(time)?;
        let mut state = self.lock();
        let Some(latest) = state.latest.clone() else {
            return Err(Error::argument(
                "expected a frame before a moving hull, found none; call update first",
            ));
        };
        if motion == Motion::Held {
            return Ok(latest);
        }

        // One frame of latency lets every time lie between two frames.
        state.motion_asked = Some(state.published);
        let is_ahead = motion == Motion::Predicted;
        let asked = if is_ahead { time } else { time - state.period };
        let shown = if is_ahead { time } else { asked.min(latest.time()) };
        let oldest = state.oldest_mask(shown.min(latest.time()));
        let masks = state.views.iter_mut().map(|view| view.moving_mask(asked, is_ahead, oldest));
        let mut masks: Vec<_> = masks.collect();
        drop(state);

        // Masks are warped outside the lock, so that cameras do not wait.
        warp(&mut masks);

        let mut state = self.lock();
        let hull = state.frame(shown, |k, view, bounds| {
            let mask = masks.get_mut(k).and_then(Option::take);
            view.moved_view(mask, bounds, shown, oldest)
        })?;
        state.retired.push(hull.clone());
        state.recycle();
        Ok(hull)
    }
}
