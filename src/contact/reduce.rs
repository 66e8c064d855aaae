//! The few contacts to keep of a body where there are more than the solver wants.

use super::group::{Group, Groups};
use std::ops::Range;

/// A contact at least this deep, as a part of its group's deepest, counts as deepest: the first of them starts the
/// choice, so that noise in the depths of a body at rest does not change it from step to step.
pub(super) const AS_DEEP: f64 = 0.8;

/// A contact counts as farther only by more than this ratio of squared distances: what rounding decides differs from
/// pose to pose.
const FARTHER: f64 = 1.0 + 1e-6;

/// A choice among a body's points.
#[derive(Debug, Default)]
pub(super) struct Choice {
    turns: Vec<Turn>,
    /// Squared distance of each point to the nearest one kept; below zero once kept itself.
    to_kept: Vec<f64>,
}

/// A group that takes its turn.
#[derive(Debug)]
struct Turn {
    group: Group,
    next: Option<usize>,
}

impl Choice {
    /// Adds to `kept` the places of at most `most` points of a body's groups: these take turns, the deepest first;
    /// within one its first, then always the one farthest from those kept. Ties go to the first.
    pub(super) fn spread(&mut self, groups: &Groups, body: Range<usize>, most: usize, kept: &mut Vec<usize>) {
        let Self { turns, to_kept } = self;
        turns.clear();
        turns.extend(
            groups.of(body).iter().map(|group| Turn { group: group.clone(), next: Some(group.first) }),
        );
        let (Some(first), Some(last)) = (turns.first(), turns.last()) else { return };
        let points = first.group.points.start..last.group.points.end;
        // Equally deep ones stay in their order.
        turns.sort_unstable_by(|Turn { group: a, .. }, Turn { group: b, .. }| {
            b.deepest.total_cmp(&a.deepest).then(a.points.start.cmp(&b.points.start))
        });
        if points.len() <= most {
            kept.extend(turns.iter().flat_map(|turn| turn.group.points.clone()));
            return;
        }
        to_kept.clear();
        to_kept.resize(points.len(), f64::INFINITY);
        let enough = kept.len() + most;
        while kept.len() < enough {
            for turn in turns.iter_mut() {
                if kept.len() < enough {
                    kept.extend(turn.take(groups, points.start, to_kept));
                }
            }
        }
    }
}

impl Turn {
    /// The point to keep next; `to_kept` begins with that at place `start`.
    fn take(&mut self, groups: &Groups, start: usize, to_kept: &mut [f64]) -> Option<usize> {
        let chosen = self.next?;
        to_kept[chosen - start] = -1.0;
        let mut farthest: Option<(usize, f64)> = None;
        for place in self.group.points.clone() {
            let away = &mut to_kept[place - start];
            *away = away.min((groups.point(place) - groups.point(chosen)).norm_squared());
            let is_farther = |(_, other)| *away > FARTHER * other;
            if *away >= 0.0 && place != chosen && farthest.is_none_or(is_farther) {
                farthest = Some((place, *away));
            }
        }
        self.next = farthest.map(|(place, _)| place);
        Some(chosen)
    }
}
