//! The contacts of each body with a hull geom when it was last awake: what wakes sleeping bodies, and which escape direction to keep.

use crate::hull::Aabb;
use crate::lock::lock;
use nalgebra::Vector3;
use std::collections::HashMap;
use std::sync::Mutex;

/// Steps after which a contact that was not renewed is forgotten.
const FORGET_AFTER: u64 = 1000;

/// Steps for which a body counts as touching after it has touched: a body at rest need not touch in every step, and
/// falls asleep after ten steps at rest, by ODE's default.
const RECENT: u64 = 20;

/// Number of geoms from which on those without a body are forgotten.
const MAX_GEOMS: usize = 1 << 16;

/// The last contacts of all bodies with one hull geom, under the addresses of the bodies' geoms.
///
/// An address is a hint only: by now it may be another geom's. It is compared and never followed.
#[derive(Debug, Default)]
pub(super) struct LastContacts {
    table: Mutex<Table>,
}

#[derive(Debug, Default)]
struct Table {
    by_geom: HashMap<usize, LastContact>,
    /// The number of steps so far. ODE does not tell when a step begins; here it does when a body's geom is collided again
    /// that was already collided in this step. Geoms without a body may be a program's own queries.
    steps: u64,
}

/// How a body touches the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touch {
    /// The deepest contact's depth in metres.
    pub(super) depth: f64,
    /// The deepest contact's direction out of the hull, in the hull's frame.
    pub(super) direction: Vector3<f64>,
}

/// What a collide has found of one body.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactState {
    pub(super) has_body: bool,
    pub(super) is_asleep: bool,
    /// `None` without contact.
    pub(super) touch: Option<Touch>,
    /// Whether the hull presses the body from opposite sides.
    pub(super) is_gripped: bool,
    /// The escape direction that was chosen, in the hull's frame.
    pub(super) escape: Option<Vector3<f64>>,
    /// The number of the loss of views before which the body was there, while the hull has grown over it.
    pub(super) kept_loss: Option<u64>,
    /// A box around the body, in the world's frame.
    pub(super) body: Aabb,
}

#[derive(Debug, Clone, Copy)]
struct LastContact {
    /// The last contact state, but while the body sleeps with the touch and the escape direction of when it fell asleep, so that
    /// slow motions of the hull's surface add up.
    state: ContactState,
    /// The [`Table::steps`] in which the body was last collided, and in which it last touched while awake.
    renewed: u64,
    touched: u64,
    /// The [`Table::steps`] in which the hull last pressed the body from opposite sides; `None` before it did.
    gripped: Option<u64>,
}

impl LastContacts {
    /// The escape direction chosen last for the geom at address `other`, in the hull's frame.
    pub(super) fn escape(&self, other: usize) -> Option<Vector3<f64>> {
        lock(&self.table).by_geom.get(&other)?.state.escape
    }

    /// How the geom at address `other` touched the hull when it was last awake.
    pub(super) fn touch(&self, other: usize) -> Option<Touch> {
        lock(&self.table).by_geom.get(&other)?.state.touch
    }

    /// Whether the hull has pressed the body of the geom at address `other` from opposite sides in the last steps.
    pub(super) fn is_gripped(&self, other: usize) -> bool {
        let table = lock(&self.table);
        let gripped = table.by_geom.get(&other).and_then(|last| last.gripped);
        gripped.is_some_and(|gripped| gripped + RECENT >= table.steps)
    }

    /// The [`ContactState::kept_loss`] of the geom at address `other`.
    pub(super) fn kept_loss(&self, other: usize) -> Option<u64> {
        lock(&self.table).by_geom.get(&other)?.state.kept_loss
    }

    /// Records that the geom at address `other` was collided. `is_woken` tells that its body was asleep until now.
    pub(super) fn record(&self, other: usize, mut state: ContactState, is_woken: bool) {
        let mut table = lock(&self.table);
        if state.has_body {
            table.count_steps(other);
        }
        table.forget_surplus();
        let steps = table.steps;
        let last = table.by_geom.get(&other).copied();

        if let Some(last) = last.filter(|_| state.is_asleep) {
            state.escape = last.state.escape;
        }
        let touched = if state.touch.is_some() { steps } else { last.map_or(0, |last| last.touched) };
        let keeps_touch = if state.is_asleep { !is_woken } else { touched + RECENT >= steps };
        if let Some(last) = last
            && keeps_touch
            && (state.is_asleep || state.touch.is_none())
        {
            state.touch = last.state.touch;
        }
        let gripped = if state.is_gripped { Some(steps) } else { last.and_then(|last| last.gripped) };
        table.by_geom.insert(other, LastContact { state, renewed: steps, touched, gripped });
    }

