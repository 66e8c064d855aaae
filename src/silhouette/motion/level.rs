//! One level of the pyramid of two distance images: both images, the later one's gradient, and the flow between them.

use super::cell_means::{CELL, CELL_REACH};
use super::distance_image::DistanceImage;
use super::patch::PATCH;
use crate::silhouette::Rect;

/// Cells around an image that repeat its outermost ones, so that no patch has to be cut off.
pub(super) const PAD: usize = PATCH;

/// Cells of a coarser level's padding that the padding of the finer one tells, also where its size is odd.
const PADDED: usize = PAD / 2 - 1;

/// The images of one level, padded by [`PAD`] cells on each side, and the flow without padding.
#[derive(Debug, Default)]
pub(super) struct Level {
    /// Cells in a row and rows, without the padding.
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) earlier: Vec<f32>,
    pub(super) later: Vec<f32>,
    /// The gradient of `later`, per cell.
    pub(super) gradient: [Vec<f32>; 2],
    /// The motion from `later` to `earlier`, right and down, in cells.
    pub(super) flow: [Vec<f32>; 2],
}

impl Level {
    /// Cells in a row with the padding.
    pub(super) fn stride(&self) -> usize {
        self.width + 2 * PAD
    }

    /// Copies the cells of two images that lie in `rect`, which is a multiple of cells.
    pub(super) fn fill(&mut self, rect: &Rect, earlier: &DistanceImage, later: &DistanceImage) {
        let side = CELL as usize;
        self.resize(rect.width() / side, rect.height() / side);
        let stride = self.stride();
        for (padded, image) in [(&mut self.earlier, earlier), (&mut self.later, later)] {
            padded.fill(CELL_REACH as f32);
            let own = image.cell_rect;
            if own.is_empty() {
                continue;
            }
            let (left, top) = ((own.x0 - rect.x0) as usize / side, (own.y0 - rect.y0) as usize / side);
            let columns = own.width() / side;
            for (y, row) in image.cells.chunks_exact(columns).enumerate() {
                let first = (y + top + PAD) * stride + left + PAD;
                padded[first..][..columns].copy_from_slice(row);
            }
        }
        self.finish(0);
    }

    /// Averages the images of a level whose cells are half as large.
    pub(super) fn halve(&mut self, finer: &Self) {
        self.resize(finer.width.div_ceil(2), finer.height.div_ceil(2));
        let (stride, fine_stride) = (self.stride(), finer.stride());
        // Half of the padding too: the outermost cells may hold an edge, behind which the finer level ends.
        let first = PAD - PADDED;
        let fine_first = PAD - 2 * PADDED;
        for (coarse, fine) in [(&mut self.earlier, &finer.earlier), (&mut self.later, &finer.later)] {
            for y in 0..self.height + 2 * PADDED {
                let rows = [0, 1].map(|k| {
                    &fine[(2 * y + k + fine_first) * fine_stride + fine_first..]
                        [..2 * (self.width + 2 * PADDED)]
                });
                let cells = &mut coarse[(y + first) * stride + first..][..self.width + 2 * PADDED];
                for (x, cell) in cells.iter_mut().enumerate() {
                    *cell =
                        0.25 * (rows[0][2 * x] + rows[0][2 * x + 1] + rows[1][2 * x] + rows[1][2 * x + 1]);
                }
            }
        }
        self.finish(PADDED);
    }

    fn resize(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        let padded = self.stride() * (height + 2 * PAD);
        for image in [&mut self.earlier, &mut self.later].into_iter().chain(&mut self.gradient) {
            image.resize(padded, 0.0);
        }
        for component in &mut self.flow {
            component.resize(width * height, 0.0);
        }
    }

    /// Fills the padding but for its innermost `padded` cells, and computes the gradient.
    fn finish(&mut self, padded: usize) {
        if self.width == 0 {
            return;
        }
        let stride = self.stride();
        for image in [&mut self.earlier, &mut self.later] {
            repeat_border(image, stride, PAD - padded);
        }

        let [right, down] = &mut self.gradient;
        for k in stride..self.later.len() - stride {
            right[k] = 0.5 * (self.later[k + 1] - self.later[k - 1]);
            down[k] = 0.5 * (self.later[k + stride] - self.later[k - stride]);
        }
    }

    /// Begins with the flow of a coarser level; without one, with none.
    pub(super) fn start_from(&mut self, coarser: Option<&Self>) {
        for (own, coarse) in self.flow.iter_mut().zip(0..) {
            match coarser {
                Some(level) => {
                    for (y, row) in own.chunks_exact_mut(self.width.max(1)).enumerate() {
                        let coarse = &level.flow[coarse][y / 2 * level.width..][..level.width];
                        row.iter_mut().enumerate().for_each(|(x, motion)| *motion = 2.0 * coarse[x / 2]);
                    }
                }
                None => own.fill(0.0),
            }
        }
    }

    /// Copies the flow, in cells.
    pub(super) fn write_flow(&self, right: &mut Vec<f32>, down: &mut Vec<f32>) {
        right.clone_from(&self.flow[0]);
        down.clone_from(&self.flow[1]);
    }
}

/// Repeats the cells of an image within `padding` cells of its end into these.
fn repeat_border(image: &mut [f32], stride: usize, padding: usize) {
    let rows = image.len() / stride - 2 * padding;
    for row in image.chunks_exact_mut(stride).skip(padding).take(rows) {
        let (first, last) = (row[padding], row[stride - padding - 1]);
        row[..padding].fill(first);
        row[stride - padding..].fill(last);
    }
    for y in 0..padding {
        image.copy_within(padding * stride..(padding + 1) * stride, y * stride);
        let last = (padding + rows - 1) * stride;
        image.copy_within(last..last + stride, (padding + rows + y) * stride);
    }
}
