//! Clusters of penetrating samples with similar exit directions, found with the help of the body's own normals.
//!
//! A box that is deep in a table has samples on its lower rim whose nearest exit is sideways. The box's normals show
//! that these samples belong to its underside: a sample is *supported* when its exit direction runs against the body's
//! outward normal, and only supported samples start clusters. What else leaves the hull with them is no deeper than they
//! are: of a body that is deep in the edge of a table, the part beside the table's side has no long way up.

use super::PenetratingSample;
use super::tuning::{DIRECTION_WEIGHT, JOIN_COSINE, SUPPORTED_COSINE};
use nalgebra::{Point3, Vector3};

/// The clusters of one body's penetrating samples. Samples are named by their indices among these.
#[derive(Debug, Default)]
pub(super) struct Clusters {
    clusters: Vec<Cluster>,
    /// The cluster of each sample; `None` if the sample fits none.
    of_sample: Vec<Option<usize>>,
    /// The supported samples, the deepest first.
    supported: Vec<usize>,
}

/// Samples that leave the hull in one direction.
#[derive(Debug)]
struct Cluster {
    /// Sum of the members' exit vectors, in metres.
    sum: Vector3<f64>,
    /// Unit direction of V, the mean of the members' exit vectors.
    direction: Vector3<f64>,
    /// Index of the view that gave the direction of the deepest sample; `None` if no sample gave the direction.
    view: Option<usize>,
    /// The least position along the direction, in metres, of a point that leaves with the cluster.
    lowest: f64,
}

impl Clusters {
    /// Finds the clusters of the supported samples, the one with the deepest sample first, and adds the unsupported
    /// samples that fit. There are no clusters if no sample is supported. The depths of unsupported samples are not
    /// used.
    ///
    /// No point of the body's surface is farther than `covering_radius` metres from a sample of the body.
    pub(super) fn find(&mut self, penetrating: &[PenetratingSample], covering_radius: f64) {
        self.clusters.clear();
        self.supported.clear();
        for (index, sample) in penetrating.iter().enumerate() {
            if is_supported(sample) {
                self.supported.push(index);
            }
        }
        let depth = |index: usize| penetrating[index].depth;
        self.supported.sort_unstable_by(|&a, &b| depth(b).total_cmp(&depth(a)).then(a.cmp(&b)));

        // In order of depth, so that the deepest sample starts the first cluster.
        self.of_sample.clear();
        self.of_sample.resize(penetrating.len(), None);
        for &index in &self.supported {
            self.of_sample[index] = Some(join_or_create(&mut self.clusters, &penetrating[index]));
        }

        for &index in &self.supported {
            let cluster = self.of_sample[index].map(|cluster| &mut self.clusters[cluster]);
            if let Some(Cluster { direction, lowest, .. }) = cluster {
                *lowest = lowest.min(penetrating[index].point.coords.dot(direction) - covering_radius);
            }
        }

        for (sample, cluster) in penetrating.iter().zip(&mut self.of_sample) {
            if cluster.is_none() {
                *cluster = best_cluster_for(&self.clusters, sample);
            }
        }
    }

    /// Puts all samples into one cluster that leaves along `direction`.
    pub(super) fn merge_into_one(&mut self, penetrating: &[PenetratingSample], direction: &Vector3<f64>) {
        self.clusters.clear();
        let lowest = f64::NEG_INFINITY;
        self.clusters.push(Cluster { sum: *direction, direction: direction.normalize(), view: None, lowest });
        self.of_sample.clear();
        self.of_sample.resize(penetrating.len(), Some(0));
    }

    /// Whether there are no clusters.
    pub(super) fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// The direction of each cluster, and the view that gave the direction of its deepest sample.
    pub(super) fn directions(&self) -> impl Iterator<Item = (Vector3<f64>, Option<usize>)> {
        self.clusters.iter().map(|cluster| (cluster.direction, cluster.view))
    }

    /// Whether a point of the body's surface may leave with a cluster: it is no deeper than the supported samples.
    pub(super) fn may_hold(&self, cluster: usize, point: &Point3<f64>) -> bool {
        self.clusters[cluster].may_hold(point)
    }

    /// The samples of a cluster, in their order in `penetrating`.
    pub(super) fn members<'a>(
        &'a self,
        cluster: usize,
        penetrating: &'a [PenetratingSample],
    ) -> impl Iterator<Item = &'a PenetratingSample> {
        let of_sample = penetrating.iter().zip(&self.of_sample);
        of_sample.filter(move |(_, of)| **of == Some(cluster)).map(|(sample, _)| sample)
    }
}

impl Cluster {
    /// See [`Clusters::may_hold`].
    fn may_hold(&self, point: &Point3<f64>) -> bool {
        point.coords.dot(&self.direction) >= self.lowest
    }
}

/// Adds a supported sample to the cluster with the nearest direction, or to a new one if none is near enough. Returns
/// the cluster's index.
fn join_or_create(clusters: &mut Vec<Cluster>, sample: &PenetratingSample) -> usize {
    let direction = &sample.direction;
    let cosines = clusters.iter().map(|cluster| cluster.direction.dot(direction));
    let nearest = first_greatest(cosines).filter(|(_, cosine)| *cosine >= JOIN_COSINE);

    let index = nearest.map_or(clusters.len(), |(nearest, _)| nearest);
    if index == clusters.len() {
        let (sum, direction) = (Vector3::zeros(), Vector3::zeros());
        clusters.push(Cluster { sum, direction, view: Some(sample.view), lowest: f64::INFINITY });
    }

    let cluster = &mut clusters[index];
    cluster.sum += direction * (sample.depth + DIRECTION_WEIGHT);
    cluster.direction = cluster.sum.normalize();
    index
}

/// The cluster that may hold an unsupported sample and whose direction runs most against the body's normal there, if the
/// sample would be supported in that direction.
fn best_cluster_for(clusters: &[Cluster], sample: &PenetratingSample) -> Option<usize> {
    let against = clusters.iter().map(|cluster| {
        let may_hold = cluster.may_hold(&sample.point);
        if may_hold { -cluster.direction.dot(&sample.normal) } else { f64::NEG_INFINITY }
    });
    first_greatest(against).filter(|(_, against)| -against <= SUPPORTED_COSINE).map(|(best, _)| best)
}

/// Whether a sample's exit direction runs against the body's normal, or the normal is not known.
pub(super) fn is_supported(sample: &PenetratingSample) -> bool {
    sample.normal == Vector3::zeros() || sample.direction.dot(&sample.normal) <= SUPPORTED_COSINE
}

/// Index and value of the greatest of `values`, the first among equals.
fn first_greatest(values: impl Iterator<Item = f64>) -> Option<(usize, f64)> {
    values.enumerate().reduce(|best, next| if next.1 > best.1 { next } else { best })
}
