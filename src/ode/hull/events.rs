//! Contact events: when a body begins to touch a part of a hull, and when that touch ends.
//!
//! ```text
//!   contacts of a step    .  x  x  x  .  x  x  .  .  .  .  .
//!   touch                    begin-----------------wait--> end, with the time of the last contact
//! ```
//!
//! The collider records contacts as it hands them out, on any thread and in any order. When the step is over, they are
//! sorted, their parts are found, and touches begin or go on. A touch ends when it has had no contact for longer than a mask
//! flickers, so that no touch is doubled.
//!
//! Bodies and geoms are told apart by their addresses, which are compared and never followed, and by their ids where a
//! [`World`](crate::ode::World) has told them.

mod clock;

use super::step_size::StepSize;
use crate::hull::{AT_SURFACE, Hull, Motion, NEAR_SURFACE, PartId, Parts};
use crate::ode::arena::{BodyId, GeomId};
use clock::Clock;
use nalgebra::{Point3, Vector3};
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// The default of [`Events::wait`], in seconds: three frames of 30 a second.
pub(super) const WAIT: f64 = 0.1;

/// The most events that wait to be fetched.
const MAX_QUEUED: usize = 1 << 16;

/// Steps without contact after which it is told that no time passes.
const PATIENCE: u64 = 10;

/// By how much times that add up may be off, in seconds.
const ROUNDING: f64 = 1e-9;

/// What touches a hull: a body, or a geom without one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Toucher {
    /// The addresses of the geom and of its body, 0 for none.
    pub(crate) geom: usize,
    pub(crate) body: usize,
    /// Their ids, where a world has told them.
    pub(crate) ids: Option<(GeomId, Option<BodyId>)>,
}

/// Whether a touch has begun or ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HullEventKind {
    /// The first contact.
    Begin,
    /// There was no contact for as long as [`HullMut::set_event_wait`](super::HullMut::set_event_wait) says.
    End,
}

/// A contact event, before its ids are looked up. The fields are those of [`HullEvent`](super::HullEvent).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TouchEvent {
    pub(crate) kind: HullEventKind,
    pub(crate) toucher: Toucher,
    pub(crate) part: PartId,
    pub(crate) time: f64,
    pub(crate) position: Point3<f64>,
    pub(crate) normal: Vector3<f64>,
    pub(crate) depth_rate: f64,
}

/// A contact as the collider has handed it out.
#[derive(Debug, Clone, Copy)]
pub(super) struct RecordedContact {
    pub(super) toucher: Toucher,
    /// In the world's frame; the normal points out of the hull.
    pub(super) position: Point3<f64>,
    pub(super) normal: Vector3<f64>,
    /// In metres.
    pub(super) depth: f64,
    /// Seconds until it begins; 0 where it has.
    pub(super) seconds: f64,
    /// In the hull's frame: where the surface is touched, the normal, and the velocity there of the body against the geom.
    pub(super) place: Point3<f64>,
    pub(super) direction: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
}

/// What tells touches apart: the body, or the geom without one, and the part of the hull.
type TouchKey = (Identity, PartId);

/// An address, and the id where it is known: another body may have had the same address.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Identity {
    Body(usize, Option<BodyId>),
    Geom(usize, Option<GeomId>),
}

/// A touch that goes on.
#[derive(Debug)]
struct Touch {
    /// Counts touches in the order in which they began.
    number: u64,
    toucher: Toucher,
    /// The time of the last contact, in seconds, and the number of its step.
    last: f64,
    step: u64,
    /// The deepest contact.
    position: Point3<f64>,
    normal: Vector3<f64>,
    depth: f64,
    /// The strongest so far, in m/s.
    depth_rate: f64,
}

/// The contact events of one hull geom.
#[derive(Debug)]
pub(super) struct Events {
    /// How long a touch waits for its next contact, in seconds.
    wait: f64,
    clock: Clock,
    /// The frame in force, and which hull the geom shows.
    hull: Option<Arc<Hull>>,
    motion: Motion,
    parts: Parts,
    /// Contacts of this step whose parts are not found yet.
    contacts: Vec<RecordedContact>,
    /// Bodies that sleep as they fell asleep: touching the hull.
    resting: Vec<Toucher>,
    touches: HashMap<TouchKey, Touch>,
    /// How many touches have begun.
    begun: u64,
    queue: VecDeque<TouchEvent>,
    /// Whether the last events taken were as many as asked for, so that the next call may be for the rest of the step.
    was_filled: bool,
    /// How many events found the queue full since that was told last.
    dropped: u64,
}

