//! Which squares of 8 x 8 pixels hold subject, summed up, so that any rectangle is asked in four look-ups.

use super::region::{LOW, Region, WORD};

/// Pixels on a tile's side.
const SIDE: usize = 8;

/// Tiles with subject above and left of each corner of the tiles, row-major.
#[derive(Debug, Default)]
pub(crate) struct Tiles {
    sums: Vec<u32>,
    columns: usize,
    rows: usize,
}

impl Tiles {
    pub(super) fn fill(&mut self, region: &Region) {
        let (width, words) = (region.rect().width(), region.words());
        self.columns = width / SIDE;
        let stride = self.columns + 1;
        self.sums.clear();
        self.sums.resize(stride, 0);
        self.rows = 0;
        if words == 0 {
            return;
        }
        for rows in region.subject().chunks(SIDE * words) {
            let mut sum = 0;
            self.rows += 1;
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

    /// The table, to be looked up many times.
    #[inline(always)]
    pub(crate) fn lookup(&self) -> Lookup<'_> {
        let sums: &[u32] = if self.sums.is_empty() { &[0] } else { &self.sums };
        let last = (sums.len() - 1) as u32 & LOW;
        let (columns, rows) = (self.columns as u32, self.rows as u32);
        Lookup { sums: &sums[..=last as usize], last, columns, rows }
    }

    /// Bytes of memory behind the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.sums.capacity()
    }
}

/// Tiles as many lanes look them up: without a branch, and with indices of which a vector holds many.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lookup<'a> {
    sums: &'a [u32],
    last: u32,
    columns: u32,
    rows: u32,
}

impl Lookup<'_> {
    /// Whether a tile that the pixels `from..to` touch, counted from the region's corner, holds subject; `to` is not
    /// less than `from`.
    #[inline(always)]
    pub(crate) fn any(&self, from: [u32; 2], to: [u32; 2]) -> bool {
        let side = SIDE as u32;
        let (x0, x1) = ((from[0] / side).min(self.columns), to[0].div_ceil(side).min(self.columns));
        let (y0, y1) = ((from[1] / side).min(self.rows), to[1].div_ceil(side).min(self.rows));
        let sum = |x: u32, y: u32| self.sums[(y * (self.columns + 1) + x).min(self.last) as usize];
        sum(x1, y1) + sum(x0, y0) > sum(x1, y0) + sum(x0, y1)
    }
}
