//! From bodies to their contacts, in memory that the thread uses again for the next.
//!
//! ```text
//!   body 0, body 1, ..      each in its place; what the hull is asked, it is asked for all of them at once
//!     candidates            samples that may be inside
//!     penetrating           those inside, each with its exit direction
//!     manifolds             those that leave together
//!     kept                  the few that become contacts
//! ```

use super::cluster::{Clusters, is_supported};
use super::manifold::{Manifolds, PendingManifold};
use super::reduce::Reduction;
use super::{
    BodyContacts, BodyResponse, Manifold, ManifoldPoint, Mode, PenetratingSample, SampledBody, Settings,
};
use super::{escape, tilt};
use crate::hull::{EdgeModel, ExitRay, Hull, Scratch, Workspace};
use nalgebra::{Point3, Vector3};
use std::cell::Cell;
use std::ops::Range;

thread_local! {
    static SCRATCH: Cell<Option<Box<ContactPipeline>>> = const { Cell::new(None) };
}

/// The samples of bodies inside the hull, and what becomes of them.
#[derive(Debug, Default)]
pub(super) struct ContactPipeline {
    workspace: Workspace,
    scratch: Scratch,
    /// Body and sample of each point that may be inside.
    candidates: Vec<(usize, usize)>,
    points: Vec<Point3<f64>>,
    /// Those inside: their places among the candidates, and their exit directions.
    inside: Vec<usize>,
    rays: Vec<ExitRay>,
    /// Body by body, in the order of its samples.
    penetrating: Vec<PenetratingSample>,
    bodies: Vec<TouchingBody>,
    exits: ExitScratch,
    clusters: Clusters,
    manifolds: Manifolds,
    reduction: Reduction,
    kept: Vec<usize>,
    /// The manifolds of a body that have points among its contacts.
    written: Vec<usize>,
}

/// A body that touches the hull.
#[derive(Debug, Clone)]
struct TouchingBody {
    /// Its place among all bodies.
    place: usize,
    penetrating: Range<usize>,
    manifolds: Range<usize>,
    kept: Range<usize>,
    escape: Option<Vector3<f64>>,
}

/// Memory for the exits of samples.
#[derive(Debug, Default)]
struct ExitScratch {
    /// The places of the samples that are asked about.
    queried: Vec<usize>,
    rays: Vec<ExitRay>,
    exits: Vec<f64>,
}

impl ContactPipeline {
    /// Runs `ask` on the pipeline that the thread keeps.
    pub(super) fn with_scratch<R>(ask: impl FnOnce(&mut Self) -> R) -> R {
        let mut pipeline = SCRATCH.take().unwrap_or_default();
        let answer = ask(&mut pipeline);
        SCRATCH.set(Some(pipeline));
        answer
    }

    /// Collects the samples of `bodies` that are inside by `edge`, each with its exit direction: that of contacts by the
    /// coverage edge, the paper's by whole pixels. The first `most` at least.
    pub(super) fn collect_penetrating(
        &mut self,
        hull: &Hull,
        bodies: &[SampledBody],
        edge: EdgeModel,
        most: usize,
    ) {
        let Self { candidates, points, inside, rays, penetrating, .. } = self;
        candidates.clear();
        points.clear();
        let clouds = bodies.iter().map(|body| (body.samples.point_cloud(), body.hull_from_body));
        hull.candidates(clouds, &mut self.workspace, |place, found| {
            let SampledBody { samples, hull_from_body, .. } = &bodies[place];
            for index in found.iter() {
                candidates.push((place, index));
                points.push(hull_from_body * samples.points()[index].point);
            }
        });
        hull.exit_rays(points, edge, most, &mut self.scratch, inside, rays);

        // Those of one body follow one another.
        penetrating.clear();
        self.bodies.clear();
        for (&candidate, &ExitRay { point, direction, view }) in inside.iter().zip(rays.iter()) {
            let (place, index) = candidates[candidate];
            let end = penetrating.len();
            if self.bodies.last().is_none_or(|body| body.place != place) {
                let (manifolds, kept) = (0..0, 0..0);
                self.bodies.push(TouchingBody {
                    place,
                    penetrating: end..end,
                    manifolds,
                    kept,
                    escape: None,
                });
            }
            let SampledBody { samples, hull_from_body, .. } = &bodies[place];
            let normal = hull_from_body * samples.points()[index].normal;
            penetrating.push(PenetratingSample { index, point, normal, view, direction, depth: 0.0 });
            if let Some(body) = self.bodies.last_mut() {
                body.penetrating.end += 1;
            }
        }
    }

