//! Connected regions of binary images, by union-find over the runs of their rows.

use super::bit_image::{BitImage, WORD};

/// The set pixels `start..end` of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) row: u32,
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// The regions of a binary image, in reused buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Regions {
    runs: Vec<Run>,
    /// The index of each row's first run, and the number of runs.
    rows: Vec<usize>,
    /// For each run an earlier run of its region, or itself.
    parents: Vec<u32>,
    /// For each run that is its own parent, the area of its region in pixels.
    areas: Vec<u32>,
    /// For each run that is its own parent, whether its region reaches the image's border.
    at_border: Vec<bool>,
}

impl Regions {
    /// Drops each region of fewer than `area_px` pixels or less than `share` of the largest one's area. Diagonal
    /// neighbours are connected.
    pub(crate) fn drop_small(&mut self, bits: &mut BitImage, area_px: u32, share: f64) {
        self.find(bits, 0, 1);
        let most = self.areas.iter().copied().max().unwrap_or(0);
        let least = area_px.max((share * f64::from(most)).ceil() as u32);
        let small = |regions: &Self, root: usize| regions.areas[root] < least;
        self.flip(bits, small);
    }

    /// Fills each hole of fewer than `area_px` pixels. Diagonal neighbours are not connected, since two diagonals
    /// could cross otherwise; a region at the image's border is not a hole.
    pub(crate) fn fill_holes(&mut self, bits: &mut BitImage, area_px: u32) {
        self.find(bits, u64::MAX, 0);
        self.flip(bits, |regions, root| !regions.at_border[root] && regions.areas[root] < area_px);
    }

    /// The runs of the set pixels, row-major, each with the index of its region's first run. Diagonal neighbours are
    /// connected.
    #[cfg(feature = "ode")]
    pub(crate) fn runs_by_region(&mut self, bits: &BitImage) -> impl Iterator<Item = (Run, usize)> {
        self.find(bits, 0, 1);
        (0..self.runs.len()).map(|k| (self.runs[k], self.root(k)))
    }

    /// Finds the regions of the set pixels of `bits ^ invert`. Runs of neighbouring rows are connected if they share a
    /// column, or come within `reach` pixels of it.
    fn find(&mut self, bits: &BitImage, invert: u64, reach: u32) {
        self.list_runs(bits, invert);
        let count = self.runs.len();
        self.parents.clear();
        self.parents.extend(0..count as u32);

        // Traverse the runs of two neighbouring rows together.
        for y in 1..bits.height() {
            let (mut a, mut b) = (self.rows[y - 1], self.rows[y]);
            let (a_end, b_end) = (self.rows[y], self.rows[y + 1]);
            while a < a_end && b < b_end {
                let (above, below) = (self.runs[a], self.runs[b]);
                if above.start < below.end + reach && below.start < above.end + reach {
                    self.join(a, b);
                }
                if above.end < below.end { a += 1 } else { b += 1 }
            }
        }

        self.measure_regions(bits);
    }

    /// Lists the runs of all rows.
    fn list_runs(&mut self, bits: &BitImage, invert: u64) {
        self.runs.clear();
        self.rows.clear();
        for y in 0..bits.height() {
            self.rows.push(self.runs.len());
            let (row, width, last) = (bits.row(y), bits.width() as u32, bits.last_word());

            let mut open = None;
            for (k, &word) in row.iter().enumerate() {
                let within = if k + 1 == row.len() { last } else { u64::MAX };
                let word = (word ^ invert) & within;
                // Each change from one pixel to the next begins or ends a run.
                let mut changes = word ^ (word << 1 | u64::from(open.is_some()));
                while changes != 0 {
                    let x = (k * WORD) as u32 + changes.trailing_zeros();
                    open = match open {
                        None => Some(x),
                        Some(start) => {
                            self.runs.push(Run { row: y as u32, start, end: x });
                            None
                        }
                    };
                    changes &= changes - 1;
                }
            }

            if let Some(start) = open {
                self.runs.push(Run { row: y as u32, start, end: width });
            }
        }

        self.rows.push(self.runs.len());
    }

    /// The first run of `run`'s region; halves the path to it.
    fn root(&mut self, run: usize) -> usize {
        let mut at = run;
        while self.parents[at] as usize != at {
            let up = self.parents[self.parents[at] as usize];
            self.parents[at] = up;
            at = up as usize;
        }
        at
    }

    /// Unites the regions of two runs.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }

    /// Computes the regions' areas and whether they reach the border.
    fn measure_regions(&mut self, bits: &BitImage) {
        let count = self.runs.len();
        self.areas.clear();
        self.areas.resize(count, 0);
        self.at_border.clear();
        self.at_border.resize(count, false);

        for k in 0..count {
            let (run, root) = (self.runs[k], self.root(k));
            self.areas[root] += run.end - run.start;
            let at_edge = run.row == 0 || run.row as usize + 1 == bits.height();
            self.at_border[root] |= at_edge || run.start == 0 || run.end as usize == bits.width();
        }
    }

    /// Inverts the pixels of the regions for which `wanted` is true.
    fn flip(&mut self, bits: &mut BitImage, wanted: impl Fn(&Self, usize) -> bool) {
        for k in 0..self.runs.len() {
            let root = self.root(k);
            if !wanted(self, root) {
                continue;
            }

            let Run { row, start, end } = self.runs[k];
            bits.flip_run(row as usize, start as usize, end as usize);
        }
    }
}
