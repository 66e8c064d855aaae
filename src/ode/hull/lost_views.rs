//! Bodies that the hull has grown over, because views were lost.
//!
//! ```text
//!     all views                one is lost
//!     .------.                 .-------------
//!     | hull |[box]            | hull  [box]     the box is deep inside, although nothing real has moved
//!     '------'                 '-------------
//! ```
//!
//! Where a view is lost, because it is disabled or late, the hull grows by what that view alone has shown to be empty. A
//! body there would be thrown out at the speed that its depth demands. But the other views cannot tell whether anything
//! real is there. So the last mask of a lost view stays valid for the bodies that were there when the hull grew: they
//! collide with the hull of all views, until these are back, or until the grown hull has left the body. All other
//! bodies, and those that come later, collide with the grown hull.

use super::query::{CollideContext, ContactQuery};
use crate::contact::tuning::GROWTH_PX;
use crate::contact::{self, BodyContacts};
use crate::hull::{Hull, View};
use nalgebra::Point3;
use std::sync::{Arc, OnceLock};

/// The views that a hull geom has lost, from frame to frame.
#[derive(Debug, Default)]
pub(super) struct LostViews {
    /// The views that took part once and abstain now, by their indices, as they were last.
    views: Vec<(usize, View)>,
    /// Counts the times at which a first view was lost.
    loss: u64,
    /// Whether the next frame is not compared with the last, which is of other data.
    begins_anew: bool,
    in_force: Option<Arc<Loss>>,
}

/// The views that the frame in force lacks.
#[derive(Debug)]
pub(super) struct Loss {
    /// Tells this loss from those before and after a time at which all views took part.
    number: u64,
    views: Vec<(usize, View)>,
    /// Whether the frame is the first without one of the views.
    is_new: bool,
    /// The frame in force with the views as they were last, where a body has asked for it.
    hull: OnceLock<Hull>,
}

impl LostViews {
    /// Forgets all losses, since the next frame is of other data.
    pub(super) fn begin_anew(&mut self) {
        self.views.clear();
        (self.in_force, self.begins_anew) = (None, true);
    }

    /// Finds the views that are lost or have come back in the frame `next`, which follows `last`.
    pub(super) fn compare(&mut self, last: Option<&Hull>, next: Option<&Hull>) {
        self.in_force = None;
        let begins_anew = std::mem::take(&mut self.begins_anew);
        let (Some(last), Some(next)) = (last.filter(|_| !begins_anew), next) else { return };

        let abstains = |k: usize| next.views().get(k).is_some_and(|view| !view.is_enabled());
        self.views.retain(|(k, _)| abstains(*k));
        let known = self.views.len();
        let before = last.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
        self.views.extend(before.filter(|(k, _)| abstains(*k)).map(|(k, view)| (k, view.clone())));
        if self.views.is_empty() {
            return;
        }

        self.loss += u64::from(known == 0);
        self.in_force = Some(Arc::new(Loss {
            number: self.loss,
            views: self.views.clone(),
            is_new: self.views.len() > known,
            hull: OnceLock::new(),
        }));
    }

    /// The views that the frame in force lacks; `None` where it lacks none.
    pub(super) fn in_force(&self) -> Option<Arc<Loss>> {
        self.in_force.clone()
    }
}

impl CollideContext<'_> {
    /// The frame in force with the views as they were before their loss; `None` where no view is lost.
    fn hull_with_lost_views(&self) -> Option<&Hull> {
        let loss = self.loss.as_deref()?;
        Some(loss.hull.get_or_init(|| self.hull.with_views(&loss.views)))
    }

    /// The hull that the geom at address `other` collides with.
    pub(super) fn hull_for(&self, other: usize) -> &Hull {
        let number = self.geom.last_contacts.kept_loss(other);
        let keeps = number.is_some() && number == self.loss.as_ref().map(|loss| loss.number);
        self.hull_with_lost_views().filter(|_| keeps).unwrap_or(&self.hull)
    }

    /// Replaces the contacts `found`, those with the frame in force, by those with the hull of all views, where the body
    /// of `query` was there when the hull grew over it. Returns the number of the loss then.
    pub(super) fn keep_lost_views(&self, query: &ContactQuery, found: &mut BodyContacts) -> Option<u64> {
        let loss = self.loss.as_ref().filter(|_| !found.points.is_empty())?;
        let keeps = self.geom.last_contacts.kept_loss(query.other) == Some(loss.number);
        if !keeps && !loss.is_new {
            return None;
        }

        let mut before = [BodyContacts::default()];
        let hull = self.hull_with_lost_views()?;
        contact::collide_into(&mut before, hull, &[query.body()], &query.settings);
        let [before] = before;
        let tolerance = || {
            let position = Point3::from(query.stamp.hull_from_other.translation.vector);
            GROWTH_PX * hull.pixel_size(&position)
        };
        if !keeps && found.deepest() - before.deepest() <= tolerance() {
            return None;
        }
        *found = before;
        Some(loss.number)
    }
}

#[cfg(test)]
mod tests;