    /// A box around the bodies that touched the hull when they were last awake, in the world's frame: those that sleep,
    /// and those of the last steps, which may have fallen asleep since.
    pub(super) fn touching_bodies(&self) -> Aabb {
        let table = lock(&self.table);
        let may_sleep = |last: &&LastContact| last.state.is_asleep || last.is_recent(table.steps);
        let bodies = table.by_geom.values().filter(may_sleep).map(|last| &last.state);
        bodies
            .filter(|state| state.touch.is_some())
            .fold(Aabb::EMPTY, |union, state| union.union(&state.body))
    }

    /// The addresses of the geoms that touched the hull when their bodies were last awake.
    pub(super) fn touching_geoms(&self) -> Vec<usize> {
        let table = lock(&self.table);
        let touching = table.by_geom.iter().filter(|(_, last)| last.state.touch.is_some());
        touching.map(|(&geom, _)| geom).collect()
    }
}

impl LastContact {
    fn is_recent(&self, steps: u64) -> bool {
        self.renewed + RECENT >= steps
    }
}

impl Table {
    /// Counts the steps, and now and then removes contacts that were not renewed for long: their geoms may be gone.
    fn count_steps(&mut self, geom: usize) {
        if self.by_geom.get(&geom).is_none_or(|last| last.renewed != self.steps) {
            return;
        }
        self.steps += 1;
        if self.steps.is_multiple_of(FORGET_AFTER) {
            let now = self.steps;
            self.by_geom.retain(|_, last| last.renewed + FORGET_AFTER >= now);
        }
    }

    /// Bounds the memory where geoms are collided once each, and steps are not counted.
    fn forget_surplus(&mut self) {
        if self.by_geom.len() >= MAX_GEOMS {
            self.by_geom.retain(|_, last| last.state.has_body);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    const AT_ORIGIN: Aabb = Aabb { min: Point3::new(0.0, 0.0, 0.0), max: Point3::new(1.0, 1.0, 1.0) };

    fn state(is_asleep: bool, depth: Option<f64>) -> ContactState {
        let touch = depth.map(|depth| Touch { depth, direction: Vector3::z() });
        ContactState {
            has_body: true,
            is_asleep,
            touch,
            is_gripped: false,
            escape: None,
            kept_loss: None,
            body: AT_ORIGIN,
        }
    }

    fn depth(contacts: &LastContacts, geom: usize) -> Option<f64> {
        contacts.touch(geom).map(|touch| touch.depth)
    }

    #[test]
    fn a_sleeping_body_keeps_the_touch_with_which_it_fell_asleep_until_it_is_woken() {
        let contacts = LastContacts::default();
        contacts.record(1, state(false, Some(0.1)), false);
        contacts.record(1, state(true, Some(0.2)), false);
        contacts.record(1, state(true, None), false);
        assert_eq!(depth(&contacts, 1), Some(0.1));
        contacts.record(1, state(true, None), true);
        assert_eq!(depth(&contacts, 1), None);
    }

    #[test]
    fn a_body_that_touches_now_and_then_counts_as_touching() {
        let contacts = LastContacts::default();
        contacts.record(1, state(false, Some(0.1)), false);
        (0..RECENT).for_each(|_| contacts.record(1, state(false, None), false));
        assert_eq!(depth(&contacts, 1), Some(0.1));
        contacts.record(1, state(false, None), false);
        assert_eq!(depth(&contacts, 1), None);
    }

    #[test]
    fn no_contact_is_forgotten_within_a_step_however_many_bodies_it_has() {
        let contacts = LastContacts::default();
        for _ in 0..3 {
            (0..5000).for_each(|geom| contacts.record(geom, state(true, Some(0.1)), false));
        }
        assert!((0..5000).all(|geom| depth(&contacts, geom) == Some(0.1)));
        assert_eq!(contacts.touching_geoms().len(), 5000);
        assert_eq!(contacts.touching_bodies(), AT_ORIGIN);
    }

    #[test]
    fn contacts_of_geoms_that_are_gone_are_forgotten() {
        let contacts = LastContacts::default();
        contacts.record(1, state(true, Some(0.1)), false);
        (0..2 * FORGET_AFTER + 1).for_each(|_| contacts.record(2, state(false, None), false));
        assert_eq!(contacts.touching_geoms(), []);
        assert!(contacts.touching_bodies().is_empty());
    }
}
