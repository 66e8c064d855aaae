//! Where many points inside leave the hull.
//!
//! ```text
//!   the view that decided ─► wall ─► which others stay clear ─► walks in those that may not
//! ```

use super::super::lanes::{bits, either, ones, whole};
use super::super::points::{Block, LANES, Lane};
use super::fold::{Folded, Homogeneous, Volume};
use super::pool::{Pool, Sighting};
use super::walk::{Route, walk};
use crate::vectorised::vectorised;

/// Exits of the points of a pool: metres along a direction each to the first background in any view, or to the side
/// of the work volume.
#[derive(Debug, Default)]
pub(super) struct Exits {
    /// Block by block.
    metres: Vec<Lane>,
    /// Scratch.
    doubtful: Vec<u32>,
}

impl Exits {
    /// Metres from a point to its exit.
    pub(super) fn get(&self, point: usize) -> f32 {
        self.metres[point / LANES][point % LANES]
    }

    pub(super) fn set(&mut self, point: usize, metres: f32) {
        self.metres[point / LANES][point % LANES] = metres;
    }

    /// Makes room for the points of `pool`, none of which has an exit.
    pub(super) fn start(&mut self, pool: &Pool) {
        self.metres.clear();
        self.metres.resize(pool.at.len(), [f32::INFINITY; LANES]);
    }

    /// Block by block.
    pub(super) fn metres(&mut self) -> &mut [Lane] {
        &mut self.metres
    }

    /// Lowers the exits, which are those of the views that decided, to those of walls and other views. Few of these are
    /// in doubt, since the view that decided is likely to end a walk.
    pub(super) fn lower(&mut self, views: &[Folded], volume: &Volume, pool: &Pool, directions: &[Block]) {
        let Self { metres, doubtful } = self;
        walls(volume, &pool.at, directions, metres);
        for (place, view) in views.iter().enumerate() {
            let route = Route { view, place, pool, directions };
            doubtful.clear();
            doubt(&route, metres, doubtful);
            walk(&route, doubtful, view.tables.distance_words, metres);
        }
    }

    /// As far as the walls of the work volume.
    pub(super) fn start_at_walls(&mut self, volume: &Volume, pool: &Pool, directions: &[Block]) {
        self.start(pool);
        walls(volume, &pool.at, directions, &mut self.metres);
    }

    /// The exits of these points, of which no more is known than the walls.
    pub(super) fn fill_some(&mut self, views: &[Folded], pool: &Pool, directions: &[Block], points: &[u32]) {
        for (place, view) in views.iter().enumerate() {
            let route = Route { view, place, pool, directions };
            walk(&route, points, view.tables.distance_words, &mut self.metres);
        }
    }
}

vectorised! {
    /// Metres to the side of the work volume.
    fn walls(volume: &Volume, at: &[Block], directions: &[Block], metres: &mut [Lane]) {
        for ((at, ahead), exit) in at.iter().zip(directions).zip(metres) {
            let axes = [(&at.x, &ahead.x), (&at.y, &ahead.y), (&at.z, &ahead.z)];
            for ((at, ahead), half) in axes.into_iter().zip(volume.half) {
                for k in 0..LANES {
                    let t = (half.copysign(ahead[k]) - at[k]) / ahead[k];
                    // 0 / 0 is NaN, and not nearer.
                    exit[k] = either(t < exit[k], t, exit[k]);
                }
            }
            for exit in exit {
                *exit = either(*exit > 0.0, *exit, 0.0);
            }
        }
    }
}

vectorised! {
    /// Adds the points that do not surely stay on subject pixels of the view up to their exits so far, but for those
    /// that it decided.
    fn doubt(route: &Route, metres: &[Lane], doubtful: &mut Vec<u32>) {
        let Route { view, place, pool, directions } = route;
        for (block, (direction, metres)) in directions.iter().zip(metres).enumerate() {
            let clear = stays_clear(view, pool.sighting(block, *place), &view.changes(direction), metres);
            let doubts = pool.filled(block) & !clear & !pool.decisions[block].by(*place);
            doubtful.extend(ones(doubts).map(|lane| (block * LANES + lane) as u32));
        }
    }
}

/// Which lines surely stay on subject pixels up to their exits: those whose start and end lie in squares of subject
/// pixels that meet.
#[inline(always)]
fn stays_clear(view: &Folded, sighting: &Sighting, changes: &Homogeneous, exit: &Lane) -> u32 {
    let distances = view.distances();
    let [right, below] = view.last_pixel();
    let mut clear = [0_u32; LANES];
    for k in 0..LANES {
        let t = exit[k] * sighting.per_depth[k];
        let depth = t.mul_add(changes.depth[k], 1.0);
        let per_depth = 1.0 / depth;
        let u = t.mul_add(changes.u[k], sighting.u[k]) * per_depth;
        let v = t.mul_add(changes.v[k], sighting.v[k]) * per_depth;
        let end = distances.at(whole(u, right), whole(v, below)) as f32;
        // From a point to its square's side it is at least one pixel less than the distance says.
        let meet = (sighting.clear[k] - 1.0) + (end - 1.0);
        let (du, dv) = ((u - sighting.u[k]).abs(), (v - sighting.v[k]).abs());
        clear[k] = u32::from((depth > 0.0) & (end > 0.0) & (du <= meet) & (dv <= meet));
    }
    bits(&clear)
}
