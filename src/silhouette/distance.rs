//! The exact Chebyshev distance from each subject pixel to the nearest background pixel.

use super::{Border, Rect};

/// The distance where no background exists: an open border and a silhouette without an edge.
pub(super) const NO_EDGE: u16 = u16::MAX;

/// Over `rect` of an image `image`: 0 for background, else the smallest `max(|di|, |dj|)` to a background pixel.
///
/// Two sweeps suffice, because the chessboard metric is the path metric of the eight neighbours: the first carries
/// distances down and right, the second up and left.
pub(super) fn chebyshev(
    image: &Rect,
    rect: &Rect,
    border: Border,
    is_subject: impl Fn(i32, i32) -> bool,
) -> Vec<u16> {
    let mut table: Vec<u16> = Vec::with_capacity(rect.width() * rect.height());
    let beyond = |i: i32, j: i32| match border {
        Border::Open if !image.contains(i, j) => NO_EDGE,
        _ => 0,
    };
    let at = |table: &[u16], i: i32, j: i32| {
        if rect.contains(i, j) { table[rect.index(i, j)] } else { beyond(i, j) }
    };
    for j in rect.y0..rect.y1 {
        for i in rect.x0..rect.x1 {
            let distance = if is_subject(i, j) {
                let above = at(&table, i - 1, j - 1).min(at(&table, i, j - 1)).min(at(&table, i + 1, j - 1));
                above.min(at(&table, i - 1, j)).saturating_add(1)
            } else {
                0
            };
            table.push(distance);
        }
    }
    for j in (rect.y0..rect.y1).rev() {
        for i in (rect.x0..rect.x1).rev() {
            let below = at(&table, i - 1, j + 1).min(at(&table, i, j + 1)).min(at(&table, i + 1, j + 1));
            let through = below.min(at(&table, i + 1, j)).saturating_add(1);
            let here = &mut table[rect.index(i, j)];
            *here = through.min(*here);
        }
    }
    table
}
