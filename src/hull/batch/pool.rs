//! The points inside of one body or several, side by side, and how every view sees them.
//!
//! ```text
//!   block        0                 1                    LANES points each; the last is filled up with its last point
//!   at           x y z             x y z
//!   sightings    view 0, 1, 2 ..   view 0, 1, 2 ..
//!   order        view 0: 17 3 21 .. | view 1: 40 2 ..   places of points by the view that decides, shallow ones first
//! ```

use super::super::lanes::{bits, bits_of, either, whole};
use super::super::points::{Block, LANES, Lane, Points};
use super::fold::{Folded, Homogeneous, NEAREST, Posed};
use crate::vectorised::vectorised;

/// Points that lie deeper than this, in pixels, count as equally deep where they are put in order.
const DEEPEST: usize = 63;

/// So many points keep the lanes full, and what is known of them in the cache.
pub(super) const ENOUGH: usize = 2048;

/// Where a view sees points. They lie at the start of cache lines, as all that vectors are loaded from here.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub(super) struct Sighting {
    /// From the corner of the region, in pixels.
    pub(super) u: Lane,
    pub(super) v: Lane,
    pub(super) per_depth: Lane,
    /// Chebyshev distance to the background.
    pub(super) clear: Lane,
}

/// Which view decides the window search for each point of a block.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub(super) struct Decision {
    /// Its place among the folded ones.
    pub(super) view: [u32; LANES],
    /// How deep the point lies there, in pixels, up to `DEEPEST`.
    depth: [u32; LANES],
    /// Half-width of its window.
    pub(super) half: Lane,
}

/// Points inside.
#[derive(Debug, Default)]
pub(super) struct Pool {
    /// The body that each point belongs to.
    pub(super) owners: Vec<u32>,
    pub(super) at: Vec<Block>,
    /// Block by block, a view after the other.
    pub(super) sightings: Vec<Sighting>,
    pub(super) decisions: Vec<Decision>,
    pub(super) order: Vec<u32>,
    /// Where each view's part of the order ends.
    ends: Vec<usize>,
    /// Scratch.
    starts: Vec<usize>,
}

impl Decision {
    /// Which points a view decides, a bit each.
    #[inline(always)]
    pub(super) fn by(&self, view: usize) -> u32 {
        let mut decided = [0; LANES];
        for k in 0..LANES {
            decided[k] = u32::from(self.view[k] == view as u32);
        }
        bits(&decided)
    }
}

impl Pool {
    pub(super) fn clear(&mut self) {
        self.owners.clear();
        self.at.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.owners.len()
    }

    /// Adds the points at `places` of a body's blocks.
    pub(super) fn take(&mut self, body: usize, points: &Points, places: &[u32], posed: &Posed) {
        for &place in places {
            let (block, lane) = (self.len() / LANES, self.len() % LANES);
            if lane == 0 {
                self.at.push(Block::default());
            }
            self.at[block].set(lane, posed.place(points.at(place as usize)));
            self.owners.push(body as u32);
        }
    }

    /// Which lanes of a block are points, not filling.
    #[inline(always)]
    pub(super) fn filled(&self, block: usize) -> u32 {
        u32::MAX >> LANES.saturating_sub(self.len() - block * LANES)
    }

    /// Looks at all points from all views, and puts them in order.
    pub(super) fn survey(&mut self, views: &[Folded]) {
        let filled = self.len() % LANES;
        if filled > 0
            && let Some(block) = self.at.last_mut()
        {
            let last = block.get(filled - 1);
            (filled..LANES).for_each(|lane| block.set(lane, last));
        }
        self.sightings.resize(self.at.len() * views.len(), Sighting::default());
        self.decisions.resize(self.at.len(), Decision::default());
        survey(views, &self.at, &mut self.sightings, &mut self.decisions);
        self.sort(views.len());
    }

    /// Counts the points of each view and depth, and puts each to its like.
    fn sort(&mut self, views: usize) {
        let Self { owners, decisions, order, ends, starts, .. } = self;
        let class = |decision: &Decision, lane: usize| {
            decision.view[lane] as usize * (DEEPEST + 1) + decision.depth[lane] as usize
        };
        let lanes = |block: usize| 0..LANES.min(owners.len() - block * LANES);
        starts.clear();
        starts.resize(views * (DEEPEST + 1), 0);
        for (block, decision) in decisions.iter().enumerate() {
            lanes(block).for_each(|lane| starts[class(decision, lane)] += 1);
        }
        let mut sum = 0;
        for start in starts.iter_mut() {
            (*start, sum) = (sum, sum + *start);
        }
        order.resize(owners.len(), 0);
        for (block, decision) in decisions.iter().enumerate() {
            for lane in lanes(block) {
                let place = &mut starts[class(decision, lane)];
                order[*place] = (block * LANES + lane) as u32;
                *place += 1;
            }
        }
        // Each start has come to its class's end.
        ends.clear();
        ends.extend(starts.iter().skip(DEEPEST).step_by(DEEPEST + 1));
    }

