//! The distance of an image point from a silhouette's edge at any time between its last two masks and shortly after them,
//! without a warped mask.

use super::distance_image::{DistanceImage, REACH};
use super::flow::MAX_AHEAD;
use super::{MaskMotion, MotionChain};
use nalgebra::{Point2, Vector2};

/// Distance from a point at which distances are read for the edge's normal, in pixels.
const NORMAL_REACH: f64 = 2.0;

/// How far an image point is from an edge that moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EdgeClearance {
    /// In pixels, negative inside. Beyond 16 px outside it is at most the true distance.
    pub(crate) distance: f64,
    /// By how much the distance can change at most, in pixels, over the time between the two masks.
    pub(crate) change: f64,
}

impl MotionChain {
    /// The clearance of `point` where the latest motion is at `s` from 0, the earlier mask, to 1, the later one; above 1 it
    /// lies ahead of the later one.
    pub(crate) fn clearance(&self, point: &Point2<f64>, s: f64) -> EdgeClearance {
        let latest = &self.motions[0];
        let [distance, difference] = latest.distance(point, s);
        let longest =
            f64::from(latest.flow.longest()).min(if s > 1.0 { f64::from(MAX_AHEAD) } else { f64::INFINITY });
        // The flow is known by its longest component.
        EdgeClearance { distance, change: std::f64::consts::SQRT_2 * longest + difference }
    }

    /// The unit normal, out of the subject, of the edge near `point` at `s`, as in [`Self::clearance`]; `None` where
    /// distances do not change.
    pub(crate) fn edge_normal(&self, point: &Point2<f64>, s: f64) -> Option<Vector2<f64>> {
        let at = |du: f64, dv: f64| self.motions[0].distance(&(point + Vector2::new(du, dv)), s)[0];
        let along = |du: f64, dv: f64| at(du, dv) - at(-du, -dv);
        Vector2::new(along(NORMAL_REACH, 0.0), along(0.0, NORMAL_REACH)).try_normalize(1e-6)
    }

    /// The longest way of an edge between the last two masks, in pixels.
    #[cfg(feature = "ode")]
    pub(crate) fn longest_way(&self) -> f64 {
        std::f64::consts::SQRT_2 * f64::from(self.motions[0].flow.longest())
    }
}

impl MaskMotion {
    /// The distance of `point` from the edge at `s`, as a warp to that time has it, and how much those by the two masks
    /// differ.
    fn distance(&self, point: &Point2<f64>, s: f64) -> [f64; 2] {
        let (u, v, s) = (point.x as f32, point.y as f32, s as f32);
        let (earlier, later) = (&self.earlier.0, &self.later.0);
        let flow = if s > 1.0 { self.flow.ahead() } else { self.flow.between() };

        // The flow is known where the later image shows the subject, which is not where it is now.
        let to_later = s - 1.0;
        let there = flow.at(u, v);
        let [right, down] = flow.at(u + to_later * there[0], v + to_later * there[1]);
        let by =
            |image: &DistanceImage, along: f32| image.distance_outwards(u + along * right, v + along * down);
        let by_later = by(later, to_later);
        if s > 1.0 {
            return [f64::from(by_later), 0.0];
        }
        let by_earlier = by(earlier, s);
        [f64::from((1.0 - s) * by_earlier + s * by_later), f64::from((by_earlier - by_later).abs())]
    }
}

impl DistanceImage {
    /// The distance at an image position; beyond the pixels that have distances, a lower bound of it.
    fn distance_outwards(&self, u: f32, v: f32) -> f32 {
        let distance = self.sample(u, v);
        if distance < REACH as f32 - 0.5 {
            return distance;
        }
        let beyond = |x: f32, first: i32, end: i32| (first as f32 - x).max(x - end as f32).max(0.0);
        distance + beyond(u, self.rect.x0, self.rect.x1).hypot(beyond(v, self.rect.y0, self.rect.y1))
    }
}
