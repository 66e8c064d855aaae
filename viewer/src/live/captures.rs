//! The captures of the last moments.

use ode_visual_hull::pipeline::Captured;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Captures that are kept: a hull that moves between frames shows a moment one or two periods ago.
const KEPT: usize = 4;

/// The captures of the last moments, in the order of their times.
#[derive(Debug, Default)]
pub struct Captures(Mutex<VecDeque<Arc<Captured>>>);

impl Captures {
    /// Adds the latest capture.
    pub fn push(&self, captured: Arc<Captured>) {
        let mut kept = self.lock();
        kept.push_back(captured);
        if kept.len() > KEPT {
            kept.pop_front();
        }
    }

    /// The capture whose time is nearest to `time`, in seconds.
    pub fn nearest(&self, time: f64) -> Option<Arc<Captured>> {
        let distance = |captured: &Arc<Captured>| (captured.images.time - time).abs();
        self.lock().iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).cloned()
    }

    /// The time of the first capture that was not taken before `time`, in seconds; else of the latest one.
    pub fn time_of_first_after(&self, time: f64) -> Option<f64> {
        let kept = self.lock();
        let mut times = kept.iter().map(|captured| captured.images.time);
        times.find(|taken| *taken >= time).or_else(|| kept.back().map(|captured| captured.images.time))
    }

    /// The time of the last capture that was taken at `time` or before, in seconds; else of the first one.
    pub fn time_of_last_before(&self, time: f64) -> Option<f64> {
        let kept = self.lock();
        let mut times = kept.iter().rev().map(|captured| captured.images.time);
        times.find(|taken| *taken <= time).or_else(|| kept.front().map(|captured| captured.images.time))
    }

    /// The latest capture.
    pub fn latest(&self) -> Option<Arc<Captured>> {
        self.lock().back().cloned()
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<Arc<Captured>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
