//! Contacts of many bodies with a hull, computed together before ODE queries them pair by pair.
//!
//! ```text
//!   a step      A, B and C are collided one by one, and noted
//!   the next    A is queried again, in another pose ─► A, B and C are collided together
//!               B and C are copied from there as ODE queries them
//! ```
//!
//! ODE does not tell its colliders when a step begins, and bodies are collided faster side by side. But bodies that were
//! queried in one step are likely to be queried in the next. Contacts are used for an equal query only, so that results
//! do not change; a body that has moved in between is collided once more, alone.
//!
//! Geoms are remembered by their addresses, which are compared and never followed: the geoms to collide are those that
//! ODE lists in the space that it is colliding.

use super::query::{CollideContext, ContactQuery, PoseStamp};
use crate::contact::{self, BodyContacts, SampledBody, Settings};
use crate::hull::Hull;
use crate::lock::lock;
use crate::recycle::recycle;
use ode_sys::{
    dGeomGetClass, dGeomGetSpace, dGeomID, dQuadTreeSpaceClass, dSpaceGetGeom, dSpaceGetNumGeoms, dSpaceID,
    dTriMeshClass,
};
use std::collections::HashMap;
use std::sync::Mutex;

/// Steps without prefetching after one in which most prefetched contacts were not used: the program moves bodies between
/// queries.
const COOLDOWN_STEPS: u32 = 16;

/// Geoms that are remembered of a step. Bounds memory if geoms are never queried twice, since addresses accumulate.
const MAX_GEOMS: usize = 1 << 16;

/// Prefetched contacts of one step, and which geoms were queried when.
#[derive(Debug, Default)]
pub(super) struct ContactPrefetch {
    queries: Vec<ContactQuery>,
    /// The contacts of `queries`, in their order; there may be more places than queries.
    contacts: Vec<BodyContacts>,
    /// The place of each geom among the queries, by its address.
    places: HashMap<usize, usize>,
    /// How many prefetched contacts were used.
    used: usize,
    /// Geoms queried in the last step and in this one, with their poses.
    last_step: HashMap<usize, PoseStamp>,
    this_step: HashMap<usize, PoseStamp>,
    /// The addresses of the spaces that were collided as a whole in this step.
    spaces: Vec<usize>,
    /// Steps left without prefetching.
    cooldown: u32,
    /// Memory for lists that are built anew in each step.
    geoms: Vec<usize>,
    bodies: Vec<SampledBody<'static>>,
}

/// Writes the contacts of `query`, which is for the geom `other`, to `contacts`.
///
/// # Safety
/// `other` is a living geom, and no thread changes the space that it is in.
pub(super) unsafe fn contacts_for(
    prefetch: &Mutex<Option<Box<ContactPrefetch>>>,
    context: &CollideContext,
    other: dGeomID,
    query: &ContactQuery,
    contacts: &mut BodyContacts,
) {
    // Taken out, so that no lock is held while ODE is called: another thread that comes meanwhile collides its body alone.
    let Some(mut cached) = lock(prefetch).take() else {
        return collide_single(&context.hull, query, contacts);
    };

    if !cached.take_cached(query, contacts) {
        // SAFETY: the caller vouches for the geom.
        let space = unsafe { dGeomGetSpace(other) };
        if cached.should_batch(query, space) {
            // SAFETY: the caller vouches for the space.
            unsafe { cached.collide_space(space, context, query) };
            cached.take_cached(query, contacts);
        } else {
            collide_single(&context.hull, query, contacts);
        }
    }
    *lock(prefetch) = Some(cached);
}

/// Collides one body alone.
fn collide_single(hull: &Hull, query: &ContactQuery, contacts: &mut BodyContacts) {
    contact::collide_into(std::slice::from_mut(contacts), hull, &[query.body()], &query.settings);
}

impl ContactPrefetch {
    /// Writes the contacts of `query` to `contacts`, if they were prefetched.
    fn take_cached(&mut self, query: &ContactQuery, contacts: &mut BodyContacts) -> bool {
        let place = self.places.get(&query.other).filter(|&&place| self.queries[place].matches(query));
        let Some(&place) = place else { return false };
        contacts.copy(&self.contacts[place]);
        self.used += 1;
        self.this_step.insert(query.other, query.stamp);
        true
    }

