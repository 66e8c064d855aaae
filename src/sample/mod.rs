//! Surface samples of body shapes: points and outward normals, in the body's own frame.
//!
//! A body collides through its samples. They are so dense that no feature of diameter `min_feature` fits between them:
//! every point of the surface is within `min_feature / 2` of a sample, which on a flat face is a square grid of
//! spacing `min_feature / sqrt(2)`.
//!
//! ```text
//!      c---e---e---c      c  corner: the normalised sum of its faces' normals
//!      |           |      e  edge:   the normalised sum of its two faces' normals
//!      e   f   f   e      f  face:   the face's normal; the grid is symmetric about the face's centre
//!      |           |
//!      c---e---e---c      order: corners, edges, faces
//! ```
//!
//! The order of the samples is fixed for a given shape and `min_feature`; ties between samples go to the lower index.
//! Lengths are in metres. The axis of capsules and cylinders is the local z axis.
//!
//! ```
//! use nalgebra::Vector3;
//! use ode_visual_hull::sample;
//!
//! let samples = sample::box_(Vector3::new(0.4, 0.3, 0.2), 0.03)?;
//! assert!(samples.covering_radius() <= 0.03 / 2.0);
//! assert!(samples.points().iter().all(|sample| (sample.normal.norm() - 1.0).abs() < 1e-12));
//! # Ok::<(), ode_visual_hull::Error>(())
//! ```

mod cache;
mod capsule;
mod convex;
mod cuboid;
mod cylinder;
mod decimate;
mod facets;
mod implicit;
mod limits;
mod points;
mod rings;
mod shape;
mod sphere;
mod support;
mod trimesh;
mod weld;
mod wrap;

#[cfg(test)]
pub(crate) mod testing;

pub use cache::SampleCache;
pub use capsule::capsule;
pub use convex::convex;
pub use cuboid::box_;
pub use cylinder::cylinder;
pub use implicit::implicit;
pub use limits::MAX_SAMPLES;
pub use points::from_points;
pub use sphere::sphere;
pub use support::{FLAT_ANGLE, Smooth, SupportPoints};
pub use trimesh::trimesh;

use crate::hull::Points;
use nalgebra::{Point3, Vector3};

/// One point of a body's surface, in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The position, in metres.
    pub point: Point3<f64>,
    /// The unit outward normal, or zero if unknown (such a sample counts as supported in any direction).
    pub normal: Vector3<f64>,
}

/// The surface samples of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    samples: Vec<Sample>,
    point_cloud: Points,
    bounding_radius: f64,
    bounding_sphere: (Point3<f64>, f64),
    covering_radius: f64,
    smooth: Option<Smooth>,
}

impl Samples {
    /// Samples of a body that extends no farther than its samples.
    fn new(samples: Vec<Sample>, covering_radius: f64) -> Self {
        let bounding_radius = samples.iter().map(|s| s.point.coords.norm()).fold(0.0, f64::max);
        let bounding_sphere = bounding_sphere(&samples);
        let point_cloud = point_cloud_of(&samples);
        Self { samples, point_cloud, bounding_radius, bounding_sphere, covering_radius, smooth: None }
    }

    /// Samples of a smooth body centred at the origin; `reach` is the distance of its farthest point.
    fn of_smooth(samples: Vec<Sample>, covering_radius: f64, smooth: Smooth, reach: f64) -> Self {
        let bounding_sphere = (Point3::origin(), reach);
        let point_cloud = point_cloud_of(&samples);
        Self {
            samples,
            point_cloud,
            bounding_radius: reach,
            bounding_sphere,
            covering_radius,
            smooth: Some(smooth),
        }
    }

