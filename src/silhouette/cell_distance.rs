//! Distances of the squares between four pixel centres, in which coverage is bilinear: the least of the four pixels'.

use super::distance::DistanceTable;
use super::mask_crop::MaskCrop;
use crate::math::vectorised;

/// Distances over a region with coverage, by the upper left of the four pixels; none without.
#[derive(Debug, Default)]
pub(super) struct CellDistances {
    /// Up to 254, four a word as they lie in memory; 255 stands for more.
    narrow: Vec<u32>,
    stride: usize,
}

impl CellDistances {
    pub(super) fn fill(&mut self, region: &MaskCrop, pixels: &DistanceTable) {
        self.stride = region.rect().width();
        if !region.has_coverage() || self.stride == 0 {
            return self.narrow.clear();
        }
        let pixels = pixels.narrow();
        self.narrow.resize(pixels.len().div_ceil(4), 0);
        least_of_four(pixels, self.stride, bytemuck::cast_slice_mut(&mut self.narrow));
    }

    /// The distances, four a word.
    pub(super) fn narrow_words(&self) -> &[u32] {
        &self.narrow
    }

    /// The distance at a place of the table, however large.
    pub(super) fn at(&self, place: usize, pixels: &DistanceTable) -> u16 {
        let corners = [place, place + 1, place + self.stride, place + self.stride + 1];
        corners.into_iter().map(|place| pixels.at(place)).min().unwrap_or(0)
    }

    /// Bytes of memory behind the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.narrow.capacity()
    }
}

vectorised! {
    /// Writes the least distance of the pixels at each place, beside it, below, and beside that.
    fn least_of_four(pixels: &[u8], stride: usize, cells: &mut [u8]) {
        let count = pixels.len() - stride - 1;
        let [here, right, below, diagonal] = [0, 1, stride, stride + 1].map(|offset| &pixels[offset..][..count]);
        for (k, cell) in cells[..count].iter_mut().enumerate() {
            *cell = here[k].min(right[k]).min(below[k].min(diagonal[k]));
        }
        // The last row's pixels have none below.
        cells[count..].fill(0);
    }
}