    /// The points that a view decides, shallow ones first.
    pub(super) fn decided_by(&self, view: usize) -> &[u32] {
        let start = if view == 0 { 0 } else { self.ends[view - 1] };
        &self.order[start..self.ends[view]]
    }

    /// Which view decides for a point.
    pub(super) fn decided(&self, point: usize) -> usize {
        self.decisions[point / LANES].view[point % LANES] as usize
    }

    /// The half-widths of these points' windows, as [`Self::sightings_of`] has them.
    #[inline(always)]
    pub(super) fn halves_of(&self, points: &[u32]) -> Lane {
        let mut halves = [0.0; LANES];
        for k in 0..LANES {
            let point = points[k.min(points.len() - 1)] as usize;
            halves[k] = self.decisions[point / LANES].half[point % LANES];
        }
        halves
    }

    /// How a view sees the points of a block.
    #[inline(always)]
    pub(super) fn sighting(&self, block: usize, view: usize) -> &Sighting {
        &self.sightings[block * self.ends.len() + view]
    }

    /// How it sees these points, at most as many as are asked together; lanes left over see the last one.
    #[inline(always)]
    pub(super) fn sightings_of(&self, points: &[u32], view: usize) -> Sighting {
        let mut gathered = Sighting::default();
        for k in 0..LANES {
            let point = points[k.min(points.len() - 1)] as usize;
            let (sighting, lane) = (self.sighting(point / LANES, view), point % LANES);
            (gathered.u[k], gathered.v[k]) = (sighting.u[lane], sighting.v[lane]);
            (gathered.per_depth[k], gathered.clear[k]) = (sighting.per_depth[lane], sighting.clear[lane]);
        }
        gathered
    }
}

vectorised! {
    fn survey(views: &[Folded], at: &[Block], sightings: &mut [Sighting], decisions: &mut [Decision]) {
        let blocks = sightings.chunks_exact_mut(views.len().max(1));
        for ((at, sightings), decision) in at.iter().zip(blocks).zip(decisions) {
            for (view, sighting) in views.iter().zip(sightings.iter_mut()) {
                look(view, at, sighting);
            }
            *decision = decide(views, sightings);
        }
    }
}

#[inline(always)]
fn look(view: &Folded, at: &Block, sighting: &mut Sighting) {
    let Homogeneous { u, v, depth } = view.project(at);
    let [right, below] = view.last_pixel();
    let table = view.distances();
    let (mut columns, mut rows, mut pixels) = ([0; LANES], [0; LANES], [0; LANES]);
    for k in 0..LANES {
        // What is behind the camera comes to the rim, which is background.
        let per_depth = either(depth[k] > NEAREST, 1.0 / depth[k], 0.0);
        let (u, v) = (u[k] * per_depth, v[k] * per_depth);
        let (column, row) = (whole(u, right), whole(v, below));
        (sighting.u[k], sighting.v[k], sighting.per_depth[k]) = (u, v, per_depth);
        (columns[k], rows[k]) = (column, row);
        pixels[k] = table.at(column, row);
    }
    for k in 0..LANES {
        sighting.clear[k] = pixels[k] as f32;
    }
    if pixels.iter().any(|&pixels| pixels == u32::from(u8::MAX)) {
        for k in 0..LANES {
            sighting.clear[k] = f32::from(view.exact_distance(columns[k], rows[k]));
        }
    }
}

/// The first k at which the half-width `1 + floor(k d_max / d_i)` reaches the view's distance decides, the first view
/// among equals.
#[inline(always)]
fn decide(views: &[Folded], sightings: &[Sighting]) -> Decision {
    // Pixels that a metre covers, in the view where they are fewest: d_max. The ratio of equals is exactly one.
    let mut fewest = [f32::INFINITY; LANES];
    for (view, sighting) in views.iter().zip(sightings) {
        for k in 0..LANES {
            let pixels = view.pixels_per_metre * sighting.per_depth[k];
            fewest[k] = either(pixels < fewest[k], pixels, fewest[k]);
        }
    }
    let (mut decision, mut soonest) = (Decision::default(), [f32::INFINITY; LANES]);
    let (mut pixels_of, mut clear_of) = ([1.0; LANES], [0.0; LANES]);
    for (place, (view, sighting)) in (0..).zip(views.iter().zip(sightings)) {
        for k in 0..LANES {
            let pixels = view.pixels_per_metre * sighting.per_depth[k];
            let iteration = ((sighting.clear[k] - 1.0) * (fewest[k] / pixels)).ceil();
            let sooner = iteration < soonest[k];
            soonest[k] = either(sooner, iteration, soonest[k]);
            decision.view[k] = if sooner { place } else { decision.view[k] };
            pixels_of[k] = either(sooner, pixels, pixels_of[k]);
            clear_of[k] = either(sooner, sighting.clear[k], clear_of[k]);
        }
    }
    for k in 0..LANES {
        let (deepest, reach) = (DEEPEST as f32, 1.0 + (soonest[k] * (pixels_of[k] / fewest[k])).floor());
        decision.half[k] = either(reach > clear_of[k], reach, clear_of[k]);
        decision.depth[k] = bits_of(either(clear_of[k] < deepest, clear_of[k], deepest));
    }
    decision
}
