//! The tables that follow from a silhouette's bits, and that queries look up.

use super::boundary::Boundary;
use super::cell_distance::CellDistances;
use super::distance::DistanceTable;
use super::edge_table::EdgeTable;
use super::mask_crop::{MaskCrop, Word};
use super::occupancy::Occupancy;
use super::transposed::Transposed;

/// All that can be derived again from the region alone, which is nine tenths of a silhouette's memory.
#[derive(Debug, Default)]
pub(crate) struct Tables {
    pub(super) boundary: Boundary,
    pub(super) transposed: Transposed,
    pub(super) occupancy: Occupancy,
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
    pub(crate) dilated: &'a [Word],
    transposed: &'a Transposed,
    /// Chebyshev distances, four a word as they lie in memory; 255 for all that are larger than 254.
    pub(crate) distance_words: &'a [u32],
    /// Distances of the squares between four pixel centres likewise, where the mask carries coverage.
    pub(crate) cell_distance_words: &'a [u32],
    /// The mask's bytes; none where each is 0 or 255.
    pub(crate) coverage: &'a [u8],
    pub(crate) occupancy: &'a Occupancy,
}

impl Tables {
    /// Derives the tables of `region` in new memory.
    pub(super) fn new(region: &MaskCrop) -> Self {
        let mut tables = Self::default();
        // A silhouette of no image has no bits, and its tables are the empty ones.
        if !region.rect().is_empty() {
            tables.fill(region);
        }
        tables
    }

    /// Derives the tables of `region` in the memory of these ones.
    pub(super) fn fill(&mut self, region: &MaskCrop) {
        self.boundary.fill(region);
        self.transposed.invalidate();
        self.occupancy.fill(region);
        self.distances.fill(region, &self.occupancy);
        self.cell_distances.fill(region, &self.distances);
        self.edges.fill(&self.boundary);
    }

    /// The slices for queries of many points; `region` is the one that the tables were derived from.
    pub(super) fn slices<'a>(&'a self, region: &'a MaskCrop) -> TableSlices<'a> {
        let rect = region.rect();
        TableSlices {
            corner: (rect.x0, rect.y0),
            width: rect.width(),
            height: rect.height(),
            words: region.words(),
            subject: region.subject(),
            dilated: self.boundary.dilated(),
            transposed: &self.transposed,
            distance_words: self.distances.narrow_words(),
            cell_distance_words: self.cell_distances.narrow_words(),
            coverage: region.bytes(),
            occupancy: &self.occupancy,
        }
    }

    /// Bytes of memory behind the tables.
    pub(super) fn working_memory(&self) -> usize {
        self.boundary.working_memory()
            + self.transposed.working_memory()
            + self.occupancy.working_memory()
            + self.distances.working_memory()
            + self.cell_distances.working_memory()
            + self.edges.working_memory()
    }
}

impl<'a> TableSlices<'a> {
    /// Subject pixels by columns, column-major, and how many words a column has.
    pub(crate) fn columns(&self) -> (&'a [Word], usize) {
        self.transposed.columns(self.subject, self.words)
    }
}
