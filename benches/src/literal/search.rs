//! The search for the nearest silhouette edge, with a growing window in each view.

use super::{LiteralHull, LiteralView, MAX_VIEWS, Vec3};
use ode_visual_hull::silhouette::SUBJECT;

/// The silhouette edge nearest to a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearestEdge {
    /// Index of the deciding view.
    pub(super) view: usize,
    /// The point's pixel in the deciding view.
    pub(super) pixel: (i32, i32),
    /// The background pixel nearest to it, the projection of the paper's point b.
    pub(super) b: (i32, i32),
}

/// The search window of a view.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    centre: (i32, i32),
    /// Metres that a pixel covers at the point. The window grows the faster the less it is.
    footprint: f32,
    /// Half-width of the part that is scanned already.
    scanned: i32,
}

impl LiteralHull<'_> {
    /// The first background pixel that a window reaches; among windows that reach one in the same iteration, the view in
    /// which it is the nearest in metres.
    pub(super) fn nearest_edge(&self, a: &Vec3) -> Option<NearestEdge> {
        let mut windows = [Window::default(); MAX_VIEWS];
        let windows = &mut windows[..self.views.len()];

        let mut d_max = 0.0_f32;
        for (window, view) in windows.iter_mut().zip(&self.views) {
            (window.centre, window.footprint) = view.project(a);
            d_max = d_max.max(window.footprint);
        }

        for k in 0..i32::MAX {
            let mut nearest: Option<(f32, NearestEdge)> = None;
            for (index, (window, view)) in windows.iter_mut().zip(&self.views).enumerate() {
                let half = 1 + (k as f32 * (d_max / window.footprint)) as i32;
                let found = view.nearest_background(window.centre, window.scanned + 1, half);
                if let Some((radius, b)) = found {
                    let extent = (radius as f32 + 0.5) * window.footprint;
                    if nearest.as_ref().is_none_or(|(least, _)| extent < *least) {
                        nearest = Some((extent, NearestEdge { view: index, pixel: window.centre, b }));
                    }
                }
                window.scanned = half;
            }
            if let Some((_, nearest)) = nearest {
                return Some(nearest);
            }
        }

        None
    }
}

/// Whether all bytes are [`SUBJECT`] or more, tested by their highest bit, eight at a time.
fn all_subject(bytes: &[u8]) -> bool {
    const { assert!(SUBJECT == 0x80) };
    const HIGH: u64 = u64::from_ne_bytes([SUBJECT; 8]);
    let (words, rest) = bytes.as_chunks::<8>();
    let words = words.iter().fold(HIGH, |all, word| all & u64::from_ne_bytes(*word));
    words & HIGH == HIGH && rest.iter().fold(SUBJECT, |all, byte| all & byte) == SUBJECT
}

/// Squared distance in pixels, row and column of a background pixel. The smallest tuple is chosen.
type Candidate = (i32, i32, i32);

impl LiteralView<'_> {
    /// The radius of the first of the rings `first..=last` around `centre` with background, and the nearest background pixel
    /// on them. All pixels within are subject.
    fn nearest_background(&self, centre: (i32, i32), first: i32, last: i32) -> Option<(i32, (i32, i32))> {
        let found = (first..=last).find(|&radius| self.ring_has_background(centre, radius))?;
        let mut best = self.nearest_on_ring(centre, found);
        for radius in found + 1..=last {
            // A ring holds nothing nearer than its radius.
            if best.is_some_and(|(squared, ..)| squared < radius * radius) {
                break;
            }
            best = best.into_iter().chain(self.nearest_on_ring(centre, radius)).min();
        }
        best.map(|(_, y, x)| (found, (x, y)))
    }

    fn ring_has_background(&self, (i, j): (i32, i32), radius: i32) -> bool {
        if !self.holds_square((i, j), radius) {
            return true;
        }
        let row = |y: i32| !all_subject(self.row(y, i - radius, i + radius));
        row(j - radius) || row(j + radius) || self.columns_have_background((i, j), radius)
    }

    /// Whether the ring's two columns, without its two rows, have a background pixel.
    fn columns_have_background(&self, (i, j): (i32, i32), radius: i32) -> bool {
        let (bytes, stride) = self.bytes_at((i - radius, j - radius));
        let (width, mut left, mut all) = (2 * radius as usize, stride, SUBJECT);
        for _ in 1..width {
            all &= bytes[left] & bytes[left + width];
            left += stride;
        }
        all != SUBJECT
    }

    fn nearest_on_ring(&self, (i, j): (i32, i32), radius: i32) -> Option<Candidate> {
        let mut best: Option<Candidate> = None;
        let mut consider = |x: i32, y: i32| {
            if !self.is_subject(x, y) {
                let candidate = ((x - i).pow(2) + (y - j).pow(2), y, x);
                best = Some(best.map_or(candidate, |best| best.min(candidate)));
            }
        };

        for x in i - radius..=i + radius {
            consider(x, j - radius);
            consider(x, j + radius);
        }

        for y in j - radius + 1..j + radius {
            consider(i - radius, y);
            consider(i + radius, y);
        }

        best
    }
}
