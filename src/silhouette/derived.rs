//! What follows from a silhouette's bits: the tables that queries look up.

use super::distance::DistanceTable;
use super::edge::EdgeTable;
use super::neighbours::Neighbours;
use super::region::Region;
use super::tiles::Tiles;
use super::turned::Turned;

/// All that can be made again from the region alone. Most of a silhouette's memory, which goes from one that nobody
/// asks to the next.
#[derive(Debug, Default)]
pub(crate) struct Derived {
    pub(super) neighbours: Neighbours,
    pub(super) turned: Turned,
    pub(super) tiles: Tiles,
    pub(super) distances: DistanceTable,
    pub(super) edges: EdgeTable,
}

impl Derived {
    pub(super) fn fill(&mut self, region: &Region) {
        self.neighbours.fill(region);
        self.turned.clear();
        self.tiles.fill(region);
        self.distances.fill(region, &self.tiles);
        self.edges.fill(&self.neighbours);
    }

    /// Bytes of memory behind the tables.
    pub(super) fn working_memory(&self) -> usize {
        self.neighbours.working_memory()
            + self.turned.working_memory()
            + self.tiles.working_memory()
            + self.distances.working_memory()
            + self.edges.working_memory()
    }
}
