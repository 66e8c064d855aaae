//! When points that move enter the hull, which moves too: the paper's section 7 names it as missing.
//!
//! ```text
//!     .------.   .------.        a point that is outside at both ends of a step may have been passed by the hull
//!     | now  | . | then |
//!     '------'   '------'        it is outside as long as one view shows it beside the silhouette, and as long as the
//!       ─────────────►           edge there is farther away than point and edge can move
//! ```
//!
//! No mask is warped: each view reads the distances of its two masks where the flow leads, at the point's pixel alone.

use super::query::nearest_edge_in;
use super::view::EdgeModel;
use super::{Hull, Verdict, View};
use crate::camera::{MIN_DEPTH, floor_pixel};
use crate::silhouette::{MotionChain, Rect};
use nalgebra::{Point2, Point3, Vector3};

/// The least progress of a search, in pixels: the hull may pass a point by less than this without being noticed.
const LEAST_PROGRESS_PX: f64 = 0.25;

/// The most steps of a search. A point that is not decided by then does not enter.
const MOST_STEPS: usize = 500;

/// The time of an entry is halved this often: from a quarter of a pixel to a thousandth.
const HALVINGS: usize = 8;

/// Where and when a point that moves enters the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Seconds after the hull's time.
    pub seconds: f64,
    /// Unit outward normal of the surface there and then.
    pub normal: Vector3<f64>,
    /// Index of the view whose silhouette's edge the point crosses last.
    pub view: usize,
}

/// A point that moves along a straight line, in the hull's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingPoint {
    pub(crate) start: Point3<f64>,
    /// In m/s.
    pub(crate) velocity: Vector3<f64>,
}

/// A search for entries into one hull within a time.
#[derive(Debug)]
pub(crate) struct Sweep<'h> {
    hull: &'h Hull,
    views: Vec<SweptView<'h>>,
    seconds: f64,
    /// The place among `views` of the one that decided last. It decides most points nearby too.
    decisive: usize,
}

/// A view that takes part.
#[derive(Debug, Clone, Copy)]
struct SweptView<'h> {
    index: usize,
    view: &'h View,
    /// `None` where its silhouette stands still.
    motion: Option<ViewMotion<'h>>,
}

#[derive(Debug, Clone, Copy)]
struct ViewMotion<'h> {
    chain: &'h MotionChain,
    /// Where in the latest motion the silhouette is: 0 at the earlier mask, 1 at the later one.
    s: f64,
    /// The time between the two masks.
    period: f64,
}

/// What a view tells of a point at a time.
#[derive(Debug, Clone, Copy)]
struct Clearance {
    /// In pixels, negative inside; outside at most the true distance.
    distance: f64,
    /// By how much it can change at most, in pixels a second, until the end.
    speed: f64,
}

/// What all views tell of a point at a time.
#[derive(Debug, Clone, Copy)]
enum State {
    /// The point stays outside at least for `wait` seconds.
    Outside {
        wait: f64,
        least_progress: f64,
    },
    Inside,
}

impl Hull {
    /// When a point that is at `start` now, outside the hull, and moves at `velocity` m/s, first enters the hull within
    /// `seconds`, and where the surface faces there. All lengths are in metres, in the hull's frame.
    ///
    /// The hull moves as its silhouettes do, ahead of its own time: between two frames of a hull in
    /// [`Motion`](super::Motion) along their flow, after the last frame as it would be predicted. A hull without motion, and
    /// each view without one, stands still. No view is overruled.
    pub fn first_entry(&self, start: &Point3<f64>, velocity: &Vector3<f64>, seconds: f64) -> Option<Entry> {
        let mut sweep = Sweep::new(self, seconds);
        sweep.first_entry(&MovingPoint { start: *start, velocity: *velocity })
    }

    /// The views that take part in queries but whose silhouettes stand still, since their motion is not known.
    #[cfg(feature = "ode")]
    pub(crate) fn views_without_motion(&self) -> impl Iterator<Item = &View> {
        self.enabled_views().filter(|view| !view.has_motion())
    }

    /// By how much the hull's surface can move at most in `seconds`, in metres.
    #[cfg(feature = "ode")]
    pub(crate) fn farthest_motion(&self, seconds: f64) -> f64 {
        let of_view = |view: &View| {
            let (chain, _) = view.motion()?;
            let depths = self.aabb.corners().map(|corner| view.homogeneous(&corner).z);
            let farthest = depths.into_iter().fold(0.0, f64::max);
            Some(view.footprint().at(farthest) * chain.longest_way() * seconds / chain.period())
        };
        self.enabled_views().filter_map(of_view).fold(0.0, f64::max)
    }
}

