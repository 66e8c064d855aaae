//! The components of one view's silhouettes, followed from frame to frame.
//!
//! ```text
//!   last     [ 1 ]   [ 2 ]        [ 1 ]              [ 1 ][ 2 ]        [ 2 ] is lost, and remembered for a while
//!   next     [ 1 ]   [ 2 ]        [ 1 ][ 3 ]           [ 1 ]           [ 1 ]
//!            by overlap           3 may still be 1     1 may be 2 too
//! ```
//!
//! Masks flicker: a component falls apart for a frame, two grow together, one is missing. So a component has, besides the
//! track of its own, others that it may be, for a while: those that it has come off or has swallowed.

use crate::silhouette::regions::Run;
use crate::silhouette::{Component, Components, Label, Rect};
use std::collections::HashMap;

/// The number of a track, unique within its view. Numbers are not used again.
pub(super) type TrackId = u32;

/// How long a piece that comes off a component counts as it too, in seconds: three frames.
const PIECE_SECONDS: f64 = 0.1;

/// How long a component that was lost or swallowed is remembered, in seconds; less, where it was not seen for so long.
const MEMORY_SECONDS: f64 = 2.0;

/// The most components that are remembered.
const MAX_LOST: usize = 256;

/// Components of fewer pixels are not looked for beside where they were: specks are everywhere.
const LEAST_AREA: u32 = 16;

/// How many times as large as before a component may be that overlaps nothing.
const LIKE_SIZE: u32 = 3;

/// A component, as it was when it was last seen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track {
    pub(super) id: TrackId,
    /// When it was seen first and last, in seconds.
    since: f64,
    last: f64,
    /// Other tracks that it may be, and until when.
    others: Vec<(TrackId, f64)>,
}

/// A component that is not seen now.
#[derive(Debug, Clone)]
struct Lost {
    track: Track,
    component: Component,
    runs: Vec<Run>,
}

/// The tracks of one view.
#[derive(Debug, Clone, Default)]
pub(super) struct Tracks {
    components: Components,
    /// The track of each component, by its label.
    tracks: Vec<Track>,
    lost: Vec<Lost>,
    next_id: TrackId,
}

/// A component of the last frame or a lost one, by its index, and one of the next.
#[derive(Debug, Clone, Copy)]
struct Pair {
    old: usize,
    label: Label,
    /// Pixels that they share.
    shared: u32,
}

impl Track {
    /// Whether it may be the track `id`, also if it is not.
    pub(super) fn may_be(&self, id: TrackId) -> bool {
        self.id == id || self.others.iter().any(|(other, _)| *other == id)
    }

    /// How long it is remembered when it is not seen.
    fn memory(&self) -> f64 {
        (self.last - self.since).min(MEMORY_SECONDS)
    }

    /// Adds tracks that it may be until `until`.
    fn add_others(&mut self, others: impl Iterator<Item = (TrackId, f64)>, until: f64) {
        for (id, own_until) in others {
            let until = own_until.min(until);
            match self.others.iter_mut().find(|(other, _)| *other == id) {
                Some((_, known)) => *known = known.max(until),
                None if id != self.id => self.others.push((id, until)),
                None => {}
            }
        }
    }

    /// Itself and the tracks that it may be.
    fn names(&self) -> impl Iterator<Item = (TrackId, f64)> {
        std::iter::once((self.id, f64::INFINITY)).chain(self.others.iter().copied())
    }
}

impl Tracks {
    /// The track of the component nearest to a pixel, within `reach` pixels.
    pub(super) fn nearest(&self, (i, j): (i32, i32), reach: i32) -> Option<&Track> {
        self.components.nearest(i, j, reach).map(|label| &self.tracks[label])
    }

    /// Whether a component may be the track `id`, one that is remembered included.
    pub(super) fn knows(&self, id: TrackId) -> bool {
        self.tracks.iter().any(|track| track.may_be(id)) || self.lost.iter().any(|lost| lost.track.id == id)
    }

