//! Planes through a camera's centre: the back-projection of an image line, and the frustum of a silhouette's rectangle
//! (paper, section 4.1).

use super::{Camera, MIN_DEPTH};
use crate::math::aabb::Aabb;
use crate::math::rect::Rect;
use nalgebra::{Matrix3x4, Point2, Point3, Vector2, Vector3};

/// The unit normal, in the world, of the plane through the camera's centre and the image line through `point` (pixels)
/// whose normal in the image is `normal`. It points to the same side as `normal`.
pub(crate) fn backproject_normal(
    projection: &Matrix3x4<f64>,
    point: &Point2<f64>,
    normal: &Vector2<f64>,
) -> Vector3<f64> {
    let row = |r: usize| Vector3::new(projection[(r, 0)], projection[(r, 1)], projection[(r, 2)]);
    let across = (row(0) - row(2) * point.x) * normal.x + (row(1) - row(2) * point.y) * normal.y;
    across.normalize()
}

/// The outward unit normals of the four planes through the camera's centre and the sides of `rect`.
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

/// The axis-aligned box around the part of the frustum inside `bounds`; empty where there is none.
///
/// A box cut by planes is a convex polyhedron, whose corners lie on the faces of the box or where three planes meet
/// inside it. Here the latter can only be the camera's centre, so that it suffices to clip the faces.
pub(crate) fn clipped_box(bounds: &Aabb, camera: &Camera, planes: &[Vector3<f64>; 4]) -> Aabb {
    let centre = camera.centre();
    let near = (camera.forward() * -1.0, centre + camera.forward() * MIN_DEPTH);
    let cuts = || planes.iter().map(|&outward| (outward, centre)).chain([near]);

    // Each face of the box, clipped by the frustum.
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

    // A cull must never change a verdict: the margin exceeds the rounding of a clipped corner, and is less than any
    // pixel covers.
    if aabb.is_empty() {
        aabb
    } else {
        aabb.grown(1e-9 * (bounds.max - bounds.min).norm()).intersection(bounds)
    }
}

/// The faces of a box: indices of each face's corners in [`Aabb::corners`], in order around it.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];

/// The largest number of corners of a quadrilateral clipped by five planes: each cut adds at most one.
const MAX_CORNERS: usize = 9;

/// A convex polygon.
#[derive(Default)]
struct Polygon {
    corners: [Point3<f64>; MAX_CORNERS],
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
        // A corner beyond the ninth can only come from rounding; it lies on the polygon's boundary and may be left out.
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    /// Writes to `kept` the part of the polygon behind the plane through `on` with normal `outward`
    /// (Sutherland-Hodgman clipping).
    fn clip(&self, outward: &Vector3<f64>, on: &Point3<f64>, kept: &mut Self) {
        kept.count = 0;
        let height = |p: &Point3<f64>| outward.dot(&(p - on));
        let Some(mut here) = self.corners().last() else { return };
        let mut h0 = height(here);

        for next in self.corners() {
            let h1 = height(next);
            // The edge from `here` to `next` crosses the plane.
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
