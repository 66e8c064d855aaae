//! Samples of bodies with flat faces: corners, edges, and a lattice on each face.
//!
//! ```text
//!   . . .+-----+. .      a lattice node covers its cell's part of the face (at most half a cell's diagonal
//!   .    |. . .|\ .      away from it). Nodes inside are samples. If a corner's or an edge's sample covers that
//!   . . .|. . .| \.      part already, nothing is added; else the node moves to the nearest point of the outline,
//!   .    +-----+--+      which is no farther from any point of a convex face.
//! ```

use super::Sample;
use super::limits::{cells, check_count, spacing};
use crate::Result;
use nalgebra::{Point3, Vector2, Vector3};
use std::collections::BTreeMap;

/// A flat, convex face.
#[derive(Debug, Clone)]
pub(super) struct Facet {
    /// Indices of the corners, counter-clockwise as seen from outside.
    pub outline: Vec<usize>,
    /// The unit outward normal.
    pub normal: Vector3<f64>,
}

/// A surface of flat faces that share corners.
#[derive(Debug)]
pub(super) struct Facets {
    pub corners: Vec<Point3<f64>>,
    pub faces: Vec<Facet>,
}

/// Samples in order, with the data for thinning them.
#[derive(Debug)]
pub(super) struct Covering {
    pub samples: Vec<Sample>,
    /// For each sample the length of the mean of its faces' normals: 1 where the surface is flat, 0.58 at a box's
    /// corner.
    pub flatness: Vec<f64>,
    pub radius: f64,
}

#[derive(Debug, Default)]
/// An edge of the surface: the sum and number of its faces' normals, and its samples between the corners.
struct Edge {
    normals: Vector3<f64>,
    faces: f64,
    points: Vec<Point3<f64>>,
}

impl Facets {
    /// The total area of the faces.
    pub fn area(&self) -> f64 {
        self.faces.iter().map(|face| self.area_of(face)).sum()
    }

    fn area_of(&self, face: &Facet) -> f64 {
        let start = self.corners[face.outline[0]];
        let fan = face.outline.windows(2);
        fan.map(|ab| (self.corners[ab[0]] - start).cross(&(self.corners[ab[1]] - start)).norm() / 2.0).sum()
    }

    /// Samples the surface with the covering radius `min_feature / 2`. With `own` every face gets a sample of its own,
    /// with the face's normal. `body` names the shape in errors; corners do not count towards the limit on samples.
    pub fn cover(&self, body: &str, min_feature: f64, own: bool) -> Result<Covering> {
        let spacing = spacing(min_feature)?;
        let mut edges = self.polygon_edges();

        let length = |(a, b): &(usize, usize)| (self.corners[*a] - self.corners[*b]).norm();
        let on_edges: f64 = edges.keys().map(|edge| cells(length(edge), spacing, 1.0) - 1.0).sum();
        check_count(body, on_edges + self.area() / (spacing * spacing), min_feature)?;

        for ((a, b), edge) in &mut edges {
            let n = cells(length(&(*a, *b)), spacing, 1.0) as usize;
            let (a, b) = (self.corners[*a], self.corners[*b]);
            edge.points = (1..n).map(|k| a + (b - a) * (k as f64 / n as f64)).collect();
        }

        let mut inner = Vec::new();
        let mut radius = 0.0_f64;
        for face in &self.faces {
            let before = inner.len();
            radius = radius.max(self.cover_face(face, spacing, &mut edges, &mut inner));
            if own && inner.len() == before {
                let sum: Vector3<f64> = face.outline.iter().map(|corner| self.corners[*corner].coords).sum();
                inner.push(Sample {
                    point: Point3::from(sum / face.outline.len() as f64),
                    normal: face.normal,
                });
            }
        }

        Ok(self.in_order(edges, inner, radius))
    }

    /// The edges of all faces, keyed by their corners in ascending order.
    fn polygon_edges(&self) -> BTreeMap<(usize, usize), Edge> {
        let mut edges: BTreeMap<_, Edge> = BTreeMap::new();
        for face in &self.faces {
            for (a, b) in sides(&face.outline) {
                let edge = edges.entry((a.min(b), a.max(b))).or_default();
                edge.normals += face.normal;
                edge.faces += 1.0;
            }
        }
        edges
    }

