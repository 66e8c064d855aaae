//! Support points of smooth shapes: where the surface reaches farthest along a direction.
//!
//! ```text
//!     lying (axis within FLAT_ANGLE of        tilted            standing (cylinder, axis within
//!     perpendicular to d): both ends                            FLAT_ANGLE of d): the flat end, none
//!        _________________                      /\                   ___
//!       |_________________|                    /  \                 |   |
//!       *                 *                    \  /                 |___|
//!     d |                                       \/ *
//! ```
//!
//! Without them a round body would touch only at its samples, like a polyhedron, and would not roll.

use super::Sample;
use nalgebra::{Point3, Vector3};
use std::ops::Deref;

/// A body counts as lying if the direction is within this angle (radians) of perpendicular to its axis, and as
/// standing if it is within this angle of the axis. The angle is wide enough for the noise of a hull's normals; of the
/// two points of a nearly lying body only the touching one matters.
pub const FLAT_ANGLE: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// A shape with analytic support points: the axis is the local z axis, lengths are in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Smooth {
    /// A sphere about the origin.
    Sphere {
        /// The radius.
        radius: f64,
    },
    /// A cylinder with a hemisphere at either end.
    Capsule {
        /// The radius of the side and of the hemispheres.
        radius: f64,
        /// The length of the side, without the hemispheres.
        length: f64,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// The radius of the side.
        radius: f64,
        /// The full length.
        length: f64,
    },
}

/// Up to two points of a surface, the farthest first, as a slice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportPoints {
    points: [Sample; 2],
    count: usize,
}

impl SupportPoints {
    fn none() -> Self {
        let unused = Sample { point: Point3::origin(), normal: Vector3::zeros() };
        Self { points: [unused; 2], count: 0 }
    }

    fn one(point: Sample) -> Self {
        Self { points: [point; 2], count: 1 }
    }

    fn two(farthest: Sample, other: Sample) -> Self {
        Self { points: [farthest, other], count: 2 }
    }
}

impl Deref for SupportPoints {
    type Target = [Sample];

    fn deref(&self) -> &[Sample] {
        &self.points[..self.count]
    }
}

impl Smooth {
    /// Whether the surface has one normal at each of its points, so that a point on an edge of something else is touched
    /// along that normal.
    pub(crate) fn is_without_rim(&self) -> bool {
        !matches!(self, Self::Cylinder { .. })
    }

    /// The points of the surface farthest along the unit direction `d` (body frame), farthest first.
    ///
    /// A sphere has one point. A capsule has one, or one at either end if it lies. A cylinder has one on the rim, or
    /// one on either rim if it lies, or none if it stands (its flat end is covered by the samples). For a lying body
    /// the straight line between the two points is part of the surface too. The normal of a single point is `d`; the
    /// normals of a lying body's points are radial, except `d` at the farther end of a capsule. The result is empty if
    /// `d` is zero or not finite.
    pub fn support(&self, d: &Vector3<f64>) -> SupportPoints {
        let Some(d) = d.try_normalize(1e-12).filter(|d| d.iter().all(|x| x.is_finite())) else {
            return SupportPoints::none();
        };

        match *self {
            Smooth::Sphere { radius } => SupportPoints::one(along(Vector3::zeros(), d, radius)),
            Smooth::Capsule { radius, length } => {
                let end = Vector3::z() * (length / 2.0).copysign(d.z);
                let farthest = along(end, d, radius);
                match radial(&d) {
                    Some(radial) if lies(&d) && length > 0.0 => {
                        SupportPoints::two(farthest, along(-end, radial, radius))
                    }
                    _ => SupportPoints::one(farthest),
                }
            }

            Smooth::Cylinder { radius, length } => {
                let end = Vector3::z() * (length / 2.0).copysign(d.z);
                match radial(&d) {
                    Some(radial) if lies(&d) => {
                        SupportPoints::two(along(end, radial, radius), along(-end, radial, radius))
                    }
                    Some(radial) if !stands(&d) => {
                        SupportPoints::one(Sample { point: Point3::from(end + radial * radius), normal: d })
                    }
                    _ => SupportPoints::none(),
                }
            }
        }
    }
}

