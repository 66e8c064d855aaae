//! The latest masks of one view, by the times at which they were taken.

use super::Silhouette;
use crate::{Error, Result};
use std::collections::VecDeque;
use std::sync::Arc;

/// How far back in time past masks are kept, in seconds; one older than that is kept too.
const HISTORY: f64 = 0.1;

/// The masks of one view of the last tenth of a second and one more, by time, the latest last.
#[derive(Debug, Default)]
pub(crate) struct MaskRing {
    masks: VecDeque<TimedMask>,
}

/// A prepared mask and when it was taken, in seconds; a mask without a time of its own takes that of the first frame it
/// is in.
#[derive(Debug, Clone)]
pub(crate) struct TimedMask {
    pub(crate) silhouette: Arc<Silhouette>,
    pub(crate) time: Option<f64>,
}

impl MaskRing {
    pub(crate) fn latest(&self) -> Option<&TimedMask> {
        self.masks.back()
    }

    /// The latest mask that was not taken after `time`, or the earliest one.
    pub(crate) fn at(&self, time: f64) -> Option<&TimedMask> {
        let not_after = |mask: &&TimedMask| mask.time.is_some_and(|taken| taken <= time);
        self.masks.iter().rev().find(not_after).or(self.masks.front())
    }

    /// Refuses the time of a mask that cannot be the next one.
    ///
    /// # Errors
    /// A time that is not finite or lies before the latest mask's.
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

    /// Appends a mask, and returns one that it replaces: of two masks of one time, or of none, the later one stands.
    pub(crate) fn push(&mut self, mask: TimedMask) -> Option<Arc<Silhouette>> {
        let is_replaced = self.latest().is_some_and(|last| last.time.is_none() || last.time == mask.time);
        let replaced = if is_replaced { self.masks.pop_back() } else { None };
        self.masks.push_back(mask);
        replaced.map(|mask| mask.silhouette)
    }

    /// The time at which the latest mask counts as taken in a frame of `time`.
    pub(crate) fn time_in_frame(&self, time: f64) -> Option<f64> {
        let before = self.masks.iter().rev().nth(1).and_then(|mask| mask.time);
        self.latest().map(|latest| latest.time.unwrap_or(before.map_or(time, |before| before.max(time))))
    }

    /// Gives the latest mask the time of the frame of `time` that it is in, unless it has one of its own.
    pub(crate) fn publish(&mut self, time: f64) {
        let taken = self.time_in_frame(time);
        if let Some(latest) = self.masks.back_mut() {
            latest.time = taken;
        }
    }

    /// Removes a mask that is too old, if there is any.
    pub(crate) fn pop_old(&mut self) -> Option<Arc<Silhouette>> {
        let latest = self.latest()?.time?;
        let is_old = self.masks.len() > 2 && self.masks[1].time.is_some_and(|time| time < latest - HISTORY);
        if is_old { self.masks.pop_front().map(|mask| mask.silhouette) } else { None }
    }

    /// All masks but the latest, which a frame no longer needs, from the latest of them on.
    pub(crate) fn past(&mut self) -> impl Iterator<Item = &mut Arc<Silhouette>> {
        self.masks.iter_mut().rev().skip(1).map(|mask| &mut mask.silhouette)
    }

    /// All masks.
    pub(crate) fn all(&mut self) -> impl Iterator<Item = &mut Arc<Silhouette>> {
        self.masks.iter_mut().map(|mask| &mut mask.silhouette)
    }
}
