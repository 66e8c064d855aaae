//! Where rays enter the visual hull: sphere tracing on the distances of the silhouettes.
//!
//! ```text
//!   image of the ray     .  o----D----)   .        no subject within D pixels: the ray may leap to where its
//!   in one view       ---o-------------x-----      image is D pixels farther
//! ```
//!
//! All in single precision, as on a GPU.

mod line;
mod packet;
mod ray;
mod view;

pub use line::{Line, Lines};
pub use packet::{PacketLines, Packets};
pub use ray::Ray;
pub use view::MarchView;

use crate::scene::Scene;
use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::{Aabb, Unseen};
use ray::clip_to_box;
use std::ops::Range;

/// The smallest leap, in pixels of the view that decides. What is thinner may be missed.
const MIN_LEAP_PX: f32 = 0.25;

/// The smallest leap in metres, and as a part of the distance, whose rounding error it must exceed: close to a camera a pixel is
/// much smaller.
const MIN_LEAP: f32 = 1e-5;
const MIN_RELATIVE_LEAP: f32 = 4.0 * f32::EPSILON;

/// The smallest depth in front of a camera, in metres.
const MIN_DEPTH: f32 = 1e-3;

/// How far a ray goes on where too few views see it, in metres.
const BLIND_STEP: f32 = 0.01;

/// Places along a ray at which [`March::least_outside`] looks.
const LEAST_STEPS: u32 = 256;

/// Where a ray enters the hull.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Metres along the ray.
    pub t: f32,
    /// The index, among the scene's views, of the one whose silhouette ends the hull there.
    pub view: usize,
}

/// The hull of a scene, prepared for rays.
#[derive(Debug)]
pub struct March<'s> {
    views: Vec<MarchView<'s>>,
    /// Holds the hull.
    bounds: Aabb,
    /// The number of views that have to see a point of the hull, where views abstain.
    min_views: Option<usize>,
}

/// What one view says of a point.
enum Verdict {
    Inside,
    /// Outside, and so is the ray for so many metres more.
    Outside(f32),
    Unseen,
}

impl<'s> March<'s> {
    /// The hull of `scene`.
    pub fn new(scene: &'s Scene) -> Self {
        let min_views = match scene.hull.unseen() {
            Unseen::Outside => None,
            Unseen::Abstain { min_views } => Some(min_views.max(1)),
        };
        Self {
            views: scene.views.iter().map(MarchView::new).collect(),
            bounds: *scene.hull.aabb(),
            min_views,
        }
    }

    /// The views, in the scene's order.
    pub fn views(&self) -> &[MarchView<'s>] {
        &self.views
    }

    /// Where `ray` enters the hull within the `range` of distances along it: the reference for [`entries`](Self::entries).
    #[cfg(test)]
    pub fn entry(&self, ray: &Ray, range: Range<f32>, lines: &mut Lines) -> Option<Entry> {
        let (before, entry) = self.first_inside(ray, range, 0.0, lines)?;
        Some(self.entry_between(ray, before, entry))
    }

    /// Where `ray` enters the hull, which is behind distance `before` and not behind the place `after`.
    fn entry_between(&self, ray: &Ray, before: f32, after: Entry) -> Entry {
        // The distance from the silhouette that ends the hull there is nearly linear over the last leap.
        let Entry { t, view } = after;
        let line = self.views[view].line(ray);
        let distance = |t: f32| {
            let h = line.at(t);
            self.views[view].distance(h.x / h.z, h.y / h.z)
        };
        let (outside, inside) = (distance(before), distance(t));
        let part = if outside > inside { (outside / (outside - inside)).clamp(0.0, 1.0) } else { 1.0 };
        Entry { t: before + part * (t - before), view }
    }

    /// A distance along `ray` before which no ray enters the hull that starts with it and is at most `spread` radians off.
    /// `None` if none of them ever does.
    pub fn cone_entry(&self, ray: &Ray, spread: f32, lines: &mut Lines) -> Option<f32> {
        self.first_inside(ray, 0.0..f32::MAX, spread, lines).map(|(before, _)| before)
    }

