//! The background pixel nearest to a pixel inside, for one pixel: ring by ring, as the paper grows its window.

use super::{NO_EDGE, Silhouette};

impl Silhouette {
    /// The background pixel nearest to `(i, j)` (Euclidean, then row-major) within the window of half-width `half`.
    pub fn nearest_background(&self, i: i32, j: i32, half: i32) -> Option<(i32, i32)> {
        let first = match self.distance(i, j) {
            0 => return Some((i, j)),
            NO_EDGE => return None,
            first => i32::from(first),
        };
        let mut best: Option<(i64, i32, i32)> = None;
        let mut radius = first;
        // The ring of this Chebyshev radius holds nothing that is nearer.
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
        let is_side = dy.abs() == radius;
        // Between the upper and the lower side only both ends of a row.
        let step = if is_side { 1 } else { 2 * radius };
        (-radius..=radius).step_by(step as usize).map(move |dx| (dx, dy))
    })
}

fn squared_length(dx: i32, dy: i32) -> i64 {
    i64::from(dx).pow(2) + i64::from(dy).pow(2)
}
