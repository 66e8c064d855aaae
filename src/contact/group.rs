//! Contacts along one direction, whose depths are found as far as anybody wants to know them.
//!
//! Of a body's many contacts few are kept, and of the others nobody asks more than whether they are among the deepest.
//! One look at where a contact would end, were it as deep, mostly tells that it is not.

use super::reduce::{self, Kept, counts_as};
use super::{Colliding, Contact};
use crate::hull::{self, EdgeModel, Hull, Start};
use crate::sample::Smooth;
use nalgebra::{Isometry3, Point3, Vector3};

/// The exits of many points.
#[derive(Debug, Default)]
pub(super) struct Exits {
    pub(super) exact: hull::Memory,
    starts: Vec<Start>,
    places: Vec<usize>,
    exits: Vec<f64>,
}

impl Exits {
    /// Takes up the samples that are asked from now on, and where they go.
    pub(super) fn begin_at<'a>(&mut self, samples: impl Iterator<Item = (&'a Colliding, Vector3<f64>)>) {
        self.starts.clear();
        self.starts.extend(samples.map(|(sample, direction)| start(sample, direction)));
    }

    pub(super) fn starts(&self) -> &[Start] {
        &self.starts
    }

    /// Metres from each start to its exit, at most `most`.
    pub(super) fn within(&mut self, hull: &Hull, edge: EdgeModel, most: f64) -> &[f64] {
        hull.exits_within(&self.starts, edge, most, &mut self.exact, &mut self.exits);
        &self.exits
    }

    /// The same, all along one direction.
    pub(super) fn along(
        &mut self,
        hull: &Hull,
        direction: &Vector3<f64>,
        edge: EdgeModel,
        most: f64,
    ) -> &[f64] {
        self.starts.iter_mut().for_each(|start| start.direction = *direction);
        self.within(hull, edge, most)
    }
}

/// Points that leave the hull together.
#[derive(Debug)]
pub(super) struct Group {
    direction: Vector3<f64>,
    edge: EdgeModel,
    max_depth: f64,
    starts: Vec<Start>,
    /// As far as they are known.
    depths: Vec<Option<f64>>,
    /// The place of the sample with the longest way out of its own.
    likely: usize,
}

impl Default for Group {
    fn default() -> Self {
        let (direction, edge, max_depth) = (Vector3::zeros(), EdgeModel::Coverage, f64::INFINITY);
        Self { direction, edge, max_depth, starts: Vec::new(), depths: Vec::new(), likely: 0 }
    }
}

impl Group {
    /// Empty, to leave along `direction`, to a depth of at most `max_depth`.
    pub(super) fn begin(&mut self, direction: Vector3<f64>, edge: EdgeModel, max_depth: f64) {
        (self.direction, self.edge, self.max_depth, self.likely) = (direction, edge, max_depth, 0);
        self.starts.clear();
        self.depths.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    pub(super) fn points(&self) -> impl Iterator<Item = Point3<f64>> {
        self.starts.iter().map(|start| start.point)
    }

    pub(super) fn add_samples<'a>(&mut self, samples: impl Iterator<Item = &'a Colliding>) {
        let mut longest = f64::NEG_INFINITY;
        for sample in samples {
            if sample.depth > longest {
                (longest, self.likely) = (sample.depth, self.starts.len());
            }
            self.starts.push(start(sample, self.direction));
            self.depths.push(None);
        }
    }

    /// Adds the support points against the direction that are inside.
    pub(super) fn add_support(&mut self, hull: &Hull, smooth: &Smooth, hull_from_body: &Isometry3<f64>) {
        let support = smooth.support(&hull_from_body.inverse_transform_vector(&-self.direction));
        for sample in support.iter() {
            let point = hull_from_body * sample.point;
            if hull.inside_by(&point, self.edge) {
                self.starts.push(Start { point, direction: self.direction, view: 0 });
                self.depths.push(Some(hull.exit_within(&point, &self.direction, self.edge, self.max_depth)));
            }
        }
    }

    /// How deep the deepest is, and the first that counts as deepest, where at most `most` will be kept.
    pub(super) fn find_deepest(&mut self, hull: &Hull, most: usize, exits: &mut Exits) -> (f64, usize) {
        if self.starts.len() <= most || !hull.every_view_tells() {
            self.find_depths(hull, 0..self.starts.len(), exits);
            return reduce::deepest(self.depths.iter().flatten().copied());
        }
        self.find_depths(hull, [self.likely], exits);
        let mut deepest = self.known(self.likely);
        if deepest < self.max_depth {
            let mut places = std::mem::take(&mut exits.places);
            places.clear();
            places.extend((0..self.starts.len()).filter(|&place| self.may_reach(hull, place, deepest)));
            self.find_depths(hull, places.iter().copied(), exits);
            exits.places = places;
            deepest = self.depths.iter().flatten().copied().fold(0.0, f64::max);
        }
        let mut first = 0;
        while first + 1 < self.starts.len() && !self.counts_as(hull, deepest, first, exits) {
            first += 1;
        }
        (deepest, first)
    }

    fn counts_as(&mut self, hull: &Hull, deepest: f64, place: usize, exits: &mut Exits) -> bool {
        if self.depths[place].is_none() && !self.may_reach(hull, place, reduce::AS_DEEP * deepest) {
            return false;
        }
        self.find_depths(hull, [place], exits);
        counts_as(deepest, self.known(place))
    }

    /// Whether a contact is, or may be, as deep as that.
    fn may_reach(&self, hull: &Hull, place: usize, depth: f64) -> bool {
        self.depths[place].is_some() || !hull.surely_leaves_before(&self.starts[place], self.edge, depth)
    }

    /// Finds the depths at `places` that are not known yet.
    fn find_depths(
        &mut self,
        hull: &Hull,
        places: impl IntoIterator<Item = usize> + Clone,
        exits: &mut Exits,
    ) {
        exits.starts.clear();
        exits.starts.extend(places.clone().into_iter().filter_map(|place| self.unknown(place)));
        let mut found = exits.within(hull, self.edge, self.max_depth).iter();
        for place in places {
            self.learn(place, &mut found);
        }
    }

    /// Where a contact starts whose depth is not known yet.
    fn unknown(&self, place: usize) -> Option<Start> {
        if self.depths[place].is_none() { Some(self.starts[place]) } else { None }
    }

    /// Takes the next of the depths `found`, unless it is known.
    fn learn<'d>(&mut self, place: usize, found: &mut impl Iterator<Item = &'d f64>) {
        if self.depths[place].is_none() {
            self.depths[place] = found.next().copied();
        }
    }

    fn known(&self, place: usize) -> f64 {
        self.depths[place].unwrap_or(0.0)
    }

    /// The contact of a point whose depth has been found.
    pub(super) fn contact(&self, place: usize) -> Contact {
        Contact { point: self.starts[place].point, direction: self.direction, depth: self.known(place) }
    }
}

/// Finds the depths of what is kept of groups that share their edge and largest depth.
pub(super) fn find_depths(hull: &Hull, groups: &mut [Group], kept: &[Kept], exits: &mut Exits) {
    let Some(Group { edge, max_depth, .. }) = groups.first() else { return };
    exits.starts.clear();
    exits.starts.extend(kept.iter().filter_map(|kept| groups[kept.cluster].unknown(kept.place)));
    let mut found = exits.within(hull, *edge, *max_depth).iter();
    for kept in kept {
        groups[kept.cluster].learn(kept.place, &mut found);
    }
}

fn start(sample: &Colliding, direction: Vector3<f64>) -> Start {
    Start { point: sample.point, direction, view: sample.view }
}
