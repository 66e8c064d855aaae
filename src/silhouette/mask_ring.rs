//! The latest masks of one view, ordered by the times at which they were taken.

use super::Silhouette;
use crate::{Error, Result};
use std::collections::VecDeque;
use std::sync::Arc;

/// How long masks are kept after the latest one was taken, in seconds. One older mask is kept in addition.
const HISTORY: f64 = 0.1;

/// The masks of one view from the last tenth of a second and one before them, ordered by time.
#[derive(Debug, Default)]
pub(crate) struct MaskRing {
    masks: VecDeque<TimedMask>,
}

/// A prepared mask and the time at which it was taken.
#[derive(Debug, Clone)]
pub(crate) struct TimedMask {
    pub(crate) silhouette: Arc<Silhouette>,
    /// The time in seconds. A mask without a time gets the time of the first frame that uses it.
    pub(crate) time: Option<f64>,
}

impl MaskRing {
    /// The latest mask.
    pub(crate) fn latest(&self) -> Option<&TimedMask> {
        self.masks.back()
    }

    /// The latest mask that was taken at `time` or before, or the earliest mask if there is none.
    pub(crate) fn at(&self, time: f64) -> Option<&TimedMask> {
        let not_after = |mask: &&TimedMask| mask.time.is_some_and(|taken| taken <= time);
        self.masks.iter().rev().find(not_after).or(self.masks.front())
    }

    /// Checks that `time` can be the time of the next mask.
    ///
    /// # Errors
    /// If `time` is not finite, or lies before the time of the latest mask.
    pub(crate) fn check_time(&self, time: Option<f64>) -> Result<()> {
        let Some(time) = time else { return Ok(()) };
        if !time.is_finite() {
            return Err(Error::argument(format!(
                "mask: expected a finite time in seconds, found {time}; pass the camera's clock"
            )));
        }

        let latest = self.masks.iter().rev().find_map(|mask| mask.time);
        if let Some(latest) = latest.filter(|&latest| time < latest) {
            return Err(Error::argument(format!(
                "mask: expected a time not before the last mask's, {latest} s, found {time} s; pass the times of one \
                 clock, and leave out masks that come late"
            )));
        }
        Ok(())
    }

    /// Appends a mask. It replaces the latest one if that has the same time or none; the replaced mask is returned.
    pub(crate) fn push(&mut self, mask: TimedMask) -> Option<Arc<Silhouette>> {
        let is_replaced = self.latest().is_some_and(|last| last.time.is_none() || last.time == mask.time);
        let replaced = if is_replaced { self.masks.pop_back() } else { None };
        self.masks.push_back(mask);
        replaced.map(|mask| mask.silhouette)
    }

    /// The time of the latest mask as part of a frame at `time`: its own time, or else `time`, but not before the
    /// previous mask's.
    pub(crate) fn time_in_frame(&self, time: f64) -> Option<f64> {
        let previous = self.masks.iter().rev().nth(1).and_then(|mask| mask.time);
        self.latest()
            .map(|latest| latest.time.unwrap_or(previous.map_or(time, |previous| previous.max(time))))
    }

    /// Sets the time of the latest mask to [`Self::time_in_frame`] when a frame at `time` is published.
    pub(crate) fn publish(&mut self, time: f64) {
        let mask_time = self.time_in_frame(time);
        if let Some(latest) = self.masks.back_mut() {
            latest.time = mask_time;
        }
    }

    /// Removes and returns the earliest mask if it is too old.
    pub(crate) fn pop_old(&mut self) -> Option<Arc<Silhouette>> {
        let latest = self.latest()?.time?;
        let is_old = self.masks.len() > 2 && self.masks[1].time.is_some_and(|time| time < latest - HISTORY);
        if is_old { self.masks.pop_front().map(|mask| mask.silhouette) } else { None }
    }

    /// All masks but the latest, from late to early.
    pub(crate) fn past(&mut self) -> impl Iterator<Item = &mut Arc<Silhouette>> {
        self.masks.iter_mut().rev().skip(1).map(|mask| &mut mask.silhouette)
    }

    /// All masks, from early to late.
    pub(crate) fn all(&mut self) -> impl Iterator<Item = &mut Arc<Silhouette>> {
        self.masks.iter_mut().map(|mask| &mut mask.silhouette)
    }
}