    /// Follows the components of the last frame to those of the next, seen at `time` seconds.
    pub(super) fn follow(&mut self, next: Components, time: f64) {
        let live = std::mem::take(&mut self.tracks).into_iter().zip(self.components.all().iter().copied());
        let lost = self.lost.iter().map(|lost| (lost.track.clone(), lost.component));
        let old: Vec<(Track, Component)> = live.chain(lost).collect();

        // Each component of the next frame continues one old one at most, and the other way round.
        let overlaps = self.overlaps(&next, &old);
        let mut known = vec![None; next.all().len()];
        let mut is_found = vec![false; old.len()];
        for &Pair { old, label, .. } in overlaps.iter().chain(&beside(&overlaps, &old, &next)) {
            if !is_found[old] && known[label].is_none() {
                is_found[old] = true;
                known[label] = Some(old);
            }
        }
        self.tracks = known.iter().map(|known| self.continued(known.map(|k| &old[k].0), time)).collect();

        // What is left over has come off an old component, or was swallowed by one of the next frame.
        let live_count = self.components.all().len();
        for &Pair { old: k, label, shared } in overlaps.iter().filter(|pair| pair.old < live_count) {
            let (track, component) = &old[k];
            if known[label].is_none() && 2 * shared > next.all()[label].area {
                self.tracks[label].add_others(track.names(), time + PIECE_SECONDS);
            } else if !is_found[k] && 2 * shared > component.area {
                self.tracks[label].add_others(track.names(), track.last + track.memory());
            }
        }
        self.remember(&old, &is_found, time);
        self.components = next;
    }

    /// The pairs of components that share pixels, those of the last frame before the lost ones, and then those that share
    /// most.
    fn overlaps(&self, next: &Components, old: &[(Track, Component)]) -> Vec<Pair> {
        let mut pixels: HashMap<(usize, Label), u32> = HashMap::new();
        let mut add = |old: usize, run: &Run| {
            next.overlap(run, |label, shared| *pixels.entry((old, label)).or_default() += shared);
        };
        self.components.runs().iter().for_each(|(run, label)| add(*label, run));
        let live = self.components.all().len();
        for (k, lost) in self.lost.iter().enumerate() {
            lost.runs.iter().for_each(|run| add(live + k, run));
        }

        let mut pairs: Vec<Pair> =
            pixels.into_iter().map(|((old, label), shared)| Pair { old, label, shared }).collect();
        pairs.sort_by_key(|pair| (pair.old >= live, u32::MAX - pair.shared, old[pair.old].0.id, pair.label));
        pairs
    }

    /// The track of a component of the next frame: that of `known`, or a new one.
    fn continued(&mut self, known: Option<&Track>, time: f64) -> Track {
        let Some(known) = known else {
            self.next_id += 1;
            return Track { id: self.next_id, since: time, last: time, others: Vec::new() };
        };
        let others = known.others.iter().copied().filter(|(_, until)| time <= *until).collect();
        Track { last: time, others, ..*known }
    }

    /// Remembers the old components that were not found again, as long as they were seen.
    fn remember(&mut self, old: &[(Track, Component)], is_found: &[bool], time: f64) {
        let live = self.components.all().len();
        let mut was_found = is_found[live..].iter();
        self.lost.retain(|_| was_found.next() == Some(&false));
        for label in (0..live).filter(|&label| !is_found[label]) {
            let runs = self.components.runs().iter().filter(|(_, own)| *own == label);
            let (track, component) = old[label].clone();
            self.lost.push(Lost { track, component, runs: runs.map(|(run, _)| *run).collect() });
        }
        self.lost.retain(|Lost { track, .. }| time <= track.last + track.memory());
        let surplus = self.lost.len().saturating_sub(MAX_LOST);
        self.lost.drain(..surplus);
    }
}

