//! What is kept of one body while its contacts are made, in memory that is used again for the next.

use super::cluster::{Clusters, is_supported};
use super::group::{self, Exits, Group};
use super::reduce::{self, Choice, Kept};
use super::{Colliding, Contact, Settings, escape, own_contact};
use crate::hull::{EdgeModel, Hull, Start, Workspace};
use crate::sample::Samples;
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
    ways: Vec<(usize, Start)>,
    /// In the order of the samples.
    pub(super) colliding: Vec<Colliding>,
    clusters: Clusters,
    exits: Exits,
    groups: Vec<Group>,
    choice: Choice,
    kept: Vec<Kept>,
    contacts: Vec<Contact>,
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
        hull.ways_out_of(&self.points, hull_from_body, most, &mut self.exits.exact, &mut self.ways);
        self.colliding.extend(self.ways.iter().map(|&(place, Start { point, direction, view })| {
            let normal = hull_from_body * samples[self.candidates[place]].normal;
            Colliding { point, normal, view, direction, depth: 0.0 }
        }));
    }

    /// Finds how long the ways out are of the samples `wanted`.
    pub(super) fn find_depths(&mut self, hull: &Hull, wanted: impl Fn(&Colliding) -> bool) {
        let of_wanted = self.colliding.iter().filter(|sample| wanted(sample));
        self.exits.begin_at(of_wanted.map(|sample| (sample, sample.direction)));
        let depths = self.exits.within(hull, EdgeModel::Coverage, f64::INFINITY);
        let of_wanted = self.colliding.iter_mut().filter(|sample| wanted(sample));
        for (sample, depth) in of_wanted.zip(depths) {
            sample.depth = *depth;
        }
    }

    /// Puts the samples into clusters; where none can tell, into one, to leave along the way out returned.
    pub(super) fn cluster(&mut self, hull: &Hull, last_escape: Option<Vector3<f64>>) -> Option<Vector3<f64>> {
        // Of the others only the direction matters.
        self.find_depths(hull, is_supported);
        self.clusters.find(&self.colliding);
        if !self.clusters.is_empty() {
            return None;
        }
        self.find_depths(hull, |_| true);
        let direction = escape::direction(hull, &self.colliding, last_escape, &mut self.exits);
        self.clusters.put_together(&self.colliding, &direction);
        Some(direction)
    }

    /// Makes one contact a member of each cluster, along its V, the depth the member's own exit, and keeps at most
    /// `most`. A smooth body touches with its support points instead, or else it would roll like the polyhedron of its
    /// samples.
    pub(super) fn contacts_of_clusters(
        &mut self,
        hull: &Hull,
        body: &Samples,
        hull_from_body: &Isometry3<f64>,
        settings: &Settings,
    ) -> &[Contact] {
        let Self { clusters, colliding, exits, groups, choice, .. } = self;
        choice.clear();
        groups.resize_with(groups.len().max(clusters.len()), Group::default);
        let (edge, most) = (EdgeModel::Coverage, settings.max_depth);
        for ((cluster, direction), group) in clusters.directions().enumerate().zip(groups) {
            group.begin(direction, edge, most);
            if let Some(smooth) = body.smooth() {
                group.add_support(hull, smooth, hull_from_body);
            }
            if group.is_empty() {
                group.add_samples(clusters.members(cluster, colliding));
            }
            let (deepest, first) = group.find_deepest(hull, settings.max_contacts, exits);
            choice.add(group.points(), deepest, first);
        }
        self.keep(hull, settings.max_contacts)
    }

    /// Makes one contact a sample that is inside by whole pixels, along the paper's `vector`, and keeps at most `most`.
    pub(super) fn contacts_of_paper(
        &mut self,
        hull: &Hull,
        vector: &Vector3<f64>,
        most: usize,
    ) -> &[Contact] {
        let Self { colliding, exits, groups, choice, .. } = self;
        choice.clear();
        groups.resize_with(groups.len().max(1), Group::default);
        let direction = vector.try_normalize(0.0).unwrap_or(colliding[0].direction);
        let group = &mut groups[0];
        group.begin(direction, EdgeModel::Pixel, f64::INFINITY);
        group.add_samples(colliding.iter().filter(|sample| hull.inside(&sample.point)));
        if !group.is_empty() {
            let (deepest, first) = group.find_deepest(hull, most, exits);
            choice.add(group.points(), deepest, first);
        }
        self.keep(hull, most)
    }

    /// Makes a contact of each sample along its own way out, and keeps at most `most`.
    pub(super) fn contacts_of_points(&mut self, max_depth: f64, most: usize) -> &[Contact] {
        let Self { colliding, choice, kept, contacts, .. } = self;
        choice.clear();
        let own = |sample: &Colliding| own_contact(sample, max_depth);
        let (deepest, first) = reduce::deepest(colliding.iter().map(|sample| own(sample).depth));
        choice.add(colliding.iter().map(|sample| sample.point), deepest, first);
        choice.spread(most, kept);
        contacts.clear();
        contacts.extend(kept.iter().map(|kept| own(&colliding[kept.place])));
        contacts
    }

    /// Chooses what to keep, and finds how deep that is.
    fn keep(&mut self, hull: &Hull, most: usize) -> &[Contact] {
        let Self { exits, groups, choice, kept, contacts, .. } = self;
        choice.spread(most, kept);
        group::find_depths(hull, groups, kept, exits);
        contacts.clear();
        contacts.extend(kept.iter().map(|kept| groups[kept.cluster].contact(kept.place)));
        contacts
    }
}
