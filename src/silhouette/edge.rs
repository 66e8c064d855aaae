//! Normals at the edge of a silhouette: the paper's, and the one that contacts use.

use super::{HALF_COVERAGE, Rect, Silhouette};
use nalgebra::{Point2, Vector2};
use std::sync::OnceLock;

/// Half-width of the contact normal's window, in pixels.
const WINDOW: i32 = 6;

/// Squared distance, in pixels, at which the contact normal's weights `(1 - r^2 / REACH_SQUARED)^3` end: a round bell
/// of standard deviation 2.2, wide enough to see past the stairs of a binary edge, narrow enough to follow a finger.
/// It ends inside the window. A Gaussian that the square window cuts off tilts the normals of straight edges by 0.08
/// degrees on average, enough for a sphere on a flat table to roll away; this one by 0.02.
const REACH_SQUARED: f64 = 48.0;

/// A mean vector shorter than this, in pixels, has no direction worth trusting (paper, section 4.2; design value).
const SHORTEST_MEAN: f64 = 0.3;

/// A silhouette's edge at one of its background pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// A point of the edge, in image coordinates.
    pub point: Point2<f64>,
    /// Unit normal in the image, from the subject to the background.
    pub normal: Vector2<f64>,
}

/// The edge pixels of a silhouette, row-major, each with its [`Edge`] once somebody asked for it.
#[derive(Debug, Default)]
pub(super) struct EdgeTable(Vec<EdgePixel>);

#[derive(Debug)]
struct EdgePixel {
    /// Row and column.
    at: (i32, i32),
    edge: OnceLock<Option<Edge>>,
}

impl EdgeTable {
    pub(super) fn of(silhouette: &Silhouette) -> Self {
        let rect = silhouette.rect;
        if rect.is_empty() {
            return Self::default();
        }
        let mut pixels = Vec::new();
        for j in rect.y0 - 1..=rect.y1 {
            for i in rect.x0 - 1..=rect.x1 {
                let beside = [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)];
                let subject = |(i, j): (i32, i32)| rect.contains(i, j) && silhouette.is_subject(i, j);
                if !silhouette.is_subject(i, j) && beside.into_iter().any(subject) {
                    pixels.push(EdgePixel { at: (j, i), edge: OnceLock::new() });
                }
            }
        }
        Self(pixels)
    }

    pub(super) fn get(&self, silhouette: &Silhouette, i: i32, j: i32) -> Option<Edge> {
        match self.0.binary_search_by_key(&(j, i), |pixel| pixel.at) {
            Ok(found) => *self.0[found].edge.get_or_init(|| silhouette.contact_edge(i, j)),
            Err(_) => silhouette.contact_edge(i, j),
        }
    }

    pub(super) fn pixels(&self) -> impl Iterator<Item = (i32, i32)> {
        self.0.iter().map(|pixel| (pixel.at.1, pixel.at.0))
    }
}

impl Silhouette {
    /// The paper's normal (section 4.2) at background pixel `(i, j)`: the mean vector from there to the background
    /// pixels of the 5x5 window around, of 7x7 or 9x9 where that mean is short; `None` where all are.
    pub fn paper_normal(&self, i: i32, j: i32) -> Option<Vector2<f64>> {
        [2, 3, 4].into_iter().find_map(|half| {
            let window = Rect::window(i, j, half);
            let (mut sum, mut count) = (Vector2::zeros(), 0.0);
            for y in window.y0..window.y1 {
                for x in window.x0..window.x1 {
                    if !self.is_subject(x, y) {
                        sum += Vector2::new(f64::from(x - i), f64::from(y - j));
                        count += 1.0;
                    }
                }
            }
            let mean = sum / f64::max(count, 1.0);
            (mean.norm() >= SHORTEST_MEAN).then(|| mean.normalize())
        })
    }

    /// The contact normal at `(i, j)`: the same mean with each vector weighted by `(1 - coverage)` and a bell,
    /// which takes the square window's bias away; and the edge point beneath it.
    fn contact_edge(&self, i: i32, j: i32) -> Option<Edge> {
        let (mut sum, mut total) = (Vector2::zeros(), 0.0);
        for dy in -WINDOW..=WINDOW {
            for dx in -WINDOW..=WINDOW {
                let weight = f64::from(255 - self.value(i + dx, j + dy)) * bell(dx, dy);
                sum += Vector2::new(f64::from(dx), f64::from(dy)) * weight;
                total += weight;
            }
        }
        let normal = (sum / total).try_normalize(SHORTEST_MEAN)?;
        let centre = Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
        let point = centre - normal * self.depth_of_edge(centre, normal);
        Some(Edge { point, normal })
    }

    /// How far inwards of a background pixel's centre the edge lies, in pixels: where coverage reaches one half, or
    /// half a pixel where the mask carries none.
    fn depth_of_edge(&self, centre: Point2<f64>, normal: Vector2<f64>) -> f64 {
        const STEP: f64 = 0.125;
        if !self.has_coverage {
            return 0.5;
        }
        let coverage = |depth: f64| {
            let inwards = centre - normal * depth;
            self.coverage(inwards.x, inwards.y) - HALF_COVERAGE
        };
        let mut before = coverage(0.0);
        for step in 1..=16 {
            let depth = f64::from(step) * STEP;
            let here = coverage(depth);
            if before < 0.0 && here >= 0.0 {
                return depth - STEP * here / (here - before);
            }
            before = here;
        }
        0.5
    }
}

/// The weight of the pixel `(dx, dy)` from the middle of the contact normal's window.
fn bell(dx: i32, dy: i32) -> f64 {
    let rest = f64::max(1.0 - f64::from(dx * dx + dy * dy) / REACH_SQUARED, 0.0);
    rest * rest * rest
}
