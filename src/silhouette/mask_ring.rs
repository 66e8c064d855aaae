//! The latest masks of one view, ordered by the times at which they were taken.

use super::{EdgeDistances, MaskMotion, MotionChain, Silhouette};
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
    /// Whether a frame at this mask's time or later has been published.
    pub(crate) is_published: bool,
    /// The distances from its edge, and its motion since the mask before it, where a geom has asked for motion.
    pub(crate) distances: Option<Arc<EdgeDistances>>,
    pub(crate) motion: Option<Arc<MaskMotion>>,
    /// The motions up to this mask, where they were asked for.
    pub(crate) chain: Option<Arc<MotionChain>>,
}

impl TimedMask {
    /// A mask that no frame shows yet.
    pub(crate) fn new(silhouette: Arc<Silhouette>, time: Option<f64>) -> Self {
        Self { silhouette, time, is_published: false, distances: None, motion: None, chain: None }
    }
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
    pub(crate) fn push(&mut self, mask: TimedMask) -> Option<TimedMask> {
        let is_replaced = self.latest().is_some_and(|last| last.time.is_none() || last.time == mask.time);
        let replaced = if is_replaced { self.masks.pop_back() } else { None };
        self.masks.push_back(mask);
        replaced
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
        self.masks.iter_mut().for_each(|mask| mask.is_published = true);
    }

    /// The mask that stays the latest one's predecessor if another is pushed: the latest with a time.
    pub(crate) fn predecessor(&self) -> Option<&TimedMask> {
        self.masks.iter().rev().find(|mask| mask.time.is_some())
    }

    /// The index of the mask at which the motion at `time` ends: the first published one that was taken at `time` or
    /// later, or the last one; never the first of all. `None` if fewer than two are published.
    pub(crate) fn moving_at(&self, time: f64) -> Option<usize> {
        let published = self.masks.iter().take_while(|mask| mask.is_published).count();
        let is_later = |mask: &TimedMask| mask.time.is_some_and(|taken| taken >= time);
        let later = self.masks.iter().take(published).position(is_later).unwrap_or(published);
        (published > 1).then(|| later.clamp(1, published - 1))
    }

    /// The mask at an index and the one before it.
    pub(crate) fn pair(&mut self, later: usize) -> Option<[&mut TimedMask; 2]> {
        let mut masks = self.masks.iter_mut().skip(later.checked_sub(1)?);
        Some([masks.next()?, masks.next()?])
    }

    /// The motions up to the mask at index `later`, back to at most [`HISTORY`] before it.
    pub(crate) fn chain(&mut self, later: usize) -> Option<Arc<MotionChain>> {
        let last = self.masks.get(later)?;
        if let Some(chain) = &last.chain {
            return Some(chain.clone());
        }

        let end = last.time?;
        let period = end - self.masks.get(later.checked_sub(1)?)?.time?;
        let (mut motions, mut start) = (Vec::new(), end);
        for k in (1..=later).rev() {
            let (before, motion) = (self.masks[k - 1].time?, &self.masks[k].motion);
            // A little more, since times are rounded.
            let is_old = !motions.is_empty() && end - before > 1.01 * HISTORY;
            let Some(motion) = motion.as_ref().filter(|_| !is_old) else { break };
            motions.push(motion.clone());
            start = before;
        }
        let chain = (!motions.is_empty()).then(|| Arc::new(MotionChain::new(motions, end - start, period)));
        self.masks[later].chain = chain.clone();
        chain
    }

    /// Removes and returns the earliest mask if it is too old.
    pub(crate) fn pop_old(&mut self) -> Option<TimedMask> {
        let latest = self.latest()?.time?;
        // Two published masks are kept, since the motion between them may be asked for.
        let published = self.masks.iter().filter(|mask| mask.is_published).count();
        let is_spare = published > 2 || self.masks.len() > published + 2;
        let is_old = is_spare && self.masks[1].time.is_some_and(|time| time < latest - HISTORY);
        if is_old { self.masks.pop_front() } else { None }
    }

    /// Forgets distances and motions, which are computed again where they are asked for.
    pub(crate) fn forget_motion(&mut self) {
        self.masks.iter_mut().for_each(|mask| (mask.distances, mask.motion, mask.chain) = (None, None, None));
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
