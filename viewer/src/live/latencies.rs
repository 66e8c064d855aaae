//! How long something takes, as a distribution.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Latencies that are kept, so that memory stays flat.
const KEPT: usize = 20_000;

/// The last latencies of one kind, in seconds.
#[derive(Debug, Default)]
pub struct Latencies(Mutex<VecDeque<f64>>);

impl Latencies {
    /// Adds one.
    pub fn add(&self, seconds: f64) {
        let mut kept = self.lock();
        if kept.len() == KEPT {
            kept.pop_front();
        }
        kept.push_back(seconds);
    }

    /// The latency that a part of the last `count` ones, from 0 to 1, do not exceed, in seconds; `None` without any.
    pub fn quantile(&self, part: f64, count: usize) -> Option<f64> {
        let mut last: Vec<f64> = self.lock().iter().rev().take(count).copied().collect();
        last.sort_by(f64::total_cmp);
        let index = (part * last.len().checked_sub(1)? as f64).ceil() as usize;
        last.get(index).copied()
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<f64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_last_latencies() {
        let latencies = Latencies::default();
        assert_eq!(latencies.quantile(0.5, 10), None);
        (0..=100).for_each(|k| latencies.add(f64::from(k)));
        assert_eq!(latencies.quantile(0.5, usize::MAX), Some(50.0));
        assert_eq!(latencies.quantile(0.99, usize::MAX), Some(99.0));
        assert_eq!(latencies.quantile(0.0, 11), Some(90.0));
    }
}