    /// The first place found along `ray` that views see inside, or less than `spread` radians from there, and the last one
    /// before it that some view sees outside.
    fn first_inside(
        &self,
        ray: &Ray,
        range: Range<f32>,
        spread: f32,
        lines: &mut Lines,
    ) -> Option<(f32, Entry)> {
        let (from, to) = clip_to_box(&self.bounds, spread, ray, (range.start, range.end))?;
        let count = self.views.len();
        lines.begin(&self.views, &ray.origin);

        // A view is asked until it lets the ray pass; the ray is inside where all views in turn did.
        let (mut t, mut before, mut decided_by) = (from, from, lines.decided_by);
        let (mut turn, mut passed, mut seen) = (0, 0, 0);
        while t <= to {
            let (view, line) = lines.of_turn(turn, &self.views, ray);
            match self.verdict(view, line, t, spread) {
                Verdict::Outside(leap) => {
                    (before, decided_by) = (t, view);
                    t += leap.max(MIN_LEAP).max(MIN_RELATIVE_LEAP * t);
                    (passed, seen) = (0, 0);
                }
                verdict => {
                    let is_seen = matches!(verdict, Verdict::Inside);
                    (passed, seen) = (passed + 1, seen + usize::from(is_seen));
                    turn = if turn + 1 == count { 0 } else { turn + 1 };
                }
            }
            if passed == count {
                if seen >= self.min_views.unwrap_or(count) {
                    lines.decided_by = decided_by;
                    return Some((before, Entry { t, view: decided_by }));
                }
                before = t;
                t += BLIND_STEP;
                (passed, seen) = (0, 0);
            }
        }
        lines.decided_by = decided_by;
        None
    }

    /// What view number `view` says of the place at distance `t` along the ray of `line`, and of all within `spread` radians.
    #[inline(always)]
    fn verdict(&self, view: usize, line: &Line, t: f32, spread: f32) -> Verdict {
        let (view, h) = (&self.views[view], line.at(t));
        let distance = match self.min_views {
            None if h.z < MIN_DEPTH => return Verdict::Outside(line.leap_to_front(h.z)),
            None => Some(view.distance(h.x / h.z, h.y / h.z)),
            Some(_) => view.distance_at(&h),
        };
        let Some(distance) = distance else { return Verdict::Unseen };
        let distance = distance - spread * t * view.pixels_per_metre / h.z;
        if distance <= 0.0 {
            return Verdict::Inside;
        }
        Verdict::Outside(line.leap(h.z, distance.max(MIN_LEAP_PX)))
    }

    /// The distance along `ray`, which passes through the silhouette of view `own`, at which the others contradict it least:
    /// where their greatest distance from a silhouette in pixels is the smallest. `None` where the ray misses the bounds or is
    /// seen by no other view.
    ///
    /// Silhouettes that do not fit one another leave holes in the hull, as a real camera sees it.
    pub fn least_outside(&self, ray: &Ray, own: usize) -> Option<Entry> {
        let (from, to) = clip_to_box(&self.bounds, 0.0, ray, (MIN_DEPTH, f32::MAX))?;
        let lines: Vec<Line> = self.views.iter().map(|view| view.line(ray)).collect();
        let step = (to - from) / LEAST_STEPS as f32;
        let worst_at = |t: f32| {
            let of_view = |(view, line): (&MarchView, &Line)| view.distance_at(&line.at(t));
            let others = self.views.iter().zip(&lines).enumerate().filter(|(k, _)| *k != own);
            let worst = others.filter_map(|(k, one)| of_view(one).map(|distance| (distance, k)));
            worst.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(distance, view)| (distance, Entry { t, view }))
        };
        let ts = (0..=LEAST_STEPS).map(|k| from + step * k as f32);
        ts.filter_map(worst_at).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, entry)| entry)
    }

    /// The outward unit normal of the hull's surface near `point`: where the view decides whose silhouette's edge is nearest.
    pub fn normal_near(&self, point: &Point3<f32>) -> Vector3<f32> {
        let distance = |view: &MarchView| view.distance_at(&view.homogeneous(point)).unwrap_or(f32::MIN);
        let distances = self.views.iter().map(distance).enumerate();
        let nearest = distances.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(view, _)| view);
        self.normal(point, nearest)
    }

    /// The outward unit normal of the hull at `point` on its surface, where `view` decides.
    pub fn normal(&self, point: &Point3<f32>, view: usize) -> Vector3<f32> {
        let view = &self.views[view];
        let h = view.homogeneous(point);
        let (u, v) = (h.x / h.z, h.y / h.z);
        let gradient = view.gradient(u, v);
        let row = |k: usize| view.projection.fixed_view::<1, 3>(k, 0).transpose();
        let normal = (row(0) - row(2) * u) * gradient.x + (row(1) - row(2) * v) * gradient.y;
        normal.try_normalize(1e-12).unwrap_or_else(Vector3::z)
    }
}

#[cfg(test)]
mod tests;