impl Events {
    /// Without events so far.
    pub(super) fn new(wait: f64) -> Self {
        Self {
            wait,
            clock: Clock::default(),
            hull: None,
            motion: Motion::Held,
            parts: Parts::default(),
            contacts: Vec::new(),
            resting: Vec::new(),
            touches: HashMap::new(),
            begun: 0,
            queue: VecDeque::new(),
            was_filled: false,
            dropped: 0,
        }
    }

    /// Sets how long a touch waits for its next contact, in seconds.
    pub(super) fn set_wait(&mut self, wait: f64) {
        self.wait = wait;
    }

    /// Sets the time of the steps that follow, and closes the one before.
    pub(super) fn set_time(&mut self, time: f64, step: &StepSize) {
        if self.clock.is_open {
            self.close_step(step);
        }
        if !self.clock.is_told {
            // Another clock: the touches that go on keep their age.
            self.touches.values_mut().for_each(|touch| touch.last += time - self.clock.now);
        }
        (self.clock.now, self.clock.is_told) = (time, true);
    }

    /// Ends all touches, since the next frame is of other data, by another clock.
    pub(super) fn begin_anew(&mut self) {
        self.find_touches();
        self.end_touches(|_| true);
        self.parts.begin_anew();
        (self.hull, self.clock.is_told) = (None, false);
    }

    /// Follows the parts to the frame that is in force from now on.
    pub(super) fn follow(&mut self, next: Option<&Arc<Hull>>, motion: Motion) {
        self.find_touches();
        self.motion = motion;
        let Some(next) = next else { return };
        if let Some(last) = &self.hull {
            self.clock.between_frames += (next.time() - last.time()).max(0.0);
        }
        self.parts.follow(self.hull.as_deref(), next);
        self.hull = Some(next.clone());
    }

    /// Records contacts of one body, or that it rests.
    pub(super) fn record(&mut self, contacts: impl Iterator<Item = RecordedContact>, step: &StepSize) {
        self.clock.open(step);
        self.contacts.extend(contacts);
    }

    /// Records that a body sleeps, and touches the hull as it did when it fell asleep, or that it sticks to the hull.
    pub(super) fn record_resting(&mut self, body: Toucher, step: &StepSize) {
        self.clock.open(step);
        self.resting.push(body);
    }

    /// Looks up the ids of what has touched in this step. All of it is living.
    pub(super) fn identify(&mut self, ids: impl Fn(&Toucher) -> Option<(GeomId, Option<BodyId>)>) {
        let touchers = self.contacts.iter_mut().map(|contact| &mut contact.toucher).chain(&mut self.resting);
        for toucher in touchers.filter(|toucher| toucher.ids.is_none()) {
            toucher.ids = ids(toucher);
        }
    }

    /// Begins the next step, and closes the one before unless that is done.
    pub(super) fn begin_step(&mut self, step: &StepSize) {
        if self.clock.is_open {
            self.close_step(step);
        }
        self.clock.open(step);
    }

    /// Closes the step before events are fetched. Where the program does not tell the time, a call for the rest of the last
    /// step closes no other one.
    pub(super) fn close_step_to_fetch(&mut self, step: &StepSize) {
        let is_for_rest = std::mem::take(&mut self.was_filled) || !self.queue.is_empty();
        if self.clock.is_told || self.clock.is_open || !is_for_rest {
            self.close_step(step);
        }
    }

    /// Closes the step: touches begin, go on, or end.
    pub(super) fn close_step(&mut self, step: &StepSize) {
        self.clock.open(step);
        self.find_touches();
        let oldest = self.clock.now - self.wait - ROUNDING;
        self.end_touches(|touch| touch.last < oldest);
        self.clock.is_open = false;
    }

    /// Whether a touch waits to end while no time passes.
    pub(super) fn waits_in_vain(&self) -> bool {
        let Clock { now, is_told, steps, .. } = self.clock;
        now == 0.0 && !is_told && self.touches.values().any(|touch| touch.step + PATIENCE < steps)
    }

    /// How many events wait to be fetched.
    pub(super) fn queued(&self) -> usize {
        self.queue.len()
    }

    /// Takes up to `most` events, the earliest first.
    pub(super) fn take(&mut self, most: usize) -> impl Iterator<Item = TouchEvent> {
        let count = most.min(self.queue.len());
        self.was_filled = most > 0 && count == most;
        self.queue.drain(..count)
    }

