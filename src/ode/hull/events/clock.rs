//! The time of the steps, of which ODE tells nothing.

use crate::ode::hull::step_size::StepSize;

/// The time of the steps.
#[derive(Debug, Default)]
pub(super) struct Clock {
    /// In seconds: what the program has told, or else the lengths of the steps since the events were switched on, or else the
    /// time between the frames.
    pub(super) now: f64,
    pub(super) is_told: bool,
    /// How many steps have begun, and whether the last one is not closed yet.
    pub(super) steps: u64,
    pub(super) is_open: bool,
    /// The time between frames since the last step, in seconds.
    pub(super) between_frames: f64,
}

impl Clock {
    /// Begins a step, unless it has begun.
    pub(super) fn open(&mut self, step: &StepSize) {
        if std::mem::replace(&mut self.is_open, true) {
            return;
        }
        let between_frames = std::mem::take(&mut self.between_frames);
        if !self.is_told && self.steps > 0 {
            self.now += step.unbounded_seconds().unwrap_or(between_frames);
        }
        self.steps += 1;
    }
}
