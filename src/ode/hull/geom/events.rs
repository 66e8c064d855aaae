//! The contact events of a hull geom: switching them on, recording contacts, and fetching.

use super::HullGeom;
use crate::contact::{BodyContacts, SweptContact};
use crate::lock::lock;
use crate::ode::convert;
use crate::ode::hull::events::{Events, RecordedContact, TouchEvent, Toucher, WAIT};
use crate::ode::hull::query::CollideContext;
use crate::{Error, Result};
use nalgebra::{Point3, Vector3};
use ode_sys::{dBodyGetPointVel, dBodyID, dBodyIsEnabled, dGeomGetBody, dGeomID};
use std::sync::MutexGuard;

/// The events of a geom, and how they are set.
#[derive(Debug)]
pub(super) struct EventRecorder {
    /// How long a touch waits for its next contact, in seconds.
    wait: f64,
    /// `None` while events are off.
    events: Option<Box<Events>>,
}

impl Default for EventRecorder {
    fn default() -> Self {
        Self { wait: WAIT, events: None }
    }
}

impl HullGeom {
    fn recorder(&self) -> MutexGuard<'_, EventRecorder> {
        lock(&self.events)
    }

    /// Calls `change` with the events, where they are on.
    fn change_events<T>(&self, change: impl FnOnce(&mut Events) -> T) -> Option<T> {
        self.recorder().events.as_deref_mut().map(change)
    }

    /// Switches events on or off. Touches that go on when they are switched off have no event any more.
    pub(in crate::ode::hull) fn set_events(&self, on: bool) {
        let (hull, motion) = {
            let mut state = self.lock();
            state.has_events = on;
            (state.hull.clone(), state.motion)
        };

        let mut recorder = self.recorder();
        if on && recorder.events.is_none() {
            let mut events = Events::new(recorder.wait);
            events.follow(hull.as_ref(), motion);
            recorder.events = Some(Box::new(events));
        } else if !on {
            recorder.events = None;
        }
    }

    /// Whether events are on.
    pub(in crate::ode::hull) fn has_events(&self) -> bool {
        self.lock().has_events
    }

    /// How long a touch waits for its next contact before it ends, in seconds.
    pub(in crate::ode::hull) fn event_wait(&self) -> f64 {
        self.recorder().wait
    }

    /// Sets [`Self::event_wait`].
    pub(in crate::ode::hull) fn set_event_wait(&self, wait: f64) {
        let mut recorder = self.recorder();
        recorder.wait = wait;
        if let Some(events) = &mut recorder.events {
            events.set_wait(wait);
        }
    }

    /// Tells the events that the geom shows another frame.
    pub(super) fn follow_parts(&self) {
        let (hull, motion) = {
            let state = self.lock();
            if !state.has_events {
                return;
            }
            (state.hull.clone(), state.motion)
        };
        self.change_events(|events| events.follow(hull.as_ref(), motion));
    }

    /// Tells the events the time of the steps that follow.
    pub(super) fn set_event_time(&self, time: f64) {
        self.change_events(|events| events.set_time(time, &self.step_size));
    }

    /// Ends all touches, since the geom is bound to other data.
    pub(super) fn end_touches(&self) {
        self.change_events(Events::begin_anew);
    }

    /// Begins a step, where the program tells when.
    pub(in crate::ode::hull) fn begin_event_step(&self) {
        self.change_events(|events| events.begin_step(&self.step_size));
    }

    /// Looks up the ids of what has touched the hull in this step. All of it is living.
    pub(in crate::ode::hull) fn identify_touchers(
        &self,
        ids: impl Fn(&Toucher) -> Option<(crate::ode::GeomId, Option<crate::ode::BodyId>)>,
    ) {
        self.change_events(|events| events.identify(ids));
    }

    /// Closes the step, and passes `most` events at most to `fetch`. Returns how many remain.
    ///
    /// # Errors
    /// Events are off.
    pub(in crate::ode::hull) fn fetch_events(
        &self,
        most: usize,
        fetch: impl FnMut(TouchEvent),
    ) -> Result<usize> {
        let fetched = self.change_events(|events| {
            events.close_step_to_fetch(&self.step_size);
            events.take(most).for_each(fetch);
            (events.queued(), events.take_dropped(), events.waits_in_vain())
        });
        let (queued, dropped, waits_in_vain) = fetched.ok_or_else(|| {
            Error::argument(
                "events of the hull: expected them switched on, found them off; switch them on before the \
                             first collide",
            )
        })?;
        if dropped > 0 {
            self.record_left_out(Error::argument(format!(
                "events of the hull: expected that they are fetched after each step, found so many waiting that {dropped} \
                 of them are lost; fetch them more often"
            )));
        }
        if waits_in_vain {
            self.record_left_out(Error::argument(
                "events of the hull: expected the length of a step, or frames of different times, found none, so that no \
                 touch can end; set the hull's time before each collide",
            ));
        }
        Ok(queued)
    }
}

