//! How a pair of hands moves: poses and gaps at given times, and smooth motion from one to the next.

use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::synthetic::Subject;

/// The way of a pair of hands.
#[derive(Debug, Clone, Copy)]
pub struct HandScript<'s> {
    /// Times in seconds, and the middle between the palms then, in metres, with the turn about the vertical, in radians.
    pub poses: &'s [(f64, [f64; 4])],
    /// Times, and the distance between the palms, in metres.
    pub gaps: &'s [(f64, [f64; 1])],
}

impl HandScript<'_> {
    /// The pose of the hands at a time.
    pub fn pose(&self, time: f64) -> Isometry3<f64> {
        let [x, y, z, yaw] = between(self.poses, time);
        Isometry3::new(Vector3::new(x, y, z), Vector3::z() * yaw)
    }

    /// The hands at a time, as a subject.
    pub fn subject(&self, time: f64) -> Subject {
        Subject::hands(&self.pose(time), between(self.gaps, time)[0])
    }
}

/// The values at a time: those of the keys before and after it, with speed and acceleration zero at the keys.
fn between<const N: usize>(keys: &[(f64, [f64; N])], time: f64) -> [f64; N] {
    let next = keys.partition_point(|(key, _)| *key <= time).clamp(1, keys.len() - 1);
    let ((start, from), (end, to)) = (keys[next - 1], keys[next]);
    let part = ((time - start) / (end - start)).clamp(0.0, 1.0);
    let smooth = part * part * part * (10.0 + part * (6.0 * part - 15.0));
    std::array::from_fn(|k| from[k] + smooth * (to[k] - from[k]))
}