    /// Extends the bounds to contain further `points` of the body.
    fn holding<'a>(mut self, points: impl IntoIterator<Item = &'a Point3<f64>>) -> Self {
        let (center, radius) = &mut self.bounding_sphere;
        for point in points {
            self.bounding_radius = self.bounding_radius.max(point.coords.norm());
            *radius = radius.max((point - *center).norm());
        }
        self
    }

    /// Widens the bounds by `margin`, for surfaces that bulge out between their samples.
    fn widened(mut self, margin: f64) -> Self {
        self.bounding_radius += margin;
        self.bounding_sphere.1 += margin;
        self
    }

    /// The samples in the order corners, edges, faces; never empty.
    pub fn points(&self) -> &[Sample] {
        &self.samples
    }

    /// The samples' points in the form of the hull's batch queries.
    pub fn point_cloud(&self) -> &Points {
        &self.point_cloud
    }

    /// The radius of a sphere about the body's origin that contains the body, in metres.
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// The centre (body frame) and radius in metres of a sphere that contains the body: tighter than
    /// [`Self::bounding_radius`] if the body lies far from its origin.
    pub fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        self.bounding_sphere
    }

    /// The largest distance in metres from a point of the surface to the nearest sample. It never exceeds `min_feature
    /// / 2`; it is infinite for a user's own points, whose surface is unknown.
    pub fn covering_radius(&self) -> f64 {
        self.covering_radius
    }

    /// The analytic shape behind the samples, for bodies that roll.
    pub fn smooth(&self) -> Option<&Smooth> {
        self.smooth.as_ref()
    }
}

fn point_cloud_of(samples: &[Sample]) -> Points {
    let points: Vec<_> = samples.iter().map(|sample| sample.point).collect();
    Points::new(&points)
}

/// The sphere about the centre of the samples' bounding box that contains them all.
fn bounding_sphere(samples: &[Sample]) -> (Point3<f64>, f64) {
    let (mut lower, mut upper) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for sample in samples {
        lower = lower.inf(&sample.point.coords);
        upper = upper.sup(&sample.point.coords);
    }
    // Halve before adding, so that coordinates near the largest float do not overflow.
    let center = Point3::from(lower * 0.5 + upper * 0.5);
    (center, samples.iter().map(|s| (s.point - center).norm()).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Convex, Shape, TriMesh};

    fn shapes() -> [Shape; 6] {
        let sign = |k: u32, bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
        let corner = |k: u32| Point3::new(0.2 * sign(k, 1), 0.2 * sign(k, 2), 0.1 * sign(k, 4));
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let convex = Convex::new((0..8).map(corner).collect(), &faces.map(|face| face.to_vec())).unwrap();
        let tetrahedron = vec![[0, 2, 1], [0, 1, 4], [0, 4, 2], [1, 2, 4]];
        let mesh = TriMesh::new((0..8).map(corner).collect(), tetrahedron).unwrap();
        [
            Shape::Sphere { radius: 0.2 },
            Shape::cuboid(0.3, 0.2, 0.1),
            Shape::Capsule { radius: 0.1, length: 0.4 },
            Shape::Cylinder { radius: 0.1, length: 0.4 },
            Shape::Convex(convex.into()),
            Shape::TriMesh(mesh.into()),
        ]
    }

    #[test]
    fn sampling_twice_gives_the_same_samples() {
        for shape in shapes() {
            assert_eq!(shape.sample(0.05).unwrap(), shape.sample(0.05).unwrap());
        }
    }

    #[test]
    fn a_larger_min_feature_needs_fewer_samples() {
        for shape in shapes() {
            let counts = [0.02, 0.04, 0.08].map(|d| shape.sample(d).unwrap().points().len());
            assert!(counts.is_sorted_by(|a, b| a > b), "{shape:?}: {counts:?}");
        }
    }

    #[test]
    fn only_round_shapes_are_smooth() {
        let smooth = shapes().map(|shape| shape.sample(0.05).unwrap().smooth().is_some());
        assert_eq!(smooth, [true, false, true, true, false, false]);
    }

    #[test]
    fn samples_can_be_sent_to_and_shared_with_other_threads() {
        fn is_send_and_sync<T: Send + Sync>() {}
        is_send_and_sync::<(Samples, SampleCache, SupportPoints)>();
    }
}
