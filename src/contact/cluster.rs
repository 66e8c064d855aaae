//! Penetrating samples with like exit directions, told apart with the help of the body's own normals.
//!
//! A box set deep into a table has samples on its lower rim whose nearest exit is sideways. The box's normals say
//! that they belong to its underside: a sample is *supported* when its exit direction runs against the body's outward
//! normal, and only supported samples found clusters.

use super::PenetratingSample;
use super::tuning::{DIRECTION_WEIGHT, JOIN_COSINE, SUPPORTED_COSINE};
use nalgebra::Vector3;

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
    /// The direction of V, the mean of the members' exit vectors.
    direction: Vector3<f64>,
    /// Index of the view that gave the direction of its deepest sample; none where no sample gave it.
    view: Option<usize>,
}

impl Clusters {
    /// Finds the clusters of the supported samples, the one with the deepest sample first, joined by the unsupported
    /// ones that fit; none where no sample is supported. Asks no depth of unsupported ones.
    pub(super) fn find(&mut self, penetrating: &[PenetratingSample]) {
        self.clusters.clear();
        self.supported.clear();
        for (place, sample) in penetrating.iter().enumerate() {
            if is_supported(sample) {
                self.supported.push(place);
            }
        }
        let depth = |place: usize| penetrating[place].depth;
        self.supported.sort_unstable_by(|&a, &b| depth(b).total_cmp(&depth(a)).then(a.cmp(&b)));
        self.of_sample.clear();
        self.of_sample.resize(penetrating.len(), None);
        for &place in &self.supported {
            self.of_sample[place] = Some(join_or_found(&mut self.clusters, &penetrating[place]));
        }
        for (sample, cluster) in penetrating.iter().zip(&mut self.of_sample) {
            if cluster.is_none() {
                *cluster = best_cluster_for(&self.clusters, sample);
            }
        }
    }

    /// All samples in one cluster, to leave along `direction`.
    pub(super) fn put_together(&mut self, penetrating: &[PenetratingSample], direction: &Vector3<f64>) {
        self.clusters.clear();
        self.clusters.push(Cluster { sum: *direction, direction: direction.normalize(), view: None });
        self.of_sample.clear();
        self.of_sample.resize(penetrating.len(), Some(0));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// The clusters' directions, and the views that gave those of their deepest samples.
    pub(super) fn directions(&self) -> impl Iterator<Item = (Vector3<f64>, Option<usize>)> {
        self.clusters.iter().map(|cluster| (cluster.direction, cluster.view))
    }

    /// The samples of a cluster, in their order.
    pub(super) fn members<'a>(
        &'a self,
        cluster: usize,
        penetrating: &'a [PenetratingSample],
    ) -> impl Iterator<Item = &'a PenetratingSample> {
        let of_sample = penetrating.iter().zip(&self.of_sample);
        of_sample.filter(move |(_, of)| **of == Some(cluster)).map(|(sample, _)| sample)
    }
}

/// The cluster that a supported sample belongs to, which may be its own.
fn join_or_found(clusters: &mut Vec<Cluster>, sample: &PenetratingSample) -> usize {
    let direction = &sample.direction;
    let cosines = clusters.iter().map(|cluster| cluster.direction.dot(direction));
    let joined = first_greatest(cosines).filter(|(_, cosine)| *cosine >= JOIN_COSINE);
    let joined = joined.map_or(clusters.len(), |(nearest, _)| nearest);
    if joined == clusters.len() {
        let (sum, direction) = (Vector3::zeros(), Vector3::zeros());
        clusters.push(Cluster { sum, direction, view: Some(sample.view) });
    }
    let cluster = &mut clusters[joined];
    cluster.sum += direction * (sample.depth + DIRECTION_WEIGHT);
    cluster.direction = cluster.sum.normalize();
    joined
}

/// The cluster that an unsupported sample fits best, if any.
fn best_cluster_for(clusters: &[Cluster], sample: &PenetratingSample) -> Option<usize> {
    let against = clusters.iter().map(|cluster| -cluster.direction.dot(&sample.normal));
    first_greatest(against).filter(|(_, against)| -against <= SUPPORTED_COSINE).map(|(nearest, _)| nearest)
}

/// Whether a sample's exit direction runs against the body's normal there, as far as that is known.
pub(super) fn is_supported(sample: &PenetratingSample) -> bool {
    sample.normal == Vector3::zeros() || sample.direction.dot(&sample.normal) <= SUPPORTED_COSINE
}

fn first_greatest(values: impl Iterator<Item = f64>) -> Option<(usize, f64)> {
    values.enumerate().reduce(|best, next| if next.1 > best.1 { next } else { best })
}
