//! How a hull moves between the frames of its cameras.

/// Which hull a simulation sees at its own time, while frames come less often than its steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Motion {
    /// The latest frame, until the next one: the paper's way. A real surface that moves stands still for a frame and then
    /// jumps.
    #[default]
    Held,
    /// The hull between two frames, warped along the optical flow of each view. It lags behind by the time between the
    /// last two frames: at time t it shows what the cameras would have seen at t less that time.
    Interpolated,
    /// The latest frame, warped ahead to the simulation's time along the same flow, by at most the time between the last
    /// two frames. It has no such lag, and is wrong where the subject changes its speed.
    Predicted,
}