    /// Adds the samples that the face needs beyond those on its outline; returns the covering radius.
    fn cover_face(
        &self,
        face: &Facet,
        spacing: f64,
        polygon_edges: &mut BTreeMap<(usize, usize), Edge>,
        inner: &mut Vec<Sample>,
    ) -> f64 {
        let corners: Vec<_> = face.outline.iter().map(|corner| self.corners[*corner]).collect();
        let reach = spacing / std::f64::consts::SQRT_2;
        if let Some(radius) = corners_cover(&corners).filter(|radius| *radius <= reach) {
            return radius;
        }

        let lattice = Lattice::new(&corners, &face.normal, spacing);
        let outline: Vec<_> = corners.iter().map(|corner| lattice.projected(corner)).collect();
        let mut boundary = outline.clone();
        for (a, b) in sides(&face.outline) {
            boundary.extend(
                polygon_edges[&(a.min(b), a.max(b))].points.iter().map(|point| lattice.projected(point)),
            );
        }

        let mut radius = 0.0_f64;
        for node in lattice.nodes() {
            let depth = depth(&node, &outline);
            if depth >= spacing / 4.0 {
                inner.push(Sample { point: lattice.solid(&node), normal: face.normal });
                radius = radius.max(lattice.cell.norm() / 2.0);
                continue;
            }

            // The part of the face in the node's cell, and its distance to the nearest sample on the outline.
            let polygon = if depth < -reach { Vec::new() } else { clip(&outline, &node, &lattice.cell) };
            let farthest =
                |from: &Vector2<f64>| polygon.iter().map(|p| (p - from).norm()).fold(0.0, f64::max);
            let covered = boundary.iter().map(&farthest).fold(f64::INFINITY, f64::min);
            if polygon.is_empty() || covered <= reach * (1.0 + 1e-9) {
                radius = if polygon.is_empty() { radius } else { radius.max(covered) };
            } else if depth > 1e-9 * spacing {
                inner.push(Sample { point: lattice.solid(&node), normal: face.normal });
                radius = radius.max(farthest(&node));
            } else {
                let (side, along) = nearest_side(&node, &outline);
                let (a, b) = (face.outline[side], face.outline[(side + 1) % outline.len()]);
                let point = self.corners[a] + (self.corners[b] - self.corners[a]) * along;
                radius = radius.max(farthest(&lattice.projected(&point)));
                boundary.push(lattice.projected(&point));
                polygon_edges.entry((a.min(b), a.max(b))).or_default().points.push(point);
            }
        }
        radius
    }

    /// The samples in the order corners, edges, faces.
    fn in_order(&self, edges: BTreeMap<(usize, usize), Edge>, inner: Vec<Sample>, radius: f64) -> Covering {
        let mut covering = Covering { samples: Vec::new(), flatness: Vec::new(), radius };
        for (point, (normals, angle)) in self.corners.iter().zip(self.corner_normals()) {
            if angle > 0.0 {
                covering.push(*point, normals, angle);
            }
        }
        for edge in edges.values() {
            for point in &edge.points {
                covering.push(*point, edge.normals, edge.faces);
            }
        }
        for sample in inner {
            covering.push(sample.point, sample.normal, 1.0);
        }
        covering
    }

    /// For each corner the sum of its faces' normals weighted by their angles there, and the sum of these angles.
    fn corner_normals(&self) -> Vec<(Vector3<f64>, f64)> {
        let mut sums = vec![(Vector3::zeros(), 0.0); self.corners.len()];
        for face in &self.faces {
            let n = face.outline.len();
            for k in 0..n {
                let at = self.corners[face.outline[k]];
                let to = [n - 1, 1].map(|step| self.corners[face.outline[(k + step) % n]] - at);
                let angle = to[0].cross(&to[1]).norm().atan2(to[0].dot(&to[1]));
                let sum = &mut sums[face.outline[k]];
                sum.0 += face.normal * angle;
                sum.1 += angle;
            }
        }
        sums
    }
}

impl Covering {
    fn push(&mut self, point: Point3<f64>, normals: Vector3<f64>, weight: f64) {
        let flatness = normals.norm() / weight;
        // Two faces back to back have no common outside, so the normal is unknown.
        let normal = if flatness > 1e-6 { normals.normalize() } else { Vector3::zeros() };
        self.samples.push(Sample { point, normal });
        self.flatness.push(flatness);
    }
}

fn sides(outline: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
    (0..outline.len()).map(|k| (outline[k], outline[(k + 1) % outline.len()]))
}

