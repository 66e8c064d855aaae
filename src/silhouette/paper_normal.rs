//! The paper's normal at the edge of a silhouette (section 4.2).

use super::Silhouette;
use super::edge::SHORTEST_MEAN;
use nalgebra::Vector2;

impl Silhouette {
    /// The paper's normal (section 4.2) at background pixel `(i, j)`: the unit mean vector from the pixel to the
    /// background pixels of its 5x5 window. If that mean is too short, the window grows to 7x7 and 9x9; `None` if all
    /// three means are too short.
    pub fn paper_normal(&self, i: i32, j: i32) -> Option<Vector2<f64>> {
        [2, 3, 4].into_iter().find_map(|half| {
            let (x, y, count) = self.paper_sum(i, j, half);
            let mean = Vector2::new(f64::from(x), f64::from(y)) / f64::max(f64::from(count), 1.0);
            (mean.norm() >= SHORTEST_MEAN).then(|| mean.normalize())
        })
    }

    /// The sum of the vectors from `(i, j)` to the background pixels in its window of half-width `half`, and their
    /// number. These are integers, so that the order of summation does not matter.
    #[inline(always)]
    fn paper_sum(&self, i: i32, j: i32, half: i32) -> (i32, i32, i32) {
        let rect = self.crop.rect();
        if !rect.contains(i - half, j - half) || !rect.contains(i + half, j + half) {
            return self.paper_sum_anywhere(i, j, half);
        }

        let rows = self.crop.rows_from(i - half, j - half);
        let (mut x, mut y, mut count) = (0, 0, 0);
        for dy in -half..=half {
            // Columns count from the left side of the window.
            let (pixels, columns) = sums(!rows.row(dy + half) & ((2 << (2 * half)) - 1));
            x += columns - half * pixels;
            y += dy * pixels;
            count += pixels;
        }
        (x, y, count)
    }

    /// [`Self::paper_sum`] pixel by pixel, for windows that leave the crop.
    #[cold]
    fn paper_sum_anywhere(&self, i: i32, j: i32, half: i32) -> (i32, i32, i32) {
        let offsets = (-half..=half).flat_map(|dy| (-half..=half).map(move |dx| (dx, dy)));
        let background = offsets.filter(|(dx, dy)| !self.is_subject(i + dx, j + dy));
        background.fold((0, 0, 0), |(x, y, count), (dx, dy)| (x + dx, y + dy, count + 1))
    }
}

/// The number of the low nine bits that are set, and the sum of their positions.
#[inline(always)]
fn sums(bits: u32) -> (i32, i32) {
    const TABLE: [(u8, u8); 512] = {
        let mut table = [(0, 0); 512];
        let mut bits = 0;
        while bits < 512 {
            let mut position = 0;
            while position < 9 {
                if bits >> position & 1 == 1 {
                    table[bits].0 += 1;
                    table[bits].1 += position;
                }
                position += 1;
            }
            bits += 1;
        }
        table
    };

    let (count, positions) = TABLE[(bits & 511) as usize];
    (i32::from(count), i32::from(positions))
}
