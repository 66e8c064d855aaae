//! Chebyshev distances of the cells between four pixel centres, in which coverage is bilinear: the least distance of
//! the four pixels.

use super::distance::DistanceTable;
use super::mask_crop::MaskCrop;
use crate::math::vectorised;

/// Cell distances over a crop in pixels, row-major by the upper left of the four pixels; empty without coverage.
#[derive(Debug, Default)]
pub(super) struct CellDistances {
    /// Distances up to 254, four per word in the order of memory; 255 stands for all above.
    narrow: Vec<u32>,
    /// Pixels in a row of the crop.
    stride: usize,
}

impl CellDistances {
    /// Computes the distances of a crop from the distances of its pixels.
    pub(super) fn fill(&mut self, crop: &MaskCrop, pixels: &DistanceTable) {
        self.stride = crop.rect().width();
        if !crop.has_coverage() || self.stride == 0 {
            return self.narrow.clear();
        }
        let pixels = pixels.narrow();
        self.narrow.resize(pixels.len().div_ceil(4), 0);
        least_of_four(pixels, self.stride, bytemuck::cast_slice_mut(&mut self.narrow));
    }

    /// The distances, four per word; 255 stands for all above 254.
    pub(super) fn narrow_words(&self) -> &[u32] {
        &self.narrow
    }

    /// The exact distance of the cell at a row-major index, also above 254.
    pub(super) fn at(&self, index: usize, pixels: &DistanceTable) -> u16 {
        let corners = [index, index + 1, index + self.stride, index + self.stride + 1];
        corners.into_iter().map(|corner| pixels.at(corner)).min().unwrap_or(0)
    }

    /// Bytes of memory of the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.narrow.capacity()
    }
}

vectorised! {
    /// Writes the least distance of each pixel and the pixels to its right, below it and below on the right.
    fn least_of_four(pixels: &[u8], stride: usize, cells: &mut [u8]) {
        let count = pixels.len() - stride - 1;
        let [here, right, below, diagonal] = [0, 1, stride, stride + 1].map(|offset| &pixels[offset..][..count]);
        for (k, cell) in cells[..count].iter_mut().enumerate() {
            *cell = here[k].min(right[k]).min(below[k].min(diagonal[k]));
        }
        // The last row has no pixels below it.
        cells[count..].fill(0);
    }
}
