//! Groups of points that are pushed out of the hull in one direction, whose depths are computed only as far as needed.
//!
//! A manifold may have a hundred points, and only a few of them are kept. For the others it only matters whether they
//! are among the deepest. One look-up at the depth of the deepest point along a ray mostly proves that the ray has left
//! the hull by then, so that its exit need not be found. Queries are batched over the manifolds of all bodies.

use super::PenetratingSample;
use super::tuning::DEEPEST_FRACTION;
use crate::hull::{EdgeModel, ExitRay, Hull, Scratch};
use crate::sample::Smooth;
use nalgebra::{Isometry3, Point3, Vector3};
use std::ops::Range;

/// The manifolds of many bodies, and their points in one list. Points are named by their indices in that list.
#[derive(Debug)]
pub(super) struct Manifolds {
    /// The edge model of depths.
    edge: EdgeModel,
    /// Largest depth, in metres.
    max_depth: f64,
    manifolds: Vec<PendingManifold>,
    /// The ray along which each point leaves the hull.
    rays: Vec<ExitRay>,
    /// The index of each point among its body's samples; `None` for a support point.
    samples: Vec<Option<usize>>,
    /// The depth of each point in metres; `None` until it is computed.
    depths: Vec<Option<f64>>,
    /// The points whose depths [`Self::find_depths`] computes next.
    queried: Vec<usize>,
    /// The rays of a query of the hull, of points whose depths are not known.
    unknown: Vec<ExitRay>,
    exits: Vec<f64>,
    /// The points with the rays `unknown`, in a query for those that may be deepest.
    unknown_points: Vec<usize>,
    /// The deepest known depth in the manifold of each of `unknown_points`.
    deepest: Vec<f64>,
    /// Indices into `unknown_points` of those that may be deeper than that.
    kept: Vec<usize>,
}

/// A manifold before its points are reduced.
#[derive(Debug, Clone)]
pub(super) struct PendingManifold {
    /// Its points.
    pub(super) points: Range<usize>,
    /// Index of the view whose edge gave the direction of the deepest sample; `None` if no sample gave the direction.
    pub(super) view: Option<usize>,
    /// Whether all points leave in one direction. Otherwise each point becomes a manifold of its own.
    pub(super) shares_direction: bool,
    /// The point that is likely to be the deepest.
    deepest_guess: usize,
    /// Depth of the deepest point in metres, at most `max_depth`.
    pub(super) deepest: f64,
    /// The first point that counts as deepest.
    pub(super) first: usize,
}

impl Default for Manifolds {
    fn default() -> Self {
        Self {
            edge: EdgeModel::Coverage,
            max_depth: f64::INFINITY,
            manifolds: Vec::new(),
            rays: Vec::new(),
            samples: Vec::new(),
            depths: Vec::new(),
            queried: Vec::new(),
            unknown: Vec::new(),
            exits: Vec::new(),
            unknown_points: Vec::new(),
            deepest: Vec::new(),
            kept: Vec::new(),
        }
    }
}

impl Manifolds {
    /// Removes all manifolds. The depths of the next ones are measured to `edge`, and are at most `max_depth`.
    pub(super) fn restart(&mut self, edge: EdgeModel, max_depth: f64) {
        (self.edge, self.max_depth) = (edge, max_depth);
        self.manifolds.clear();
        self.rays.clear();
        self.samples.clear();
        self.depths.clear();
    }

    /// Number of manifolds.
    pub(super) fn len(&self) -> usize {
        self.manifolds.len()
    }

    /// A range of the manifolds, such as those of one body.
    pub(super) fn of(&self, manifolds: Range<usize>) -> &[PendingManifold] {
        &self.manifolds[manifolds]
    }

    /// The ray along which a point leaves the hull.
    pub(super) fn ray(&self, point: usize) -> &ExitRay {
        &self.rays[point]
    }

    /// The vector that moves all points of a manifold out of the hull, in metres.
    pub(super) fn vector(&self, manifold: &PendingManifold) -> Vector3<f64> {
        self.rays[manifold.first].direction * manifold.deepest
    }

    /// The index of a point among its body's samples; `None` for a support point.
    pub(super) fn sample(&self, point: usize) -> Option<usize> {
        self.samples[point]
    }

    /// The depth of a point in metres; zero if it was never computed.
    pub(super) fn depth(&self, point: usize) -> f64 {
        self.depths[point].unwrap_or(0.0)
    }

    /// Adds a point to the manifold that is finished next; `depth` is `None` where it is not known yet.
    fn push(&mut self, ray: ExitRay, sample: Option<usize>, depth: Option<f64>) {
        self.rays.push(ray);
        self.samples.push(sample);
        self.depths.push(depth);
    }

    /// Makes a manifold of the points added since the last one, if there are any. `deepest_guess` counts from the first
    /// of them.
    fn finish_manifold(&mut self, view: Option<usize>, shares_direction: bool, deepest_guess: usize) {
        let start = self.manifolds.last().map_or(0, |manifold| manifold.points.end);
        if start < self.rays.len() {
            self.manifolds.push(PendingManifold {
                points: start..self.rays.len(),
                view,
                shares_direction,
                deepest_guess: start + deepest_guess,
                deepest: 0.0,
                first: start,
            });
        }
    }