    /// Puts each body's samples into clusters, to leave along the cluster's V; where none is supported, into one, to
    /// leave along one direction for all.
    ///
    /// A smooth body touches with its support points instead, or else it would roll like the polyhedron of its samples.
    pub(super) fn group_by_clusters(&mut self, hull: &Hull, bodies: &[SampledBody], max_depth: f64) {
        let Self { penetrating, exits, clusters, manifolds, scratch, .. } = self;
        // Of the others only the direction matters.
        exits.find_depths(hull, penetrating, EdgeModel::Coverage, is_supported, scratch);
        manifolds.restart(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let SampledBody { samples, hull_from_body, last_escape } = &bodies[touching.place];
            let penetrating = &mut penetrating[touching.penetrating.clone()];
            clusters.find(penetrating);
            if clusters.is_empty() {
                exits.find_depths(hull, penetrating, EdgeModel::Coverage, |_| true, scratch);
                let direction = escape::escape_direction(hull, penetrating, *last_escape, scratch);
                clusters.put_together(penetrating, &direction);
                touching.escape = Some(direction);
            }

            let start = manifolds.len();
            for (cluster, (direction, view)) in clusters.directions().enumerate() {
                let before = manifolds.len();
                if let Some(smooth) = samples.smooth() {
                    manifolds.add_support(hull, smooth, hull_from_body, &direction, view);
                }
                if manifolds.len() == before {
                    manifolds.add_samples(clusters.members(cluster, penetrating), &direction, view);
                }
            }
            touching.manifolds = start..manifolds.len();
        }
    }

    /// Finds how long the exits of all samples are, to `edge`.
    fn find_all_depths(&mut self, hull: &Hull, edge: EdgeModel) {
        let Self { penetrating, rays, exits, scratch, .. } = self;
        // The rays still lie as the samples do; only the last ones may have been dropped since.
        rays.truncate(penetrating.len());
        hull.exits_within(rays, edge, f64::INFINITY, scratch, &mut exits.exits);
        for (sample, exit) in penetrating.iter_mut().zip(&exits.exits) {
            sample.depth = *exit;
        }
    }

    /// Puts the samples of each body together, to leave along the direction of the paper's V: the mean of their
    /// responses, or the response of the deepest where these cancel out.
    pub(super) fn group_by_mean_response(&mut self, hull: &Hull) {
        self.find_all_depths(hull, EdgeModel::Pixel);
        self.group_along(|penetrating, _| mean_direction(penetrating), |_| true);
    }

    /// Tells `take` the paper's response of each body that touches, by its place: V with the length of the longest exit
    /// of its samples along it.
    pub(super) fn each_response(&mut self, hull: &Hull, mut take: impl FnMut(usize, BodyResponse)) {
        self.manifolds.find_deepest(hull, 0, &mut self.scratch);
        for TouchingBody { place, penetrating, manifolds, .. } in &self.bodies {
            for manifold in self.manifolds.of(manifolds.clone()) {
                let (vector, colliding) = (self.manifolds.vector(manifold), penetrating.len());
                take(*place, BodyResponse { vector, colliding });
            }
        }
    }

    /// Puts the samples of each body together, to leave along the paper's vector. As in every mode contacts begin at the
    /// coverage edge.
    pub(super) fn group_by_paper(&mut self, hull: &Hull) {
        self.group_by_mean_response(hull);
        self.manifolds.find_deepest(hull, 0, &mut self.scratch);
        // Their directions, as the vectors' lengths round them.
        let manifolds = self.manifolds.of(0..self.bodies.len()).iter();
        let vectors: Vec<_> = manifolds.map(|manifold| self.manifolds.vector(manifold)).collect();
        let direction = |penetrating: &[PenetratingSample], body: usize| {
            vectors[body].try_normalize(0.0).unwrap_or_else(|| mean_direction(penetrating))
        };
        self.group_along(direction, |sample| hull.inside_by(&sample.point, EdgeModel::Coverage));
    }

    /// Puts those samples of each body together that are `wanted`, to leave along a direction for each body.
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

    /// Lets each sample leave along its own direction.
    pub(super) fn leave_alone(&mut self, hull: &Hull, max_depth: f64) {
        self.find_all_depths(hull, EdgeModel::Coverage);
        let Self { penetrating, manifolds, .. } = self;
        manifolds.restart(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let start = manifolds.len();
            manifolds.add_alone(penetrating[touching.penetrating.clone()].iter());
            touching.manifolds = start..manifolds.len();
        }
    }

