//! Contacts that leave the hull together, whose depths are found as far as anybody wants to know them.
//!
//! Of a body's many contacts few are kept, and of the others nobody asks more than whether they are among the deepest.
//! One look at where a contact would end, were it as deep, mostly tells that it is not. The groups of all bodies are
//! asked side by side.

use super::reduce::AS_DEEP;
use super::{Colliding, Contact};
use crate::hull::{EdgeModel, Hull, Memory, Start};
use crate::sample::Smooth;
use nalgebra::{Isometry3, Point3, Vector3};
use std::ops::Range;

/// Groups of points, those of each group one after the other.
#[derive(Debug)]
pub(super) struct Groups {
    edge: EdgeModel,
    max_depth: f64,
    groups: Vec<Group>,
    starts: Vec<Start>,
    /// As far as they are known.
    depths: Vec<Option<f64>>,
    /// Places of points whose depths are wanted.
    asked: Vec<usize>,
    unknown: Vec<Start>,
    exits: Vec<f64>,
}

/// Points that leave the hull together.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// Their places among all.
    pub(super) points: Range<usize>,
    /// The place of the one that is likely to be the deepest.
    likely: usize,
    /// How deep the deepest is, at most `max_depth`.
    pub(super) deepest: f64,
    /// The place of the first that counts as deepest.
    pub(super) first: usize,
}

impl Default for Groups {
    fn default() -> Self {
        Self {
            edge: EdgeModel::Coverage,
            max_depth: f64::INFINITY,
            groups: Vec::new(),
            starts: Vec::new(),
            depths: Vec::new(),
            asked: Vec::new(),
            unknown: Vec::new(),
            exits: Vec::new(),
        }
    }
}

impl Groups {
    /// None yet; depths end at `edge`, and at `max_depth`.
    pub(super) fn clear(&mut self, edge: EdgeModel, max_depth: f64) {
        (self.edge, self.max_depth) = (edge, max_depth);
        self.groups.clear();
        self.starts.clear();
        self.depths.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.groups.len()
    }

    pub(super) fn of(&self, groups: Range<usize>) -> &[Group] {
        &self.groups[groups]
    }

    pub(super) fn point(&self, place: usize) -> &Point3<f64> {
        &self.starts[place].point
    }

    /// Adds a point to the group that comes next; its depth, where that is known.
    pub(super) fn add(&mut self, start: Start, depth: Option<f64>) {
        self.starts.push(start);
        self.depths.push(depth);
    }

    /// Makes a group of the points added since the last one, of which that at `likely` is likely to be the deepest;
    /// there need not be any.
    pub(super) fn close(&mut self, likely: usize) {
        let start = self.groups.last().map_or(0, |group| group.points.end);
        if start < self.starts.len() {
            let points = start..self.starts.len();
            self.groups.push(Group { points, likely: start + likely, deepest: 0.0, first: start });
        }
    }

    /// Makes a group of samples that leave along `direction`.
    pub(super) fn add_samples<'a>(
        &mut self,
        samples: impl Iterator<Item = &'a Colliding>,
        direction: &Vector3<f64>,
    ) {
        // The one that lies farthest back.
        let (mut hindmost, mut likely) = (f64::INFINITY, 0);
        for (k, sample) in samples.enumerate() {
            let along = sample.point.coords.dot(direction);
            if along < hindmost {
                (hindmost, likely) = (along, k);
            }
            self.add(Start { point: sample.point, direction: *direction, view: sample.view }, None);
        }
        self.close(likely);
    }

    /// Makes a group of a smooth body's support points against `direction` that are inside, if there are any.
    pub(super) fn add_support(
        &mut self,
        hull: &Hull,
        smooth: &Smooth,
        hull_from_body: &Isometry3<f64>,
        direction: &Vector3<f64>,
    ) {
        let support = smooth.support(&hull_from_body.inverse_transform_vector(&-direction));
        for sample in support.iter() {
            let point = hull_from_body * sample.point;
            if hull.inside_by(&point, self.edge) {
                let depth = hull.exit_within(&point, direction, self.edge, self.max_depth);
                self.add(Start { point, direction: *direction, view: 0 }, Some(depth));
            }
        }
        self.close(0);
    }

    /// Finds how deep each group's deepest point is, and the first that counts as deepest, where at most `most` will
    /// be kept.
    pub(super) fn find_deepest(&mut self, hull: &Hull, most: usize, memory: &mut Memory) {
        let tells = hull.every_view_tells();
        for Group { points, likely, .. } in &self.groups {
            if points.len() <= most || !tells {
                self.asked.extend(points.clone());
            } else {
                self.asked.push(*likely);
            }
        }
        self.find_depths(hull, memory);
        for Group { points, likely, .. } in &self.groups {
            let deepest = self.depths[*likely].unwrap_or(0.0);
            if deepest < self.max_depth {
                let may_be_deeper = |&place: &usize| {
                    self.depths[place].is_none()
                        && !hull.surely_leaves_before(&self.starts[place], self.edge, deepest)
                };
                self.asked.extend(points.clone().filter(may_be_deeper));
            }
        }
        self.find_depths(hull, memory);
        for group in &mut self.groups {
            let known = self.depths[group.points.clone()].iter().flatten();
            group.deepest = known.copied().fold(0.0, f64::max);
        }
        while self.ask_for_first(hull) {
            self.find_depths(hull, memory);
        }
    }

    /// Goes on in each group to the first point that counts as deepest; asks for those of which only the depth can
    /// tell, and says whether there are any.
    fn ask_for_first(&mut self, hull: &Hull) -> bool {
        for group in &mut self.groups {
            while group.first + 1 < group.points.end {
                let (place, as_deep) = (group.first, AS_DEEP * group.deepest);
                match self.depths[place] {
                    Some(depth) if depth >= as_deep => break,
                    None if !hull.surely_leaves_before(&self.starts[place], self.edge, as_deep) => {
                        self.asked.push(place);
                        break;
                    }
                    _ => group.first += 1,
                }
            }
        }
        !self.asked.is_empty()
    }

    /// Finds the depths of the points asked that are not known yet.
    fn find_depths(&mut self, hull: &Hull, memory: &mut Memory) {
        let Self { asked, depths, starts, unknown, exits, .. } = self;
        asked.retain(|&place| depths[place].is_none());
        unknown.clear();
        unknown.extend(asked.iter().map(|&place| starts[place]));
        hull.exits_within(unknown, self.edge, self.max_depth, memory, exits);
        for (place, exit) in asked.drain(..).zip(exits) {
            depths[place] = Some(*exit);
        }
    }

    /// Writes the contacts of the points at `places` to `contacts`.
    pub(super) fn make_contacts(
        &mut self,
        hull: &Hull,
        places: &[usize],
        memory: &mut Memory,
        contacts: &mut Vec<Contact>,
    ) {
        self.asked.extend_from_slice(places);
        self.find_depths(hull, memory);
        contacts.clear();
        contacts.extend(places.iter().map(|&place| {
            let Start { point, direction, .. } = self.starts[place];
            Contact { point, direction, depth: self.depths[place].unwrap_or(0.0) }
        }));
    }
}
