//! Two geoms that may touch: their bodies, their contacts, and what a visual hull adds to a contact's surface.

use std::cell::Cell;
use std::fmt;

use nalgebra::Vector3;
use ode_sys::{
    CONTACTS_UNIMPORTANT, dAreConnectedExcluding, dGeomGetBody, dGeomID, dJointID, dJointTypeContact,
};

use super::arena::{BodyId, GeomId};
use super::body::Body;
use super::contacts::{ContactGeom, Contacts, create_contact, true_contacts};
use super::geom::Geom;
use super::hull::{Restitution, Softness, SurfaceMotion, Touching, grip_softness, surface_motion};
use super::slip::friction_direction;
use super::surface::{Approximation, Surface};
use super::world::World;
use crate::Error;

/// Two geoms whose bounding boxes overlap, as [`World::collide`] passes them to its closure.
pub struct Pair<'c> {
    pub(super) world: &'c World,
    pub(super) first_error: &'c Cell<Option<Error>>,
    pub(super) raw: [dGeomID; 2],
    pub(super) geoms: [GeomId; 2],
}

impl<'c> Pair<'c> {
    /// The ids of the two geoms.
    pub fn geoms(&self) -> [GeomId; 2] {
        self.geoms
    }

    /// Read access to the two geoms.
    pub fn geom_views(&self) -> [Geom<'c>; 2] {
        self.geoms.map(|geom| self.world.geom(geom))
    }

    /// The bodies of the two geoms; `None` for a geom without a body.
    pub fn bodies(&self) -> [Option<BodyId>; 2] {
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        self.raw.map(|geom| unsafe { self.world.body_id(dGeomGetBody(geom)) })
    }

