//! Bodies that stick to the hull while it is held: the paper's button (section 7).
//!
//! ```text
//!   a contact ─► grab: Track::begin, and where the body is beside it
//!   each collide ─► carry: Track::follow, and the velocity that takes the body to its place beside it
//!   released ─► the motion of the subject there, once
//! ```
//!
//! A body is known by its address, which is compared and never followed: what is set is the velocity of the body that ODE has
//! just passed.

use super::class;
use super::geom::HullGeom;
use super::held_body::{Carried, HeldBody};
use super::query::CollideContext;
use crate::Error;
use crate::contact::BodyContacts;
use crate::hull::{Aabb, Track};
use crate::lock::lock;
use nalgebra::{Point3, Vector3};
use ode_sys::{dBodyID, dBodyIsKinematic, dGeomGetBody, dGeomID};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

/// Frames, settings of the time and collides after which a body is forgotten that was not collided since: it may have been destroyed.
const FORGET_AFTER: u32 = 40;

/// Bodies are grabbed one at a time, so that no two hulls grab one.
static GRABBING: Mutex<()> = Mutex::new(());

/// The bodies that stick to one hull geom, by their addresses.
#[derive(Debug, Default)]
pub(super) struct Hold(Mutex<Table>);

#[derive(Debug, Default)]
struct Table {
    is_on: bool,
    bodies: BTreeMap<usize, HeldBody>,
    /// Bodies that touch the hull but do not stick, as the program was told.
    refused: BTreeSet<usize>,
}

impl Hold {
    /// Whether bodies that touch the hull stick to it.
    pub(super) fn is_on(&self) -> bool {
        lock(&self.0).is_on
    }

    /// Lets bodies stick from now on, or releases them.
    pub(super) fn set(&self, on: bool) {
        let mut table = lock(&self.0);
        if !on {
            table.bodies.values_mut().for_each(HeldBody::release);
        }
        if table.is_on != on {
            table.refused.clear();
        }
        table.is_on = on;
    }

    /// Whether the body at an address sticks to the hull.
    pub(super) fn holds(&self, body: usize) -> bool {
        lock(&self.0).bodies.get(&body).is_some_and(HeldBody::is_held)
    }

    /// Whether the program has not been told yet, since the hull was held, that a body does not stick.
    fn is_first_refusal(&self, body: dBodyID) -> bool {
        lock(&self.0).refused.insert(body as usize)
    }

    /// A box around the bodies, in the world's frame, and around where they may be when the box is made next; empty without any.
    pub(super) fn bodies(&self) -> Aabb {
        lock(&self.0).bodies.values().fold(Aabb::EMPTY, |all, body| all.union(&body.reach()))
    }

    /// Counts a frame or a collide, and forgets bodies that are collided no more. Returns whether there are any left.
    pub(super) fn count(&self) -> bool {
        let mut table = lock(&self.0);
        table.bodies.retain(|_, body| body.count() <= FORGET_AFTER);
        !table.bodies.is_empty()
    }
}

impl CollideContext<'_> {
    /// Moves the body of `other` with the hull if it sticks to it, and returns whether it does: then it has no contacts. In
    /// the first collide after its release it gets the velocity of the subject.
    ///
    /// # Safety
    /// `other` is a living geom, and so is its body.
    pub(super) unsafe fn carry(&self, other: dGeomID) -> bool {
        // SAFETY: the caller vouches for the geom.
        let body = unsafe { dGeomGetBody(other) };
        if body.is_null() {
            return false;
        }
        let mut table = lock(&self.geom.hold.0);
        let Some(held) = table.bodies.get_mut(&(body as usize)) else { return false };
        // SAFETY: the caller vouches for the body.
        let carried = unsafe { held.carry(body, other, self) };
        if carried == Carried::Held {
            return true;
        }
        table.bodies.remove(&(body as usize));
        drop(table);
        if let Some(reason) = carried.reason() {
            self.geom.record_left_out(Error::argument(format!(
                "hold: expected the body to stick to the hull, {reason}; it sticks again when it touches the held hull"
            )));
        }
        false
    }

    /// Lets the body of `other`, whose contacts are `found`, stick to the hull if that is held, and returns whether it does.
    ///
    /// # Safety
    /// `other` is a living geom, and so is its body.
    pub(super) unsafe fn grab(&self, other: dGeomID, found: &BodyContacts) -> bool {
        if found.points.is_empty() || !self.geom.hold.is_on() {
            return false;
        }
        // SAFETY: the caller vouches for the geom and its body.
        let body = unsafe {
            let body = dGeomGetBody(other);
            if body.is_null() || dBodyIsKinematic(body) != 0 {
                return false;
            }
            body
        };

        let _one_at_a_time = lock(&GRABBING);
        let is_elsewhere = class::all().iter().any(|(_, geom)| {
            !std::ptr::eq::<HullGeom>(geom.as_ref(), self.geom) && geom.hold.holds(body as usize)
        });
        if is_elsewhere {
            if self.geom.hold.is_first_refusal(body) {
                self.geom.record_error(Error::argument(
                    "hold: expected a body that no other hull holds, found one that sticks to another hull, which keeps \
                     it; release that hull first",
                ));
            }
            return false;
        }
        let Some(track) = Track::begin(&self.hull, &middle(found)) else {
            if self.geom.hold.is_first_refusal(body) {
                self.geom.record_left_out(Error::argument(
                    "hold: expected edges of silhouettes around the contact, by which the hull is followed, found too \
                     few: the body touches without sticking",
                ));
            }
            return false;
        };
        // SAFETY: the caller vouches for the body and the geom.
        unsafe { self.keep(body, other, track) }
    }

    /// Keeps a body that has just been grabbed, and moves it on with the hull. Returns whether it is held: it is not where the
    /// hull was released meanwhile.
    ///
    /// # Safety
    /// `body` is living, and so is `other`, a geom of it.
    unsafe fn keep(&self, body: dBodyID, other: dGeomID, track: Track) -> bool {
        let mut table = lock(&self.geom.hold.0);
        if !table.is_on {
            return false;
        }
        // SAFETY: the caller vouches for the body.
        let mut held = unsafe { HeldBody::new(body, track, self) };
        // SAFETY: as above.
        let is_held = unsafe { held.carry(body, other, self) } == Carried::Held;
        if is_held {
            table.refused.remove(&(body as usize));
            table.bodies.insert(body as usize, held);
        }
        is_held
    }
}

/// The middle of the contacts, in the hull's frame.
fn middle(found: &BodyContacts) -> Point3<f64> {
    let sum = found.points.iter().fold(Vector3::zeros(), |sum, contact| sum + contact.point.coords);
    Point3::from(sum / found.points.len() as f64)
}
