//! Where rays enter the visual hull: sphere tracing on the distances of the silhouettes.
//!
//! ```text
//!   image of the ray     .  o----D----)   .        no subject within D pixels: the ray may leap to where its
//!   in one view       ---o-------------x-----      image is D pixels farther
//! ```
//!
//! All in single precision, as on a GPU.

use crate::scene::{Scene, SceneView};
use nalgebra::{Matrix3x4, Point3, Vector2, Vector3};
use ode_visual_hull::hull::{Aabb, Unseen};
use std::ops::Range;

/// The smallest leap, in pixels of the view that decides. What is thinner may be missed.
const MIN_LEAP_PX: f32 = 0.25;

/// The smallest depth in front of a camera, in metres.
const MIN_DEPTH: f32 = 1e-3;

/// How far a ray goes on where too few views see it, in metres.
const BLIND_STEP: f32 = 0.01;

/// Places along a ray at which [`March::least_outside`] looks.
const LEAST_STEPS: u32 = 256;

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

/// One view, as rays need it.
#[derive(Debug)]
pub struct MarchView<'s> {
    projection: Matrix3x4<f32>,
    /// Width and height of the image in pixels.
    image: Vector2<f32>,
    /// The focal length in pixels.
    focal: f32,
    distances: &'s [f32],
    /// Image position of the first of the distances, and columns and rows from there to the last one.
    first: [f32; 2],
    last: [f32; 2],
    /// Distances in a row.
    stride: usize,
}

/// The images of a ray's points in one view: homogeneous coordinates `at_origin + t slope`.
#[derive(Debug, Clone, Copy)]
struct Line {
    at_origin: Vector3<f32>,
    slope: Vector3<f32>,
    /// The speed of the image is this over the squared depth, in pixels a metre.
    speed: f32,
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

