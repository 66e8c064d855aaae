//! The tables that follow from a silhouette's bits, and that queries look up.

use super::cell_distance::CellDistances;
use super::distance::DistanceTable;
use super::edge_table::EdgeTable;
use super::neighbours::Neighbours;
use super::region::{Region, Word};
use super::tiles::Tiles;
use super::turned::Turned;

/// All that can be derived again from the region alone, which is nine tenths of a silhouette's memory.
#[derive(Debug, Default)]
pub(crate) struct Tables {
    pub(super) neighbours: Neighbours,
    pub(super) turned: Turned,
    pub(super) tiles: Tiles,
    pub(super) distances: DistanceTable,
    pub(super) cell_distances: CellDistances,
    pub(super) edges: EdgeTable,
}

/// The tables over a silhouette's region, borrowed as slices for queries of many points: row-major.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableSlices<'a> {
    /// Column and row of the first pixel.
    pub(crate) corner: (i32, i32),
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Words in a row of bits.
    pub(crate) words: usize,
    /// Subject pixels, 32 a word, the first in the lowest bit.
    pub(crate) subject: &'a [Word],
    /// Subject pixels and those around each.
    pub(crate) near: &'a [Word],
    turned: &'a Turned,
    /// Chebyshev distances, four a word as they lie in memory; 255 for all that are larger than 254.
    pub(crate) distance_words: &'a [u32],
    /// Distances of the squares between four pixel centres likewise, where the mask carries coverage.
    pub(crate) cell_distance_words: &'a [u32],
    /// The mask's bytes; none where each is 0 or 255.
    pub(crate) coverage: &'a [u8],
    pub(crate) tiles: &'a Tiles,
}

impl Tables {
    /// Derives the tables of `region` in new memory.
    pub(super) fn new(region: &Region) -> Self {
        let mut tables = Self::default();
        // A silhouette of no image has no bits, and its tables are the empty ones.
        if !region.rect().is_empty() {
            tables.fill(region);
        }
        tables
    }

    /// Derives the tables of `region` in the memory of these ones.
    pub(super) fn fill(&mut self, region: &Region) {
        self.neighbours.fill(region);
        self.turned.clear();
        self.tiles.fill(region);
        self.distances.fill(region, &self.tiles);
        self.cell_distances.fill(region, &self.distances);
        self.edges.fill(&self.neighbours);
    }

    /// The slices for queries of many points; `region` is the one that the tables were derived from.
    pub(super) fn slices<'a>(&'a self, region: &'a Region) -> TableSlices<'a> {
        let rect = region.rect();
        TableSlices {
            corner: (rect.x0, rect.y0),
            width: rect.width(),
            height: rect.height(),
            words: region.words(),
            subject: region.subject(),
            near: self.neighbours.near(),
            turned: &self.turned,
            distance_words: self.distances.narrow_words(),
            cell_distance_words: self.cell_distances.narrow_words(),
            coverage: region.bytes(),
            tiles: &self.tiles,
        }
    }

    /// Bytes of memory behind the tables.
    pub(super) fn working_memory(&self) -> usize {
        self.neighbours.working_memory()
            + self.turned.working_memory()
            + self.tiles.working_memory()
            + self.distances.working_memory()
            + self.cell_distances.working_memory()
            + self.edges.working_memory()
    }
}

impl<'a> TableSlices<'a> {
    /// Subject pixels by columns, column-major, and how many words a column has.
    pub(crate) fn columns(&self) -> (&'a [Word], usize) {
        self.turned.columns(self.subject, self.words)
    }
}
