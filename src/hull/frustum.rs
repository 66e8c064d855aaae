//! Planes through a camera's centre: behind an image line, and around a silhouette's rectangle (paper, section 4.1).

use super::Aabb;
use crate::camera::{Camera, MIN_DEPTH};
use crate::silhouette::Rect;
use nalgebra::{Matrix3x4, Point2, Point3, Vector2, Vector3};

/// The outward normal of the plane through the camera's centre and the image line through `point` with image normal
/// `normal`.
pub(super) fn backproject_normal(
    projection: &Matrix3x4<f64>,
    point: &Point2<f64>,
    normal: &Vector2<f64>,
) -> Vector3<f64> {
    let row = |r: usize| Vector3::new(projection[(r, 0)], projection[(r, 1)], projection[(r, 2)]);
    let across = (row(0) - row(2) * point.x) * normal.x + (row(1) - row(2) * point.y) * normal.y;
    across.normalize()
}

/// The outward normals of the four planes through the camera's centre and the sides of `rect`.
pub(super) fn planes(projection: &Matrix3x4<f64>, rect: &Rect) -> [Vector3<f64>; 4] {
    let upper_left = Point2::new(f64::from(rect.x0), f64::from(rect.y0));
    let lower_right = Point2::new(f64::from(rect.x1), f64::from(rect.y1));
    [
        backproject_normal(projection, &upper_left, &-Vector2::x()),
        backproject_normal(projection, &upper_left, &-Vector2::y()),
        backproject_normal(projection, &lower_right, &Vector2::x()),
        backproject_normal(projection, &lower_right, &Vector2::y()),
    ]
}

/// The box of the frustum's part inside `bounds`; empty where there is none.
///
/// The corners of a convex body that is a box cut by planes lie on the box's faces, except where planes meet inside
/// it: for a frustum that is the camera's centre alone.
pub(super) fn clipped_box(bounds: &Aabb, camera: &Camera, planes: &[Vector3<f64>; 4]) -> Aabb {
    let centre = camera.centre();
    let near = (camera.forward() * -1.0, centre + camera.forward() * MIN_DEPTH);
    let cuts = || planes.iter().map(|&outward| (outward, centre)).chain([near]);
    let mut corners: Vec<Point3<f64>> = Vec::new();
    for face in faces(bounds) {
        let polygon = cuts().fold(face, |polygon, (outward, on)| clip(&polygon, &outward, &on));
        corners.extend(polygon);
    }
    if bounds.contains(&centre) {
        corners.push(centre);
    }
    let aabb = Aabb::of_points(&corners);
    // A cull must never change a verdict: more than the rounding of a clipped corner, less than any pixel.
    if aabb.is_empty() {
        aabb
    } else {
        aabb.grown(1e-9 * (bounds.max - bounds.min).norm()).intersection(bounds)
    }
}

/// The six faces of a box as quadrilaterals.
fn faces(aabb: &Aabb) -> [Vec<Point3<f64>>; 6] {
    let corners = aabb.corners();
    let quad = |a: usize, b: usize, c: usize, d: usize| vec![corners[a], corners[b], corners[c], corners[d]];
    [
        quad(0, 2, 6, 4),
        quad(1, 3, 7, 5),
        quad(0, 1, 5, 4),
        quad(2, 3, 7, 6),
        quad(0, 1, 3, 2),
        quad(4, 5, 7, 6),
    ]
}

/// The part of a convex polygon behind the plane through `on` with normal `outward`.
fn clip(polygon: &[Point3<f64>], outward: &Vector3<f64>, on: &Point3<f64>) -> Vec<Point3<f64>> {
    let height = |p: &Point3<f64>| outward.dot(&(p - on));
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, here) in polygon.iter().enumerate() {
        let next = &polygon[(k + 1) % polygon.len()];
        let (h0, h1) = (height(here), height(next));
        if h0 <= 0.0 {
            kept.push(*here);
        }
        if (h0 < 0.0 && h1 > 0.0) || (h0 > 0.0 && h1 < 0.0) {
            kept.push(here + (next - here) * (h0 / (h0 - h1)));
        }
    }
    kept
}
