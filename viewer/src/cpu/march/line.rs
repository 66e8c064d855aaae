//! The images of rays in views.

use super::MIN_DEPTH;
use super::ray::Ray;
use super::view::MarchView;
use nalgebra::{Matrix3x4, Point3, Vector3};

/// The images of a ray's points in one view: homogeneous coordinates `at_origin + t slope`.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    at_origin: Vector3<f32>,
    slope: Vector3<f32>,
    /// The speed of the image is this over the squared depth, in pixels a metre.
    speed: f32,
}

/// Scratch memory of [`March::entry`](super::March::entry): the images of a ray in the views that were asked about it, in the order in which
/// they are asked.
#[derive(Debug, Default)]
pub struct Lines {
    lines: Vec<Line>,
    /// The origin of the ray, and its images in the views that were asked: rays of a picture share it.
    origin: Option<Point3<f32>>,
    at_origin: Vec<Option<Vector3<f32>>>,
    /// The view that decided the last ray: it is asked first, since it often decides neighbouring rays too.
    pub(super) decided_by: usize,
    first: usize,
}

impl Lines {
    pub(super) fn begin(&mut self, views: &[MarchView], origin: &Point3<f32>) {
        self.lines.clear();
        self.first = if self.decided_by < views.len() { self.decided_by } else { 0 };
        if self.origin != Some(*origin) || self.at_origin.len() != views.len() {
            self.origin = Some(*origin);
            self.at_origin.clear();
            self.at_origin.resize(views.len(), None);
        }
    }

    /// The view whose turn it is, and the ray's image in it.
    pub(super) fn of_turn(&mut self, turn: usize, views: &[MarchView], ray: &Ray) -> (usize, &Line) {
        let view = self.first + turn;
        let view = if view < views.len() { view } else { view - views.len() };
        if turn == self.lines.len() {
            let at_origin = self.at_origin[view].get_or_insert_with(|| views[view].homogeneous(&ray.origin));
            self.lines.push(Line::new(*at_origin, &views[view].projection, &ray.direction));
        }
        (view, &self.lines[turn])
    }
}

impl Line {
    pub(super) fn new(
        at_origin: Vector3<f32>,
        projection: &Matrix3x4<f32>,
        direction: &Vector3<f32>,
    ) -> Self {
        let slope = projection.fixed_columns::<3>(0) * direction;
        let speed = (slope.xy() * at_origin.z - at_origin.xy() * slope.z).norm();
        Self { at_origin, slope, speed }
    }

    /// The homogeneous image coordinates of the ray's point at distance `t`.
    pub fn at(&self, t: f32) -> Vector3<f32> {
        self.at_origin + self.slope * t
    }

    /// How many metres the ray goes on from a point at this depth before its image has moved by `distance` pixels.
    pub(super) fn leap(&self, depth: f32, distance: f32) -> f32 {
        let slower = self.speed - distance * depth * self.slope.z;
        // A ray that flees from the camera may never move so far.
        if slower <= 0.0 { f32::INFINITY } else { distance * depth * depth / slower }
    }

    /// How many metres the ray goes on from a point at this depth before it is in front of the camera.
    pub(super) fn leap_to_front(&self, depth: f32) -> f32 {
        // The factor keeps it there in spite of rounding.
        if self.slope.z > 0.0 { (1.001 * MIN_DEPTH - depth) / self.slope.z + 1e-4 } else { f32::INFINITY }
    }
}
