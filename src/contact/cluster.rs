//! Colliding samples with like ways out, told apart with the help of the body's own normals.
//!
//! A box set deep into a table has samples on its lower rim whose nearest way out is sideways. The box's normals say
//! that they belong to its underside: a sample is *supported* when the way out runs against the body's outward
//! normal, and only supported samples found clusters.

use super::{Colliding, Contact, Room};
use crate::hull::{EdgeModel, Hull};
use crate::sample::Samples;
use nalgebra::{Isometry3, Vector3};

/// A sample is supported when the cosine between its way out and the body's normal is at most this.
const SUPPORTED: f64 = -0.3;

/// Samples whose ways out lie within this of a cluster's mean join it. At 20 degrees one face falls into two
/// clusters; 35 to 60 are alike.
const JOIN_COSINE: f64 = 0.819_152_044_288_991_8; // cos 35 degrees

/// Length, in metres, added to every way out, so that one of length zero still counts by its direction.
const DIRECTION_WEIGHT: f64 = 1e-6;

/// Samples that leave the hull together along one direction.
#[derive(Debug)]
pub(super) struct Cluster {
    members: Vec<Colliding>,
    sum: Vector3<f64>,
}

/// The clusters of the supported samples, the one with the deepest sample first, joined by the unsupported ones that
/// fit; empty where no sample is supported.
pub(super) fn of(colliding: &[Colliding]) -> Vec<Cluster> {
    let (mut supported, unsupported): (Vec<Colliding>, Vec<Colliding>) =
        colliding.iter().partition(|sample| is_supported(&sample.push.direction, &sample.normal));
    supported.sort_by(|a, b| b.push.depth.total_cmp(&a.push.depth).then(a.index.cmp(&b.index)));
    let mut clusters: Vec<Cluster> = Vec::new();
    for sample in supported {
        let cosines = clusters.iter().map(|cluster| cluster.direction().dot(&sample.push.direction));
        match first_greatest(cosines) {
            Some((nearest, cosine)) if cosine >= JOIN_COSINE => clusters[nearest].add(sample),
            _ => clusters.push(Cluster::founded_by(sample)),
        }
    }
    for sample in unsupported {
        let against = clusters.iter().map(|cluster| -cluster.direction().dot(&sample.normal));
        if let Some((nearest, cosine)) = first_greatest(against)
            && -cosine <= SUPPORTED
        {
            clusters[nearest].members.push(sample);
        }
    }
    clusters
}

fn is_supported(way_out: &Vector3<f64>, normal: &Vector3<f64>) -> bool {
    *normal == Vector3::zeros() || way_out.dot(normal) <= SUPPORTED
}

fn first_greatest(values: impl Iterator<Item = f64>) -> Option<(usize, f64)> {
    values.enumerate().reduce(|best, next| if next.1 > best.1 { next } else { best })
}

impl Cluster {
    fn founded_by(sample: Colliding) -> Self {
        let mut cluster = Self { members: Vec::new(), sum: Vector3::zeros() };
        cluster.add(sample);
        cluster
    }

    /// All samples, to leave along `direction`.
    pub(super) fn all(colliding: &[Colliding], direction: Vector3<f64>) -> Self {
        Self { members: colliding.to_vec(), sum: direction }
    }

    fn add(&mut self, sample: Colliding) {
        self.sum += sample.push.direction * (sample.push.depth + DIRECTION_WEIGHT);
        self.members.push(sample);
    }

    /// The direction of V, the mean of the members' ways out.
    fn direction(&self) -> Vector3<f64> {
        self.sum.normalize()
    }

    /// One contact a member, along V, its depth the member's own exit, in the order of the samples. A smooth body
    /// touches with its support points instead, or else it would roll like the polyhedron of its samples.
    pub(super) fn contacts(
        &mut self,
        hull: &Hull,
        body: &Samples,
        hull_from_body: &Isometry3<f64>,
        max_depth: f64,
        room: &mut Room,
    ) -> Vec<Contact> {
        let direction = self.direction();
        if let Some(smooth) = body.smooth() {
            let support = smooth.support(&hull_from_body.inverse_transform_vector(&-direction));
            let points = support.iter().map(|sample| hull_from_body * sample.point);
            let contact = |point| {
                let depth = hull.exit_within(&point, &direction, EdgeModel::Coverage, max_depth);
                Contact { point, direction, depth }
            };
            let touching: Vec<_> =
                points.filter(|p| hull.inside_by(p, EdgeModel::Coverage)).map(contact).collect();
            if !touching.is_empty() {
                return touching;
            }
        }
        self.members.sort_unstable_by_key(|sample| sample.index);
        let depths = room.exits_within(hull, self.members.iter(), &direction, EdgeModel::Coverage, max_depth);
        let contact =
            |(sample, &depth): (&Colliding, &f64)| Contact { point: sample.point, direction, depth };
        self.members.iter().zip(depths).map(contact).collect()
    }
}
