//! Half-lines, and the parts of them in half-spaces and boxes.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::Aabb;

/// A half-line in the world.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Where it starts.
    pub origin: Point3<f32>,
    /// Unit direction.
    pub direction: Vector3<f32>,
}

impl Ray {
    /// The point at distance `t` metres.
    pub fn at(&self, t: f32) -> Point3<f32> {
        self.origin + self.direction * t
    }
}

/// The part of the range in which `at_0 + slope t >= 0`.
fn clip_to_half_line(at_0: f32, slope: f32, (from, to): (f32, f32)) -> Option<(f32, f32)> {
    let root = -at_0 / slope;
    let (from, to) = match slope {
        _ if slope > 0.0 => (from.max(root), to),
        _ if slope < 0.0 => (from, to.min(root)),
        _ if at_0 < 0.0 => return None,
        _ => (from, to),
    };
    (from <= to).then_some((from, to))
}

/// The part of the range in which `ray` is in the box, or at most `spread` radians beside it.
pub fn clip_to_box(bounds: &Aabb, spread: f32, ray: &Ray, range: (f32, f32)) -> Option<(f32, f32)> {
    (0..3).try_fold(range, |range, axis| {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        let range = clip_to_half_line(origin - bounds.min[axis] as f32, direction + spread, range)?;
        clip_to_half_line(bounds.max[axis] as f32 - origin, spread - direction, range)
    })
}
