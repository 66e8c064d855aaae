//! One view of the hull: its projection and the distances of its silhouette.

use super::MIN_DEPTH;
use super::line::Line;
use super::ray::Ray;
use crate::scene::SceneView;
use nalgebra::{Matrix3x4, Point3, Vector2, Vector3};
use ode_visual_hull::camera::Camera;

/// One view, as rays need it.
#[derive(Debug)]
pub struct MarchView<'s> {
    pub(super) projection: Matrix3x4<f32>,
    /// Width and height of the image in pixels.
    pub(super) image: Vector2<f32>,
    /// By how many pixels a point's image moves at most for each metre that the point moves, 1 m in front of the camera: more
    /// than the focal length far off the axis.
    pub(super) pixels_per_metre: f32,
    pub(super) distances: &'s [f32],
    /// Image position of the first of the distances, and columns and rows from there to the last one.
    pub(super) first: [f32; 2],
    pub(super) last: [f32; 2],
    /// Distances in a row.
    pub(super) stride: usize,
}

impl<'s> MarchView<'s> {
    pub(super) fn new(view: &'s SceneView) -> Self {
        let distances = view.distance();
        let known = distances.rect();
        let (width, height) = view.camera().size();
        Self {
            projection: view.projection().cast(),
            image: Vector2::new(width as f32, height as f32),
            pixels_per_metre: pixels_per_metre(view.camera()),
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
    pub fn line(&self, ray: &Ray) -> Line {
        Line::new(self.homogeneous(&ray.origin), &self.projection, &ray.direction)
    }

    /// The signed distance from the silhouette's edge in pixels, negative inside, at homogeneous image coordinates; `None`
    /// where the view does not see the point.
    pub(super) fn distance_at(&self, h: &Vector3<f32>) -> Option<f32> {
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
    pub(super) fn gradient(&self, u: f32, v: f32) -> Vector2<f32> {
        const REACH: f32 = 3.0;
        let along = |du: f32, dv: f32| self.distance(u + du, v + dv) - self.distance(u - du, v - dv);
        Vector2::new(along(REACH, 0.0), along(0.0, REACH))
    }
}

/// See [`MarchView::pixels_per_metre`]: the derivative of the projection is greatest in a corner of the image.
fn pixels_per_metre(camera: &Camera) -> f32 {
    let (k, (width, height)) = (camera.intrinsics(), camera.size());
    let tangent = |axis: usize, length: u32| {
        let centre = k[(axis, 2)];
        centre.abs().max((f64::from(length) - centre).abs()) / k[(axis, axis)]
    };
    let (x, y) = (tangent(0, width), tangent(1, height));
    (k[(0, 0)].max(k[(1, 1)]) * (1.0 + x * x + y * y).sqrt()) as f32
}