    /// Takes the number of events that found the queue full.
    pub(super) fn take_dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    /// Finds the parts of the contacts recorded, and begins touches or lets them go on.
    fn find_touches(&mut self) {
        let mut contacts = std::mem::take(&mut self.contacts);
        if let Some(hull) = self.hull.clone() {
            // Threads record in any order, and new parts get their ids in this one.
            contacts.sort_by(RecordedContact::compare);
            let mut deepest: Vec<(TouchKey, RecordedContact)> = Vec::new();
            let mut places: HashMap<TouchKey, usize> = HashMap::new();
            for contact in &contacts {
                let reach = if contact.seconds > 0.0 { NEAR_SURFACE } else { AT_SURFACE };
                let Some(part) = self.parts.part_at(&hull, &contact.place, reach) else { continue };
                let key = (contact.toucher.identity(), part);
                let place = *places.entry(key).or_insert(deepest.len());
                match deepest.get_mut(place) {
                    Some((_, known)) if known.depth < contact.depth => *known = *contact,
                    Some(_) => {}
                    None => deepest.push((key, *contact)),
                }
            }
            for (key, contact) in &deepest {
                let depth_rate = contact.depth_rate(&hull, self.motion);
                self.touch(*key, contact, depth_rate);
            }
        }
        contacts.clear();
        self.contacts = contacts;

        let now = self.clock.now;
        for body in self.resting.drain(..) {
            let touches = self.touches.iter_mut().filter(|((other, _), _)| *other == body.identity());
            touches.for_each(|(_, touch)| touch.renew(now, self.clock.steps));
        }
    }

    /// Begins a touch by a contact of this step, or lets it go on.
    fn touch(&mut self, key: TouchKey, contact: &RecordedContact, depth_rate: f64) {
        let &RecordedContact { toucher, position, normal, depth, seconds, .. } = contact;
        let now = self.clock.now;
        if let Some(touch) = self.touches.get_mut(&key) {
            touch.renew(now + seconds, self.clock.steps);
            touch.depth_rate = touch.depth_rate.max(depth_rate);
            if touch.depth < depth {
                (touch.toucher, touch.position, touch.normal, touch.depth) =
                    (toucher, position, normal, depth);
            }
            return;
        }

        self.begun += 1;
        let touch = Touch {
            number: self.begun,
            toucher,
            last: now + seconds,
            step: self.clock.steps,
            position,
            normal,
            depth,
            depth_rate,
        };
        self.push(touch.event(HullEventKind::Begin, key.1));
        self.touches.insert(key, touch);
    }

    /// Ends the touches for which `is_over` is true, in the order in which they began.
    fn end_touches(&mut self, is_over: impl Fn(&Touch) -> bool) {
        let mut over: Vec<(TouchKey, Touch)> = self.touches.extract_if(|_, touch| is_over(touch)).collect();
        over.sort_by_key(|(_, touch)| touch.number);
        for ((_, part), touch) in &over {
            self.push(touch.event(HullEventKind::End, *part));
        }
    }

    /// Queues an event, or counts it where the queue is full.
    fn push(&mut self, event: TouchEvent) {
        if self.queue.len() < MAX_QUEUED {
            self.queue.push_back(event);
        } else {
            self.dropped += 1;
        }
    }
}

impl Toucher {
    fn identity(&self) -> Identity {
        match self.body {
            0 => Identity::Geom(self.geom, self.ids.map(|(geom, _)| geom)),
            body => Identity::Body(body, self.ids.and_then(|(_, body)| body)),
        }
    }
}

impl Touch {
    /// Lets it go on at `time`, in the step with this number.
    fn renew(&mut self, time: f64, step: u64) {
        (self.last, self.step) = (self.last.max(time), step);
    }

    fn event(&self, kind: HullEventKind, part: PartId) -> TouchEvent {
        let &Self { toucher, last, position, normal, depth_rate, .. } = self;
        TouchEvent { kind, toucher, part, time: last, position, normal, depth_rate }
    }
}

impl RecordedContact {
    /// An order by places and depths, which are the same in each run, whatever the threads do. Addresses come last.
    fn compare(&self, other: &Self) -> std::cmp::Ordering {
        let numbers = |contact: &Self| {
            let (p, d) = (contact.place, contact.direction);
            [p.x, p.y, p.z, contact.depth, contact.seconds, d.x, d.y, d.z]
        };
        let pairs = numbers(self).into_iter().zip(numbers(other));
        let by_numbers = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
        let address = |contact: &Self| (contact.toucher.body, contact.toucher.geom);
        by_numbers.unwrap_or_else(|| address(self).cmp(&address(other)))
    }

    /// How fast the depth grows, in m/s: the speed of the body against the surface, along the normal; 0 where it shrinks.
    fn depth_rate(&self, hull: &Hull, motion: Motion) -> f64 {
        let moves = motion != Motion::Held;
        // Along a normal, the mean of a tenth of a second is as near to the truth as noise allows.
        let of_surface = if moves { hull.surface_velocity(&self.place) } else { None };
        let of_surface = of_surface.map_or(Vector3::zeros(), |found| found.mean);
        (of_surface - self.velocity).dot(&self.direction).max(0.0)
    }
}

#[cfg(test)]
mod tests;