impl<'h> Sweep<'h> {
    /// A search in `hull` over the `seconds` after its time.
    pub(crate) fn new(hull: &'h Hull, seconds: f64) -> Self {
        let views = hull.views.iter().enumerate().filter(|(_, view)| view.is_enabled());
        let views = views.map(|(index, view)| SweptView { index, view, motion: motion_of(view) }).collect();
        Self { hull, views, seconds, decisive: 0 }
    }

    /// Whether anything within `radius` metres of `centre`, where no point is faster than `speed` m/s, may enter.
    #[cfg(feature = "ode")]
    pub(crate) fn may_enter(&self, centre: &MovingPoint, radius: f64, speed: f64) -> bool {
        let stays_outside = |view: &SweptView| {
            let Some(Clearance { distance, speed: of_edge }) =
                self.clearance_at(view, centre, 0.0, self.seconds)
            else {
                return false;
            };
            let depth = view.view.homogeneous(&centre.start).z;
            let nearest = depth.min(view.view.homogeneous(&centre.after(self.seconds).start).z);
            // A sphere beside the optical axis looks larger.
            let away = (centre.start - view.view.camera().centre()).norm() / depth;
            let footprint = view.view.footprint().at(nearest - radius - speed * self.seconds);
            footprint > 0.0
                && distance
                    > away * away * (radius + speed * self.seconds) / footprint + of_edge * self.seconds
        };
        !self.views.iter().any(stays_outside)
    }

    /// The first entry of a point; `None` also where it is inside at the start.
    pub(crate) fn first_entry(&mut self, point: &MovingPoint) -> Option<Entry> {
        let [start, end] = self.within_bounds(point)?;
        let (mut time, mut outside) = (start, None);
        for _ in 0..MOST_STEPS {
            match (self.state(point, time, end), outside) {
                (State::Inside, None) => return self.entry_at_start(point, time, end),
                (State::Inside, Some(outside)) => return self.entry_between(point, outside, time, end),
                (State::Outside { wait, .. }, _) if time + wait >= end || time >= end => return None,
                (State::Outside { wait, least_progress }, _) => {
                    outside = Some(time);
                    time = (time + wait.max(least_progress)).min(end);
                }
            }
        }
        None
    }

    /// The entry of a point that is inside at the start by the distances. The mask decides, from which they differ by rounding.
    fn entry_at_start(&self, point: &MovingPoint, start: f64, end: f64) -> Option<Entry> {
        let is_inside = start == 0.0 && self.hull.inside_by(&point.start, EdgeModel::Coverage);
        if is_inside { None } else { self.entry_at(point, start, end) }
    }

    /// The part of the time in which a point is inside the work volume.
    fn within_bounds(&self, point: &MovingPoint) -> Option<[f64; 2]> {
        let (mut start, mut end) = (0.0_f64, self.seconds);
        for k in 0..3 {
            let (at, speed) = (point.start[k], point.velocity[k]);
            let (low, high) = (self.hull.bounds.min[k] - at, self.hull.bounds.max[k] - at);
            if speed == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (first, last) =
                if speed > 0.0 { (low / speed, high / speed) } else { (high / speed, low / speed) };
            (start, end) = (start.max(first), end.min(last));
        }
        (start < end).then_some([start, end])
    }

    /// Whether a point is inside at a time, and if not, for how long it stays outside at least, up to `end`.
    fn state(&mut self, point: &MovingPoint, time: f64, end: f64) -> State {
        let point = point.after(time);
        let (mut wait, mut fastest, mut outside, mut inside): (f64, f64, usize, usize) = (0.0, 0.0, 0, 0);
        let count = self.views.len();
        let first = self.decisive;
        for k in (0..count).map(|k| (first + k) % count) {
            let Some(Clearance { distance, speed }) = self.clearance_at(&self.views[k], &point, time, end)
            else {
                continue;
            };
            fastest = fastest.max(speed);
            if distance <= 0.0 {
                inside += 1;
                continue;
            }
            outside += 1;
            let own = distance / speed;
            if own > wait {
                (wait, self.decisive) = (own, k);
            }
            if time + wait >= end {
                break;
            }
        }

        if self.hull.unseen.decides_inside(inside, outside, count) {
            return State::Inside;
        }
        let least = (end - time) / MOST_STEPS as f64;
        State::Outside { wait, least_progress: (LEAST_PROGRESS_PX / fastest).max(least) }
    }

    /// The entry of a point that is outside at one time and inside at another.
    fn entry_between(
        &mut self,
        point: &MovingPoint,
        mut outside: f64,
        mut inside: f64,
        end: f64,
    ) -> Option<Entry> {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (outside + inside);
            match self.state(point, middle, end) {
                State::Inside => inside = middle,
                State::Outside { .. } => outside = middle,
            }
        }

