//! The few contacts to keep of a body where there are more than the solver wants.

use super::manifold::{Manifolds, PendingManifold};
use super::tuning::FARTHER_RATIO;
use std::ops::Range;

/// A choice among a body's points.
#[derive(Debug, Default)]
pub(super) struct Reduction {
    cursors: Vec<ManifoldCursor>,
    /// Squared distance of each point to the nearest one kept; below zero once kept itself.
    to_kept: Vec<f64>,
}

/// A manifold, and the point that it gives next.
#[derive(Debug)]
struct ManifoldCursor {
    manifold: PendingManifold,
    next: Option<usize>,
}

impl Reduction {
    /// Adds to `kept` the places of at most `most` points of a body's manifolds. These give a point each in turn, the
    /// deepest manifold first: its first deep point, then always the one farthest from those kept. Ties go to the first.
    pub(super) fn farthest_point_sampling(
        &mut self,
        manifolds: &Manifolds,
        body: Range<usize>,
        max_count: usize,
        kept: &mut Vec<usize>,
    ) {
        let Self { cursors, to_kept } = self;
        let cursor = |manifold: &PendingManifold| ManifoldCursor {
            manifold: manifold.clone(),
            next: Some(manifold.first),
        };
        cursors.clear();
        cursors.extend(manifolds.of(body).iter().map(cursor));
        let (Some(first), Some(last)) = (cursors.first(), cursors.last()) else { return };
        let points = first.manifold.points.start..last.manifold.points.end;
        // Equally deep ones stay in their order.
        cursors.sort_unstable_by(|ManifoldCursor { manifold: a, .. }, ManifoldCursor { manifold: b, .. }| {
            b.deepest.total_cmp(&a.deepest).then(a.points.start.cmp(&b.points.start))
        });
        if points.len() <= max_count {
            kept.extend(cursors.iter().flat_map(|cursor| cursor.manifold.points.clone()));
            return;
        }
        to_kept.clear();
        to_kept.resize(points.len(), f64::INFINITY);
        let enough = kept.len() + max_count;
        while kept.len() < enough {
            for cursor in cursors.iter_mut() {
                if kept.len() < enough {
                    kept.extend(cursor.next_point(manifolds, points.start, to_kept));
                }
            }
        }
    }
}

impl ManifoldCursor {
    /// The point to keep next; `to_kept` begins with that at place `start`.
    fn next_point(&mut self, manifolds: &Manifolds, start: usize, to_kept: &mut [f64]) -> Option<usize> {
        let chosen = self.next?;
        to_kept[chosen - start] = -1.0;
        let mut farthest: Option<(usize, f64)> = None;
        for place in self.manifold.points.clone() {
            let away = &mut to_kept[place - start];
            *away = away.min((manifolds.ray(place).point - manifolds.ray(chosen).point).norm_squared());
            let is_farther = |(_, other)| *away > FARTHER_RATIO * other;
            if *away >= 0.0 && place != chosen && farthest.is_none_or(is_farther) {
                farthest = Some((place, *away));
            }
        }
        self.next = farthest.map(|(place, _)| place);
        Some(chosen)
    }
}
