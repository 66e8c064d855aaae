//! The latest of what one thread makes and others use.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The latest value that a thread has made, with its number, counted from 1. Readers never wait for its maker.
#[derive(Debug)]
pub struct Latest<T> {
    state: Mutex<(u64, Option<Arc<T>>)>,
    changed: Condvar,
}

impl<T> Default for Latest<T> {
    fn default() -> Self {
        Self { state: Mutex::new((0, None)), changed: Condvar::new() }
    }
}

impl<T> Latest<T> {
    /// Replaces the value.
    pub fn put(&self, value: T) {
        let mut state = self.lock();
        *state = (state.0 + 1, Some(Arc::new(value)));
        drop(state);
        self.changed.notify_all();
    }

    /// The number of the value and the value; 0 and `None` before the first.
    pub fn get(&self) -> (u64, Option<Arc<T>>) {
        self.lock().clone()
    }

    /// Waits until the value's number is not `known`, at most for this long.
    pub fn wait_for_other(&self, known: u64, most: Duration) {
        let state = self.lock();
        let waited = self.changed.wait_timeout_while(state, most, |state| state.0 == known);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    /// A value is replaced in one assignment, so that a thread that panicked has left a whole one.
    fn lock(&self) -> MutexGuard<'_, (u64, Option<Arc<T>>)> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reader_gets_the_latest_value_and_wakes_when_there_is_another() {
        let latest = Latest::default();
        assert_eq!(latest.get(), (0, None));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                latest.put("first");
                latest.put("second");
            });
            latest.wait_for_other(0, Duration::from_secs(60));
            latest.wait_for_other(1, Duration::from_secs(60));
        });
        assert_eq!(latest.get(), (2, Some(Arc::new("second"))));
        latest.wait_for_other(2, Duration::ZERO);
    }
}
