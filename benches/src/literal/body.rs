//! The body vector of the paper's section 5.

use super::view::{add, dot, scaled};
use super::{LiteralHull, Vec3};
use crate::scene::Bodies;

/// The boxes in plain `f32`.
#[derive(Debug, Clone)]
pub struct LiteralBodies {
    /// Samples of one box, in its own frame.
    samples: Vec<Vec3>,
    /// Bounding radius of a box about its origin, in metres.
    radius: f32,
    poses: Vec<Pose>,
    /// Buffer for the samples of a body that are inside, each with its response vector and the deciding view.
    hits: Vec<(Vec3, Vec3, usize)>,
}

/// The transform from a body's frame to the world.
#[derive(Debug, Clone, Copy)]
struct Pose {
    rotation: [Vec3; 3],
    translation: Vec3,
}

/// The vector that moves a body out of the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyVector {
    /// The vector in metres; zero where no sample collides.
    pub vector: Vec3,
    /// Number of colliding samples.
    pub colliding: usize,
}

impl LiteralBodies {
    /// Converts the samples and poses of `bodies` to `f32`.
    pub fn new(bodies: &Bodies) -> Self {
        let vec3 = |v: nalgebra::Vector3<f64>| -> Vec3 { v.cast::<f32>().into() };
        let pose = |pose: &nalgebra::Isometry3<f64>| {
            let rotation = pose.rotation.to_rotation_matrix();
            let row = |r: usize| vec3(rotation.matrix().row(r).transpose());
            Pose { rotation: [row(0), row(1), row(2)], translation: vec3(pose.translation.vector) }
        };
        Self {
            samples: bodies.samples.points().iter().map(|sample| vec3(sample.point.coords)).collect(),
            radius: bodies.samples.bounding_radius() as f32,
            poses: bodies.poses.iter().map(pose).collect(),
            hits: Vec::new(),
        }
    }

    /// Writes the bodies' vectors in `hull` to `vectors`.
    pub fn vectors(&mut self, hull: &LiteralHull, vectors: &mut Vec<BodyVector>) {
        let Self { samples, radius, poses, hits } = self;
        let responses = poses.iter().map(|pose| hull.body_vector(samples, *radius, pose, hits));
        vectors.clear();
        vectors.extend(responses);
    }
}

impl Pose {
    #[inline]
    fn apply(&self, p: &Vec3) -> Vec3 {
        add(&self.rotation.map(|row| dot(&row, p)), &self.translation)
    }
}

impl LiteralHull<'_> {
    /// The body vector: its direction is the mean of the colliding samples' responses, and its length the longest exit
    /// in that direction. Where the responses cancel out, the deepest sample's response gives the direction.
    fn body_vector(
        &self,
        samples: &[Vec3],
        radius: f32,
        pose: &Pose,
        hits: &mut Vec<(Vec3, Vec3, usize)>,
    ) -> BodyVector {
        hits.clear();

        let near = |axis: usize| {
            let x = pose.translation[axis];
            self.aabb[0][axis] - radius <= x && x <= self.aabb[1][axis] + radius
        };
        if (0..3).all(near) {
            hits.extend(samples.iter().filter_map(|sample| {
                let p = pose.apply(sample);
                let response = self.respond(&p)?;
                Some((p, response.w(), response.view))
            }));
        }

        let sum = hits.iter().fold([0.0; 3], |sum, (_, w, _)| add(&sum, w));
        let squared = dot(&sum, &sum);
        let deepest = hits.iter().map(|(_, w, _)| w).max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
        let Some(deepest) = deepest else { return BodyVector { vector: [0.0; 3], colliding: 0 } };
        let along = if squared > 0.0 { sum } else { *deepest };
        let direction = scaled(&along, 1.0 / dot(&along, &along).sqrt());

        let exits = hits.iter().map(|(p, _, view)| self.exit(p, &direction, *view));

        BodyVector { vector: scaled(&direction, exits.fold(0.0, f32::max)), colliding: hits.len() }
    }
}
