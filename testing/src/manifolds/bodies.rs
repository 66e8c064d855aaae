//! Bodies whose surfaces are known analytically.

use crate::random::Random;
use nalgebra::{Point3, Vector3, vector};
use ode_visual_hull::sample::{Samples, from_points};
use ode_visual_hull::shape::{Convex, Shape, TriMesh};
use std::sync::Arc;

/// A body in its own frame.
pub struct Body {
    /// A ball, a box, a capsule, a cylinder, an octahedron, or a mesh of an L.
    pub shape: Shape,
    /// Its samples.
    pub samples: Samples,
    surface: Surface,
}

/// The analytic surface of a body.
enum Surface {
    Sphere {
        radius: f64,
    },
    Box {
        half: Vector3<f64>,
    },
    Capsule {
        radius: f64,
        half: f64,
    },
    Cylinder {
        radius: f64,
        half: f64,
    },
    /// The distances of the corners from the centre.
    Octahedron {
        corners: Vector3<f64>,
    },
    /// Two boxes that make an L.
    Boxes([(Point3<f64>, Vector3<f64>); 2]),
}

impl Body {
    /// Number of kinds of bodies.
    pub const KINDS: usize = 6;

    /// A random body of a kind, 4 to 25 cm across.
    pub fn random(random: &mut Random, kind: usize) -> Self {
        let mut length = |low: f64, high: f64| random.between(low, high);
        let radius = length(0.02, 0.08);
        let (shape, surface) = match kind {
            0 => (Shape::Sphere { radius }, Surface::Sphere { radius }),
            1 => {
                let half = Vector3::from_fn(|_, _| length(0.02, 0.08));
                (Shape::Box { sides: half * 2.0 }, Surface::Box { half })
            }
            2 => {
                let half = length(0.01, 0.06);
                (Shape::Capsule { radius, length: 2.0 * half }, Surface::Capsule { radius, half })
            }
            3 => {
                let half = length(0.02, 0.08);
                (Shape::Cylinder { radius, length: 2.0 * half }, Surface::Cylinder { radius, half })
            }
            4 => {
                let corners = Vector3::from_fn(|_, _| length(0.03, 0.1));
                (Shape::Convex(Arc::new(octahedron(&corners))), Surface::Octahedron { corners })
            }
            _ => {
                let [long, wide, thick] = [length(0.1, 0.2), length(0.03, 0.08), length(0.03, 0.08)];
                (Shape::TriMesh(Arc::new(l_mesh(long, wide, thick))), Surface::of_l(long, wide, thick))
            }
        };
        let min_feature = length(0.02, 0.05);
        let samples = shape.sample(min_feature).unwrap();
        Self { shape, samples, surface }
    }

    /// The largest distance of its surface from its centre, in metres.
    pub fn reach(&self) -> f64 {
        self.samples.bounding_radius()
    }

    /// The samples in the given order, as samples that know of no shape.
    pub fn samples_in_order(&self, order: &[usize]) -> Samples {
        let samples = order.iter().map(|&index| self.samples.points()[index]);
        let (points, normals): (Vec<_>, Vec<_>) = samples.map(|sample| (sample.point, sample.normal)).unzip();
        from_points(&points, Some(&normals)).unwrap()
    }

    /// The distance of a point of the body's frame from the body, negative within it: exact on the surface.
    pub fn signed_distance(&self, point: &Point3<f64>) -> f64 {
        let p = point.coords;
        let to_segment = |half: f64| vector![p.x, p.y, p.z - p.z.clamp(-half, half)].norm();
        match self.surface {
            Surface::Sphere { radius } => p.norm() - radius,
            Surface::Box { half } => to_box(&p, &half),
            Surface::Capsule { radius, half } => to_segment(half) - radius,
            Surface::Cylinder { radius, half } => (p.xy().norm() - radius).max(p.z.abs() - half),
            Surface::Octahedron { corners } => {
                let inverse = corners.map(f64::recip);
                (p.abs().dot(&inverse) - 1.0) / inverse.norm()
            }
            Surface::Boxes(boxes) => {
                let distances = boxes.map(|(centre, half)| to_box(&(p - centre.coords), &half));
                distances[0].min(distances[1])
            }
        }
    }
}

impl Surface {
    /// The L of [`l_mesh`]. Its boxes overlap in the corner, so that a face of one within the other is no
    /// surface.
    fn of_l(long: f64, wide: f64, thick: f64) -> Self {
        let half = |x: f64, y: f64| vector![x, y, thick] * 0.5;
        let centred = |half: Vector3<f64>| (Point3::from(half), half);
        Self::Boxes([centred(half(long, wide)), centred(half(wide, long))])
    }
}

/// The largest distance of a point from the planes of a box's faces.
fn to_box(p: &Vector3<f64>, half: &Vector3<f64>) -> f64 {
    (p.abs() - half).max()
}

fn octahedron(corners: &Vector3<f64>) -> Convex {
    let axes = [Vector3::x() * corners.x, Vector3::y() * corners.y, Vector3::z() * corners.z];
    let points = axes.iter().flat_map(|axis| [Point3::from(*axis), Point3::from(-axis)]).collect();
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Convex::new(points, &faces.map(|face| face.to_vec())).unwrap()
}

/// An L with one corner at the origin, whose two legs are `long` and `wide` and lie along x and y; `thick`
/// along z.
fn l_mesh(long: f64, wide: f64, thick: f64) -> TriMesh {
    let outline = [[0.0, 0.0], [long, 0.0], [long, wide], [wide, wide], [wide, long], [0.0, long]];
    let ring = |z: f64| outline.map(|[x, y]| Point3::new(x, y, z));
    let points = [ring(0.0), ring(thick)].concat();

    // Fans about the inner corner, which sees all of the outline.
    let fan = [[3, 4, 5], [3, 5, 0], [3, 0, 1], [3, 1, 2]];
    let bottom = fan.map(|[a, b, c]| [a, c, b]);
    let top = fan.map(|corners| corners.map(|k| k + 6));
    let sides = (0..6).flat_map(|k| {
        let next = (k + 1) % 6;
        [[k, next, next + 6], [k, next + 6, k + 6]]
    });
    let triangles = bottom.into_iter().chain(top).chain(sides).collect();
    TriMesh::new(points, triangles).unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_of_a_point_off_the_surface_is_not_zero() {
        let mut random = Random(1);
        for kind in 0..Body::KINDS {
            let body = Body::random(&mut random, kind);
            for sample in body.samples.points() {
                assert!(body.signed_distance(&sample.point).abs() < 1e-12);
                let (off, within) =
                    (sample.point + sample.normal * 1e-3, sample.point - sample.normal * 1e-3);
                assert!(body.signed_distance(&off) > 1e-4, "kind {kind}");
                assert!(body.signed_distance(&within) < -1e-4, "kind {kind}");
            }
        }
    }
}
