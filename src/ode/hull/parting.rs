//! Restitution where a body parts from a hull already.
//!
//! ODE's restitution is Newton's, of single contacts: one that approaches parts at e times its speed, and one that parts at
//! the speed u keeps out of the surface only. An impact at another contact of the body then adds u times half its impulse
//! there to the energy. Newton's law for all contacts at once is that none parts slower than at -e u, and with one e it adds
//! no energy without friction (Moreau 1988, "Unilateral contact and dry friction in finite freedom dynamics").

use super::class;
use crate::ode::convert;
use nalgebra::{Point3, Vector3};
use ode_sys::{
    dBodyGetPointVel, dBodyID, dContact, dContactBounce, dContactMotionN, dGeomGetBody, dGeomID, dReal,
};

/// How a contact bounces, in the terms of ODE's contact joints.
#[derive(Debug, Clone, Copy)]
pub(in crate::ode) struct Restitution {
    /// The coefficient of restitution.
    pub(in crate::ode) bounce: f64,
    /// The speed below which nothing bounces, m/s.
    pub(in crate::ode) bounce_velocity: f64,
    /// The velocity at which the contact pushes the bodies apart, m/s (ODE's `motionN`).
    pub(in crate::ode) normal_velocity: f64,
}

/// The normal velocity (ODE's `motionN`) of a contact whose bodies part already, beside its own normal velocity; `None` where
/// they do not, or no faster than what bounces.
///
/// # Safety
/// Both geoms are living, and so are their bodies.
pub(in crate::ode) unsafe fn parting_velocity(
    geoms: [dGeomID; 2],
    position: &Point3<f64>,
    normal: &Vector3<f64>,
    restitution: Restitution,
) -> Option<f64> {
    let Restitution { bounce, bounce_velocity, normal_velocity } = restitution;
    // SAFETY: the caller vouches for the geoms and their bodies.
    let [first, second] = geoms.map(|geom| unsafe { point_velocity(dGeomGetBody(geom), position) });
    let parting = (first - second).dot(normal) - normal_velocity;
    (parting > bounce_velocity).then_some(normal_velocity - bounce * parting)
}

/// Fills [`parting_velocity`] into a contact of ODE that bounces off a hull, and returns whether it has changed the contact.
///
/// # Safety
/// The contact's geoms are living, and so are their bodies.
pub(super) unsafe fn set_parting_velocity(contact: &mut dContact) -> bool {
    let geoms = [contact.geom.g1, contact.geom.g2];
    let bounces = contact.surface.mode & dContactBounce as i32 != 0 && contact.surface.bounce > 0.0;
    if !bounces || geoms.into_iter().all(|geom| class::find_current(geom).is_none()) {
        return false;
    }
    let (position, normal) = (convert::point(&contact.geom.pos), convert::vector(&contact.geom.normal));
    let has_velocity = contact.surface.mode & dContactMotionN as i32 != 0;
    let restitution = Restitution {
        bounce: contact.surface.bounce,
        bounce_velocity: contact.surface.bounce_vel,
        normal_velocity: if has_velocity { contact.surface.motionN } else { 0.0 },
    };
    // SAFETY: the caller vouches for the geoms.
    let parting = unsafe { parting_velocity(geoms, &position, &normal, restitution) };
    let Some(parting) = parting else { return false };
    contact.surface.mode |= dContactMotionN as i32;
    contact.surface.motionN = parting;
    true
}

/// The velocity of a body's point; zero for the world.
///
/// # Safety
/// `body` is null or a living body.
unsafe fn point_velocity(body: dBodyID, point: &Point3<f64>) -> Vector3<f64> {
    let mut velocity: [dReal; 4] = [0.0; 4];
    if !body.is_null() {
        // SAFETY: the caller vouches for the body; the array holds four numbers.
        unsafe { dBodyGetPointVel(body, point.x, point.y, point.z, velocity.as_mut_ptr()) };
    }
    convert::vector(&velocity)
}
