//! The look-up tables that are derived from a silhouette's mask.

use super::boundary::Boundary;
use super::cell_distance::CellDistances;
use super::distance::DistanceTable;
use super::edge_table::EdgeTable;
use super::mask_crop::{MaskCrop, Word};
use super::occupancy::Occupancy;
use super::transposed::Transposed;

/// The tables derived from the crop of a mask. They take nine tenths of a silhouette's memory.
#[derive(Debug, Default)]
pub(crate) struct Tables {
    pub(super) boundary: Boundary,
    pub(super) transposed: Transposed,
    pub(super) occupancy: Occupancy,
    pub(super) distances: DistanceTable,
    pub(super) cell_distances: CellDistances,
    pub(super) edges: EdgeTable,
}

/// The tables over a silhouette's crop, borrowed as row-major slices for queries of many points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableSlices<'a> {
    /// Column and row in the image of the crop's first pixel.
    pub(crate) corner: (i32, i32),
    /// Columns of the crop.
    pub(crate) width: usize,
    /// Rows of the crop.
    pub(crate) height: usize,
    /// Words in a row of bits.
    pub(crate) words: usize,
    /// Subject pixels, 32 per word, the first in the lowest bit.
    pub(crate) subject: &'a [Word],
    /// Subject pixels and the eight pixels around each, as `subject`.
    pub(crate) dilated: &'a [Word],
    transposed: &'a Transposed,
    /// Chebyshev distances, four per word in the order of memory; 255 stands for all above 254.
    pub(crate) distance_words: &'a [u32],
    /// Distances of the cells between four pixel centres, as `distance_words`; empty for a mask without coverage.
    pub(crate) cell_distance_words: &'a [u32],
    /// The mask's bytes; empty if each is 0 or 255.
    pub(crate) coverage: &'a [u8],
    pub(crate) occupancy: &'a Occupancy,
}

impl Tables {
    /// Derives the tables of `crop` in new memory.
    pub(super) fn new(crop: &MaskCrop) -> Self {
        let mut tables = Self::default();
        // The tables of an empty crop are the empty ones.
        if !crop.rect().is_empty() {
            tables.fill(crop);
        }
        tables
    }

    /// Derives the tables of `crop` in the memory of the last ones.
    pub(super) fn fill(&mut self, crop: &MaskCrop) {
        self.boundary.fill(crop);
        self.transposed.invalidate();
        self.occupancy.fill(crop);
        self.distances.fill(crop, &self.occupancy);
        self.cell_distances.fill(crop, &self.distances);
        self.edges.fill(&self.boundary);
    }

    /// The slices for queries of many points. `crop` is the one that the tables were derived from.
    pub(super) fn slices<'a>(&'a self, crop: &'a MaskCrop) -> TableSlices<'a> {
        let rect = crop.rect();

        TableSlices {
            corner: (rect.x0, rect.y0),
            width: rect.width(),
            height: rect.height(),
            words: crop.words(),
            subject: crop.subject(),
            dilated: self.boundary.dilated(),
            transposed: &self.transposed,
            distance_words: self.distances.narrow_words(),
            cell_distance_words: self.cell_distances.narrow_words(),
            coverage: crop.bytes(),
            occupancy: &self.occupancy,
        }
    }

    /// Bytes of memory of the tables.
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
    /// Subject pixels, column-major, and the number of words in a column.
    pub(crate) fn columns(&self) -> (&'a [Word], usize) {
        self.transposed.columns(self.subject, self.words)
    }
}
