//! Many points, or whole bodies, asked at once.
//!
//! ```text
//!   bodies ─► fold ─► find ─► pool ─► survey ─► decide ─► edge, exit ─► V ─► longest exit
//!                     one body's     many bodies' points, side by side       the body's vector
//! ```
//!
//! The same answers as [`Hull::inside`] and [`Hull::respond`], point by point, but in single precision, from the
//! points' frame straight to the images: a point whose image lies within a few ten-thousandths of a pixel of a pixel's
//! border may count to the other side. Contacts do not rest on that: they use it to leave out what is surely outside.
//!
//! Frames in which a view may abstain are asked point by point, in double precision.

// Loops over the lanes of several arrays say what happens to lane k: it is what the compiler turns into vectors.
#![allow(clippy::needless_range_loop)]

mod bodies;
mod edge;
mod exit;
mod fold;
mod folded_hull;
mod inside;
pub(super) mod lookup;
mod pool;
mod respond;
pub(super) mod rings;
mod walk;
mod workspace;

pub use bodies::{Body, BodyResponse};
pub use workspace::{Inside, PointResponse, Workspace};

use super::Hull;
use super::points::Points;
use crate::Result;
use inside::Within;
use nalgebra::Isometry3;
use pool::ENOUGH;

impl Hull {
    /// Which of `points` are inside, in the pose `world_from_points`.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn inside_many<'w>(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        workspace: &'w mut Workspace,
    ) -> Result<Inside<'w>> {
        let mut folded = workspace.fold(self);
        workspace.found.places.clear();
        let found = folded.find(points, world_from_points, Within::Subject, &mut workspace.found);
        workspace.take_back(folded);
        found.map(|_| workspace.mark(points))
    }

    /// Tells `take` of each of `bodies`, by its place, which points may be inside by any edge model: all but those
    /// surely outside; none in a pose that is not finite.
    pub(crate) fn candidates<'b>(
        &self,
        bodies: impl Iterator<Item = Body<'b>>,
        workspace: &mut Workspace,
        mut take: impl FnMut(usize, Inside),
    ) {
        let mut folded = workspace.fold(self);
        for (place, (points, world_from_points)) in bodies.enumerate() {
            workspace.found.places.clear();
            let found = folded.find(points, &world_from_points, Within::NearSubject, &mut workspace.found);
            if found.is_ok() && !workspace.found.places.is_empty() {
                take(place, workspace.mark(points));
            }
        }
        workspace.take_back(folded);
    }

    /// The paper's response of each point inside, in the order in which the points lie in memory.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn respond_many<'w>(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        workspace: &'w mut Workspace,
    ) -> Result<&'w [PointResponse]> {
        let mut folded = workspace.fold(self);
        let Workspace { found, pool, ways, responses, .. } = workspace;
        found.places.clear();
        responses.clear();
        let posed = folded.find(points, world_from_points, Within::Subject, found);
        if let Ok(posed) = &posed {
            for places in found.places.chunks(ENOUGH) {
                pool.clear();
                pool.take(0, points, places, posed);
                ways.fill(&folded, pool);
                responses.reserve(places.len());
                for (point, &place) in places.iter().enumerate() {
                    if let Some(way) = ways.get(point) {
                        let view = folded.views[pool.decided(point)].index;
                        let point = points.given(place as usize);
                        responses.push(PointResponse { point, view, normal: way.normal, depth: way.depth });
                    }
                }
            }
        }
        workspace.take_back(folded);
        posed.map(|_| workspace.responses.as_slice())
    }
}

#[cfg(test)]
mod tests;