/// Pairs of components that overlap nothing, the nearest first: where a part is so fast that it has left its place. They are
/// no farther apart than the larger of them is long, and of like size.
fn beside(overlaps: &[Pair], old: &[(Track, Component)], next: &Components) -> Vec<Pair> {
    let alone = |count: usize, index: fn(&Pair) -> usize, area: &dyn Fn(usize) -> u32| {
        let mut is_alone: Vec<bool> = (0..count).map(|k| area(k) >= LEAST_AREA).collect();
        overlaps.iter().for_each(|pair| is_alone[index(pair)] = false);
        (0..count).filter(|&k| is_alone[k]).collect::<Vec<_>>()
    };
    let old_alone = alone(old.len(), |pair| pair.old, &|k| old[k].1.area);
    let next_alone = alone(next.all().len(), |pair| pair.label, &|k| next.all()[k].area);

    let mut pairs: Vec<(i32, Pair)> = Vec::new();
    for &k in &old_alone {
        for &label in &next_alone {
            let (a, b) = (&old[k].1, &next.all()[label]);
            let gap = gap(&a.rect, &b.rect);
            let is_alike = a.area <= LIKE_SIZE * b.area && b.area <= LIKE_SIZE * a.area;
            if is_alike && gap <= length(&a.rect).max(length(&b.rect)) {
                pairs.push((gap, Pair { old: k, label, shared: 0 }));
            }
        }
    }
    pairs.sort_by_key(|(gap, pair)| (*gap, old[pair.old].0.id, pair.label));
    pairs.into_iter().map(|(_, pair)| pair).collect()
}

/// The columns or rows between two rectangles, whichever are more; 0 where they overlap.
fn gap(a: &Rect, b: &Rect) -> i32 {
    let across = (a.x0 - b.x1).max(b.x0 - a.x1);
    let down = (a.y0 - b.y1).max(b.y0 - a.y1);
    across.max(down).max(0)
}

