//! Many points at once, in double precision: the ways out and exits that contacts are made of.
//!
//! ```text
//!   points ─► sight ─► nearest edge ─► contact normal ─► exit
//!             every view, once         of new edge pixels many at once
//! ```
//!
//! The same arithmetic in the same order as [`Hull::push`] and [`Hull::exit_within`], so that the same bits come out;
//! only what a point does not wait for is done for many at a time. What is rare goes the single query's way: walks
//! along a silhouette's rectangle or through an edge with coverage, and all of a frame in which a view may abstain.

// Loops over the lanes of several arrays say what happens to lane k: it is what the compiler turns into vectors.
#![allow(clippy::needless_range_loop)]

mod exits;
mod nearest;
mod sight;
mod walk;

use super::points::LANES;
use super::view::whole;
use super::{EdgeModel, Hull, View};
use crate::silhouette::HALF_COVERAGE;
use crate::vectorised::vectorised;
use exits::Exits;
use nalgebra::{Point3, Vector3};
use nearest::Decided;
use sight::{Block, Field};

/// So few exits are sooner found one by one.
const FEW: usize = 2;

/// One number of each of as many points as are asked together.
type Wide = [f64; LANES];

/// A point inside, and where it is to leave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start {
    pub(crate) point: Point3<f64>,
    pub(crate) direction: Vector3<f64>,
    /// Index of the view that is likely to decide how far that is: the one that gave the direction.
    pub(crate) view: usize,
}

/// Memory that is used again and again; it holds no answer.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    fields: Vec<Field<'static>>,
    block: Block,
    decided: Decided,
    exits: Exits,
}

impl Hull {
    /// Writes to `ways` the directions of [`Self::push`] for those of `points` that are inside by the coverage edge,
    /// with their places, in their order; of the first `most` of them at least.
    pub(crate) fn ways_out_of(
        &self,
        points: &[Point3<f64>],
        most: usize,
        memory: &mut Memory,
        ways: &mut Vec<(usize, Start)>,
    ) {
        ways.clear();
        if !self.every_view_tells() {
            let way = |(place, &point): (usize, &Point3<f64>)| {
                let (view, direction) = self.way_out(&point)?;
                Some((place, Start { point, direction, view }))
            };
            ways.extend(points.iter().enumerate().filter_map(way).take(most));
            return;
        }
        memory.with_queries(self, EdgeModel::Coverage, |queries| {
            for (chunk, first) in points.chunks(LANES).zip((0..).step_by(LANES)) {
                if ways.len() >= most {
                    break;
                }
                find_inside(queries, chunk, first, ways);
            }
            queries.decided.find_directions(queries.fields, ways);
        });
    }

    /// Writes to `exits` [`Self::exit_within`] of each of `starts`, all of them inside.
    pub(crate) fn exits_within(
        &self,
        starts: &[Start],
        edge: EdgeModel,
        most: f64,
        memory: &mut Memory,
        exits: &mut Vec<f64>,
    ) {
        exits.clear();
        if starts.len() <= FEW || !self.every_view_tells() {
            let exit = |start: &Start| self.exit_within(&start.point, &start.direction, edge, most);
            exits.extend(starts.iter().map(exit));
            return;
        }
        memory.with_queries(self, edge, |queries| {
            queries.exits.find(self, queries.fields, starts, most, exits);
        });
    }

    /// Whether the exit of `start` surely lies before `t` metres: some view sees background there; the one that is
    /// likely to decide is asked first. A look a view, where an exit is a walk. Only where
    /// [`Self::every_view_tells`].
    pub(crate) fn surely_leaves_before(&self, start: &Start, edge: EdgeModel, t: f64) -> bool {
        let end = start.point + start.direction * t;
        let others =
            self.views().iter().enumerate().filter(|(k, view)| *k != start.view && view.is_enabled());
        surely_outside(&self.views()[start.view], &end, edge)
            || others.into_iter().any(|(_, view)| surely_outside(view, &end, edge))
    }
}

/// Whether a view sees background at `p`, however its place is rounded.
fn surely_outside(view: &View, p: &Point3<f64>, edge: EdgeModel) -> bool {
    /// Far more than rounding, in pixels.
    const RIM: f64 = 1e-6;
    let silhouette = view.silhouette();
    let Some(at) = view.project(p) else { return false };
    let (i, j) = whole(at.u, at.v);
    let (x, y) = (at.u - f64::from(i), at.v - f64::from(j));
    let within = |x: f64| x > RIM && x < 1.0 - RIM;
    if !view.sees(i, j) || !within(x) || !within(y) {
        false
    } else if edge == EdgeModel::Coverage && silhouette.has_coverage() {
        silhouette.coverage(at.u, at.v) < HALF_COVERAGE - 255.0 * RIM
    } else {
        silhouette.distance(i, j) == 0
    }
}

vectorised! {
    /// Adds those of a block of points that are inside to `ways`, and to the points that a view decides; the first of
    /// the block has the place `first`.
    fn find_inside(queries: &mut Queries, points: &[Point3<f64>], first: usize, ways: &mut Vec<(usize, Start)>) {
        let Queries { hull, fields, block, decided, .. } = queries;
        block.place(points.len(), |k| points[k]);
        let inside = block.within(hull.bounds(), u32::MAX >> (LANES - points.len()));
        let inside = if hull.culls.frustum_box { block.within(hull.aabb(), inside) } else { inside };
        let inside = block.sight_inside(fields, inside);
        if inside != 0 {
            decided.add(fields, block, inside, first, ways);
        }
    }
}

/// A hull that is asked, and what the answers are worked out in.
struct Queries<'a> {
    hull: &'a Hull,
    fields: &'a [Field<'a>],
    block: &'a mut Block,
    decided: &'a mut Decided,
    exits: &'a mut Exits,
}

impl Memory {
    /// Runs `ask` on what of the hull's views every point needs.
    fn with_queries(&mut self, hull: &Hull, edge: EdgeModel, ask: impl FnOnce(&mut Queries)) {
        let mut fields: Vec<Field> = std::mem::take(&mut self.fields);
        let enabled = hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
        fields.extend(enabled.map(|(index, view)| Field::new(index, view, edge)));
        let Self { block, decided, exits, .. } = self;
        ask(&mut Queries { hull, fields: &fields, block, decided, exits });
        fields.clear();
        // Collected in place: nothing is left to convert but the lifetime.
        self.fields = fields.into_iter().map(|_| unreachable!("it was cleared")).collect();
    }
}

#[cfg(test)]
mod tests;
