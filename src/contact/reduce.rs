//! The few contacts to keep where there are more than the solver wants.

use super::Contact;

/// A contact at least this deep, as a part of its cluster's deepest, counts as deepest: the first of them starts the
/// choice, so that noise in the depths of a body at rest does not change it from step to step.
const AS_DEEP: f64 = 0.8;

/// A contact counts as farther only by more than this ratio of squared distances: what rounding decides differs from
/// pose to pose.
const FARTHER: f64 = 1.0 + 1e-6;

/// At most `most` contacts: clusters take turns, the deepest first; within one its deepest contact, then always the
/// one farthest from those kept. Ties go to the first. `clusters` hold contacts in the order of their samples.
pub(super) fn spread(mut clusters: Vec<Vec<Contact>>, most: usize) -> Vec<Contact> {
    clusters.retain(|cluster| !cluster.is_empty());
    clusters.sort_by(|a, b| deepest(b).total_cmp(&deepest(a)));
    if clusters.iter().map(Vec::len).sum::<usize>() <= most {
        return clusters.concat();
    }
    let mut turns: Vec<FarthestFirst> = clusters.into_iter().map(FarthestFirst::new).collect();
    let mut kept = Vec::with_capacity(most);
    while kept.len() < most {
        for turn in &mut turns {
            if kept.len() < most {
                kept.extend(turn.next());
            }
        }
    }
    kept
}

fn deepest(cluster: &[Contact]) -> f64 {
    cluster.iter().map(|contact| contact.depth).fold(0.0, f64::max)
}

/// A cluster's contacts in the order in which they are kept.
struct FarthestFirst {
    contacts: Vec<Contact>,
    /// Squared distance to the nearest contact kept; below zero once kept itself.
    to_kept: Vec<f64>,
    next: Option<usize>,
}

impl FarthestFirst {
    fn new(contacts: Vec<Contact>) -> Self {
        let as_deep = AS_DEEP * deepest(&contacts);
        let next = contacts.iter().position(|contact| contact.depth >= as_deep);
        Self { to_kept: vec![f64::INFINITY; contacts.len()], contacts, next }
    }
}

impl Iterator for FarthestFirst {
    type Item = Contact;

    fn next(&mut self) -> Option<Contact> {
        let chosen = self.next?;
        let kept = self.contacts[chosen];
        self.to_kept[chosen] = -1.0;
        let mut farthest: Option<usize> = None;
        for (k, contact) in self.contacts.iter().enumerate() {
            self.to_kept[k] = self.to_kept[k].min((contact.point - kept.point).norm_squared());
            let is_farther = |other: usize| self.to_kept[k] > FARTHER * self.to_kept[other];
            if self.to_kept[k] >= 0.0 && k != chosen && farthest.is_none_or(is_farther) {
                farthest = Some(k);
            }
        }
        self.next = farthest;
        Some(kept)
    }
}
