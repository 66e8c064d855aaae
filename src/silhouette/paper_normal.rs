//! The normal of the paper (section 4.2) at the edge of a silhouette.

use super::Silhouette;
use super::edge::SHORTEST_MEAN;
use nalgebra::Vector2;

impl Silhouette {
    /// The paper's normal (section 4.2) at background pixel `(i, j)`: the mean vector from there to the background
    /// pixels of the 5x5 window around, of 7x7 or 9x9 where that mean is short; `None` where all are.
    pub fn paper_normal(&self, i: i32, j: i32) -> Option<Vector2<f64>> {
        [2, 3, 4].into_iter().find_map(|half| {
            let (x, y, count) = self.paper_sum(i, j, half);
            let mean = Vector2::new(f64::from(x), f64::from(y)) / f64::max(f64::from(count), 1.0);
            (mean.norm() >= SHORTEST_MEAN).then(|| mean.normalize())
        })
    }

    /// The sum of the vectors from `(i, j)` to the background pixels of the window around, and their number: whole
    /// numbers, exact in any order.
    #[inline(always)]
    fn paper_sum(&self, i: i32, j: i32, half: i32) -> (i32, i32, i32) {
        let rect = self.crop.rect();
        if !rect.contains(i - half, j - half) || !rect.contains(i + half, j + half) {
            return self.paper_sum_anywhere(i, j, half);
        }
        let rows = self.crop.rows_from(i - half, j - half);
        let (mut x, mut y, mut count) = (0, 0, 0);
        for dy in -half..=half {
            let (pixels, offsets) = sums(!rows.row(dy + half) & ((2 << (2 * half)) - 1));
            x += offsets - half * pixels;
            y += dy * pixels;
            count += pixels;
        }
        (x, y, count)
    }

    #[cold]
    fn paper_sum_anywhere(&self, i: i32, j: i32, half: i32) -> (i32, i32, i32) {
        let offsets = (-half..=half).flat_map(|dy| (-half..=half).map(move |dx| (dx, dy)));
        let background = offsets.filter(|(dx, dy)| !self.is_subject(i + dx, j + dy));
        background.fold((0, 0, 0), |(x, y, count), (dx, dy)| (x + dx, y + dy, count + 1))
    }
}

/// How many of the low nine bits are set, and the sum of their positions.
#[inline(always)]
fn sums(bits: u32) -> (i32, i32) {
    const TABLE: [(u8, u8); 512] = {
        let mut table = [(0, 0); 512];
        let mut bits = 0;
        while bits < 512 {
            let mut place = 0;
            while place < 9 {
                if bits >> place & 1 == 1 {
                    table[bits].0 += 1;
                    table[bits].1 += place;
                }
                place += 1;
            }
            bits += 1;
        }
        table
    };
    let (count, places) = TABLE[(bits & 511) as usize];
    (i32::from(count), i32::from(places))
}
