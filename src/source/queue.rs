//! A bounded queue between a thread that reads images and their consumer.

use super::Frame;
use crate::Result;
use crate::lock::lock;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// What a reading thread does when the queue is full.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhenFull {
    /// Wait, so that nothing is lost; for recordings.
    Wait,
    /// Drop the oldest image and count it, so that the next image is fresh; for live cameras.
    DropOldest,
}

/// The queue, with one producer and one consumer.
pub(super) struct Queue {
    state: Mutex<State>,
    /// Notified when the queue becomes longer or shorter, or ends.
    changed: Condvar,
    depth: usize,
    when_full: WhenFull,
}

#[derive(Default)]
struct State {
    frames: VecDeque<Result<Frame>>,
    dropped: u64,
    /// The source's notes, once it has ended.
    ended: Option<Vec<String>>,
    /// Set when the consumer has been dropped.
    closed: bool,
}

/// The result of [`Queue::pop`].
pub(super) enum Taken {
    Frame(Result<Frame>),
    Ended,
    /// No frame arrived before the deadline.
    Timeout,
}

impl Queue {
    pub(super) fn new(depth: usize, when_full: WhenFull) -> Self {
        Self { state: Mutex::default(), changed: Condvar::new(), depth, when_full }
    }

    /// Appends a frame; false if the consumer has been dropped.
    pub(super) fn put(&self, frame: Result<Frame>) -> bool {
        let mut state = lock(&self.state);
        while state.frames.len() >= self.depth && !state.closed {
            if self.when_full == WhenFull::DropOldest && state.drop_oldest() {
                break;
            }
            state = self.wait(state);
        }

        if !state.closed {
            state.frames.push_back(frame);
            self.changed.notify_all();
        }
        !state.closed
    }

    /// Marks the end of the source, with its notes.
    pub(super) fn end(&self, notes: Vec<String>) {
        lock(&self.state).ended = Some(notes);
        self.changed.notify_all();
    }

    /// Marks that the consumer takes no more frames.
    pub(super) fn disconnect(&self) {
        lock(&self.state).closed = true;
        self.changed.notify_all();
    }

    /// The next frame, for which it waits until `deadline` at most, or without limit if that is `None`.
    pub(super) fn pop(&self, deadline: Option<Instant>) -> Taken {
        let mut state = lock(&self.state);
        loop {
            if let Some(frame) = state.frames.pop_front() {
                self.changed.notify_all();
                return Taken::Frame(frame);
            }

            if state.ended.is_some() {
                return Taken::Ended;
            }

            state = match deadline.map(|deadline| deadline.saturating_duration_since(Instant::now())) {
                None => self.wait(state),
                Some(left) if left.is_zero() => return Taken::Timeout,
                Some(left) => {
                    self.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0
                }
            };
        }
    }

    pub(super) fn dropped(&self) -> u64 {
        lock(&self.state).dropped
    }

    pub(super) fn notes(&self) -> Vec<String> {
        lock(&self.state).ended.clone().unwrap_or_default()
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Drops and counts the oldest image; false if there is none. Errors stay: each has to be reported once.
    fn drop_oldest(&mut self) -> bool {
        let oldest = self.frames.iter().position(Result::is_ok);
        self.dropped += u64::from(oldest.is_some());
        oldest.is_some_and(|at| self.frames.remove(at).is_some())
    }
}