fn length(rect: &Rect) -> i32 {
    rect.width().max(rect.height()) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::silhouette::{Border, Silhouette};
    use image::{GrayImage, Luma};

    /// The components of discs, each a centre and a radius in pixels.
    fn discs(discs: &[(f64, f64, f64)]) -> Components {
        let mask = GrayImage::from_fn(200, 100, |i, j| {
            let inside = |&(u, v, r): &(f64, f64, f64)| (f64::from(i) - u).hypot(f64::from(j) - v) < r;
            Luma([if discs.iter().any(inside) { 255 } else { 0 }])
        });
        Components::new(&Silhouette::new(&mask, Border::Background), None)
    }

    /// Follows frames, a thirtieth of a second apart.
    fn follow(tracks: &mut Tracks, start: f64, frames: impl IntoIterator<Item = Components>) -> f64 {
        frames.into_iter().fold(start, |time, next| {
            tracks.follow(next, time);
            time + 1.0 / 30.0
        })
    }

    fn id_at(tracks: &Tracks, u: i32, v: i32) -> TrackId {
        tracks.nearest((u, v), 0).expect("a component").id
    }

    const A: (f64, f64, f64) = (40.0, 50.0, 20.0);
    const B: (f64, f64, f64) = (140.0, 50.0, 15.0);

    #[test]
    fn components_that_move_keep_their_tracks() {
        let mut tracks = Tracks::default();
        let moved = |k: f64| discs(&[(40.0 + 3.0 * k, 50.0, 20.0), (140.0, 50.0 - 2.0 * k, 15.0)]);
        follow(&mut tracks, 0.0, [moved(0.0)]);
        let ids = [id_at(&tracks, 40, 50), id_at(&tracks, 140, 50)];
        follow(&mut tracks, 0.1, (1..15).map(|k| moved(f64::from(k))));
        assert_eq!([id_at(&tracks, 82, 50), id_at(&tracks, 140, 22)], ids);
    }

    #[test]
    fn a_component_that_leaves_its_place_within_a_frame_is_looked_for_beside_it() {
        let mut tracks = Tracks::default();
        follow(&mut tracks, 0.0, [discs(&[(20.0, 50.0, 10.0), B])]);
        let ids = [id_at(&tracks, 20, 50), id_at(&tracks, 140, 50)];
        // It is 19 pixels long, with as much between its places.
        follow(&mut tracks, 0.1, [discs(&[(58.0, 50.0, 10.0), B])]);
        assert_eq!([id_at(&tracks, 58, 50), id_at(&tracks, 140, 50)], ids);

        // Not farther than it is long, nor for one of another size.
        follow(&mut tracks, 0.2, [discs(&[(98.0, 50.0, 10.0), B])]);
        assert_ne!(id_at(&tracks, 98, 50), ids[0]);
        let id = id_at(&tracks, 98, 50);
        follow(&mut tracks, 0.3, [discs(&[(75.0, 50.0, 5.0), B])]);
        assert_ne!(id_at(&tracks, 75, 50), id);
    }

    #[test]
    fn the_larger_piece_keeps_the_track_and_the_other_may_be_it_for_a_while() {
        let mut tracks = Tracks::default();
        let whole = || discs(&[(60.0, 50.0, 20.0), (90.0, 50.0, 15.0)]);
        let split = || discs(&[(58.0, 50.0, 20.0), (96.0, 50.0, 15.0)]);
        let time = follow(&mut tracks, 0.0, [whole()]);
        let id = id_at(&tracks, 60, 50);
        let time = follow(&mut tracks, time, [split()]);
        assert_eq!(id_at(&tracks, 58, 50), id);
        let piece = tracks.nearest((96, 50), 0).unwrap().clone();
        assert!(piece.id != id && piece.may_be(id));

        // One frame later they are together again, or one of its own.
        let mut together = tracks.clone();
        follow(&mut together, time, [whole()]);
        assert_eq!([id_at(&together, 60, 50), id_at(&together, 96, 50)], [id; 2]);
        follow(&mut tracks, time, [split(), split(), split(), split()]);
        let later = tracks.nearest((96, 50), 0).unwrap();
        assert!(later.id == piece.id && !later.may_be(id));
    }

    #[test]
    fn what_has_merged_goes_on_as_the_larger_and_may_be_the_smaller_for_a_while() {
        let mut tracks = Tracks::default();
        let apart = || discs(&[A, (82.0, 50.0, 15.0)]);
        let merged = || discs(&[(44.0, 50.0, 20.0), (74.0, 50.0, 15.0)]);
        let time = follow(&mut tracks, 0.0, (0..90).map(|_| apart()));
        let [larger, smaller] = [id_at(&tracks, 40, 50), id_at(&tracks, 82, 50)];
        let time = follow(&mut tracks, time, [merged()]);
        let both = tracks.nearest((74, 50), 0).unwrap();
        assert!(both.id == larger && both.may_be(smaller));

        let mut apart_again = tracks.clone();
        follow(&mut apart_again, time, [apart()]);
        assert_eq!([id_at(&apart_again, 40, 50), id_at(&apart_again, 82, 50)], [larger, smaller]);
        follow(&mut tracks, time, (0..61).map(|_| merged()));
        assert!(!tracks.nearest((74, 50), 0).unwrap().may_be(smaller) && !tracks.knows(smaller));
    }

    #[test]
    fn a_component_that_is_missing_for_a_few_frames_is_known_again() {
        let mut tracks = Tracks::default();
        let time = follow(&mut tracks, 0.0, (0..30).map(|_| discs(&[A, B])));
        let ids = [id_at(&tracks, 40, 50), id_at(&tracks, 140, 50)];
        let time = follow(&mut tracks, time, [discs(&[]), discs(&[B]), discs(&[A, B])]);
        assert_eq!([id_at(&tracks, 40, 50), id_at(&tracks, 140, 50)], ids);

        // It was seen for a second, and so is remembered for one.
        let time = follow(&mut tracks, time, (0..33).map(|_| discs(&[B])));
        assert!(!tracks.knows(ids[0]));
        follow(&mut tracks, time, [discs(&[A, B])]);
        assert_ne!(id_at(&tracks, 40, 50), ids[0]);
    }

    #[test]
    fn specks_are_not_remembered() {
        let mut tracks = Tracks::default();
        follow(&mut tracks, 0.0, [discs(&[A])]);
        for frame in 1..1000 {
            let speck = (f64::from(frame * 37 % 200), f64::from(frame * 17 % 100), 1.5);
            follow(&mut tracks, f64::from(frame) / 30.0, [discs(&[A, speck])]);
            assert!(tracks.lost.len() <= 2 && tracks.tracks.iter().all(|track| track.others.len() <= 2));
        }
        assert_eq!(id_at(&tracks, 40, 50), 1);
    }
}