/// A radius such that balls around the face's corners cover the face.
fn corners_cover(corners: &[Point3<f64>]) -> Option<f64> {
    if let [a, b, c] = corners {
        // The equilateral triangle is the worst case.
        let longest = (a - b).norm().max((b - c).norm()).max((c - a).norm());
        return Some(longest / 3.0_f64.sqrt());
    }
    corners.iter().map(|corner| (corner - corners[0]).norm()).reduce(f64::max)
}

/// A rectangular lattice in a face's plane, aligned with its longest side, over the face's bounding rectangle.
struct Lattice {
    origin: Point3<f64>,
    right: Vector3<f64>,
    up: Vector3<f64>,
    lower: Vector2<f64>,
    cell: Vector2<f64>,
    count: [usize; 2],
}

impl Lattice {
    fn new(corners: &[Point3<f64>], normal: &Vector3<f64>, spacing: f64) -> Self {
        let mut longest = Vector3::zeros();
        for k in 0..corners.len() {
            let side = corners[(k + 1) % corners.len()] - corners[k];
            // Among sides that differ only by noise choose the first.
            if side.norm() > longest.norm() * (1.0 + 1e-9) {
                longest = side;
            }
        }

        let right = longest.normalize();
        let mut lattice = Self {
            origin: corners[0],
            right,
            up: normal.cross(&right),
            lower: Vector2::zeros(),
            cell: Vector2::zeros(),
            count: [0; 2],
        };

        let flat: Vec<_> = corners.iter().map(|corner| lattice.projected(corner)).collect();
        let upper = flat.iter().fold(flat[0], |upper, p| upper.sup(p));
        lattice.lower = flat.iter().fold(flat[0], |lower, p| lower.inf(p));

        let size = upper - lattice.lower;
        let count = size.map(|length| cells(length, spacing, 1.0));
        lattice.count = count.map(|n| n as usize).into();
        lattice.cell = size.component_div(&count);
        lattice
    }

    fn nodes(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        let node =
            |i: usize, j: usize| self.lower + self.cell.component_mul(&Vector2::new(i as f64, j as f64));
        (0..=self.count[0]).flat_map(move |i| (0..=self.count[1]).map(move |j| node(i, j)))
    }

    fn projected(&self, point: &Point3<f64>) -> Vector2<f64> {
        let offset = point - self.origin;
        Vector2::new(offset.dot(&self.right), offset.dot(&self.up))
    }

    fn solid(&self, at: &Vector2<f64>) -> Point3<f64> {
        self.origin + self.right * at.x + self.up * at.y
    }
}

/// The distance to the nearest side's line, positive inside the outline.
fn depth(at: &Vector2<f64>, outline: &[Vector2<f64>]) -> f64 {
    let inwards = |k: usize| {
        let side = outline[(k + 1) % outline.len()] - outline[k];
        side.perp(&(at - outline[k])) / side.norm()
    };
    (0..outline.len()).map(inwards).fold(f64::INFINITY, f64::min)
}

/// The side nearest to a point, and the position on it, 0 to 1.
fn nearest_side(at: &Vector2<f64>, outline: &[Vector2<f64>]) -> (usize, f64) {
    let mut nearest = (f64::INFINITY, 0, 0.0);
    for (k, a) in outline.iter().enumerate() {
        let side = outline[(k + 1) % outline.len()] - a;
        let along = (side.dot(&(at - a)) / side.norm_squared()).clamp(0.0, 1.0);
        let distance = (a + side * along - at).norm();
        if distance < nearest.0 {
            nearest = (distance, k, along);
        }
    }
    (nearest.1, nearest.2)
}

/// The corners of the part of a convex outline in the cell around a node (Sutherland-Hodgman clipping).
fn clip(outline: &[Vector2<f64>], node: &Vector2<f64>, cell: &Vector2<f64>) -> Vec<Vector2<f64>> {
    let mut polygon = outline.to_vec();
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        let inside = |p: &Vector2<f64>| cell[axis] / 2.0 - sign * (p[axis] - node[axis]);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (k, a) in polygon.iter().enumerate() {
            let b = &polygon[(k + 1) % polygon.len()];
            let (at_a, at_b) = (inside(a), inside(b));
            if at_a >= 0.0 {
                kept.push(*a);
            }
            if (at_a >= 0.0) != (at_b >= 0.0) {
                kept.push(a + (b - a) * (at_a / (at_a - at_b)));
            }
        }
        polygon = kept;
    }
    polygon
}
