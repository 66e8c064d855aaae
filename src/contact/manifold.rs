//! Points that leave the hull together, whose depths are found only as far as they matter.
//!
//! Of the hundred points of a body's manifold few are kept, and of the others it only matters whether they are among
//! the deepest. One look at where a point would exit, were it as deep, mostly tells that it is not. The manifolds of all
//! bodies are asked side by side.

use super::PenetratingSample;
use super::tuning::DEEPEST_FRACTION;
use crate::hull::{EdgeModel, ExitRay, Hull, Scratch};
use crate::sample::Smooth;
use nalgebra::{Isometry3, Vector3};
use std::ops::Range;

/// Manifolds of many bodies, the points of each one after the other.
#[derive(Debug)]
pub(super) struct Manifolds {
    edge: EdgeModel,
    max_depth: f64,
    manifolds: Vec<PendingManifold>,
    rays: Vec<ExitRay>,
    /// The index of each point among its body's samples; none for a support point.
    samples: Vec<Option<usize>>,
    /// As far as they are known.
    depths: Vec<Option<f64>>,
    /// Places of points whose depths are wanted.
    queried: Vec<usize>,
    unknown: Vec<ExitRay>,
    exits: Vec<f64>,
    /// Of the unknown ones: their places, the deepest known depths of their manifolds, and which may be deeper.
    places: Vec<usize>,
    deepest: Vec<f64>,
    kept: Vec<usize>,
}

/// A manifold before its points are reduced.
#[derive(Debug, Clone)]
pub(super) struct PendingManifold {
    /// The places of its points among all.
    pub(super) points: Range<usize>,
    /// Index of the view whose edge gave the direction of its deepest sample; none where no sample gave it.
    pub(super) view: Option<usize>,
    /// Whether all leave in one direction. Else each point becomes a manifold of its own.
    pub(super) shares_direction: bool,
    /// The place of the point that is likely to be the deepest.
    deepest_guess: usize,
    /// How deep the deepest is, at most `max_depth`.
    pub(super) deepest: f64,
    /// The place of the first that counts as deepest.
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
            places: Vec::new(),
            deepest: Vec::new(),
            kept: Vec::new(),
        }
    }
}

impl Manifolds {
    /// Removes all; depths of the next ones end at `edge`, and at `max_depth`.
    pub(super) fn restart(&mut self, edge: EdgeModel, max_depth: f64) {
        (self.edge, self.max_depth) = (edge, max_depth);
        self.manifolds.clear();
        self.rays.clear();
        self.samples.clear();
        self.depths.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.manifolds.len()
    }

    pub(super) fn of(&self, manifolds: Range<usize>) -> &[PendingManifold] {
        &self.manifolds[manifolds]
    }

    pub(super) fn ray(&self, place: usize) -> &ExitRay {
        &self.rays[place]
    }

    /// The vector that moves out all points of a manifold.
    pub(super) fn vector(&self, manifold: &PendingManifold) -> Vector3<f64> {
        self.rays[manifold.first].direction * manifold.deepest
    }

    pub(super) fn sample(&self, place: usize) -> Option<usize> {
        self.samples[place]
    }

    /// How deep a point is; zero where that was never asked.
    pub(super) fn depth(&self, place: usize) -> f64 {
        self.depths[place].unwrap_or(0.0)
    }

    /// Adds a point to the manifold that is finished next; its depth, where that is known.
    fn push(&mut self, ray: ExitRay, sample: Option<usize>, depth: Option<f64>) {
        self.rays.push(ray);
        self.samples.push(sample);
        self.depths.push(depth);
    }

    /// Makes a manifold of the points added since the last one, if there are any, of which that at `deepest_guess` is
    /// likely to be the deepest.
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

