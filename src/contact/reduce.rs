//! The few contacts to keep where there are more than the solver wants.

use super::Contact;
use std::ops::Range;

/// A contact at least this deep, as a part of its cluster's deepest, counts as deepest: the first of them starts the
/// choice, so that noise in the depths of a body at rest does not change it from step to step.
const AS_DEEP: f64 = 0.8;

/// A contact counts as farther only by more than this ratio of squared distances: what rounding decides differs from
/// pose to pose.
const FARTHER: f64 = 1.0 + 1e-6;

/// Contacts of several clusters, in each in the order of their samples.
#[derive(Debug, Default)]
pub(super) struct Choice {
    contacts: Vec<Contact>,
    clusters: Vec<Turn>,
    /// Squared distance of each contact to the nearest one kept; below zero once kept itself.
    to_kept: Vec<f64>,
}

/// A cluster that takes its turn.
#[derive(Debug)]
struct Turn {
    contacts: Range<usize>,
    deepest: f64,
    next: Option<usize>,
}

impl Choice {
    pub(super) fn clear(&mut self) {
        self.contacts.clear();
        self.clusters.clear();
    }

    /// Adds the contacts of a cluster; returns how many they are.
    pub(super) fn add(&mut self, cluster: impl IntoIterator<Item = Contact>) -> usize {
        let start = self.contacts.len();
        self.contacts.extend(cluster);
        let contacts = start..self.contacts.len();
        let deepest = self.contacts[start..].iter().map(|contact| contact.depth).fold(0.0, f64::max);
        if !contacts.is_empty() {
            self.clusters.push(Turn { contacts, deepest, next: None });
        }
        self.contacts.len() - start
    }

    /// Writes to `kept` at most `most` contacts: clusters take turns, the deepest first; within one its deepest
    /// contact, then always the one farthest from those kept. Ties go to the first.
    pub(super) fn spread(&mut self, most: usize, kept: &mut Vec<Contact>) {
        kept.clear();
        let Self { contacts, clusters, to_kept } = self;
        // Equally deep ones stay in their order.
        clusters.sort_unstable_by(|a, b| {
            b.deepest.total_cmp(&a.deepest).then(a.contacts.start.cmp(&b.contacts.start))
        });
        if contacts.len() <= most {
            kept.extend(clusters.iter().flat_map(|turn| &contacts[turn.contacts.clone()]));
            return;
        }
        to_kept.clear();
        to_kept.resize(contacts.len(), f64::INFINITY);
        for turn in clusters.iter_mut() {
            let as_deep = AS_DEEP * turn.deepest;
            turn.next = turn.contacts.clone().find(|&k| contacts[k].depth >= as_deep);
        }
        while kept.len() < most {
            for turn in clusters.iter_mut() {
                if kept.len() < most {
                    kept.extend(turn.take(contacts, to_kept));
                }
            }
        }
    }
}

impl Turn {
    /// The contact to keep next.
    fn take(&mut self, contacts: &[Contact], to_kept: &mut [f64]) -> Option<Contact> {
        let chosen = self.next?;
        let kept = contacts[chosen];
        to_kept[chosen] = -1.0;
        let mut farthest: Option<usize> = None;
        for k in self.contacts.clone() {
            to_kept[k] = to_kept[k].min((contacts[k].point - kept.point).norm_squared());
            let is_farther = |other: usize| to_kept[k] > FARTHER * to_kept[other];
            if to_kept[k] >= 0.0 && k != chosen && farthest.is_none_or(is_farther) {
                farthest = Some(k);
            }
        }
        self.next = farthest;
        Some(kept)
    }
}
