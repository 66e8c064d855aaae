//! Steps of a simulation by a clock.

use super::report::Tally;

/// Steps by which the simulation may be behind the clock before it drops some.
const MOST_BEHIND: f64 = 4.0;

/// The steps of a simulation that keeps up with a clock: when each is due, and what became of it.
///
/// A simulation that is behind by more than four steps drops those that are due, so that it is never late silently.
#[derive(Debug, Clone)]
pub struct Steps {
    dt: f64,
    /// The number of the next step.
    next: u64,
    tally: Tally,
}

impl Steps {
    /// `rate` steps a second from time `start` on, in seconds; the first one is due at the first multiple of a step that is not
    /// before it.
    pub fn new(rate: f64, start: f64) -> Self {
        Self { dt: 1.0 / rate, next: (start * rate).ceil().max(0.0) as u64, tally: Tally::default() }
    }

    /// The duration of a step, in seconds.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// When the next step is due, in seconds.
    pub fn due(&self) -> f64 {
        self.next as f64 * self.dt
    }

    /// Drops the steps that are due at time `now`, if they are too many, and returns how many seconds they would have taken.
    pub fn drop_if_behind(&mut self, now: f64) -> f64 {
        let behind = ((now - self.due()) / self.dt).floor();
        if behind <= MOST_BEHIND {
            return 0.0;
        }
        self.tally.dropped += behind as usize;
        self.next += behind as u64;
        behind * self.dt
    }

    /// Counts the step that was due, which ended at time `ended`, and goes on to the next one.
    pub fn count(&mut self, ended: f64) {
        self.tally.count(ended <= self.due() + self.dt);
        self.next += 1;
    }

    /// What became of the steps so far.
    pub fn tally(&self) -> Tally {
        self.tally
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_that_end_before_the_next_one_are_in_time_and_those_far_behind_are_dropped() {
        let mut steps = Steps::new(100.0, 0.0);
        steps.count(0.009);
        assert_eq!((steps.due(), steps.drop_if_behind(0.04)), (0.01, 0.0));
        steps.count(0.021);
        assert_eq!(steps.drop_if_behind(0.125), 0.1);
        assert_eq!(steps.tally(), Tally { in_time: 1, late: 1, dropped: 10 });
        assert_eq!(steps.due(), 0.12);
    }

    #[test]
    fn the_first_step_is_due_at_the_start_or_after_it() {
        assert_eq!(Steps::new(100.0, 0.0).due(), 0.0);
        assert_eq!(Steps::new(100.0, 1.234).due(), 1.24);
    }
}
