//! Contacts of many bodies with a hull, found together before ODE asks for them pair by pair.
//!
//! ```text
//!   a step      A alone, B alone, C alone                        each is noted
//!   the next    A is asked for again, elsewhere ─► A, B and C together
//!               A, B and C are handed out as ODE asks for them
//! ```
//!
//! Whoever was asked for in one step is likely to be asked for in the next. An answer is handed out for the very
//! question that it answers, so that it is what the body alone would get; a body that has moved meanwhile is alone.
//!
//! Geoms are remembered by their addresses, which are compared and never followed: those to ask for ahead are met in
//! the space that ODE is colliding.

use super::body_samples;
use super::geom::{Collidable, HullGeom};
use crate::Result;
use crate::contact::{self, BodyContacts, SampledBody, Settings};
use crate::hull::Hull;
use crate::lock::lock;
use crate::ode::convert;
use crate::recycle::recycle;
use crate::sample::Samples;
use nalgebra::{Isometry3, Vector3};
use ode_sys::{
    dGeomGetClass, dGeomGetSpace, dGeomID, dQuadTreeSpaceClass, dSpaceGetGeom, dSpaceGetNumGeoms, dSpaceID,
    dTriMeshClass,
};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Steps in which nothing is asked ahead after most answers went unused: the program moves bodies between questions.
const REST: u32 = 16;

/// Geoms that are remembered of a step: enough for any, and few enough for a program that never asks for one twice.
const MOST: usize = 1 << 16;

/// What the contacts of a body with a hull depend on.
#[derive(Debug, Clone)]
pub(super) struct Question {
    /// The address of its geom.
    pub(super) other: usize,
    pub(super) samples: Arc<Samples>,
    pub(super) when: Moment,
    pub(super) settings: Settings,
    pub(super) last_escape: Option<Vector3<f64>>,
}

/// Where a body was in which frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    /// How many frames the hull had taken up by then.
    pub(super) frame: u64,
    pub(super) hull_from_other: Isometry3<f64>,
}

/// What is in force in a hull geom while ODE asks it.
pub(super) struct InForce<'a> {
    pub(super) geom: &'a HullGeom,
    pub(super) now: &'a Collidable,
    pub(super) hull_from_world: &'a Isometry3<f64>,
}

/// The answers that wait for their questions.
#[derive(Debug, Default)]
pub(super) struct Ahead {
    /// As many answers at least, which belong to the questions in their order.
    questions: Vec<Question>,
    answers: Vec<BodyContacts>,
    /// The place of each geom's.
    places: HashMap<usize, usize>,
    handed_out: usize,
    /// Geoms asked for in the last step and in this one, and when.
    expected: HashMap<usize, Moment>,
    asked: HashMap<usize, Moment>,
    /// The addresses of the spaces that were looked through in this step.
    spaces: Vec<usize>,
    /// Steps in which nothing is asked ahead.
    rest: u32,
    /// Memory.
    met: Vec<usize>,
    bodies: Vec<SampledBody<'static>>,
}

impl Question {
    /// That for the contacts of `geom`; `None` for a class that has no surface, and in a pose that is not finite.
    ///
    /// # Errors
    /// A shape that cannot be sampled.
    ///
    /// # Safety
    /// `geom` is living.
    pub(super) unsafe fn of(geom: dGeomID, in_force: &InForce) -> Result<Option<Self>> {
        let Collidable { settings, min_feature, adopted, .. } = *in_force.now;
        // SAFETY: the caller vouches for the geom.
        let world_from_geom = unsafe { convert::any_pose(geom) };
        let hull_from_other = in_force.hull_from_world * world_from_geom;
        if !hull_from_other.to_homogeneous().iter().all(|x| x.is_finite()) {
            return Ok(None);
        }
        // SAFETY: as above; the pose is the geom's.
        let samples = unsafe { body_samples::of(geom, &world_from_geom, min_feature)? };
        let (other, when) = (geom as usize, Moment { frame: adopted, hull_from_other });
        let question =
            |samples| Self { other, samples, when, settings, last_escape: in_force.geom.last_escape(other) };
        Ok(samples.map(question))
    }

    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.samples, &other.samples)
            && self.when == other.when
            && self.settings == other.settings
            && self.last_escape == other.last_escape
    }

    fn body(&self) -> SampledBody<'_> {
        let Self { samples, when, last_escape, .. } = self;
        SampledBody { samples, hull_from_body: when.hull_from_other, last_escape: *last_escape }
    }
}

