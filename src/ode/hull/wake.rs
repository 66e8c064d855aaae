//! Wakes sleeping bodies at which the hull's surface has moved. ODE wakes a body only through contacts with another that
//! is awake.

use super::grip;
use super::last_contacts::{ContactState, Touch};
use super::query::CollideContext;
use crate::contact::tuning::WAKE_PX;
use crate::contact::{self, BodyContacts};
use crate::hull::Aabb;
use crate::sample::Samples;
use nalgebra::{Isometry3, Point3};
use ode_sys::{dBodyEnable, dBodyIsEnabled, dGeomGetBody, dGeomID};

/// A body that is collided with a hull geom.
pub(super) struct CollidedBody<'a> {
    pub(super) geom: dGeomID,
    pub(super) samples: &'a Samples,
    pub(super) hull_from_body: Isometry3<f64>,
}

/// Records the contacts of `other` with the hull, and wakes it where it sleeps and the hull at it has changed. `kept_loss`
/// is the number of the loss before which it was there.
///
/// # Safety
/// The geom of `other` is living.
pub(super) unsafe fn record_contacts(
    context: &CollideContext,
    other: &CollidedBody,
    found: &BodyContacts,
    kept_loss: Option<u64>,
) {
    // The body is the one that ODE names now, not one remembered.
    // SAFETY: the caller vouches for the geom, and ODE for its body.
    let (body, is_asleep) = unsafe {
        let body = dGeomGetBody(other.geom);
        (body, !body.is_null() && dBodyIsEnabled(body) == 0)
    };

    let deepest = found.contacts().max_by(|a, b| a.depth.total_cmp(&b.depth));
    let touch = deepest.map(|contact| Touch { depth: contact.depth, direction: contact.direction });
    let is_woken = is_asleep && context.has_moved_at(other, touch);

    let (centre, radius) = other.samples.bounding_sphere();
    let centre = context.hull_from_world.inverse() * (other.hull_from_body * centre);
    let around_body = Aabb { min: centre, max: centre }.grown(radius);
    let state = ContactState {
        has_body: !body.is_null(),
        is_asleep,
        touch,
        is_gripped: grip::is_gripped(&found.manifolds),
        escape: found.escape,
        kept_loss,
        body: around_body,
    };
    context.geom.last_contacts.record(other.geom as usize, state, is_woken);

    if is_woken {
        // SAFETY: as above; it sets flags of the body and touches no space.
        unsafe { dBodyEnable(body) };
    }
}

impl CollideContext<'_> {
    /// Whether the hull's surface is no longer where it was when the body fell asleep, by more than a flickering pixel.
    /// A body that was never collided had no contact.
    fn has_moved_at(&self, other: &CollidedBody, now: Option<Touch>) -> bool {
        let position = Point3::from(other.hull_from_body.translation.vector);
        // A depth that is limited cannot change by more.
        let tolerance = (WAKE_PX * self.hull.pixel_size(&position)).min(0.5 * self.settings.max_depth);

        match (self.geom.last_contacts.touch(other.geom as usize), now) {
            (before, Some(now)) => (now.depth - before.map_or(0.0, |before| before.depth)).abs() > tolerance,
            (Some(before), None) => !self.is_within(other, &before, tolerance),
            (None, None) => false,
        }
    }

    /// Whether the body would touch the hull if it were `distance` metres deeper.
    fn is_within(&self, other: &CollidedBody, before: &Touch, distance: f64) -> bool {
        let mut deeper = other.hull_from_body;
        deeper.translation.vector -= distance * before.direction;
        let mut found = BodyContacts::default();
        contact::collide_any(
            &mut found,
            self.hull_for(other.geom as usize),
            other.samples,
            &deeper,
            &self.settings,
        );
        !found.points.is_empty()
    }
}
