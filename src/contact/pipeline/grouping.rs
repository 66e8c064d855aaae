//! The ways to group penetrating samples into manifolds, one for each mode of contacts.

use super::{ContactPipeline, TouchingBody};
use crate::contact::cluster::is_supported;
use crate::contact::{BodyResponse, PenetratingSample, SampledBody, escape};
use crate::hull::{EdgeModel, Hull};
use nalgebra::{Point3, Vector3};

#[cfg(feature = "ode")]
use crate::contact::Settings;

impl ContactPipeline {
    /// Groups each body's samples into clusters; each cluster becomes a manifold in the direction of its V. A body
    /// without a supported sample gets one escape direction for all of its samples.
    ///
    /// The manifolds of a smooth body hold its analytic support points instead of samples: on samples alone it would
    /// roll like a polyhedron. Where those of a ball or capsule in a cluster's direction are outside, it is on an
    /// edge of the hull, and the manifold's direction is against the mean normal of the cluster's samples: in
    /// another one, which does not pass through a ball's centre, an impact would turn the ball and give it energy.
    pub(in crate::contact) fn group_by_clusters(
        &mut self,
        hull: &Hull,
        bodies: &[SampledBody],
        max_depth: f64,
    ) {
        let Self { penetrating, exits, clusters, manifolds, scratch, .. } = self;

        // Unsupported samples enter the clusters by their directions alone, so their depths are not needed yet.
        exits.find_depths(hull, penetrating, EdgeModel::Coverage, is_supported, scratch);

        manifolds.restart(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let SampledBody { samples, hull_from_body, last_escape } = &bodies[touching.index];
            let penetrating = &mut penetrating[touching.penetrating.clone()];
            clusters.find(penetrating, samples.covering_radius());

            // No cluster: the body is swallowed or pierced.
            if clusters.is_empty() {
                exits.find_depths(hull, penetrating, EdgeModel::Coverage, |_| true, scratch);
                let direction = escape::escape_direction(hull, penetrating, *last_escape, scratch);
                clusters.merge_into_one(penetrating, &direction);
                touching.escape = Some(direction);
            }

            let start = manifolds.len();
            for (cluster, (direction, view)) in clusters.directions().enumerate() {
                let before = manifolds.len();
                if let Some(smooth) = samples.smooth() {
                    let belongs = |point: &Point3<f64>| clusters.may_hold(cluster, point);
                    manifolds.add_support(hull, smooth, hull_from_body, &direction, view, belongs);
                    // An edge of the hull is met beside the points that face its surfaces, and along the body's
                    // own normal.
                    let is_on_edge = manifolds.len() == before && touching.escape.is_none();
                    if is_on_edge && smooth.is_without_rim() {
                        let normals = clusters.members(cluster, penetrating).map(|sample| sample.normal);
                        if let Some(into_body) = (-normals.sum::<Vector3<f64>>()).try_normalize(1e-9) {
                            manifolds.add_support(hull, smooth, hull_from_body, &into_body, view, belongs);
                        }
                    }
                }

                // The support points of a smooth body may all be outside.
                if manifolds.len() == before {
                    manifolds.add_samples(clusters.members(cluster, penetrating), &direction, view);
                }
            }
            touching.manifolds = start..manifolds.len();
        }
    }

    /// Computes the depths of all samples along their own exit directions, to `edge`.
    fn find_all_depths(&mut self, hull: &Hull, edge: EdgeModel) {
        let Self { penetrating, rays, exits, scratch, .. } = self;

        // Rays and samples have the same order; only samples at the end may have been dropped since.
        rays.truncate(penetrating.len());
        hull.exits_within(rays, edge, f64::INFINITY, scratch, &mut exits.exits);
        for (sample, exit) in penetrating.iter_mut().zip(&exits.exits) {
            sample.depth = *exit;
        }
    }

    /// Makes one manifold of each body's samples, in the direction of the paper's V: the mean of the samples'
    /// responses, or the response of the deepest sample where the responses cancel out.
    pub(in crate::contact) fn group_by_mean_response(&mut self, hull: &Hull) {
        self.find_all_depths(hull, EdgeModel::Pixel);
        self.group_along(|penetrating, _| mean_direction(penetrating), |_| true);
    }

