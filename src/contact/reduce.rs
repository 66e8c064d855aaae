//! The few contacts to keep where there are more than the solver wants.

use nalgebra::Point3;
use std::ops::Range;

/// A contact at least this deep, as a part of its cluster's deepest, counts as deepest: the first of them starts the
/// choice, so that noise in the depths of a body at rest does not change it from step to step.
pub(super) const AS_DEEP: f64 = 0.8;

/// A contact counts as farther only by more than this ratio of squared distances: what rounding decides differs from
/// pose to pose.
const FARTHER: f64 = 1.0 + 1e-6;

/// Points of several clusters, in each in the order of their samples.
#[derive(Debug, Default)]
pub(super) struct Choice {
    points: Vec<Point3<f64>>,
    clusters: Vec<Turn>,
    /// Squared distance of each point to the nearest one kept; below zero once kept itself.
    to_kept: Vec<f64>,
}

/// A cluster that takes its turn.
#[derive(Debug)]
struct Turn {
    cluster: usize,
    points: Range<usize>,
    deepest: f64,
    next: Option<usize>,
}

/// A point that is kept: its cluster, and its place among that one's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Kept {
    pub(super) cluster: usize,
    pub(super) place: usize,
}

impl Choice {
    pub(super) fn clear(&mut self) {
        self.points.clear();
        self.clusters.clear();
    }

    /// Adds the next cluster: its points, its depth, and the first of them that counts as deepest.
    pub(super) fn add(&mut self, points: impl Iterator<Item = Point3<f64>>, deepest: f64, first: usize) {
        let start = self.points.len();
        self.points.extend(points);
        let (cluster, points) = (self.clusters.len(), start..self.points.len());
        self.clusters.push(Turn { cluster, points, deepest, next: Some(start + first) });
    }

    /// Writes to `kept` at most `most` points: clusters take turns, the deepest first; within one its first, then
    /// always the one farthest from those kept. Ties go to the first.
    pub(super) fn spread(&mut self, most: usize, kept: &mut Vec<Kept>) {
        kept.clear();
        let Self { points, clusters, to_kept } = self;
        // Equally deep ones stay in their order.
        clusters.sort_unstable_by(|a, b| b.deepest.total_cmp(&a.deepest).then(a.cluster.cmp(&b.cluster)));
        if points.len() <= most {
            for Turn { cluster, points, .. } in clusters {
                kept.extend((0..points.len()).map(|place| Kept { cluster: *cluster, place }));
            }
            return;
        }
        to_kept.clear();
        to_kept.resize(points.len(), f64::INFINITY);
        while kept.len() < most {
            for turn in clusters.iter_mut() {
                if kept.len() < most {
                    kept.extend(turn.take(points, to_kept));
                }
            }
        }
    }
}

/// The depth of a cluster, and which of its contacts is the first that counts as deepest.
pub(super) fn deepest(depths: impl Iterator<Item = f64> + Clone) -> (f64, usize) {
    let deepest = depths.clone().fold(0.0, f64::max);
    (deepest, depths.into_iter().position(|depth| counts_as(deepest, depth)).unwrap_or(0))
}

/// Whether a contact counts as deepest.
pub(super) fn counts_as(deepest: f64, depth: f64) -> bool {
    depth >= AS_DEEP * deepest
}

impl Turn {
    /// The point to keep next.
    fn take(&mut self, points: &[Point3<f64>], to_kept: &mut [f64]) -> Option<Kept> {
        let chosen = self.next?;
        to_kept[chosen] = -1.0;
        let mut farthest: Option<usize> = None;
        for k in self.points.clone() {
            to_kept[k] = to_kept[k].min((points[k] - points[chosen]).norm_squared());
            let is_farther = |other: usize| to_kept[k] > FARTHER * to_kept[other];
            if to_kept[k] >= 0.0 && k != chosen && farthest.is_none_or(is_farther) {
                farthest = Some(k);
            }
        }
        self.next = farthest;
        Some(Kept { cluster: self.cluster, place: chosen - self.points.start })
    }
}
