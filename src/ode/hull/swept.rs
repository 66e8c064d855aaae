//! Contacts with a hull that will begin within the next step, so that nothing fast passes through between two collides.

use super::query::{CollideContext, ContactQuery};
use crate::Error;
use crate::contact::tuning::WAKE_PX;
use crate::contact::{self, BodyMotion, SweptContact};
use crate::ode::convert;
use crate::ode::slip::free_velocity;
use nalgebra::{Point3, Vector3};
use ode_sys::{
    dBodyEnable, dBodyGetAngularVel, dBodyGetPosition, dBodyIsEnabled, dGeomGetBody, dGeomID, dReal,
};

/// Whether a hull geom collides with what it will meet within the next step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Swept {
    /// It does not: the paper's way. What passes the hull between two collides is missed.
    #[default]
    Off,
    /// Its box holds all that it may meet within the next step, for programs that sweep their bodies themselves.
    BroadPhase,
    /// In addition, a body that will meet the hull within the next step has contacts with it. Their depth is zero, and they
    /// tell how long it will take.
    On,
}

impl CollideContext<'_> {
    /// Finds the contacts that the body of `other` will have with the hull within the next step, up to `most`, and wakes it
    /// where the hull will push it. `touches` tells whether it has contacts now.
    ///
    /// # Safety
    /// Both geoms are living, and so are their bodies.
    pub(super) unsafe fn sweep(
        &self,
        hull: dGeomID,
        other: dGeomID,
        query: &ContactQuery,
        (touches, most): (bool, usize),
        found: &mut Vec<SweptContact>,
    ) {
        found.clear();
        if self.swept != Swept::On {
            return;
        }
        let Some(seconds) = self.geom.step_size.seconds() else {
            return self.geom.record_left_out(Error::argument(
                "sweep: expected the length of a step, found none, so that nothing was swept; set the hull's time before \
                 each collide",
            ));
        };

        // SAFETY: the caller vouches for the geoms and their bodies.
        let motion = unsafe { self.motion_of(hull, other, seconds) };
        let shape = &query.stamp.hull_from_other;
        let most = most.min(self.settings.max_contacts);
        contact::sweep(found, self.hull_for(query.other), &query.samples, shape, &motion, seconds, most);
        let before = self.geom.last_swept.renew(query, &motion, seconds, found);
        found.extend(before.filter(|_| !touches && found.len() < most));

        // SAFETY: as above; enabling sets flags of the body and touches no space.
        unsafe {
            let body = dGeomGetBody(other);
            if !body.is_null() && dBodyIsEnabled(body) == 0 {
                found.retain(|contact| self.pushes(hull, contact, seconds));
                if !found.is_empty() {
                    dBodyEnable(body);
                }
            }
        }
    }

    /// How the body of `other` will move in the next step as seen from the hull, in the hull's frame. A sleeping body rests.
    ///
    /// # Safety
    /// Both geoms are living, and so are their bodies.
    unsafe fn motion_of(&self, hull: dGeomID, other: dGeomID, seconds: f64) -> BodyMotion {
        let into_hull = self.hull_from_world;
        // SAFETY: the caller vouches for the geoms and their bodies; ODE's vectors have at least three numbers.
        unsafe {
            let (body, own) = (dGeomGetBody(other), dGeomGetBody(hull));
            let moves = !body.is_null() && dBodyIsEnabled(body) != 0;
            let (centre, linear, angular) = if moves {
                let (centre, angular): (*const dReal, *const dReal) =
                    (dBodyGetPosition(body), dBodyGetAngularVel(body));
                let centre = Point3::from(convert::vector_at(centre));
                (centre, free_velocity(body, &centre, seconds), convert::vector_at(angular))
            } else {
                (Point3::origin(), Vector3::zeros(), Vector3::zeros())
            };
            let of_hull = free_velocity(own, &centre, seconds);
            let angular_of_hull = if own.is_null() {
                Vector3::zeros()
            } else {
                let angular: *const dReal = dBodyGetAngularVel(own);
                convert::vector_at(angular)
            };
            BodyMotion {
                linear: into_hull * (linear - of_hull),
                angular: into_hull * (angular - angular_of_hull),
                centre: into_hull * centre,
            }
        }
    }

    /// Whether the surface will be deeper in a body at rest than a flickering pixel when the step ends.
    ///
    /// # Safety
    /// `hull` is the living geom.
    unsafe fn pushes(&self, hull: dGeomID, contact: &SweptContact, seconds: f64) -> bool {
        let world_from_hull = self.hull_from_world.inverse();
        // SAFETY: the caller vouches for the geom.
        let velocity = unsafe { self.geom.velocity(hull, &(world_from_hull * contact.point)) };
        let outwards =
            velocity.map_or(0.0, |found| found.velocity.dot(&(world_from_hull * contact.direction)));
        outwards * (seconds - contact.seconds) > WAKE_PX * self.hull.pixel_size(&contact.point)
    }
}