/// Writes the answer to `question`, which is of `other`, to `contacts`.
///
/// # Safety
/// `other` is living, and nobody changes the space that it is in.
pub(super) unsafe fn answer(
    in_force: &InForce,
    other: dGeomID,
    question: Question,
    contacts: &mut BodyContacts,
) {
    // No lock is held while ODE is called: another thread that asks meanwhile asks for its body alone.
    let Some(mut ahead) = lock(&in_force.geom.ahead).take() else {
        return answer_alone(&in_force.now.hull, &question, contacts);
    };
    if !ahead.hand_out(&question, contacts) {
        // SAFETY: the caller vouches for the geom.
        let space = unsafe { dGeomGetSpace(other) };
        if ahead.expects(&question, space) {
            // SAFETY: the caller vouches for the space.
            unsafe { ahead.look_through(space, in_force, &question) };
            ahead.hand_out(&question, contacts);
        } else {
            answer_alone(&in_force.now.hull, &question, contacts);
        }
    }
    *lock(&in_force.geom.ahead) = Some(ahead);
}

fn answer_alone(hull: &Hull, question: &Question, contacts: &mut BodyContacts) {
    contact::collide_into(std::slice::from_mut(contacts), hull, &[question.body()], &question.settings);
}

impl Ahead {
    /// Writes the answer to `contacts`, if it has been found.
    fn hand_out(&mut self, question: &Question, contacts: &mut BodyContacts) -> bool {
        let place = self.places.get(&question.other).filter(|&&place| self.questions[place].is(question));
        let Some(&place) = place else { return false };
        contacts.copy(&self.answers[place]);
        self.handed_out += 1;
        self.asked.insert(question.other, question.when);
        true
    }

    /// Notes the question, and says whether others of its space are worth being asked ahead.
    fn expects(&mut self, question: &Question, space: dSpaceID) -> bool {
        if self.asked.get(&question.other).is_some_and(|before| *before != question.when) {
            self.begin_step();
        }
        if self.asked.len() >= MOST {
            self.asked.clear();
        }
        self.asked.insert(question.other, question.when);
        let is_new = !space.is_null() && !self.spaces.contains(&(space as usize));
        let expects = is_new && self.rest == 0 && self.expected.len() > 1;
        if expects && self.expected.contains_key(&question.other) {
            self.spaces.push(space as usize);
            return true;
        }
        false
    }

    /// A geom was asked for again, elsewhere or in another frame.
    fn begin_step(&mut self) {
        if self.rest > 0 {
            self.rest -= 1;
        } else if 2 * self.handed_out < self.questions.len() {
            self.rest = REST;
        }
        std::mem::swap(&mut self.asked, &mut self.expected);
        self.asked.clear();
        self.spaces.clear();
        self.questions.clear();
        self.places.clear();
        self.handed_out = 0;
    }

    /// Answers the question, together with those of all geoms in `space` that are expected and were not asked for yet.
    /// What cannot be sampled says so once it is asked for itself.
    ///
    /// # Safety
    /// `space` is living, and nobody changes it.
    unsafe fn look_through(&mut self, space: dSpaceID, in_force: &InForce, question: &Question) {
        let first = self.questions.len();
        self.questions.push(question.clone());
        self.met.clear();
        // SAFETY: the caller vouches for the space.
        unsafe { meet(space, &mut self.met) };
        for &address in &self.met {
            if self.expected.contains_key(&address) && !self.asked.contains_key(&address) {
                let geom = address as dGeomID;
                // SAFETY: the geom is in the space, and so it is living.
                unsafe {
                    // All triangles of a mesh would be read twice.
                    if dGeomGetClass(geom) != dTriMeshClass as i32 {
                        self.questions.extend(Question::of(geom, in_force).ok().flatten());
                    }
                }
            }
        }
        for (place, question) in self.questions.iter().enumerate().skip(first) {
            self.places.insert(question.other, place);
        }
        self.find_answers(first, &in_force.now.hull, &question.settings);
    }

    /// Answers the questions from place `first` on.
    fn find_answers(&mut self, first: usize, hull: &Hull, settings: &Settings) {
        let Self { questions, answers, bodies, .. } = self;
        if answers.len() < questions.len() {
            answers.resize_with(questions.len(), BodyContacts::default);
        }
        let mut list: Vec<SampledBody> = recycle(std::mem::take(bodies));
        list.extend(questions[first..].iter().map(Question::body));
        contact::collide_into(&mut answers[first..questions.len()], hull, &list, settings);
        *bodies = recycle(list);
    }
}

/// Adds the addresses of all geoms in `space`, but of none in a quadtree, which ODE 0.16 cannot enumerate.
///
/// # Safety
/// `space` is living, and nobody changes it.
unsafe fn meet(space: dSpaceID, addresses: &mut Vec<usize>) {
    // A space remembers which geom it was asked for last, and threads may collide pairs of one space side by side.
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