    /// Notes `query`, and returns whether the other geoms of its space should be collided together with it.
    fn should_batch(&mut self, query: &ContactQuery, space: dSpaceID) -> bool {
        // The same geom in another pose or frame: a new step has begun.
        if self.this_step.get(&query.other).is_some_and(|before| *before != query.stamp) {
            self.begin_step();
        }
        if self.this_step.len() >= MAX_GEOMS {
            self.this_step.clear();
        }
        self.this_step.insert(query.other, query.stamp);

        let is_new_space = !space.is_null() && !self.spaces.contains(&(space as usize));
        let is_worth_it = is_new_space && self.cooldown == 0 && self.last_step.len() > 1;
        if is_worth_it && self.last_step.contains_key(&query.other) {
            self.spaces.push(space as usize);
            return true;
        }
        false
    }

    /// Forgets the contacts of the step that is over, and what was queried in the step before that.
    fn begin_step(&mut self) {
        if self.cooldown > 0 {
            self.cooldown -= 1;
        } else if 2 * self.used < self.queries.len() {
            self.cooldown = COOLDOWN_STEPS;
        }

        std::mem::swap(&mut self.this_step, &mut self.last_step);
        self.this_step.clear();
        self.spaces.clear();
        self.queries.clear();
        self.places.clear();
        self.used = 0;
    }

    /// Finds the contacts of `query`, together with those of all geoms in `space` that were queried in the last step and
    /// not yet in this one. Errors of other geoms are left to their own queries.
    ///
    /// # Safety
    /// `space` is a living space, and no thread changes it.
    unsafe fn collide_space(&mut self, space: dSpaceID, context: &CollideContext, query: &ContactQuery) {
        let first = self.queries.len();
        self.queries.push(query.clone());
        self.geoms.clear();
        // SAFETY: the caller vouches for the space.
        unsafe { collect_geoms(space, &mut self.geoms) };

        for &address in &self.geoms {
            if self.last_step.contains_key(&address) && !self.this_step.contains_key(&address) {
                let geom = address as dGeomID;
                // SAFETY: the geom is in the space, and so it is living.
                unsafe {
                    // All triangles of a mesh would be read twice.
                    if dGeomGetClass(geom) != dTriMeshClass as i32 {
                        self.queries.extend(ContactQuery::new(geom, context).ok().flatten());
                    }
                }
            }
        }

        for (place, query) in self.queries.iter().enumerate().skip(first) {
            self.places.insert(query.other, place);
        }
        self.find_contacts(first, &context.hull, &query.settings);
    }

    /// Finds the contacts of the queries from place `first` on.
    fn find_contacts(&mut self, first: usize, hull: &Hull, settings: &Settings) {
        let Self { queries, contacts, bodies, .. } = self;
        if contacts.len() < queries.len() {
            contacts.resize_with(queries.len(), BodyContacts::default);
        }
        let mut list: Vec<SampledBody> = recycle(std::mem::take(bodies));
        list.extend(queries[first..].iter().map(ContactQuery::body));
        contact::collide_into(&mut contacts[first..queries.len()], hull, &list, settings);
        *bodies = recycle(list);
    }
}

/// Adds the addresses of all geoms in `space`. A quadtree is left out, since ODE 0.16 cannot enumerate it.
///
/// # Safety
/// `space` is a living space, and no thread changes it.
unsafe fn collect_geoms(space: dSpaceID, addresses: &mut Vec<usize>) {
    // A space caches the geom that was enumerated last, and threads may collide pairs of one space side by side.
    static ENUMERATION: Mutex<()> = Mutex::new(());
    let _one_at_a_time = lock(&ENUMERATION);
    // SAFETY: the caller vouches for the space, which is a geom.
    unsafe {
        if dGeomGetClass(space.cast()) != dQuadTreeSpaceClass as i32 {
            let geom = |k| dSpaceGetGeom(space, k) as usize;
            addresses.extend((0..dSpaceGetNumGeoms(space)).map(geom));
        }
    }
}

#[cfg(test)]
mod tests;
