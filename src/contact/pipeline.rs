//! The stages from bodies to their contacts, in scratch memory that each thread reuses.
//!
//! ```text
//!   body 0, body 1, ..      each stage runs over all bodies, so that queries of the hull are batched
//!     candidates            samples that may be inside
//!     penetrating           samples inside, each with its exit direction
//!     manifolds             groups of samples that share an exit direction
//!     kept                  the few points that become contacts
//! ```

mod grouping;

use super::cluster::Clusters;
use super::manifold::{Manifolds, PendingManifold};
use super::reduce::Reduction;
use super::{BodyContacts, Manifold, ManifoldPoint, Mode, PenetratingSample, SampledBody, Settings, tilt};
use crate::hull::{EdgeModel, ExitRay, Hull, Scratch, Workspace};
use crate::recycle::{keep_scratch, take_scratch};
use nalgebra::{Point3, Vector3};
use std::cell::Cell;
use std::ops::Range;

thread_local! {
    /// Memory that this thread's batches reuse, one at a time.
    static SCRATCH: Cell<Option<Box<ContactPipeline>>> = const { Cell::new(None) };
}

/// The intermediate results of all stages for a list of bodies.
#[derive(Debug, Default)]
pub(super) struct ContactPipeline {
    workspace: Workspace,
    scratch: Scratch,
    /// Body index and sample index of each point that may be inside.
    candidates: Vec<(usize, usize)>,
    /// The candidates' points, in the hull's frame.
    points: Vec<Point3<f64>>,
    /// Indices of the candidates that are inside.
    inside: Vec<usize>,
    /// The exit ray of each candidate that is inside.
    rays: Vec<ExitRay>,
    /// The samples inside, ordered by body and then by sample.
    penetrating: Vec<PenetratingSample>,
    bodies: Vec<TouchingBody>,
    exits: ExitScratch,
    clusters: Clusters,
    manifolds: Manifolds,
    reduction: Reduction,
    /// Indices of the points that become contacts, in the order in which they were chosen.
    kept: Vec<usize>,
    /// Indices of a body's pending manifolds that have been written to its contacts.
    written: Vec<usize>,
}

/// A body that touches the hull, and its ranges in the tables of [`ContactPipeline`].
#[derive(Debug, Clone)]
struct TouchingBody {
    /// Index in the list of bodies.
    index: usize,
    penetrating: Range<usize>,
    manifolds: Range<usize>,
    kept: Range<usize>,
    escape: Option<Vector3<f64>>,
}

/// Memory for computing the exit distances of samples.
#[derive(Debug, Default)]
struct ExitScratch {
    /// Indices of the samples whose depths are computed.
    queried: Vec<usize>,
    rays: Vec<ExitRay>,
    exits: Vec<f64>,
}

impl ContactPipeline {
    /// Runs `work` on the pipeline that belongs to the thread.
    pub(super) fn with_scratch<R>(work: impl FnOnce(&mut Self) -> R) -> R {
        let mut pipeline = take_scratch(&SCRATCH);
        let result = work(&mut pipeline);
        keep_scratch(&SCRATCH, pipeline);
        result
    }

    /// Collects the samples of `bodies` that are inside by `edge`, each with its exit direction: the normal of contacts
    /// for coverage edges, the paper's normal for pixel edges. It may stop once it has found `max_count`.
    pub(super) fn collect_penetrating(
        &mut self,
        hull: &Hull,
        bodies: &[SampledBody],
        edge: EdgeModel,
        max_count: usize,
    ) {
        self.collect_candidates(hull, bodies);
        hull.exit_rays(&self.points, edge, max_count, &mut self.scratch, &mut self.inside, &mut self.rays);

        // Candidates are ordered by body, so the samples of one body are adjacent.
        self.penetrating.clear();
        self.bodies.clear();
        for (&candidate, &ExitRay { point, direction, view, overrules }) in self.inside.iter().zip(&self.rays)
        {
            let (body, index) = self.candidates[candidate];
            let end = self.penetrating.len();
            if self.bodies.last().is_none_or(|last| last.index != body) {
                let (manifolds, kept) = (0..0, 0..0);
                self.bodies.push(TouchingBody {
                    index: body,
                    penetrating: end..end,
                    manifolds,
                    kept,
                    escape: None,
                });
            }

            let SampledBody { samples, hull_from_body, .. } = &bodies[body];
            let normal = hull_from_body * samples.points()[index].normal;
            self.penetrating.push(PenetratingSample {
                index,
                point,
                normal,
                view,
                direction,
                depth: 0.0,
                overrules,
            });
            if let Some(body) = self.bodies.last_mut() {
                body.penetrating.end += 1;
            }
        }
    }

