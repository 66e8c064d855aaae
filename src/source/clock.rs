//! The clock of a live system.

use crate::lock::lock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The longest single wait; longer ones are repeated.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

/// The time of a live system in seconds: it runs with the wall clock from 0 and can be paused.
///
/// Clones are the same clock.
///
/// ```
/// use ode_visual_hull::source::Clock;
///
/// let clock = Clock::new();
/// clock.pause();
/// let paused_at = clock.now();
/// clock.advance(0.5);
/// assert_eq!(clock.now(), paused_at + 0.5);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Clock(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    /// Notified whenever a wait has to look at its condition again.
    changed: Condvar,
}

#[derive(Debug, Clone, Copy)]
struct State {
    /// The clock's time at `since`, or now if it is paused.
    time: f64,
    /// The instant from which it runs; `None` while it is paused.
    since: Option<Instant>,
    is_closed: bool,
}

impl Default for State {
    fn default() -> Self {
        Self { time: 0.0, since: Some(Instant::now()), is_closed: false }
    }
}

impl State {
    fn at(&self, instant: Instant) -> f64 {
        let runs_for = |since: Instant| instant.saturating_duration_since(since).as_secs_f64();
        self.time + self.since.map_or(0.0, runs_for)
    }
}

impl Clock {
    /// A clock that starts at 0 and runs.
    pub fn new() -> Self {
        Self::default()
    }

    /// The time in seconds.
    pub fn now(&self) -> f64 {
        self.at(Instant::now())
    }

    /// The clock's time at `instant` in seconds, for images that carry the instant of their arrival.
    ///
    /// A pause that has ended before now is not remembered: an instant before the clock last stopped, resumed or
    /// advanced has the clock's time at that change.
    pub fn at(&self, instant: Instant) -> f64 {
        lock(&self.0.state).at(instant)
    }

    /// Stops the time until [`resume`](Self::resume).
    pub fn pause(&self) {
        self.change(|state| State { time: state.at(Instant::now()), since: None, ..state });
    }

    /// Lets a paused clock run on from the time at which it was paused.
    pub fn resume(&self) {
        self.change(|state| State { since: state.since.or_else(|| Some(Instant::now())), ..state });
    }

    /// Whether the clock is paused.
    pub fn is_paused(&self) -> bool {
        lock(&self.0.state).since.is_none()
    }

    /// Moves the time forward by `seconds`, whether it is paused or not. Time never moves back: other values than
    /// positive, finite ones change nothing.
    pub fn advance(&self, seconds: f64) {
        if seconds.is_finite() && seconds > 0.0 {
            self.change(|state| {
                let now = Instant::now();
                State { time: state.at(now) + seconds, since: state.since.map(|_| now), ..state }
            });
        }
    }

    /// Ends all waits, now and later. The time goes on.
    pub fn close(&self) {
        self.change(|state| State { is_closed: true, ..state });
    }

    /// Whether the clock is [closed](Self::close).
    pub fn is_closed(&self) -> bool {
        lock(&self.0.state).is_closed
    }

    /// Waits until `time` in seconds, through pauses too; returns whether the time has come. It has not if the clock
    /// is closed or `stop` is set, by [`stop`](Self::stop).
    pub fn wait_until(&self, time: f64, stop: &AtomicBool) -> bool {
        let mut state = lock(&self.0.state);
        loop {
            if state.is_closed || stop.load(Ordering::Relaxed) {
                return false;
            }

            // A time that is not a number has no place in the order of times; nothing can wait for it.
            let left = time - state.at(Instant::now());
            if left <= 0.0 || left.is_nan() {
                return true;
            }

            state = if state.since.is_none() {
                self.0.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
            } else {
                let left = Duration::try_from_secs_f64(left).unwrap_or(LONGEST_WAIT).min(LONGEST_WAIT);
                self.0.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0
            };
        }
    }

    /// Sets `stop` and ends the [waits](Self::wait_until) that were given it; other waits go on.
    pub fn stop(&self, stop: &AtomicBool) {
        // Under the lock, so that no wait begins between its look at `stop` and the notification.
        self.change(|state| {
            stop.store(true, Ordering::Relaxed);
            state
        });
    }

