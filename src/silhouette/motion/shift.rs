//! How far the edge of a silhouette has moved over its last masks.

use super::{EdgeDistances, MaskMotion};
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// Distance from an edge point at which distances are read for its normal, in pixels.
const NORMAL_REACH: f32 = 3.0;

/// The gradient of the distances below which an edge point has no reliable normal: 1 at a straight edge.
const LEAST_GRADIENT: f32 = 0.6;

/// The largest distance between an edge and where the flow leads, in pixels.
const LARGEST_ERROR: f32 = 4.0;

/// The motions between the last masks of a view, up to a tenth of a second.
#[derive(Debug)]
pub(crate) struct MotionChain {
    /// The latest first.
    pub(super) motions: Vec<Arc<MaskMotion>>,
    seconds: f64,
    period: f64,
}

/// An edge point and how far the edge has moved there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeShift {
    /// The unit normal in the image, out of the subject.
    pub(crate) normal: Vector2<f64>,
    /// The motion along the normal, in pixels a second.
    pub(crate) speed: f64,
    /// The time in seconds over which it is the mean.
    pub(crate) seconds: f64,
    /// By how much it is faster now than in the mean, in pixels a second, as the latest motion shows.
    pub(crate) gained: f64,
}

impl MotionChain {
    /// A chain of motions that took `seconds` in all, the latest first, which took `period` seconds. There is at least one.
    pub(crate) fn new(motions: Vec<Arc<MaskMotion>>, seconds: f64, period: f64) -> Self {
        Self { motions, seconds, period }
    }

    /// The time between the last two masks, in seconds.
    pub(crate) fn period(&self) -> f64 {
        self.period
    }

    /// The motion of the silhouette's edge near `point`, an edge point of the silhouette that lies `back` parts of the
    /// latest motion before the latest mask. `None` where the edge cannot be followed.
    ///
    /// The flow leads from the edge of the latest mask close to that of the oldest, and both masks' distances tell how
    /// far from their edges it begins and ends. So the motion along the normal is as exact as the edges are.
    pub(crate) fn edge_shift(&self, point: &Point2<f64>, back: f64) -> Option<EdgeShift> {
        let (latest, oldest) = (self.motions.first()?, self.motions.last()?);
        let (u, v, back) = (point.x as f32, point.y as f32, back as f32);
        let flow = latest.flow.between().at(u, v);
        let (u, v) = (u - back * flow[0], v - back * flow[1]);
        let normal = normal_at(&latest.later, u, v)?;

        let now = latest.later.0.sample(u, v);
        let along = |[from_u, from_v]: [f32; 2], motion: &MaskMotion| {
            let before = motion.earlier.0.sample(from_u, from_v);
            let along = (u - from_u) * normal[0] + (v - from_v) * normal[1] + before - now;
            (now.abs().max(before.abs()) <= LARGEST_ERROR).then_some(f64::from(along))
        };
        // How far the edge has come over the last one, two and three motions, and over all.
        let (mut ways, mut count, mut from) = ([0.0; 3], 0, [u, v]);
        for (k, motion) in self.motions.iter().enumerate() {
            let flow = motion.flow.between().at(from[0], from[1]);
            from = [from[0] + flow[0], from[1] + flow[1]];
            if let Some(way) = along(from, motion).filter(|_| k == count && k < ways.len()) {
                (ways[k], count) = (way, k + 1);
            }
        }
        let speed = along(from, oldest)? / self.seconds;
        let since_middle = 0.5 - f64::from(back).max(0.0);
        Some(EdgeShift {
            normal: Vector2::new(f64::from(normal[0]), f64::from(normal[1])),
            speed,
            seconds: self.seconds,
            gained: self.latest_speed(&ways[..count], since_middle).map_or(0.0, |latest| latest - speed),
        })
    }

    /// The speed `since_middle` periods after the middle of the latest motion, from the ways over the last one, two and three
    /// motions. The speed changes from motion to motion by what the last two changes have in common, so that an edge which
    /// starts or stops at once does not seem to be faster than it is.
    fn latest_speed(&self, ways: &[f64], since_middle: f64) -> Option<f64> {
        let earlier = (self.seconds - self.period) / (self.motions.len() - 1).max(1) as f64;
        let change = match ways {
            [] => return None,
            &[one, two, three] => {
                let speeds = [one / self.period, (two - one) / earlier, (three - two) / earlier];
                let changes = [speeds[0] - speeds[1], speeds[1] - speeds[2]];
                let common = changes[0].abs().min(changes[1].abs());
                if changes[0] * changes[1] > 0.0 { common.copysign(changes[0]) } else { 0.0 }
            }
            _ => 0.0,
        };
        Some(ways[0] / self.period + change * since_middle)
    }
}

/// The unit normal of the edge near a point, out of the subject: the direction in which distances grow.
fn normal_at(distances: &EdgeDistances, u: f32, v: f32) -> Option<[f32; 2]> {
    let at = |du: f32, dv: f32| distances.0.sample(u + du, v + dv);
    let reach = NORMAL_REACH;
    let x = (at(reach, 0.0) - at(-reach, 0.0)) / (2.0 * reach);
    let y = (at(0.0, reach) - at(0.0, -reach)) / (2.0 * reach);
    let length = x.hypot(y);
    (length > LEAST_GRADIENT).then(|| [x / length, y / length])
}