        self.entry_at(point, outside, end).map(|entry| Entry { seconds: inside, ..entry })
    }

    /// The entry of a point at a time at which it crosses an edge: by the view that shows it farthest outside.
    fn entry_at(&self, point: &MovingPoint, time: f64, end: f64) -> Option<Entry> {
        let at = point.after(time);
        let distance = |view: &&SweptView| {
            self.clearance_at(view, &at, time, end).map_or(f64::NEG_INFINITY, |clearance| clearance.distance)
        };
        let last = self.views.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        Some(Entry { seconds: time, normal: last.normal_at(self.hull, &at.start, time)?, view: last.index })
    }

    /// What a view tells of `point`, which is at its start at `time`; `None` where it abstains.
    fn clearance_at(&self, view: &SweptView, point: &MovingPoint, time: f64, end: f64) -> Option<Clearance> {
        let SweptView { view, motion, .. } = view;
        let is_closed = self.hull.is_closed(view);
        let (at, change) = (view.homogeneous(&point.start), view.homogeneous_direction(&point.velocity));
        let nearest = at.z.min(at.z + change.z * (end - time));
        if at.z <= MIN_DEPTH {
            return is_closed.then_some(Clearance { distance: LEAST_PROGRESS_PX, speed: f64::INFINITY });
        }

        let pixel = Point2::new(at.x / at.z, at.y / at.z);
        // The point moves in the image by a constant over the square of its depth.
        let speed = (change.x * at.z - at.x * change.z).hypot(change.y * at.z - at.y * change.z);
        let speed = speed / (nearest.max(MIN_DEPTH)).powi(2);
        let (i, j) = floor_pixel(pixel.x, pixel.y);
        if !view.judges(i, j) {
            let distance = distance_to(&view.silhouette().image(), &pixel).max(LEAST_PROGRESS_PX);
            return is_closed.then_some(Clearance { distance, speed });
        }
        match motion {
            Some(motion) => {
                let clearance = motion.chain.clearance(&pixel, motion.at(time));
                Some(Clearance {
                    distance: clearance.distance,
                    speed: speed + clearance.change / motion.period,
                })
            }
            None => Some(Clearance { distance: still_distance(view, &point.start, &pixel), speed }),
        }
    }
}

impl MovingPoint {
    /// The point after a time.
    fn after(&self, seconds: f64) -> Self {
        Self { start: self.start + self.velocity * seconds, ..*self }
    }
}

impl ViewMotion<'_> {
    /// Where in the latest motion the silhouette is after a time.
    fn at(&self, seconds: f64) -> f64 {
        (self.s + seconds / self.period).min(2.0)
    }
}

impl SweptView<'_> {
    /// The outward normal of the surface where a point crosses the view's edge.
    fn normal_at(&self, hull: &Hull, point: &Point3<f64>, time: f64) -> Option<Vector3<f64>> {
        let Some(motion) = &self.motion else {
            return nearest_edge_in(self.view, point).map(|edge| hull.contact_normal(&edge));
        };
        let pixel = self.view.project(point)?;
        let at = Point2::new(pixel.u, pixel.v);
        let normal = motion.chain.edge_normal(&at, motion.at(time))?;
        Some(self.view.backproject_normal(&at, &normal))
    }
}

fn motion_of(view: &View) -> Option<ViewMotion<'_>> {
    let (chain, back) = view.motion()?;
    Some(ViewMotion { chain, s: 1.0 - back, period: chain.period() })
}

/// The distance of a pixel from the silhouette of a view that stands still: inside -1, outside at most the true one.
fn still_distance(view: &View, point: &Point3<f64>, pixel: &Point2<f64>) -> f64 {
    if view.verdict(point, EdgeModel::Coverage, false) == Verdict::Inside {
        return -1.0;
    }
    // With coverage the edge may lie up to a pixel beyond the subject's last one.
    let of_rect = distance_to(&view.silhouette().rect().grown(1), pixel);
    of_rect.max(2.0 * LEAST_PROGRESS_PX)
}

/// The distance in pixels of a point from the pixels of a rectangle; 0 inside it.
fn distance_to(rect: &Rect, pixel: &Point2<f64>) -> f64 {
    let beyond = |x: f64, first: i32, end: i32| (f64::from(first) - x).max(x - f64::from(end)).max(0.0);
    beyond(pixel.x, rect.x0, rect.x1).hypot(beyond(pixel.y, rect.y0, rect.y1))
}
