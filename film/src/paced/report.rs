//! What a paced run has shown, and how it is told.

use std::fmt;

/// How many frames or steps were due, and what became of them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Done before the next one was due.
    pub in_time: usize,
    /// Done after that.
    pub late: usize,
    /// Not done.
    pub dropped: usize,
}

/// What a paced run has shown.
#[derive(Debug, Clone, Default)]
pub struct PaceReport {
    /// The frames.
    pub frames: Tally,
    /// The steps.
    pub steps: Tally,
    /// From a mask's time stamp to the end of the first collide with a hull that is made of it, for each frame at which a body
    /// touched the hull then, in seconds, sorted.
    pub latencies: Vec<f64>,
    /// Simulated seconds over the seconds that the simulation has worked, and recorded ones over those in which frames were
    /// published.
    pub simulation_factor: f64,
    /// As [`Self::simulation_factor`], of the thread of the cameras.
    pub frames_factor: f64,
    /// Hulls whose views are of different times, but for lost ones.
    pub mixed: usize,
}

impl Tally {
    pub(super) fn count(&mut self, is_in_time: bool) {
        let place = if is_in_time { &mut self.in_time } else { &mut self.late };
        *place += 1;
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in time, {} late, {} dropped", self.in_time, self.late, self.dropped)
    }
}

impl PaceReport {
    /// The latency that a part of the frames, from 0 to 1, do not exceed, in seconds; `None` without any.
    pub fn latency(&self, part: f64) -> Option<f64> {
        let last = self.latencies.len().checked_sub(1)?;
        self.latencies.get((part * last as f64).ceil() as usize).copied()
    }

    /// By how much the slower of the two threads is faster than the wall clock.
    pub fn realtime_factor(&self) -> f64 {
        self.simulation_factor.min(self.frames_factor)
    }
}

impl fmt::Display for PaceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "frames       {}; {:.1} times as fast as the clock", self.frames, self.frames_factor)?;
        writeln!(f, "steps        {}; {:.1} times as fast as the clock", self.steps, self.simulation_factor)?;
        let latency = |part: f64| self.latency(part).map_or("none".into(), |s| format!("{:.2} ms", 1e3 * s));
        writeln!(
            f,
            "latency      median {}, 99 % {}, worst {}, from a mask's time stamp to its first contact, {} frames",
            latency(0.5),
            latency(0.99),
            latency(1.0),
            self.latencies.len()
        )?;
        if self.frames.dropped + self.steps.dropped > 0 {
            writeln!(
                f,
                "note: the machine is too slow for this pace: {} frames were not shown and {} steps not simulated; use fewer \
                 bodies, views or pixels, or fewer steps a second",
                self.frames.dropped, self.steps.dropped
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_drops_says_what_was_left_out_and_what_to_do() {
        let slow = Tally { in_time: 3, late: 2, dropped: 5 };
        let report =
            PaceReport { steps: slow, latencies: vec![0.001, 0.002, 0.010], ..PaceReport::default() };
        let text = report.to_string();
        assert!(text.contains("5 steps not simulated; use fewer bodies"), "{text}");
        assert_eq!((report.latency(0.5), report.latency(0.99)), (Some(0.002), Some(0.010)));
    }
}
