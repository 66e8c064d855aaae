//! What is kept of one body while its contacts are made, in memory that is used again for the next.

use super::cluster::Clusters;
use super::reduce::Choice;
use super::{Colliding, Contact, escape};
use crate::hull::{self, EdgeModel, Hull, Pushed, Start, Workspace};
use crate::sample::{Samples, Smooth};
use nalgebra::{Isometry3, Point3, Vector3};
use std::cell::Cell;

thread_local! {
    static SPARE: Cell<Option<Box<Room>>> = const { Cell::new(None) };
}

/// One body's samples inside the hull, and what becomes of them.
#[derive(Debug, Default)]
pub(super) struct Room {
    batch: Workspace,
    candidates: Vec<usize>,
    points: Vec<Point3<f64>>,
    pushes: Vec<Pushed>,
    /// In the order of the samples.
    pub(super) colliding: Vec<Colliding>,
    clusters: Clusters,
    exits: Exits,
    pub(super) choice: Choice,
    pub(super) kept: Vec<Contact>,
}

/// The exits of many samples along one direction.
#[derive(Debug, Default)]
pub(super) struct Exits {
    exact: hull::Memory,
    starts: Vec<Start>,
    exits: Vec<f64>,
}

impl Exits {
    /// Takes up the samples that are asked from now on.
    pub(super) fn begin_at<'a>(&mut self, samples: impl Iterator<Item = &'a Colliding>) {
        self.starts.clear();
        self.starts.extend(samples.map(|sample| Start { point: sample.point, view: sample.view }));
    }

    pub(super) fn starts(&self) -> &[Start] {
        &self.starts
    }

    /// Metres from each start along `direction` to its exit, at most `most`.
    pub(super) fn within(
        &mut self,
        hull: &Hull,
        direction: &Vector3<f64>,
        edge: EdgeModel,
        most: f64,
    ) -> &[f64] {
        hull.exits_within(&self.starts, direction, edge, most, &mut self.exact, &mut self.exits);
        &self.exits
    }

    /// A contact of each start, its depth the exit along `direction`.
    fn contacts(
        &mut self,
        hull: &Hull,
        direction: Vector3<f64>,
        edge: EdgeModel,
        most: f64,
    ) -> impl Iterator<Item = Contact> {
        self.within(hull, &direction, edge, most);
        let contact = move |(start, &depth): (&Start, &f64)| Contact { point: start.point, direction, depth };
        self.starts.iter().zip(&self.exits).map(contact)
    }
}

impl Room {
    /// Runs `ask` in the room that the thread keeps.
    pub(super) fn with<R>(ask: impl FnOnce(&mut Self) -> R) -> R {
        let mut room = SPARE.take().unwrap_or_default();
        let answer = ask(&mut room);
        SPARE.set(Some(room));
        answer
    }

    /// Takes up the body's samples inside the hull, each with its way out; the first `most` of them.
    pub(super) fn take_inside(
        &mut self,
        hull: &Hull,
        body: &Samples,
        hull_from_body: &Isometry3<f64>,
        most: usize,
    ) {
        let samples = body.points();
        self.colliding.clear();
        // Nothing is inside in a pose that is not finite.
        let Ok(candidates) = hull.candidates(body.cloud(), hull_from_body, &mut self.batch) else { return };
        if candidates.count() == 0 {
            return;
        }
        self.candidates.clear();
        self.candidates.extend(candidates.iter());
        self.points.clear();
        self.points.extend(self.candidates.iter().map(|&index| samples[index].point));
        hull.pushes(&self.points, hull_from_body, most, &mut self.exits.exact, &mut self.pushes);
        self.colliding.extend(self.pushes.iter().map(|&Pushed { place, point, view, push }| {
            let normal = hull_from_body * samples[self.candidates[place]].normal;
            Colliding { point, normal, view, push }
        }));
    }

    /// Puts the samples into clusters; where none can tell, into one, to leave along the way out returned.
    pub(super) fn cluster(&mut self, hull: &Hull, last_escape: Option<Vector3<f64>>) -> Option<Vector3<f64>> {
        self.clusters.find(&self.colliding);
        if !self.clusters.is_empty() {
            return None;
        }
        let direction = escape::direction(hull, &self.colliding, last_escape, &mut self.exits);
        self.clusters.put_together(&self.colliding, &direction);
        Some(direction)
    }

    /// Adds one contact a member of each cluster, along its V, the depth the member's own exit. A smooth body
    /// touches with its support points instead, or else it would roll like the polyhedron of its samples.
    pub(super) fn add_clusters(
        &mut self,
        hull: &Hull,
        body: &Samples,
        hull_from_body: &Isometry3<f64>,
        max_depth: f64,
    ) {
        for (cluster, direction) in self.clusters.directions().enumerate() {
            let touches = body.smooth().is_some_and(|smooth| {
                let touching = touching(hull, smooth, hull_from_body, &direction, max_depth);
                self.choice.add(touching) > 0
            });
            if !touches {
                self.exits.begin_at(self.clusters.members(cluster, &self.colliding));
                self.choice.add(self.exits.contacts(hull, direction, EdgeModel::Coverage, max_depth));
            }
        }
    }

    /// Adds one contact a sample that is inside by whole pixels, along the paper's `vector`.
    pub(super) fn add_papers(&mut self, hull: &Hull, vector: &Vector3<f64>) {
        let direction = vector.try_normalize(0.0).unwrap_or(self.colliding[0].push.direction);
        self.exits.begin_at(self.colliding.iter().filter(|sample| hull.inside(&sample.point)));
        self.choice.add(self.exits.contacts(hull, direction, EdgeModel::Pixel, f64::INFINITY));
    }
}

/// The support points against `direction` that are inside, as contacts along it.
fn touching(
    hull: &Hull,
    smooth: &Smooth,
    hull_from_body: &Isometry3<f64>,
    direction: &Vector3<f64>,
    max_depth: f64,
) -> impl Iterator<Item = Contact> {
    let (hull_from_body, direction) = (*hull_from_body, *direction);
    let support = smooth.support(&hull_from_body.inverse_transform_vector(&-direction));
    let points = (0..support.len()).map(move |k| hull_from_body * support[k].point);
    points.filter(|p| hull.inside_by(p, EdgeModel::Coverage)).map(move |point| {
        let depth = hull.exit_within(&point, &direction, EdgeModel::Coverage, max_depth);
        Contact { point, direction, depth }
    })
}
