//! What a reconnecting source shares with its watchdog and with those that look at its status.

use super::super::CancelHandle;
use crate::lock::lock;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How a [`Reconnecting`](super::Reconnecting) source is doing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StreamStatus {
    /// Whether images arrive: one has come since the source was last opened.
    pub is_connected: bool,
    /// How often images have ceased to come.
    pub losses: u64,
    /// Why the source was last lost, could not be opened, or an image was left out. It stays after the source has
    /// come back.
    pub last_error: Option<String>,
    /// How many images were handed out.
    pub frames: u64,
    /// How many images were left out, since their size or their time was not as expected.
    pub left_out: u64,
    /// Images per second over the last second or so, by the images' times; `None` before the second image.
    pub measured_rate: Option<f64>,
    /// When the last image was handed out.
    pub last_image: Option<Instant>,
}

/// Tells the status of a [`Reconnecting`](super::Reconnecting) source, from any thread.
#[derive(Debug, Clone)]
pub struct StatusHandle(Arc<Watch>);

impl StatusHandle {
    pub(super) fn new(watch: Arc<Watch>) -> Self {
        Self(watch)
    }

    /// The status now.
    pub fn status(&self) -> StreamStatus {
        lock(&self.0.state).status.clone()
    }
}

/// The shared state.
#[derive(Debug, Default)]
pub(super) struct Watch {
    state: Mutex<State>,
    /// Notified when a wait begins or ends, and when the source is cancelled.
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    status: StreamStatus,
    /// Ends the source that is open.
    cancel_handle: Option<Arc<CancelHandle>>,
    /// When the image that is waited for is overdue.
    deadline: Option<Instant>,
    is_overdue: bool,
    is_cancelled: bool,
}

impl Watch {
    /// The watchdog: ends the open source whenever an image is overdue, until it is cancelled.
    pub(super) fn run(&self) {
        let mut state = lock(&self.state);
        while !state.is_cancelled {
            let left = state.deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
            state = match left {
                None => self.wait(state, None),
                Some(left) if !left.is_zero() => self.wait(state, Some(left)),
                Some(_) => {
                    state.deadline = None;
                    state.is_overdue = true;
                    stop(state);
                    lock(&self.state)
                }
            };
        }
    }

    /// Waits for `duration`; false if the source is cancelled.
    pub(super) fn sleep(&self, duration: Duration) -> bool {
        let end = Instant::now() + duration;
        let mut state = lock(&self.state);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            if state.is_cancelled || left.is_zero() {
                return !state.is_cancelled;
            }
            state = self.wait(state, Some(left));
        }
    }

    pub(super) fn opened(&self, cancel_handle: CancelHandle) {
        let mut state = lock(&self.state);
        state.cancel_handle = Some(Arc::new(cancel_handle));
        // It may have been cancelled while it was being opened.
        if state.is_cancelled {
            stop(state);
        }
    }

    pub(super) fn begin_wait(&self, patience: Duration) {
        let mut state = lock(&self.state);
        state.is_overdue = false;
        state.deadline = Instant::now().checked_add(patience);
        drop(state);
        self.changed.notify_all();
    }

    /// Ends the wait for an image; true if it was overdue.
    pub(super) fn end_wait(&self) -> bool {
        let mut state = lock(&self.state);
        state.deadline = None;
        state.is_overdue
    }

    pub(super) fn delivered(&self, rate: Option<f64>) {
        let status = &mut lock(&self.state).status;
        status.is_connected = true;
        status.frames += 1;
        status.measured_rate = rate;
        status.last_image = Some(Instant::now());
    }

    pub(super) fn left_out(&self, problem: String) {
        let status = &mut lock(&self.state).status;
        status.left_out += 1;
        status.last_error = Some(problem);
    }

    pub(super) fn lost(&self, problem: String) {
        let mut state = lock(&self.state);
        state.cancel_handle = None;
        // The end of a cancelled source is no loss.
        if !state.is_cancelled {
            let status = &mut state.status;
            status.losses += u64::from(status.is_connected);
            status.last_error = Some(problem);
        }
        state.status.is_connected = false;
        state.status.measured_rate = None;
    }

    pub(super) fn cancel(&self) {
        let mut state = lock(&self.state);
        state.is_cancelled = true;
        stop(state);
        self.changed.notify_all();
    }

    pub(super) fn is_cancelled(&self) -> bool {
        lock(&self.state).is_cancelled
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>, limit: Option<Duration>) -> MutexGuard<'a, State> {
        match limit {
            None => self.changed.wait(state).unwrap_or_else(PoisonError::into_inner),
            Some(limit) => self.changed.wait_timeout(state, limit).unwrap_or_else(PoisonError::into_inner).0,
        }
    }
}

/// Ends the open source, if any, without the lock, so that the status can be seen meanwhile.
fn stop(state: MutexGuard<'_, State>) {
    let cancel_handle = state.cancel_handle.clone();
    drop(state);
    if let Some(cancel_handle) = cancel_handle {
        cancel_handle.stop();
    }
}