impl CollideContext<'_> {
    /// Records the contacts that are handed out for `other`, where events are on.
    ///
    /// # Safety
    /// Both geoms are living, and so are their bodies.
    pub(in crate::ode::hull) unsafe fn record_touch(
        &self,
        hull: dGeomID,
        other: dGeomID,
        found: &BodyContacts,
        swept: &[SweptContact],
    ) {
        if !self.has_events {
            return;
        }

        // SAFETY: the caller vouches for the geoms, and ODE for their bodies.
        let (body, own, is_asleep) = unsafe {
            let body = dGeomGetBody(other);
            (body, dGeomGetBody(hull), !body.is_null() && dBodyIsEnabled(body) == 0)
        };
        let toucher = toucher(other, body);
        let step = &self.geom.step_size;
        if found.points.is_empty() && swept.is_empty() {
            if is_asleep && self.geom.last_contacts.touch(other as usize).is_some() {
                self.geom.change_events(|events| events.record_resting(toucher, step));
            }
            return;
        }

        let world_from_hull = self.hull_from_world.inverse();
        let now = found.contacts().map(|contact| (contact.point, contact.direction, contact.depth, 0.0));
        let to_come = swept.iter().map(|contact| (contact.point, contact.direction, 0.0, contact.seconds));
        let contacts = now.chain(to_come).map(|(point, direction, depth, seconds)| {
            let position = world_from_hull * point;
            // SAFETY: as above.
            let velocity = unsafe { velocity_of(body, &position) - velocity_of(own, &position) };
            let velocity = self.hull_from_world * velocity;
            RecordedContact {
                toucher,
                position,
                normal: world_from_hull * direction,
                depth,
                seconds,
                place: point + velocity * seconds,
                direction,
                velocity,
            }
        });
        self.geom.change_events(|events| events.record(contacts, step));
    }

    /// Records that the body of `other` sticks to the hull, where events are on: its touch goes on without contacts.
    ///
    /// # Safety
    /// The geom is living.
    pub(in crate::ode::hull) unsafe fn record_held(&self, other: dGeomID) {
        if self.has_events {
            // SAFETY: the caller vouches for the geom.
            let held = toucher(other, unsafe { dGeomGetBody(other) });
            self.geom.change_events(|events| events.record_resting(held, &self.geom.step_size));
        }
    }
}

/// What touches the hull, by its addresses.
fn toucher(geom: dGeomID, body: dBodyID) -> Toucher {
    Toucher { geom: geom as usize, body: body as usize, ids: None }
}

/// The velocity of a body's point, both in the world; zero without a body.
///
/// # Safety
/// `body` is null or living.
unsafe fn velocity_of(body: dBodyID, p: &Point3<f64>) -> Vector3<f64> {
    let mut velocity = [0.0; 4];
    if !body.is_null() {
        // SAFETY: the caller vouches for the body; the array holds four numbers.
        unsafe { dBodyGetPointVel(body, p.x, p.y, p.z, velocity.as_mut_ptr()) };
    }
    convert::vector(&velocity)
}
