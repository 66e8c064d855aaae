//! Reduction of a body's contact points to the few that the solver wants.

use super::manifold::{Manifolds, PendingManifold};
use super::tuning::FARTHER_RATIO;
use std::ops::Range;

/// Memory for reducing the points of one body after another.
#[derive(Debug, Default)]
pub(super) struct Reduction {
    cursors: Vec<ManifoldCursor>,
    /// Squared distance of each point to the nearest one kept of its manifold, in square metres; negative for a point
    /// that is kept itself.
    to_kept: Vec<f64>,
}

/// A manifold, and the point to be kept next from it; `None` if all are kept.
#[derive(Debug)]
struct ManifoldCursor {
    manifold: PendingManifold,
    next: Option<usize>,
}

impl Reduction {
    /// Adds at most `max_count` points of a body's manifolds to `kept`. The manifolds contribute one point each in
    /// turn, the deepest manifold first. A manifold starts with its first deep point and goes on with the point that is
    /// farthest from those kept. Ties go to the lower index.
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

        // Equally deep manifolds stay in their order.
        cursors.sort_unstable_by(|ManifoldCursor { manifold: a, .. }, ManifoldCursor { manifold: b, .. }| {
            b.deepest.total_cmp(&a.deepest).then(a.points.start.cmp(&b.points.start))
        });

        if points.len() <= max_count {
            kept.extend(cursors.iter().flat_map(|cursor| cursor.manifold.points.clone()));
            return;
        }

        to_kept.clear();
        to_kept.resize(points.len(), f64::INFINITY);
        let target = kept.len() + max_count;
        while kept.len() < target {
            for cursor in cursors.iter_mut() {
                if kept.len() < target {
                    kept.extend(cursor.next_point(manifolds, points.start, to_kept));
                }
            }
        }
    }
}

impl ManifoldCursor {
    /// Takes the next point and chooses the one after it. `to_kept` begins with the distance of point `start`.
    fn next_point(&mut self, manifolds: &Manifolds, start: usize, to_kept: &mut [f64]) -> Option<usize> {
        let chosen = self.next?;
        to_kept[chosen - start] = -1.0;

        let mut farthest: Option<(usize, f64)> = None;
        for point in self.manifold.points.clone() {
            let distance = &mut to_kept[point - start];
            *distance =
                distance.min((manifolds.ray(point).point - manifolds.ray(chosen).point).norm_squared());
            let is_farther = |(_, other)| *distance > FARTHER_RATIO * other;
            if *distance >= 0.0 && point != chosen && farthest.is_none_or(is_farther) {
                farthest = Some((point, *distance));
            }
        }

        self.next = farthest.map(|(point, _)| point);
        Some(chosen)
    }
}
