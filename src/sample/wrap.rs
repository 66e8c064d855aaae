//! The convex hull of points in space by gift wrapping: planes rotate about known edges until they meet the next
//! point.
//!
//! All points within the tolerance of such a plane form one face, so that coplanar faces are one polygon from the
//! start and noise far below the tolerance has no effect. The time is quadratic in the number of vertices.

use super::facets::Facet;
use nalgebra::{Point3, Vector2, Vector3};
use std::collections::{HashSet, VecDeque};

/// The faces of the hull of `points`, which are distinct by more than `tolerance`; `None` if they (nearly) lie in a
/// plane.
pub(super) fn wrap(points: &[Point3<f64>], tolerance: f64) -> Option<Vec<Facet>> {
    if is_flat(points, tolerance) {
        return None;
    }
    let wrapping = Wrapping { points, tolerance };
    let mut faces: Vec<Facet> = Vec::new();
    let mut known = HashSet::new();
    let mut edges = HashSet::new();
    let mut open = VecDeque::new();

    let mut next = Some(wrapping.first_plane());
    while let Some((anchor, normal)) = next.take() {
        let members = wrapping.on_plane(&anchor, &normal);
        if let Some(face) = wrapping.face(&members, &normal).filter(|_| known.insert(members)) {
            for (k, a) in face.outline.iter().enumerate() {
                let b = face.outline[(k + 1) % face.outline.len()];
                edges.insert((*a, b));
                open.push_back((*a, b, face.normal));
            }
            faces.push(face);
        }

        // A hull of n corners has at most 2 n - 4 faces: more are caused by noise above the tolerance.
        if faces.len() > 2 * points.len() {
            return None;
        }

        while next.is_none()
            && let Some((a, b, normal)) = open.pop_front()
        {
            if !edges.contains(&(b, a)) {
                next = Some((points[a], wrapping.rotate_plane(&points[a], &points[b], &normal)));
            }
        }
    }
    (faces.len() >= 4).then_some(faces)
}

struct Wrapping<'a> {
    points: &'a [Point3<f64>],
    tolerance: f64,
}

impl Wrapping<'_> {
    /// A point and the normal of a plane through it and two others, with no point outside the plane.
    fn first_plane(&self) -> (Point3<f64>, Vector3<f64>) {
        let lowest = |a: &&Point3<f64>, b: &&Point3<f64>| {
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
        };
        let a = self.points.iter().min_by(lowest).copied().unwrap_or_else(Point3::origin);
        let normal = self.rotate_plane(&a, &(a + Vector3::y()), &-Vector3::x());

        // This plane contains a second point; the line through both is the next axis.
        let off =
            |p: &&Point3<f64>| (**p - a).norm() * f64::from((**p - a).dot(&normal).abs() <= self.tolerance);
        let b = self.points.iter().max_by(|p, q| off(p).total_cmp(&off(q))).copied().unwrap_or(a);
        (a, self.rotate_plane(&a, &b, &normal))
    }

    /// Rotates the plane of `normal` about the line from `a` to `b`, away from the face on the left of that line,
    /// until it meets a point; returns the new normal.
    fn rotate_plane(&self, a: &Point3<f64>, b: &Point3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
        let away = (b - a).cross(normal).normalize();
        let mut least = (f64::INFINITY, *normal);
        for point in self.points {
            let (along, below) = ((point - a).dot(&away), (a - point).dot(normal).max(0.0));
            let distance = along.hypot(below);
            // Points on the line itself have no angle.
            if distance <= 2.0 * self.tolerance {
                continue;
            }

            let angle = below.atan2(along);
            if angle < least.0 {
                least = (angle, (normal * along + away * below) / distance);
            }
        }
        least.1.normalize()
    }

    /// The indices of the points on a plane.
    fn on_plane(&self, anchor: &Point3<f64>, normal: &Vector3<f64>) -> Vec<usize> {
        let on = |index: &usize| (self.points[*index] - anchor).dot(normal).abs() <= self.tolerance;
        (0..self.points.len()).filter(on).collect()
    }

    /// The convex polygon of the points `members` of a plane, counter-clockwise as seen from outside.
    fn face(&self, members: &[usize], normal: &Vector3<f64>) -> Option<Facet> {
        let start = self.points[*members.first()?];
        let far =
            members.iter().map(|i| self.points[*i] - start).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        let right = (far - normal * far.dot(normal)).try_normalize(self.tolerance)?;
        let up = normal.cross(&right);
        let flat = |i: &usize| {
            (Vector2::new((self.points[*i] - start).dot(&right), (self.points[*i] - start).dot(&up)), *i)
        };
        let outline = outline(members.iter().map(flat).collect(), self.tolerance)?;

        // Newell's sum uses all corners, so that no short edge tilts the plane; noise may tilt a sliver too much, which
        // then keeps the plane it was found by.
        let corner = |k: usize| self.points[outline[k % outline.len()]] - start;
        let newell: Vector3<f64> = (0..outline.len()).map(|k| corner(k).cross(&corner(k + 1))).sum();
        let newell = newell.try_normalize(0.0)?;
        let supports = self.points.iter().all(|point| (point - start).dot(&newell) <= 2.0 * self.tolerance);
        Some(Facet { normal: if supports { newell } else { *normal }, outline })
    }
}

/// The convex outline of labelled points in a plane, counter-clockwise, without corners closer than `tolerance` to the
/// line through their neighbours.
fn outline(mut points: Vec<(Vector2<f64>, usize)>, tolerance: f64) -> Option<Vec<usize>> {
    points.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut outline: Vec<(Vector2<f64>, usize)> = Vec::new();
    // Andrew's monotone chain: the lower part from left to right, then the upper part from right to left.
    for pass in 0..2 {
        let from = outline.len();
        for point in &points {
            while let [.., a, b] = &outline[from..] {
                if (b.0 - a.0).perp(&(point.0 - a.0)) > 0.0 {
                    break;
                }
                outline.pop();
            }
            outline.push(*point);
        }
        outline.pop();
        if pass == 0 {
            points.reverse();
        }
    }

    // Remove nearly collinear corners, and check the neighbours of a removed corner again.
    let mut k = 0;
    let mut kept = 0;
    while kept < outline.len() && outline.len() >= 3 {
        let n = outline.len();
        let (a, b, c) = (outline[(k + n - 1) % n].0, outline[k % n].0, outline[(k + 1) % n].0);
        if (c - a).perp(&(b - a)).abs() <= tolerance * (c - a).norm() {
            outline.remove(k % n);
            kept = 0;
            k = (k % n + n - 2) % (n - 1);
        } else {
            kept += 1;
            k = (k + 1) % n;
        }
    }

    (outline.len() >= 3).then(|| outline.into_iter().map(|(_, index)| index).collect())
}

/// Whether all points lie within a few tolerances of one plane.
fn is_flat(points: &[Point3<f64>], tolerance: f64) -> bool {
    let Some(first) = points.first() else { return true };
    let farthest = |measure: &dyn Fn(&Vector3<f64>) -> f64| {
        let offsets = points.iter().map(|point| point - first);
        offsets
            .max_by(|a, b| measure(a).total_cmp(&measure(b)))
            .filter(|offset| measure(offset) > 4.0 * tolerance)
    };
    let Some(line) = farthest(&|offset| offset.norm()).map(|offset| offset.normalize()) else { return true };
    let Some(side) = farthest(&|offset| line.cross(offset).norm()) else { return true };
    let normal = line.cross(&side).normalize();
    farthest(&|offset| offset.dot(&normal).abs()).is_none()
}
