//! What is kept of bodies while their contacts are made, in memory that is used again for the next.
//!
//! ```text
//!   body 0, body 1, ..      each in its place; what the hull is asked, it is asked for all of them at once
//!     candidates            samples that may be inside
//!     colliding             those inside, each with its way out
//!     groups                those that leave together
//!     kept                  the few that become contacts
//! ```

use super::cluster::{Clusters, is_supported};
use super::group::Groups;
use super::reduce::Choice;
use super::{Body, Colliding, Contact, Contacts, Mode, Settings, body_response, escape, own_contact, tilt};
use crate::hull::{EdgeModel, Hull, Memory, Start, Workspace};
use nalgebra::{Point3, Vector3};
use std::cell::Cell;
use std::ops::Range;

thread_local! {
    static SPARE: Cell<Option<Box<Room>>> = const { Cell::new(None) };
}

/// The samples of bodies inside the hull, and what becomes of them.
#[derive(Debug, Default)]
pub(super) struct Room {
    batch: Workspace,
    exact: Memory,
    /// Body and sample of each point that may be inside.
    candidates: Vec<(usize, usize)>,
    points: Vec<Point3<f64>>,
    ways: Vec<(usize, Start)>,
    /// Body by body, in the order of its samples.
    colliding: Vec<Colliding>,
    bodies: Vec<Touching>,
    exits: Exits,
    clusters: Clusters,
    groups: Groups,
    choice: Choice,
    kept: Vec<usize>,
    contacts: Vec<Contact>,
}

/// A body that touches the hull.
#[derive(Debug, Clone)]
struct Touching {
    /// Its place among all bodies.
    place: usize,
    colliding: Range<usize>,
    groups: Range<usize>,
    kept: Range<usize>,
    escape: Option<Vector3<f64>>,
}

/// Memory for the exits of samples.
#[derive(Debug, Default)]
struct Exits {
    starts: Vec<Start>,
    exits: Vec<f64>,
}

impl Room {
    /// Runs `ask` in the room that the thread keeps.
    pub(super) fn with<R>(ask: impl FnOnce(&mut Self) -> R) -> R {
        let mut room = SPARE.take().unwrap_or_default();
        let answer = ask(&mut room);
        SPARE.set(Some(room));
        answer
    }

    /// Takes up the samples of `bodies` inside the hull, each with its way out; the first `most` at least.
    pub(super) fn take_inside(&mut self, hull: &Hull, bodies: &[Body], most: usize) {
        let Self { candidates, points, ways, colliding, .. } = self;
        candidates.clear();
        points.clear();
        let clouds = bodies.iter().map(|body| (body.samples.cloud(), body.hull_from_body));
        hull.candidates(clouds, &mut self.batch, |place, found| {
            let Body { samples, hull_from_body, .. } = &bodies[place];
            candidates.extend(found.iter().map(|index| (place, index)));
            points.extend(found.iter().map(|index| hull_from_body * samples.points()[index].point));
        });
        hull.ways_out_of(points, most, &mut self.exact, ways);
        colliding.clear();
        self.bodies.clear();
        for &(candidate, Start { point, direction, view }) in ways.iter() {
            let (place, index) = candidates[candidate];
            let end = colliding.len();
            if self.bodies.last().is_none_or(|body| body.place != place) {
                let (groups, kept) = (0..0, 0..0);
                self.bodies.push(Touching { place, colliding: end..end, groups, kept, escape: None });
            }
            let Body { samples, hull_from_body, .. } = &bodies[place];
            let normal = hull_from_body * samples.points()[index].normal;
            colliding.push(Colliding { point, normal, view, direction, depth: 0.0 });
            if let Some(body) = self.bodies.last_mut() {
                body.colliding.end += 1;
            }
        }
    }

    /// Makes a contact of each of the first `most` samples, along its own way out.
    pub(super) fn contacts_of_first(&mut self, hull: &Hull, settings: &Settings, contacts: &mut Contacts) {
        self.colliding.truncate(settings.max_contacts);
        self.exits.find_depths(hull, &mut self.colliding, |_| true, &mut self.exact);
        let own = |sample| own_contact(sample, settings.max_depth);
        contacts.contacts.extend(self.colliding.iter().map(own));
    }

    /// Makes a contact of each body's deepest sample, the first among equals, along its own way out.
    pub(super) fn contacts_of_deepest(
        &mut self,
        hull: &Hull,
        settings: &Settings,
        contacts: &mut [Contacts],
    ) {
        self.exits.find_depths(hull, &mut self.colliding, |_| true, &mut self.exact);
        for body in &self.bodies {
            let colliding = self.colliding[body.colliding.clone()].iter();
            let deepest = colliding.rev().max_by(|a, b| a.depth.total_cmp(&b.depth));
            let own = deepest.map(|sample| own_contact(sample, settings.max_depth));
            contacts[body.place].contacts.extend(own);
        }
    }

