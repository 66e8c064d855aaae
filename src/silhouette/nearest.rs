//! The nearest background pixel to a single pixel, found ring by ring as the paper grows its window (section 4.2).

use super::{NO_EDGE, Silhouette};

impl Silhouette {
    /// The background pixel nearest to pixel `(i, j)` within the window of half-width `half`, by Euclidean distance.
    /// Ties go to the first in row-major order.
    pub fn nearest_background(&self, i: i32, j: i32, half: i32) -> Option<(i32, i32)> {
        let first_radius = match self.distance(i, j) {
            0 => return Some((i, j)),
            NO_EDGE => return None,
            distance => i32::from(distance),
        };

        // Ordered by squared distance, row and column.
        let mut best: Option<(i64, i32, i32)> = None;
        let mut radius = first_radius;
        // All pixels of a ring are at least as far as its Chebyshev radius.
        while radius <= half && best.is_none_or(|(squared, ..)| i64::from(radius).pow(2) <= squared) {
            let background = ring(radius).filter(|&(dx, dy)| !self.is_subject(i + dx, j + dy));
            let ranked = background.map(|(dx, dy)| (squared_length(dx, dy), j + dy, i + dx));
            best = best.into_iter().chain(ranked).min();
            radius += 1;
        }
        best.map(|(_, y, x)| (x, y))
    }
}

/// The offsets at a Chebyshev distance.
fn ring(radius: i32) -> impl Iterator<Item = (i32, i32)> {
    (-radius..=radius).flat_map(move |dy| {
        // Rows between the upper and the lower side belong to the ring only with their two ends.
        let is_side = dy.abs() == radius;
        let step = if is_side { 1 } else { 2 * radius };
        (-radius..=radius).step_by(step as usize).map(move |dx| (dx, dy))
    })
}

fn squared_length(dx: i32, dy: i32) -> i64 {
    i64::from(dx).pow(2) + i64::from(dy).pow(2)
}