    /// Adds samples that leave along their own directions.
    pub(super) fn add_alone<'a>(&mut self, samples: impl Iterator<Item = &'a PenetratingSample>) {
        for sample in samples {
            self.push(sample.ray(), Some(sample.index), Some(sample.depth.min(self.max_depth)));
        }
        self.finish_manifold(None, false, 0);
    }

    /// Makes a manifold of samples that leave along `direction`, which `view` gave.
    pub(super) fn add_samples<'a>(
        &mut self,
        samples: impl Iterator<Item = &'a PenetratingSample>,
        direction: &Vector3<f64>,
        view: Option<usize>,
    ) {
        // The one that lies farthest back is likely to be the deepest.
        let (mut least, mut deepest_guess) = (f64::INFINITY, 0);
        for (k, sample) in samples.enumerate() {
            let along = sample.point.coords.dot(direction);
            if along < least {
                (least, deepest_guess) = (along, k);
            }
            self.push(ExitRay { direction: *direction, ..sample.ray() }, Some(sample.index), None);
        }
        self.finish_manifold(view, true, deepest_guess);
    }

    /// Makes a manifold of those support points of a smooth body against `direction` that are inside, if there are any.
    pub(super) fn add_support(
        &mut self,
        hull: &Hull,
        smooth: &Smooth,
        hull_from_body: &Isometry3<f64>,
        direction: &Vector3<f64>,
        view: Option<usize>,
    ) {
        let support = smooth.support(&hull_from_body.inverse_transform_vector(&-direction));
        for sample in support.iter() {
            let point = hull_from_body * sample.point;
            if hull.inside_by(&point, self.edge) {
                self.push(ExitRay { point, direction: *direction, view: view.unwrap_or(0) }, None, None);
            }
        }
        self.finish_manifold(view, true, 0);
    }

    /// Finds how deep the deepest point of each manifold is, where at most `most` points will be kept.
    pub(super) fn find_deepest(&mut self, hull: &Hull, most: usize, scratch: &mut Scratch) {
        // Where all will be kept all are asked, else first those that are likely to be the deepest.
        for PendingManifold { points, deepest_guess, .. } in &self.manifolds {
            if points.len() <= most {
                self.queried.extend(points.clone());
            } else {
                self.queried.push(*deepest_guess);
            }
        }
        self.find_depths(hull, scratch);

        // What decides for one point is likely to decide for all that leave in its direction.
        for PendingManifold { points, deepest_guess, shares_direction, .. } in &self.manifolds {
            if *shares_direction {
                let view = self.rays[*deepest_guess].view;
                self.rays[points.clone()].iter_mut().for_each(|ray| ray.view = view);
            }
        }

        // Then those that do not provably exit before.
        self.ask_unless_shallower(hull, scratch);
        self.find_depths(hull, scratch);
        for manifold in &mut self.manifolds {
            let known = self.depths[manifold.points.clone()].iter().flatten();
            manifold.deepest = known.copied().fold(0.0, f64::max);
        }
    }

    /// Asks for the depths of the points that are not provably shallower than the deepest known one of their manifold.
    fn ask_unless_shallower(&mut self, hull: &Hull, scratch: &mut Scratch) {
        let Self {
            manifolds,
            rays,
            depths,
            queried: asked,
            unknown,
            places,
            deepest,
            kept,
            edge,
            max_depth,
            ..
        } = self;
        places.clear();
        unknown.clear();
        deepest.clear();
        for PendingManifold { points, deepest_guess, .. } in manifolds.iter() {
            let known = depths[*deepest_guess].unwrap_or(0.0);
            for place in points.clone().filter(|&place| known < *max_depth && depths[place].is_none()) {
                places.push(place);
                unknown.push(rays[place]);
                deepest.push(known);
            }
        }
        kept.clear();
        hull.keep_unless_proven(unknown, deepest, *edge, scratch, kept);
        asked.extend(kept.iter().map(|&k| places[k]));
    }

    /// Finds the first point of each manifold that counts as deepest.
    pub(super) fn find_first_deep(&mut self, hull: &Hull, scratch: &mut Scratch) {
        while self.ask_for_first_deep(hull) {
            self.find_depths(hull, scratch);
        }
    }

    /// Goes on in each manifold to the first point that counts as deepest; asks for the depths of those of which only
    /// the depth can tell, and says whether there are any.
    fn ask_for_first_deep(&mut self, hull: &Hull) -> bool {
        for manifold in &mut self.manifolds {
            while manifold.first + 1 < manifold.points.end {
                let (place, enough) = (manifold.first, DEEPEST_FRACTION * manifold.deepest);
                match self.depths[place] {
                    Some(depth) if depth >= enough => break,
                    None if !hull.provably_exits_before(&self.rays[place], self.edge, enough) => {
                        self.queried.push(place);
                        break;
                    }
                    _ => manifold.first += 1,
                }
            }
        }
        !self.queried.is_empty()
    }

    /// Finds the depths of the points at `places`.
    pub(super) fn find_depths_of(&mut self, hull: &Hull, places: &[usize], scratch: &mut Scratch) {
        self.queried.extend_from_slice(places);
        self.find_depths(hull, scratch);
    }

    /// Finds the depths of the points asked that are not known yet.
    fn find_depths(&mut self, hull: &Hull, scratch: &mut Scratch) {
        let Self { queried: asked, depths, rays, unknown, exits, .. } = self;
        asked.retain(|&place| depths[place].is_none());
        unknown.clear();
        unknown.extend(asked.iter().map(|&place| rays[place]));
        hull.exits_within(unknown, self.edge, self.max_depth, scratch, exits);
        for ((place, exit), ray) in asked.drain(..).zip(exits).zip(unknown) {
            depths[place] = Some(*exit);
            rays[place].view = ray.view;
        }
    }
}
