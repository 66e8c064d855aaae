//! Colliding samples with like ways out, told apart with the help of the body's own normals.
//!
//! A box set deep into a table has samples on its lower rim whose nearest way out is sideways. The box's normals say
//! that they belong to its underside: a sample is *supported* when the way out runs against the body's outward
//! normal, and only supported samples found clusters.

use super::Colliding;
use nalgebra::Vector3;

/// A sample is supported when the cosine between its way out and the body's normal is at most this.
const SUPPORTED: f64 = -0.3;

/// Samples whose ways out lie within this of a cluster's mean join it. At 20 degrees one face falls into two
/// clusters; 35 to 60 are alike.
const JOIN_COSINE: f64 = 0.819_152_044_288_991_8; // cos 35 degrees

/// Length, in metres, added to every way out, so that one of length zero still counts by its direction.
const DIRECTION_WEIGHT: f64 = 1e-6;

/// Samples that leave the hull together, each along its cluster's direction.
#[derive(Debug, Default)]
pub(super) struct Clusters {
    clusters: Vec<Cluster>,
    /// The cluster of each sample, by its place; `None` where it fits none.
    of_sample: Vec<Option<usize>>,
    /// Places of the supported samples, the deepest first.
    supported: Vec<usize>,
}

#[derive(Debug)]
struct Cluster {
    sum: Vector3<f64>,
    /// The direction of V, the mean of the members' ways out.
    direction: Vector3<f64>,
}

impl Clusters {
    /// Finds the clusters of the supported samples, the one with the deepest sample first, joined by the unsupported
    /// ones that fit; none where no sample is supported. Asks no depth of unsupported ones.
    pub(super) fn find(&mut self, colliding: &[Colliding]) {
        let is_supported = |place: &usize| is_supported(&colliding[*place]);
        self.clusters.clear();
        self.supported.clear();
        self.supported.extend((0..colliding.len()).filter(is_supported));
        let depth = |place: usize| colliding[place].depth;
        self.supported.sort_unstable_by(|&a, &b| depth(b).total_cmp(&depth(a)).then(a.cmp(&b)));
        self.of_sample.clear();
        self.of_sample.resize(colliding.len(), None);
        for &place in &self.supported {
            self.of_sample[place] = Some(join_or_found(&mut self.clusters, &colliding[place]));
        }
        for (sample, cluster) in colliding.iter().zip(&mut self.of_sample) {
            if cluster.is_none() {
                *cluster = fitting(&self.clusters, sample);
            }
        }
    }

    /// All samples in one cluster, to leave along `direction`.
    pub(super) fn put_together(&mut self, colliding: &[Colliding], direction: &Vector3<f64>) {
        self.clusters.clear();
        self.clusters.push(Cluster { sum: *direction, direction: direction.normalize() });
        self.of_sample.clear();
        self.of_sample.resize(colliding.len(), Some(0));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// The clusters' directions.
    pub(super) fn directions(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.clusters.iter().map(|cluster| cluster.direction)
    }

    /// The samples of a cluster, in their order.
    pub(super) fn members<'a>(
        &'a self,
        cluster: usize,
        colliding: &'a [Colliding],
    ) -> impl Iterator<Item = &'a Colliding> {
        let of_sample = colliding.iter().zip(&self.of_sample);
        of_sample.filter(move |(_, of)| **of == Some(cluster)).map(|(sample, _)| sample)
    }
}

/// The cluster that a supported sample belongs to, which may be its own.
fn join_or_found(clusters: &mut Vec<Cluster>, sample: &Colliding) -> usize {
    let way_out = &sample.direction;
    let cosines = clusters.iter().map(|cluster| cluster.direction.dot(way_out));
    let joined = first_greatest(cosines).filter(|(_, cosine)| *cosine >= JOIN_COSINE);
    let joined = joined.map_or(clusters.len(), |(nearest, _)| nearest);
    if joined == clusters.len() {
        clusters.push(Cluster { sum: Vector3::zeros(), direction: Vector3::zeros() });
    }
    let cluster = &mut clusters[joined];
    cluster.sum += way_out * (sample.depth + DIRECTION_WEIGHT);
    cluster.direction = cluster.sum.normalize();
    joined
}

/// The cluster that an unsupported sample fits best, if any.
fn fitting(clusters: &[Cluster], sample: &Colliding) -> Option<usize> {
    let against = clusters.iter().map(|cluster| -cluster.direction.dot(&sample.normal));
    first_greatest(against).filter(|(_, against)| -against <= SUPPORTED).map(|(nearest, _)| nearest)
}

/// Whether a sample's way out runs against the body's normal there, as far as that is known.
pub(super) fn is_supported(sample: &Colliding) -> bool {
    sample.normal == Vector3::zeros() || sample.direction.dot(&sample.normal) <= SUPPORTED
}

fn first_greatest(values: impl Iterator<Item = f64>) -> Option<(usize, f64)> {
    values.enumerate().reduce(|best, next| if next.1 > best.1 { next } else { best })
}