    /// Collects the samples of `bodies` that may be inside by any edge model.
    fn collect_candidates(&mut self, hull: &Hull, bodies: &[SampledBody]) {
        let Self { candidates, points, workspace, .. } = self;
        candidates.clear();
        points.clear();
        let clouds = bodies.iter().map(|body| (body.samples.point_cloud(), body.hull_from_body));
        hull.candidates(clouds, workspace, |body, found| {
            let SampledBody { samples, hull_from_body, .. } = &bodies[body];
            for index in found.iter() {
                candidates.push((body, index));
                points.push(hull_from_body * samples.points()[index].point);
            }
        });
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

        // Of the remaining points only these need their depths.
        manifolds.find_depths_of(hull, kept, scratch);

        for touching in &self.bodies {
            let contacts = &mut contacts[touching.index];
            contacts.escape = touching.escape;
            let points = &kept[touching.kept.clone()];
            write_contacts(manifolds, touching.manifolds.clone(), points, written, contacts);
            if settings.mode == Mode::Clustered && touching.escape.is_none() {
                tilt::drop_transient_points(&mut contacts.points);
            }
        }
    }
}

/// Writes `points` of the manifolds `of_body` to `contacts`, and these manifolds in the order in which their first
/// points were kept. `written` is scratch memory.
fn write_contacts(
    manifolds: &Manifolds,
    of_body: Range<usize>,
    points: &[usize],
    written: &mut Vec<usize>,
    contacts: &mut BodyContacts,
) {
    let of_body = manifolds.of(of_body);
    written.clear();
    for &point_index in points {
        let pending = of_body.partition_point(|manifold| manifold.points.end <= point_index);
        let PendingManifold { view, shares_direction, .. } = of_body[pending];
        let ExitRay { point, direction, view: own_view, .. } = *manifolds.ray(point_index);

        // A point with a direction of its own always begins a new manifold.
        let known = written.iter().position(|&other| shares_direction && other == pending);
        let manifold = known.unwrap_or_else(|| {
            let view = if shares_direction { view } else { Some(own_view) };
            contacts.manifolds.push(Manifold { direction, view });
            written.push(pending);
            written.len() - 1
        });

        let (depth, sample) = (manifolds.depth(point_index), manifolds.sample(point_index));
        contacts.points.push(ManifoldPoint { point, depth, sample, manifold });
    }
}

impl ExitScratch {
    /// Computes the depths of the `wanted` samples along their own exit directions, to `edge`.
    fn find_depths(
        &mut self,
        hull: &Hull,
        samples: &mut [PenetratingSample],
        edge: EdgeModel,
        wanted: impl Fn(&PenetratingSample) -> bool,
        scratch: &mut Scratch,
    ) {
        let Self { queried, rays, exits } = self;
        queried.clear();
        rays.clear();
        for (index, sample) in samples.iter().enumerate() {
            if wanted(sample) {
                queried.push(index);
                rays.push(sample.ray());
            }
        }

        hull.exits_within(rays, edge, f64::INFINITY, scratch, exits);
        for (&index, exit) in queried.iter().zip(exits) {
            samples[index].depth = *exit;
        }
    }
}