    /// Calls `visit` with the index of each body that touches and the paper's response: V with the length of the
    /// longest exit of the body's samples along it.
    pub(in crate::contact) fn each_response(
        &mut self,
        hull: &Hull,
        mut visit: impl FnMut(usize, BodyResponse),
    ) {
        self.manifolds.find_deepest(hull, 0, &mut self.scratch);
        for TouchingBody { index, penetrating, manifolds, .. } in &self.bodies {
            for manifold in self.manifolds.of(manifolds.clone()) {
                let (vector, colliding) = (self.manifolds.vector(manifold), penetrating.len());
                visit(*index, BodyResponse { vector, colliding });
            }
        }
    }

    /// Makes one manifold of each body's samples, in the direction of the paper's response. The samples are those
    /// inside by the coverage edge, at which contacts begin in every mode.
    pub(in crate::contact) fn group_by_paper(&mut self, hull: &Hull) {
        self.group_by_mean_response(hull);
        self.manifolds.find_deepest(hull, 0, &mut self.scratch);

        // Contacts take the direction of the response vector itself, rounded as its length rounds it.
        let manifolds = self.manifolds.of(0..self.bodies.len()).iter();
        let vectors: Vec<_> = manifolds.map(|manifold| self.manifolds.vector(manifold)).collect();
        let direction = |penetrating: &[PenetratingSample], body: usize| {
            vectors[body].try_normalize(0.0).unwrap_or_else(|| mean_direction(penetrating))
        };
        self.group_along(direction, |sample| hull.inside_by(&sample.point, EdgeModel::Coverage));
    }

    /// Makes one manifold of the `wanted` samples of each body, in the `direction` of that body's samples and of its
    /// index among the bodies that touch.
    fn group_along(
        &mut self,
        direction: impl Fn(&[PenetratingSample], usize) -> Vector3<f64>,
        wanted: impl Fn(&PenetratingSample) -> bool,
    ) {
        self.manifolds.restart(EdgeModel::Pixel, f64::INFINITY);
        for (body, touching) in self.bodies.iter_mut().enumerate() {
            let penetrating = &self.penetrating[touching.penetrating.clone()];
            let (direction, start) = (direction(penetrating, body), self.manifolds.len());
            self.manifolds.add_samples(penetrating.iter().filter(|sample| wanted(sample)), &direction, None);
            touching.manifolds = start..self.manifolds.len();
        }
    }

    /// Makes a manifold of each sample, in the sample's own exit direction.
    pub(in crate::contact) fn group_per_sample(&mut self, hull: &Hull, max_depth: f64) {
        self.find_all_depths(hull, EdgeModel::Coverage);
        let Self { penetrating, manifolds, .. } = self;
        manifolds.restart(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let start = manifolds.len();
            manifolds.add_separate(penetrating[touching.penetrating.clone()].iter());
            touching.manifolds = start..manifolds.len();
        }
    }

    /// Makes a manifold of each of the first `settings.max_contacts` samples, in the sample's own exit direction.
    #[cfg(feature = "ode")]
    pub(in crate::contact) fn group_first_samples(&mut self, hull: &Hull, settings: &Settings) {
        self.penetrating.truncate(settings.max_contacts);
        for body in &mut self.bodies {
            body.penetrating.end = body.penetrating.end.min(settings.max_contacts);
        }
        self.group_per_sample(hull, settings.max_depth);
    }

    /// Makes a manifold of each body's deepest sample alone, the first among equals.
    pub(in crate::contact) fn group_deepest_sample(&mut self, hull: &Hull, max_depth: f64) {
        self.find_all_depths(hull, EdgeModel::Coverage);
        let Self { penetrating, manifolds, .. } = self;
        manifolds.restart(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let start = manifolds.len();
            manifolds.add_separate(deepest(&penetrating[touching.penetrating.clone()]).into_iter());
            touching.manifolds = start..manifolds.len();
        }
    }
}

/// The direction of the mean of the samples' responses, or the deepest sample's direction where the responses cancel
/// out.
fn mean_direction(penetrating: &[PenetratingSample]) -> Vector3<f64> {
    let sum: Vector3<f64> = penetrating.iter().map(|sample| sample.direction * sample.depth).sum();
    let of_deepest = || deepest(penetrating).map_or_else(Vector3::z, |sample| sample.direction);
    sum.try_normalize(0.0).unwrap_or_else(of_deepest)
}

/// The deepest sample, the first among equals.
fn deepest(penetrating: &[PenetratingSample]) -> Option<&PenetratingSample> {
    penetrating.iter().rev().max_by(|a, b| a.depth.total_cmp(&b.depth))
}