    /// Read access to a body, if it exists in this world.
    pub fn body(&self, id: BodyId) -> Option<Body<'c>> {
        self.world.get_body(id)
    }

    /// Whether a joint that is not a contact connects the two bodies.
    pub fn are_connected_excluding_contact(&self) -> bool {
        // SAFETY: both geoms are alive, and so are their bodies.
        let [first, second] = self.raw.map(|geom| unsafe { dGeomGetBody(geom) });
        // SAFETY: two living bodies.
        !first.is_null()
            && !second.is_null()
            && unsafe { dAreConnectedExcluding(first, second, dJointTypeContact as i32) } != 0
    }

    /// Up to `max` contacts, at most 65 535; at most 1000 of a capsule or cylinder with a triangle mesh.
    pub fn contacts(&self, max: usize) -> Contacts<'c> {
        true_contacts(self.world, self.raw, self.geoms, max, 0)
    }

    /// Whether the two geoms touch. For visual hulls this is faster than computing their contacts.
    pub fn touches(&self) -> bool {
        // ODE's own colliders miss touching boxes with this flag, and read contacts that they have not written.
        let has_hull = self.has_hull();
        // A few, since false ones of heightfields are dropped.
        let (max, flags) = if has_hull { (1, CONTACTS_UNIMPORTANT) } else { (8, 0) };
        !true_contacts(self.world, self.raw, self.geoms, max, flags).is_empty()
    }

    fn has_hull(&self) -> bool {
        self.raw.iter().any(|&geom| self.world.is_hull(geom))
    }

    /// The unit direction in which the first body would slip over the second in the next step without friction, for
    /// [`Surface::friction_direction`]; `None` where it would not. `dt` is the length of the step in seconds, in which gravity
    /// and forces change how the bodies move. The surface of a hull counts as at rest: see
    /// [`surface_motion`](Self::surface_motion) for one that moves.
    ///
    /// ODE limits friction in each of two directions. Where the first one is along the slip, the limit is that of Coulomb's
    /// law; otherwise it is up to 1.4 times as large.
    pub fn slip_direction(&self, contact: &ContactGeom, dt: f64) -> Option<Vector3<f64>> {
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        unsafe { friction_direction(self.raw, &contact.position, &contact.normal.normalize(), dt) }
    }

    /// `surface` with all that a visual hull adds to it at a contact of this pair, as [`World::default_collide`] does: the
    /// motion of the real surface ([`surface_motion`](Self::surface_motion)), the direction of friction
    /// ([`slip_direction`](Self::slip_direction)), and the softness of a grip ([`grip_softness`](Self::grip_softness)). Where
    /// a surface with [`bounce`](Surface::bounce) parts from the body already, an impact at another contact brings it back by
    /// the coefficient of restitution; where friction would turn the body's slip about, that coefficient is smaller: neither
    /// adds energy. A friction direction and a softness that it states are kept, and so is all of it where neither geom is a
    /// hull. `dt` is the length of the next step in seconds.
    pub fn surface_at(&self, contact: &ContactGeom, surface: &Surface, dt: f64) -> Surface {
        if !self.has_hull() {
            return *surface;
        }
        let mut found = match self.surface_motion_along(contact, dt, surface.friction_direction) {
            Some(motion) => surface.with_motion(&motion),
            None => *surface,
        };
        found.friction_direction = found.friction_direction.or_else(|| self.slip_direction(contact, dt));
        let found = self.without_gain(contact, found);
        self.grip_softness(dt).map_or(found, |softness| found.with_softness(softness))
    }

    /// How the real surface moves at a contact of this pair; `None` unless one of its geoms is a visual hull in
    /// [`Motion`](crate::hull::Motion) whose velocity is known there.
    ///
    /// `dt` is the length of the next step in seconds, in which gravity and forces change how the body slips.
    /// [`Surface::with_motion`] hands the result to a contact.
    pub fn surface_motion(&self, contact: &ContactGeom, dt: f64) -> Option<SurfaceMotion> {
        self.surface_motion_along(contact, dt, None)
    }

    /// The softness of this pair's contacts, if one of its geoms is a visual hull that has pressed the other one's body from
    /// opposite sides, as two hands do, in this collide or one of the last twenty; `None` otherwise. It is that of a critically
    /// damped spring of 140 rad/s at the body's mass, and `dt` is the length of the next step in seconds. Ask for it after
    /// [`contacts`](Self::contacts); [`Surface::with_softness`] hands it to a contact.
    ///
    /// As stiff as other contacts, two opposite sides would press a body by thousands of times its weight, and the solver's
    /// errors would move it out from between them.
    pub fn grip_softness(&self, dt: f64) -> Option<Softness> {
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        unsafe { grip_softness(self.raw, dt) }
    }

    /// `surface` with a restitution with which the contact adds no energy on its own.
    fn without_gain(&self, contact: &ContactGeom, surface: Surface) -> Surface {
        let Some(bounce) = surface.bounce.filter(|bounce| *bounce > 0.0 && *bounce <= 1.0) else {
            return surface;
        };
        let restitution = Restitution {
            bounce,
            bounce_velocity: surface.bounce_velocity,
            normal_velocity: surface.normal_velocity,
            mu: (surface.approximation == Approximation::Pyramid).then_some(surface.mu),
        };
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        let found = unsafe { restitution.without_gain(self.raw, &contact.position, &contact.normal) };
        Surface { bounce: Some(found.bounce), normal_velocity: found.normal_velocity, ..surface }
    }

    fn surface_motion_along(
        &self,
        contact: &ContactGeom,
        dt: f64,
        friction_direction: Option<Vector3<f64>>,
    ) -> Option<SurfaceMotion> {
        let &ContactGeom { position, normal, depth, time, .. } = contact;
        let touching = Touching { position, normal, depth, seconds: time };
        // SAFETY: both geoms are alive, since ODE has just passed them, and so are their bodies.
        unsafe { surface_motion(self.raw, &touching, dt, friction_direction) }
    }

    /// Attaches a contact joint between the pair's bodies, which lasts until the next [`collide`](World::collide). A
    /// pair without a body is left alone.
    ///
    /// An invalid contact or surface becomes the error of [`collide`](World::collide).
    pub fn attach(&self, contact: &ContactGeom, surface: &Surface) {
        self.create_contact(contact, surface);
    }

    /// Attaches a contact joint as [`attach`](Self::attach) does, and has the next steps record its forces, which
    /// [`World::contact_feedback`] returns until the contacts are cleared.
    pub fn attach_measured(&self, contact: &ContactGeom, surface: &Surface) {
        if let Some(joint) = self.create_contact(contact, surface) {
            // SAFETY: the joint was just created in the world's group of contacts.
            unsafe { self.world.measure_contact(joint, contact) };
        }
    }

    fn create_contact(&self, contact: &ContactGeom, surface: &Surface) -> Option<dJointID> {
        // SAFETY: both geoms are alive, and so are their bodies.
        let bodies = self.raw.map(|geom| unsafe { dGeomGetBody(geom) });
        if bodies[0].is_null() && bodies[1].is_null() {
            return None;
        }

        // SAFETY: world, group and bodies are alive, and ODE reports no pair of geoms of one body.
        let joint = unsafe { create_contact(self.world.raw, self.world.contacts, bodies, contact, surface) };
        joint
            .map_err(|error| {
                let first = self.first_error.take().unwrap_or(error);
                self.first_error.set(Some(first));
            })
            .ok()
    }
}

impl fmt::Debug for Pair<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Pair").field(&self.geoms[0]).field(&self.geoms[1]).finish()
    }
}