    /// Where `ray` enters the hull within the `range` of distances along it.
    pub fn entry(&self, ray: &Ray, range: Range<f32>, lines: &mut Lines) -> Option<Entry> {
        let (before, Entry { t, view }) = self.first_inside(ray, range, 0.0, lines)?;

        // The distance from the silhouette that ends the hull there is nearly linear over the last leap.
        let line = self.views[view].line(ray);
        let distance = |t: f32| {
            let h = line.at(t);
            self.views[view].distance(h.x / h.z, h.y / h.z)
        };
        let (outside, inside) = (distance(before), distance(t));
        let part = if outside > inside { (outside / (outside - inside)).clamp(0.0, 1.0) } else { 1.0 };
        Some(Entry { t: before + part * (t - before), view })
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
                    t += leap;
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
        let distance = distance - spread * t * view.focal / h.z;
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

/// Scratch memory of [`March::entry`]: the images of a ray in the views that were asked about it, in the order in which
/// they are asked.
#[derive(Debug, Default)]
pub struct Lines {
    lines: Vec<Line>,
    /// The origin of the ray, and its images in the views that were asked: rays of a picture share it.
    origin: Option<Point3<f32>>,
    at_origin: Vec<Option<Vector3<f32>>>,
    /// The view that decided the last ray that missed the hull: it is asked first, since neighbouring rays miss likewise.
    decided_by: usize,
    first: usize,
}

impl Lines {
    fn begin(&mut self, views: &[MarchView], origin: &Point3<f32>) {
        self.lines.clear();
        self.first = if self.decided_by < views.len() { self.decided_by } else { 0 };
        if self.origin != Some(*origin) || self.at_origin.len() != views.len() {
            self.origin = Some(*origin);
            self.at_origin.clear();
            self.at_origin.resize(views.len(), None);
        }
    }

    /// The view whose turn it is, and the ray's image in it.
    fn of_turn(&mut self, turn: usize, views: &[MarchView], ray: &Ray) -> (usize, &Line) {
        let view = self.first + turn;
        let view = if view < views.len() { view } else { view - views.len() };
        if turn == self.lines.len() {
            let at_origin = self.at_origin[view].get_or_insert_with(|| views[view].homogeneous(&ray.origin));
            self.lines.push(Line::new(*at_origin, &views[view].projection, &ray.direction));
        }
        (view, &self.lines[turn])
    }
}

impl<'s> MarchView<'s> {
    fn new(view: &'s SceneView) -> Self {
        let distances = view.distance();
        let known = distances.rect();
        let (width, height) = view.camera().size();
        Self {
            projection: view.projection().cast(),
            image: Vector2::new(width as f32, height as f32),
            focal: view.camera().intrinsics()[(0, 0)] as f32,
            distances: distances.values(),
            first: [known.x0 as f32 + 0.5, known.y0 as f32 + 0.5],
            last: [known.width() as f32 - 1.0, known.height() as f32 - 1.0],
            // A silhouette without pixels has no distances; two columns keep the arithmetic simple.
            stride: known.width().max(2),
        }
    }

    /// Homogeneous image coordinates of `point`: `(u depth, v depth, depth)`.
    pub fn homogeneous(&self, point: &Point3<f32>) -> Vector3<f32> {
        self.projection.fixed_columns::<3>(0) * point.coords + self.projection.column(3)
    }

    /// The image of `ray`.
    fn line(&self, ray: &Ray) -> Line {
        Line::new(self.homogeneous(&ray.origin), &self.projection, &ray.direction)
    }

    /// The signed distance from the silhouette's edge in pixels, negative inside, at homogeneous image coordinates; `None`
    /// where the view does not see the point.
    fn distance_at(&self, h: &Vector3<f32>) -> Option<f32> {
        let (u, v) = (h.x / h.z, h.y / h.z);
        let is_seen = h.z > MIN_DEPTH && u >= 0.0 && v >= 0.0 && u < self.image.x && v < self.image.y;
        is_seen.then(|| self.distance(u, v))
    }

    /// Whether a point at homogeneous image coordinates `h` is in sight and belongs to the silhouette.
    pub fn is_subject(&self, h: &Vector3<f32>) -> bool {
        self.distance_at(h).is_some_and(|distance| distance < 0.0)
    }

    /// The signed distance at image position `(u, v)`, bilinear between pixel centres. Beyond the known ones it is at most
    /// the true distance, since the silhouette lies within their rectangle.
    #[inline(always)]
    pub fn distance(&self, u: f32, v: f32) -> f32 {
        let [columns, rows] = self.last;
        let (column, row) = (u - self.first[0], v - self.first[1]);
        if column >= 0.0 && row >= 0.0 && column < columns && row < rows {
            return self.interpolated(column, row);
        }
        let (x, y) = (column.clamp(0.0, columns), row.clamp(0.0, rows));
        let (du, dv, distance) = (column - x, row - y, self.interpolated(x, y));
        (du * du + dv * dv + distance * distance).sqrt()
    }

    /// The distance at this column and row of the known ones.
    #[inline(always)]
    fn interpolated(&self, column: f32, row: f32) -> f32 {
        let (i, j) = ((column as usize).min(self.stride - 2), row as usize);
        let (right, below) = (column - i as f32, row - j as f32);
        let at = j * self.stride + i;
        let upper = self.distances.get(at..at + 2);
        // In the last row nothing is below.
        let lower = self.distances.get(at + self.stride..at + self.stride + 2).or(upper);
        let (Some(&[a, b]), Some(&[c, d])) = (upper, lower) else { return f32::MAX };
        let (upper, lower) = (a + (b - a) * right, c + (d - c) * right);
        upper + (lower - upper) * below
    }

    /// The gradient of the distance, over three pixels, so that steps of pixels are smoothed.
    fn gradient(&self, u: f32, v: f32) -> Vector2<f32> {
        const REACH: f32 = 3.0;
        let along = |du: f32, dv: f32| self.distance(u + du, v + dv) - self.distance(u - du, v - dv);
        Vector2::new(along(REACH, 0.0), along(0.0, REACH))
    }
}

impl Line {
    fn new(at_origin: Vector3<f32>, projection: &Matrix3x4<f32>, direction: &Vector3<f32>) -> Self {
        let slope = projection.fixed_columns::<3>(0) * direction;
        let speed = (slope.xy() * at_origin.z - at_origin.xy() * slope.z).norm();
        Self { at_origin, slope, speed }
    }

    fn at(&self, t: f32) -> Vector3<f32> {
        self.at_origin + self.slope * t
    }

    /// How many metres the ray goes on from a point at this depth before its image has moved by `distance` pixels.
    fn leap(&self, depth: f32, distance: f32) -> f32 {
        let slower = self.speed - distance * depth * self.slope.z;
        // A ray that flees from the camera may never move so far.
        if slower <= 0.0 { f32::INFINITY } else { distance * depth * depth / slower }
    }

    /// How many metres the ray goes on from a point at this depth before it is in front of the camera.
    fn leap_to_front(&self, depth: f32) -> f32 {
        // The factor keeps it there in spite of rounding.
        if self.slope.z > 0.0 { (1.001 * MIN_DEPTH - depth) / self.slope.z + 1e-4 } else { f32::INFINITY }
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
fn clip_to_box(bounds: &Aabb, spread: f32, ray: &Ray, range: (f32, f32)) -> Option<(f32, f32)> {
    (0..3).try_fold(range, |range, axis| {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        let range = clip_to_half_line(origin - bounds.min[axis] as f32, direction + spread, range)?;
        clip_to_half_line(bounds.max[axis] as f32 - origin, spread - direction, range)
    })
}

#[cfg(test)]
mod tests;
