//! The separate parts of a hull, which keep their ids while they move, found without reconstruction.
//!
//! ```text
//!   view 1   #1##    #2##           a point of the left part falls on the components (1, 4, 6)
//!   view 2      ##4##               a point of the right part on (2, 4, 6): another part
//!   view 3   ##6###########
//! ```
//!
//! A connected part of the hull falls on one connected component of each silhouette. So the components on which a point
//! falls, one in each view that sees it, tell its part. Pieces that fall on one component in all views count as one part.
//!
//! Components are followed from frame to frame ([`tracks`]). A point belongs to the known part with which it agrees in most
//! of the views that see both, in more than half of them; without such a part, to a new one. So it changes no id that two
//! parts pass in front of each other in the image of one view, or that one mask flickers.

mod tracks;

use super::{Hull, View};
use crate::camera::floor_pixel;
use crate::silhouette::Components;
use nalgebra::Point3;
use tracks::{Track, TrackId, Tracks};

/// How far a point of the hull's surface may fall from the component that it belongs to, in pixels: coverage puts an edge up
/// to half a pixel off the subject's pixels.
pub(crate) const AT_SURFACE: i32 = 2;

/// How far a point where the hull's surface will be when a step ends may fall from the component that it belongs to, in pixels.
pub(crate) const NEAR_SURFACE: i32 = 32;

/// The id of a part of a hull, from 1 on. Ids are not used again.
pub(crate) type PartId = u32;

/// The parts of the hulls of successive frames.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    views: Vec<Tracks>,
    /// In the order of their ids.
    known: Vec<Part>,
    last_id: PartId,
}

#[derive(Debug)]
struct Part {
    id: PartId,
    /// The component that it is in each view; `None` in views that have not seen it.
    tracks: Vec<Option<TrackId>>,
}

impl Parts {
    /// Forgets all parts, since the next frame is of other data.
    pub(crate) fn begin_anew(&mut self) {
        self.views.clear();
        self.known.clear();
    }

    /// Follows the parts of the frame `last` to the frame `next`.
    pub(crate) fn follow(&mut self, last: Option<&Hull>, next: &Hull) {
        self.views.resize_with(next.views.len(), Tracks::default);
        for (k, (tracks, view)) in self.views.iter_mut().zip(&next.views).enumerate() {
            // A view that abstains has the mask that it had last. While `last` lives, its silhouettes do not change.
            let is_same = |last: &View| std::ptr::eq(last.silhouette(), view.silhouette());
            let is_unchanged = last.and_then(|last| last.views.get(k)).is_some_and(is_same);
            if view.is_enabled() && !is_unchanged {
                tracks.follow(Components::new(view.silhouette(), view.blind_spots()), next.time);
            }
        }

        // A part is not found again once half of its components are forgotten.
        let views = &self.views;
        self.known.retain(|part| {
            let seen = part.tracks.iter().flatten().count();
            let is_known = |(id, tracks): &(&Option<TrackId>, &Tracks)| id.is_some_and(|id| tracks.knows(id));
            2 * part.tracks.iter().zip(views).filter(is_known).count() > seen
        });
    }

    /// The part of `hull`, the last frame that was followed, to which `p` belongs. Its components are looked for within
    /// `reach` pixels. `None` where there is none in any view.
    pub(crate) fn part_at(&mut self, hull: &Hull, p: &Point3<f64>, reach: i32) -> Option<PartId> {
        let views = hull.views.iter().zip(&self.views);
        let point: Vec<Option<&Track>> =
            views.map(|(view, tracks)| component_at(view, tracks, p, reach)).collect();
        if point.iter().all(Option::is_none) {
            return None;
        }

        let agreements =
            self.known.iter().enumerate().filter_map(|(k, part)| Some((part.agreement(&point)?, k)));
        let best = agreements.max_by_key(|(agreement, k)| (*agreement, std::cmp::Reverse(*k)));
        if let Some((_, k)) = best {
            self.known[k].learn(&point);
            return Some(self.known[k].id);
        }

        self.last_id += 1;
        let tracks = point.iter().map(|track| track.map(|track| track.id)).collect();
        self.known.push(Part { id: self.last_id, tracks });
        Some(self.last_id)
    }
}

/// The component on which `p` falls in a view; `None` where the view does not see it.
fn component_at<'t>(view: &View, tracks: &'t Tracks, p: &Point3<f64>, reach: i32) -> Option<&'t Track> {
    let pixel = view.project(p).filter(|_| view.is_enabled())?;
    let (i, j) = floor_pixel(pixel.u, pixel.v);
    if view.judges(i, j) { tracks.nearest((i, j), reach) } else { None }
}

impl Part {
    /// How well it agrees with the components on which a point falls; `None` unless it does in more than half of the views
    /// that see both. A component that only may be the part's counts half.
    fn agreement(&self, point: &[Option<&Track>]) -> Option<usize> {
        let both = self.tracks.iter().zip(point).filter_map(|(own, track)| Some(((*own)?, (*track)?)));
        let (mut seen, mut agreeing, mut weight) = (0, 0, 0);
        for (own, track) in both {
            seen += 1;
            agreeing += usize::from(track.may_be(own));
            weight += usize::from(track.may_be(own)) + usize::from(track.id == own);
        }
        (2 * agreeing > seen).then_some(weight)
    }

    /// Takes on the components of a point that belongs to it, in the views where its own are gone.
    fn learn(&mut self, point: &[Option<&Track>]) {
        for (own, track) in self.tracks.iter_mut().zip(point) {
            if let Some(track) = track.filter(|track| own.is_none_or(|own| !track.may_be(own))) {
                *own = Some(track.id);
            }
        }
    }
}

#[cfg(test)]
mod tests;