/// The point at distance `radius` from `center` along `normal`.
fn along(center: Vector3<f64>, normal: Vector3<f64>, radius: f64) -> Sample {
    Sample { point: Point3::from(center + normal * radius), normal }
}

/// The unit direction perpendicular to the axis that is nearest to `d`; `None` if `d` is along the axis.
fn radial(d: &Vector3<f64>) -> Option<Vector3<f64>> {
    Vector3::new(d.x, d.y, 0.0).try_normalize(1e-12)
}

/// Whether a body whose lowest point is sought along `d` lies on its side.
fn lies(d: &Vector3<f64>) -> bool {
    d.z.abs() <= FLAT_ANGLE.sin()
}

/// Whether a body whose lowest point is sought along `d` stands on its end.
fn stands(d: &Vector3<f64>) -> bool {
    d.z.abs() >= FLAT_ANGLE.cos()
}

#[cfg(test)]
mod tests {
    use super::super::{capsule, cylinder, sphere};
    use super::*;
    use ode_visual_hull_random::Random;

    #[test]
    fn no_sample_lies_farther_than_the_support_point() {
        let bodies = [sphere(0.1, 0.01), capsule(0.05, 0.3, 0.01), cylinder(0.08, 0.2, 0.01)]
            .map(|body| body.unwrap());
        let mut random = Random(3);
        for body in &bodies {
            for _ in 0..200 {
                let d = random.direction();
                let support = body.smooth().unwrap().support(&d);

                let reach = |sample: &Sample| sample.point.coords.dot(&d);
                let farthest = body.points().iter().map(reach).fold(f64::NEG_INFINITY, f64::max);
                let Some(first) = support.first() else {
                    assert!(matches!(body.smooth(), Some(Smooth::Cylinder { .. })) && d.z.abs() > 0.98);
                    continue;
                };

                assert!(reach(first) >= farthest - 1e-12);
                // Samples 1 cm apart are within r - sqrt(r^2 - 0.005^2) < 0.3 mm of a sphere's top, and within
                // half a centimetre of the farthest point of a rim.
                assert!(reach(first) <= farthest + 5e-3);
                assert!(support.iter().all(|s| reach(s) <= reach(first) + 1e-12 && s.normal.dot(&d) > 0.98));
            }
        }
    }

    #[test]
    fn support_points_lie_on_the_surface() {
        let mut random = Random(5);
        for _ in 0..500 {
            let mut d = random.direction();
            d.z *= random.between(0.0, 0.3);
            for s in (Smooth::Capsule { radius: 0.05, length: 0.3 }).support(&d).iter() {
                let on_axis = Vector3::z() * s.point.z.clamp(-0.15, 0.15);
                assert!(((s.point.coords - on_axis).norm() - 0.05).abs() < 1e-12);
            }
            for s in (Smooth::Cylinder { radius: 0.05, length: 0.3 }).support(&d).iter() {
                let outside = (s.point.coords.xy().norm() - 0.05).max(s.point.z.abs() - 0.15);
                assert!(outside.abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_number_of_points_depends_on_the_tilt() {
        let tilted = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Vector3::new(cos, 0.0, sin)
        };
        let sphere = Smooth::Sphere { radius: 0.1 };
        let capsule = Smooth::Capsule { radius: 0.1, length: 0.5 };
        let cylinder = Smooth::Cylinder { radius: 0.1, length: 0.5 };

        for (degrees, on_capsule, on_cylinder) in
            [(0.0, 2, 2), (9.0, 2, 2), (-9.0, 2, 2), (11.0, 1, 1), (79.0, 1, 1), (81.0, 1, 0), (90.0, 1, 0)]
        {
            let d = tilted(degrees);
            assert_eq!(sphere.support(&d).len(), 1);
            assert_eq!(capsule.support(&d).len(), on_capsule, "{degrees}");
            assert_eq!(cylinder.support(&d).len(), on_cylinder, "{degrees}");
        }

        assert!(sphere.support(&Vector3::zeros()).is_empty());
        assert!(sphere.support(&Vector3::repeat(f64::NAN)).is_empty());
        assert_eq!(Smooth::Capsule { radius: 0.1, length: 0.0 }.support(&Vector3::x()).len(), 1);
    }
}