    /// Puts each body's samples into clusters, to leave along the cluster's V; where none can tell, into one, to leave
    /// along a way out for all.
    ///
    /// A smooth body touches with its support points instead, or else it would roll like the polyhedron of its samples.
    pub(super) fn group_by_clusters(&mut self, hull: &Hull, bodies: &[Body], max_depth: f64) {
        let Self { colliding, exits, clusters, groups, exact, .. } = self;
        // Of the others only the direction matters.
        exits.find_depths(hull, colliding, is_supported, exact);
        groups.clear(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let Body { samples, hull_from_body, last_escape } = &bodies[touching.place];
            let colliding = &mut colliding[touching.colliding.clone()];
            clusters.find(colliding);
            if clusters.is_empty() {
                exits.find_depths(hull, colliding, |_| true, exact);
                let direction = escape::direction(hull, colliding, *last_escape, exact);
                clusters.put_together(colliding, &direction);
                touching.escape = Some(direction);
            }
            let start = groups.len();
            for (cluster, direction) in clusters.directions().enumerate() {
                let before = groups.len();
                if let Some(smooth) = samples.smooth() {
                    groups.add_support(hull, smooth, hull_from_body, &direction);
                }
                if groups.len() == before {
                    groups.add_samples(clusters.members(cluster, colliding), &direction);
                }
            }
            touching.groups = start..groups.len();
        }
    }

    /// Puts each body's samples that are inside by whole pixels together, to leave along the paper's vector.
    pub(super) fn group_by_paper(&mut self, hull: &Hull, bodies: &[Body]) {
        let groups = &mut self.groups;
        groups.clear(EdgeModel::Pixel, f64::INFINITY);
        for touching in &mut self.bodies {
            let Body { samples, hull_from_body, .. } = &bodies[touching.place];
            let colliding = &self.colliding[touching.colliding.clone()];
            let vector = body_response(hull, samples, hull_from_body).vector;
            let direction = vector.try_normalize(0.0).unwrap_or(colliding[0].direction);
            let start = groups.len();
            groups.add_samples(colliding.iter().filter(|sample| hull.inside(&sample.point)), &direction);
            touching.groups = start..groups.len();
        }
    }

    /// Puts each body's samples together, to leave along their own ways out.
    pub(super) fn group_by_body(&mut self, hull: &Hull, max_depth: f64) {
        let Self { colliding, exits, groups, exact, .. } = self;
        exits.find_depths(hull, colliding, |_| true, exact);
        groups.clear(EdgeModel::Coverage, max_depth);
        for touching in &mut self.bodies {
            let start = groups.len();
            for &Colliding { point, direction, view, depth, .. } in &colliding[touching.colliding.clone()] {
                groups.add(Start { point, direction, view }, Some(depth.min(max_depth)));
            }
            groups.close(0);
            touching.groups = start..groups.len();
        }
    }

    /// Keeps a few points of each body's groups, and makes contacts of them.
    pub(super) fn contacts_of_groups(&mut self, hull: &Hull, settings: &Settings, contacts: &mut [Contacts]) {
        let Self { groups, choice, kept, exact, .. } = self;
        groups.find_deepest(hull, settings.max_contacts, exact);
        kept.clear();
        for touching in &mut self.bodies {
            let start = kept.len();
            choice.spread(groups, touching.groups.clone(), settings.max_contacts, kept);
            touching.kept = start..kept.len();
        }
        groups.make_contacts(hull, kept, exact, &mut self.contacts);
        for Touching { place, kept, escape, .. } in &self.bodies {
            let (made, Contacts { contacts, .. }) = (&self.contacts[kept.clone()], &mut contacts[*place]);
            if settings.mode == Mode::Clustered && escape.is_none() {
                contacts.extend(tilt::without_waiting(made));
            } else {
                contacts.extend_from_slice(made);
            }
        }
        self.bodies.iter().for_each(|body| contacts[body.place].escape = body.escape);
    }
}

impl Exits {
    /// Finds how long the ways out are of the samples `wanted`.
    fn find_depths(
        &mut self,
        hull: &Hull,
        samples: &mut [Colliding],
        wanted: impl Fn(&Colliding) -> bool,
        memory: &mut Memory,
    ) {
        let Self { starts, exits } = self;
        starts.clear();
        let start = |&Colliding { point, direction, view, .. }: &Colliding| Start { point, direction, view };
        starts.extend(samples.iter().filter(|sample| wanted(sample)).map(start));
        hull.exits_within(starts, EdgeModel::Coverage, f64::INFINITY, memory, exits);
        for (sample, exit) in samples.iter_mut().filter(|sample| wanted(sample)).zip(exits) {
            sample.depth = *exit;
        }
    }
}
