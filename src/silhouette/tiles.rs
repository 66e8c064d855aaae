//! Which squares of 8 x 8 pixels hold subject, summed up, so that any rectangle is asked in four look-ups.

use super::Rect;
use super::region::{Region, WORD};

/// Pixels on a tile's side.
const SIDE: usize = 8;

/// Tiles with subject above and left of each corner of the tiles, row-major.
#[derive(Debug, Default)]
pub(crate) struct Tiles {
    sums: Vec<u32>,
    columns: usize,
}

impl Tiles {
    pub(super) fn fill(&mut self, region: &Region) {
        let (width, words) = (region.rect().width(), region.words());
        self.columns = width / SIDE;
        let stride = self.columns + 1;
        self.sums.clear();
        self.sums.resize(stride, 0);
        if words == 0 {
            return;
        }
        for rows in region.subject().chunks(SIDE * words) {
            let mut sum = 0;
            self.sums.push(0);
            for k in 0..words {
                let any = rows.iter().skip(k).step_by(words).fold(0, |any, word| any | word);
                for tile in
                    any.to_le_bytes().into_iter().take((self.columns - k * WORD / SIDE).min(WORD / SIDE))
                {
                    sum += u32::from(tile != 0);
                    self.sums.push(self.sums[self.sums.len() - stride] + sum);
                }
            }
        }
    }

    /// Whether a tile that `part`, in pixels from the region's corner, touches holds subject.
    pub(crate) fn any(&self, part: &Rect) -> bool {
        let stride = self.columns + 1;
        let rows = self.sums.len() / stride;
        let clip = |pixel: i32, most: usize| (pixel.max(0) as usize).min(most);
        let (x0, x1) = (clip(part.x0, usize::MAX) / SIDE, clip(part.x1, usize::MAX).div_ceil(SIDE));
        let (y0, y1) = (clip(part.y0, usize::MAX) / SIDE, clip(part.y1, usize::MAX).div_ceil(SIDE));
        let (x1, y1) = (x1.min(self.columns), y1.min(rows.saturating_sub(1)));
        if x0 >= x1 || y0 >= y1 {
            return false;
        }
        let sum = |x: usize, y: usize| self.sums[y * stride + x];
        sum(x1, y1) + sum(x0, y0) > sum(x1, y0) + sum(x0, y1)
    }

    /// Bytes of memory behind the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.sums.capacity()
    }
}