    /// Lets the first samples leave along their own directions, as many as `settings` want contacts.
    #[cfg(feature = "ode")]
    pub(super) fn leave_first_alone(&mut self, hull: &Hull, settings: &Settings) {
        self.penetrating.truncate(settings.max_contacts);
        for body in &mut self.bodies {
            body.penetrating.end = body.penetrating.end.min(settings.max_contacts);
        }
        self.leave_alone(hull, settings.max_depth);
    }

    /// Keeps of each body the deepest sample alone, the first among equals.
    pub(super) fn leave_deepest_alone(&mut self, hull: &Hull, max_depth: f64) {
        self.find_all_depths(hull, EdgeModel::Coverage);
        let Self { penetrating, manifolds, .. } = self;
        manifolds.restart(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let start = manifolds.len();
            manifolds.add_alone(deepest(&penetrating[touching.penetrating.clone()]).into_iter());
            touching.manifolds = start..manifolds.len();
        }
    }

    /// Keeps a few points of each body's manifolds, and writes them to `contacts`.
    pub(super) fn reduce_to_contacts(
        &mut self,
        hull: &Hull,
        settings: &Settings,
        contacts: &mut [BodyContacts],
    ) {
        let Self { manifolds, reduction, kept, written, scratch, .. } = self;
        manifolds.find_deepest(hull, settings.max_contacts, scratch);
        manifolds.find_first_deep(hull, scratch);
        kept.clear();
        for touching in &mut self.bodies {
            let start = kept.len();
            reduction.farthest_point_sampling(
                manifolds,
                touching.manifolds.clone(),
                settings.max_contacts,
                kept,
            );
            touching.kept = start..kept.len();
        }
        manifolds.find_depths_of(hull, kept, scratch);

        for TouchingBody { place, manifolds: of_body, kept: places, escape, .. } in &self.bodies {
            let contacts = &mut contacts[*place];
            contacts.escape = *escape;
            write_contacts(manifolds, of_body.clone(), &kept[places.clone()], written, contacts);
            if settings.mode == Mode::Clustered && escape.is_none() {
                tilt::drop_transient_points(&mut contacts.points);
            }
        }
    }
}

/// Adds the points at `places` of a body's manifolds to `contacts`, and these manifolds in the order in which their
/// first points were kept; `written` is memory.
fn write_contacts(
    manifolds: &Manifolds,
    of_body: Range<usize>,
    places: &[usize],
    written: &mut Vec<usize>,
    contacts: &mut BodyContacts,
) {
    let of_body = manifolds.of(of_body);
    written.clear();
    for &place in places {
        let pending = of_body.partition_point(|manifold| manifold.points.end <= place);
        let PendingManifold { view, shares_direction, .. } = of_body[pending];
        let ExitRay { point, direction, view: own_view } = *manifolds.ray(place);
        let known = written.iter().position(|&other| shares_direction && other == pending);
        let manifold = known.unwrap_or_else(|| {
            let view = if shares_direction { view } else { Some(own_view) };
            contacts.manifolds.push(Manifold { direction, view });
            written.push(pending);
            written.len() - 1
        });
        let (depth, sample) = (manifolds.depth(place), manifolds.sample(place));
        contacts.points.push(ManifoldPoint { point, depth, sample, manifold });
    }
}

/// The direction of the mean of the samples' responses; that of the deepest where they cancel out.
fn mean_direction(penetrating: &[PenetratingSample]) -> Vector3<f64> {
    let sum: Vector3<f64> = penetrating.iter().map(|sample| sample.direction * sample.depth).sum();
    let of_deepest = || deepest(penetrating).map_or_else(Vector3::z, |sample| sample.direction);
    sum.try_normalize(0.0).unwrap_or_else(of_deepest)
}

/// The deepest sample, the first among equals.
fn deepest(penetrating: &[PenetratingSample]) -> Option<&PenetratingSample> {
    penetrating.iter().rev().max_by(|a, b| a.depth.total_cmp(&b.depth))
}

impl ExitScratch {
    /// Finds how long the exits of the samples `wanted` are, to `edge`.
    fn find_depths(
        &mut self,
        hull: &Hull,
        samples: &mut [PenetratingSample],
        edge: EdgeModel,
        wanted: impl Fn(&PenetratingSample) -> bool,
        scratch: &mut Scratch,
    ) {
        let Self { queried: asked, rays, exits } = self;
        asked.clear();
        rays.clear();
        for (place, sample) in samples.iter().enumerate() {
            if wanted(sample) {
                asked.push(place);
                rays.push(sample.ray());
            }
        }
        hull.exits_within(rays, edge, f64::INFINITY, scratch, exits);
        for (&place, exit) in asked.iter().zip(exits) {
            samples[place].depth = *exit;
        }
    }
}