    /// Adds samples whose directions and depths are their own.
    pub(super) fn add_separate<'a>(&mut self, samples: impl Iterator<Item = &'a PenetratingSample>) {
        for sample in samples {
            self.push(sample.ray(), Some(sample.index), Some(sample.depth.min(self.max_depth)));
        }
        self.finish_manifold(None, false, 0);
    }

    /// Makes a manifold of samples that leave along `direction`, which comes from an edge in `view`.
    pub(super) fn add_samples<'a>(
        &mut self,
        samples: impl Iterator<Item = &'a PenetratingSample>,
        direction: &Vector3<f64>,
        view: Option<usize>,
    ) {
        // The sample that lies farthest against the direction is likely to be the deepest.
        let (mut least, mut deepest_guess) = (f64::INFINITY, 0);
        for (k, sample) in samples.enumerate() {
            let position = sample.point.coords.dot(direction);
            if position < least {
                (least, deepest_guess) = (position, k);
            }
            self.push(ExitRay { direction: *direction, ..sample.ray() }, Some(sample.index), None);
        }
        self.finish_manifold(view, true, deepest_guess);
    }

    /// Makes a manifold of a smooth body's support points in the opposite of `direction`, as far as they are inside and
    /// belong to it.
    pub(super) fn add_support(
        &mut self,
        hull: &Hull,
        smooth: &Smooth,
        hull_from_body: &Isometry3<f64>,
        direction: &Vector3<f64>,
        view: Option<usize>,
        belongs: impl Fn(&Point3<f64>) -> bool,
    ) {
        let support = smooth.support(&hull_from_body.inverse_transform_vector(&-direction));
        for sample in support.iter() {
            let point = hull_from_body * sample.point;
            if belongs(&point) && hull.inside_by(&point, self.edge) {
                let (direction, view, overrules) = (*direction, view.unwrap_or(0), hull.overrules_at(&point));
                self.push(ExitRay { point, direction, view, overrules }, None, None);
            }
        }
        self.finish_manifold(view, true, 0);
    }

    /// Finds the depth of the deepest point of each manifold, of which at most `max_kept` points will be kept.
    pub(super) fn find_deepest(&mut self, hull: &Hull, max_kept: usize, scratch: &mut Scratch) {
        // Where all points will be kept their depths are all needed. Else start with the most likely one.
        for PendingManifold { points, deepest_guess, .. } in &self.manifolds {
            if points.len() <= max_kept {
                self.queried.extend(points.clone());
            } else {
                self.queried.push(*deepest_guess);
            }
        }
        self.find_depths(hull, scratch);

        // The view that gave one point's exit is likely to give the exits of all points with its direction.
        for PendingManifold { points, deepest_guess, shares_direction, .. } in &self.manifolds {
            if *shares_direction {
                let view = self.rays[*deepest_guess].view;
                self.rays[points.clone()].iter_mut().for_each(|ray| ray.view = view);
            }
        }

        self.queue_unless_shallower(hull, scratch);
        self.find_depths(hull, scratch);

        for manifold in &mut self.manifolds {
            let known = self.depths[manifold.points.clone()].iter().flatten();
            manifold.deepest = known.copied().fold(0.0, f64::max);
        }
    }

    /// Queues the points that are not provably shallower than the deepest known one of their manifold.
    fn queue_unless_shallower(&mut self, hull: &Hull, scratch: &mut Scratch) {
        let Self { manifolds, rays, depths, unknown, unknown_points, deepest, kept, .. } = self;

        // Every point of unknown depth, unless the deepest one has reached the limit already.
        unknown_points.clear();
        unknown.clear();
        deepest.clear();
        for PendingManifold { points, deepest_guess, .. } in manifolds.iter() {
            let known = depths[*deepest_guess].unwrap_or(0.0);
            for point in points.clone().filter(|&point| known < self.max_depth && depths[point].is_none()) {
                unknown_points.push(point);
                unknown.push(rays[point]);
                deepest.push(known);
            }
        }

        kept.clear();
        hull.keep_unless_proven(unknown, deepest, self.edge, scratch, kept);
        self.queried.extend(kept.iter().map(|&k| unknown_points[k]));
    }

    /// Finds the first point of each manifold that counts as deepest.
    pub(super) fn find_first_deep(&mut self, hull: &Hull, scratch: &mut Scratch) {
        while self.queue_first_deep(hull) {
            self.find_depths(hull, scratch);
        }
    }

    /// Advances `first` of each manifold to the first point that counts as deepest, or that may. Queues the points
    /// whose exact depths decide it, and returns whether there are any.
    fn queue_first_deep(&mut self, hull: &Hull) -> bool {
        for manifold in &mut self.manifolds {
            while manifold.first + 1 < manifold.points.end {
                let (point, deep_enough) = (manifold.first, DEEPEST_FRACTION * manifold.deepest);
                match self.depths[point] {
                    Some(depth) if depth >= deep_enough => break,
                    None if !hull.provably_exits_before(&self.rays[point], self.edge, deep_enough) => {
                        self.queried.push(point);
                        break;
                    }
                    _ => manifold.first += 1,
                }
            }
        }
        !self.queried.is_empty()
    }

    /// Computes the depths of `points`.
    pub(super) fn find_depths_of(&mut self, hull: &Hull, points: &[usize], scratch: &mut Scratch) {
        self.queried.extend_from_slice(points);
        self.find_depths(hull, scratch);
    }

    /// Computes the depths of the queued points that are not known yet, and empties the queue.
    fn find_depths(&mut self, hull: &Hull, scratch: &mut Scratch) {
        let Self { queried, depths, rays, unknown, exits, .. } = self;
        queried.retain(|&point| depths[point].is_none());
        unknown.clear();
        unknown.extend(queried.iter().map(|&point| rays[point]));
        hull.exits_within(unknown, self.edge, self.max_depth, scratch, exits);

        for ((point, exit), ray) in queried.drain(..).zip(exits).zip(unknown) {
            depths[point] = Some(*exit);
            rays[point].view = ray.view;
        }
    }
}
