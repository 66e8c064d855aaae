//! Hulls at a simulation's own time.

use super::{HullData, check_time};
use crate::hull::live::moving_mask::MovingMask;
use crate::hull::{Hull, Motion};
use crate::{Error, Result};
use std::sync::Arc;

impl HullData {
    /// The hull at `time` seconds of the simulation's clock, which is that of the frames: see [`Motion`].
    ///
    /// A silhouette is warped for this time alone, and kept until another time is asked for: a simulation that waits for its
    /// next step may ask for the time of that step before. Views are late as at the
    /// time that the hull shows, but no later than in the latest frame.
    ///
    /// # Errors
    /// No frame yet; a time that is not finite.
    pub fn in_motion(&self, motion: Motion, time: f64) -> Result<Arc<Hull>> {
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
        masks.iter_mut().flatten().for_each(MovingMask::warp);

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
