//! Planes through a camera's centre: behind an image line, and around a silhouette's rectangle (paper, section 4.1).

use super::{Camera, MIN_DEPTH};
use crate::math::aabb::Aabb;
use crate::math::rect::Rect;
use nalgebra::{Matrix3x4, Point2, Point3, Vector2, Vector3};

/// The outward normal of the plane through the camera's centre and the image line through `point` with image normal
/// `normal`.
pub(crate) fn backproject_normal(
    projection: &Matrix3x4<f64>,
    point: &Point2<f64>,
    normal: &Vector2<f64>,
) -> Vector3<f64> {
    let row = |r: usize| Vector3::new(projection[(r, 0)], projection[(r, 1)], projection[(r, 2)]);
    let across = (row(0) - row(2) * point.x) * normal.x + (row(1) - row(2) * point.y) * normal.y;
    across.normalize()
}

/// The outward normals of the four planes through the camera's centre and the sides of `rect`.
pub(crate) fn planes(projection: &Matrix3x4<f64>, rect: &Rect) -> [Vector3<f64>; 4] {
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
pub(crate) fn clipped_box(bounds: &Aabb, camera: &Camera, planes: &[Vector3<f64>; 4]) -> Aabb {
    let centre = camera.centre();
    let near = (camera.forward() * -1.0, centre + camera.forward() * MIN_DEPTH);
    let cuts = || planes.iter().map(|&outward| (outward, centre)).chain([near]);
    let corners = bounds.corners();
    let (mut polygon, mut cut) = (&mut Polygon::default(), &mut Polygon::default());
    let mut aabb = Aabb::EMPTY;
    for ring in FACES {
        polygon.set(ring.map(|corner| corners[corner]));
        for (outward, on) in cuts() {
            polygon.clip(&outward, &on, cut);
            std::mem::swap(&mut polygon, &mut cut);
        }
        aabb = aabb.union(&Aabb::of_points(polygon.corners()));
    }
    if bounds.contains(&centre) {
        aabb = aabb.union(&Aabb { min: centre, max: centre });
    }
    // A cull must never change a verdict: more than the rounding of a clipped corner, less than any pixel.
    if aabb.is_empty() {
        aabb
    } else {
        aabb.grown(1e-9 * (bounds.max - bounds.min).norm()).intersection(bounds)
    }
}

/// The faces of a box as rings of its corners.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];

/// The most corners of a quadrilateral cut by five planes: each cut adds one.
const MOST_CORNERS: usize = 9;

/// A convex polygon.
#[derive(Default)]
struct Polygon {
    corners: [Point3<f64>; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    fn corners(&self) -> &[Point3<f64>] {
        &self.corners[..self.count]
    }

    fn set(&mut self, corners: [Point3<f64>; 4]) {
        self.corners[..4].copy_from_slice(&corners);
        self.count = 4;
    }

    fn push(&mut self, corner: Point3<f64>) {
        // Rounding cannot add corners to a convex polygon by more than a rim: what is left out then lies on it.
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    /// The part behind the plane through `on` with normal `outward`, written to `kept`.
    fn clip(&self, outward: &Vector3<f64>, on: &Point3<f64>, kept: &mut Self) {
        kept.count = 0;
        let height = |p: &Point3<f64>| outward.dot(&(p - on));
        let Some(mut here) = self.corners().last() else { return };
        let mut h0 = height(here);
        for next in self.corners() {
            let h1 = height(next);
            if (h0 < 0.0 && h1 > 0.0) || (h0 > 0.0 && h1 < 0.0) {
                kept.push(here + (next - here) * (h0 / (h0 - h1)));
            }
            if h1 <= 0.0 {
                kept.push(*next);
            }
            (here, h0) = (next, h1);
        }
    }
}