    fn change(&self, change: impl FnOnce(State) -> State) {
        let mut state = lock(&self.0.state);
        *state = change(*state);
        drop(state);
        self.0.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    fn paused() -> Clock {
        let clock = Clock::new();
        clock.pause();
        clock
    }

    /// Starts to wait for `time` on a thread of its own, whose result tells whether the time came.
    fn waits(clock: &Clock, time: f64) -> thread::JoinHandle<bool> {
        let clock = clock.clone();
        thread::spawn(move || clock.wait_until(time, &AtomicBool::new(false)))
    }

    #[test]
    fn a_clock_runs_with_the_wall_clock() {
        let before = Instant::now();
        let clock = Clock::new();
        let after = Instant::now();
        let (earliest, now, latest) = (after.elapsed(), clock.now(), before.elapsed());
        assert!(
            earliest.as_secs_f64() <= now && now <= latest.as_secs_f64(),
            "{earliest:?} {now} {latest:?}"
        );
    }

    #[test]
    fn a_paused_clock_stands_still_and_runs_on_without_a_jump() {
        let clock = paused();
        let stopped = clock.now();
        thread::sleep(Duration::from_millis(20));
        assert!(clock.is_paused());
        assert_eq!(clock.now(), stopped);

        let before = Instant::now();
        clock.resume();
        let ran = clock.now() - stopped;
        assert!(!clock.is_paused());
        // The sum of the two times is rounded.
        assert!((0.0..=before.elapsed().as_secs_f64() + 1e-9).contains(&ran), "{ran}");
    }

    #[test]
    fn a_pause_or_a_resume_twice_is_as_one() {
        let clock = paused();
        let stopped = clock.now();
        clock.pause();
        assert_eq!(clock.now(), stopped);
        clock.resume();
        let running = clock.now();
        clock.resume();
        assert!(clock.now() >= running);
    }

    #[test]
    fn a_paused_clock_steps_forward_and_never_back() {
        let clock = paused();
        let stopped = clock.now();
        clock.advance(0.25);
        assert_eq!(clock.now(), stopped + 0.25);
        for seconds in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
            clock.advance(seconds);
            assert_eq!(clock.now(), stopped + 0.25);
        }
    }

    #[test]
    fn a_wait_ends_when_its_time_comes_and_not_before() {
        let clock = Clock::new();
        assert!(clock.wait_until(0.02, &AtomicBool::new(false)));
        assert!(clock.now() >= 0.02);
        assert!(clock.wait_until(-1.0, &AtomicBool::new(false)), "a time that has passed");
        assert!(clock.wait_until(f64::NAN, &AtomicBool::new(false)));
    }

    #[test]
    fn a_wait_through_a_pause_ends_by_a_step_or_after_the_pause() {
        let clock = paused();
        let (stepped, resumed) = (waits(&clock, clock.now() + 5.0), waits(&clock, clock.now() + 5.01));
        clock.advance(5.0);
        assert!(stepped.join().unwrap());
        assert!(!resumed.is_finished());
        clock.resume();
        assert!(resumed.join().unwrap());
    }

    #[test]
    fn a_closed_clock_ends_all_waits_paused_or_not() {
        for clock in [paused(), Clock::new()] {
            let waiting = [waits(&clock, 1e9), waits(&clock, f64::INFINITY)];
            clock.close();
            assert!(waiting.into_iter().all(|thread| !thread.join().unwrap()));
            assert!(clock.is_closed() && !clock.wait_until(0.0, &AtomicBool::new(false)));
        }
    }

    #[test]
    fn a_stop_ends_its_own_wait_only() {
        let clock = paused();
        let stop = Arc::new(AtomicBool::new(false));
        let other = waits(&clock, 10.0);
        let stopped = {
            let (clock, stop) = (clock.clone(), Arc::clone(&stop));
            thread::spawn(move || clock.wait_until(10.0, &stop))
        };
        clock.stop(&stop);
        assert!(!stopped.join().unwrap());
        clock.advance(10.0);
        assert!(other.join().unwrap());
    }

    #[test]
    fn an_instant_has_the_time_that_the_clock_showed_then() {
        let clock = Clock::new();
        let (before, instant, after) = (clock.now(), Instant::now(), clock.now());
        let at = clock.at(instant);
        assert!(before <= at && at <= after, "{before} {at} {after}");
        clock.pause();
        assert_eq!(clock.at(Instant::now() + Duration::from_secs(9)), clock.now());
    }
}
