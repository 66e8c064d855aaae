//! The paper's responses of the points of a pool (section 4.2).

use super::super::points::{Block, LANES, Lane};
use super::edge;
use super::exit::Exits;
use super::fold::Folded;
use super::folded_hull::FoldedHull;
use super::lookup::Distances;
use super::pool::Pool;
use super::walk::{Party, Walks};
use crate::vectorised::vectorised;
use nalgebra::Vector3;

/// Responses, with the world's axes.
#[derive(Debug, Default)]
pub(super) struct Responses {
    normals: Vec<Block>,
    exits: Exits,
}

/// The response of one point.
#[derive(Debug, Clone, Copy)]
pub(super) struct WayOut {
    /// Unit outward normal.
    pub(super) normal: Vector3<f32>,
    /// Metres along it to the exit.
    pub(super) depth: f32,
}

impl Responses {
    /// Finds the ways out of all points of `pool`.
    pub(super) fn fill(&mut self, hull: &FoldedHull, pool: &mut Pool) {
        // Each point gets one.
        self.normals.resize(pool.at.len(), Block::default());
        if !hull.hull.every_view_tells() {
            self.normals.fill(Block::default());
            self.fill_one_by_one(hull, pool);
            return;
        }
        pool.survey(&hull.views);
        self.exits.start(pool);
        for (place, view) in hull.views.iter().enumerate() {
            leave(view, place, pool, view.tables.distance_words, &mut self.normals, self.exits.metres());
        }
        self.exits.lower(&hull.views, &hull.volume, pool, &self.normals);
    }

    /// The way out of a point; `None` where no view has an edge.
    #[inline(always)]
    pub(super) fn get(&self, point: usize) -> Option<WayOut> {
        let normal = Vector3::from(self.normals[point / LANES].get(point % LANES));
        (normal != Vector3::zeros()).then(|| WayOut { normal, depth: self.exits.get(point) })
    }

    /// What a view's silence means, the single queries weigh.
    fn fill_one_by_one(&mut self, hull: &FoldedHull, pool: &mut Pool) {
        pool.decisions.resize(pool.at.len(), Default::default());
        self.exits.start(pool);
        for point in 0..pool.len() {
            let (block, lane) = (point / LANES, point % LANES);
            let p = hull.volume.in_world(pool.at[block].get(lane));
            let Some(response) = hull.hull.respond(&p) else { continue };
            let views = hull.hull.views();
            let nearest = |view: &Folded| std::ptr::eq(&views[view.index], response.nearest.view);
            let place = hull.views.iter().position(nearest);
            pool.decisions[block].view[lane] = place.unwrap_or(0) as u32;
            self.normals[block].set(lane, response.normal.cast::<f32>().into());
            self.exits.set(point, response.depth as f32);
        }
    }
}

vectorised! {
    /// Finds the normals of the points that `view`, at `place` among all, decides, and walks along them until it sees
    /// background; its distances come as a slice of their own, to which nothing here writes.
    fn leave(
        view: &Folded,
        place: usize,
        pool: &Pool,
        distance_words: &[u32],
        normals: &mut [Block],
        metres: &mut [Lane],
    ) {
        let table = Distances::new(distance_words, view.tables.width);
        let mut walks = Walks::new();
        for points in pool.decided_by(place).chunks(LANES) {
            let (sighting, half) = (pool.sightings_of(points, place), pool.halves_of(points));
            let normal = edge::normals(view, &sighting, &half);
            for (k, &point) in points.iter().enumerate() {
                normals[point as usize / LANES].set(point as usize % LANES, normal.get(k));
            }
            let most = &[f32::INFINITY; LANES];
            let party = Party { view, points, start: &sighting, direction: &normal, most };
            walks.set_out(&party, &table, metres);
        }
        walks.finish(&table, metres);
    }
}
