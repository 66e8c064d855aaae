//! Restitution on a hull of which no contact adds energy on its own.
//!
//! ODE's restitution is Newton's, of single contacts: one that approaches parts at e times its speed, and one that parts at
//! the speed u keeps out of the surface only. That adds energy in two ways. An impact at another contact of the body adds u
//! times half its impulse here; Newton's law for all contacts at once is that none parts slower than at -e u, and with one e
//! it adds no energy without friction (Moreau 1988, "Unilateral contact and dry friction in finite freedom dynamics"). And
//! friction adds energy where it turns the slip about: see [`Impact`].

use super::class;
use super::impact::Impact;
use crate::ode::convert;
use nalgebra::{Point3, Vector3};
use ode_sys::{
    dContact, dContactApprox1_1, dContactApprox1_2, dContactBounce, dContactMotionN, dGeomGetBody, dGeomID,
};

/// How a contact bounces, in the terms of ODE's contact joints.
#[derive(Debug, Clone, Copy)]
pub(in crate::ode) struct Restitution {
    /// The coefficient of restitution.
    pub(in crate::ode) bounce: f64,
    /// The speed below which nothing bounces, m/s.
    pub(in crate::ode) bounce_velocity: f64,
    /// The velocity at which the contact pushes the bodies apart, m/s (ODE's `motionN`); `None` if that is off.
    pub(in crate::ode) normal_velocity: Option<f64>,
    /// The friction coefficient; `None` if friction does not depend on the normal force.
    pub(in crate::ode) mu: Option<f64>,
}

impl Restitution {
    /// This restitution at a contact of two geoms, so that an impact there alone adds no energy: with another normal velocity
    /// where they part faster than what bounces, and no larger a coefficient than friction allows where they approach.
    ///
    /// # Safety
    /// Both geoms are living, and so are their bodies.
    pub(in crate::ode) unsafe fn without_gain(
        self,
        geoms: [dGeomID; 2],
        position: &Point3<f64>,
        normal: &Vector3<f64>,
    ) -> Self {
        let normal_velocity = self.normal_velocity.unwrap_or(0.0);
        // SAFETY: the caller vouches for the geoms and their bodies.
        let impact =
            unsafe { Impact::new(geoms.map(|geom| dGeomGetBody(geom)), position, normal, normal_velocity) };
        let Some(impact) = impact else { return self };
        let parting = impact.parting();
        if parting > self.bounce_velocity {
            return Self { normal_velocity: Some(normal_velocity - self.bounce * parting), ..self };
        }
        let bounces = -parting > self.bounce_velocity;
        match self.mu {
            Some(mu) if bounces => Self { bounce: impact.most_bounce(self.bounce, mu), ..self },
            _ => self,
        }
    }
}

/// Changes a contact of ODE that bounces off a hull so that it adds no energy on its own, and returns whether that has changed it.
///
/// # Safety
/// The contact's geoms are living, and so are their bodies.
pub(super) unsafe fn set_restitution(contact: &mut dContact) -> bool {
    let geoms = [contact.geom.g1, contact.geom.g2];
    let has = |bits: u32| contact.surface.mode & bits as i32 == bits as i32;
    let bounces = has(dContactBounce) && contact.surface.bounce > 0.0;
    if !bounces || geoms.into_iter().all(|geom| class::find_current(geom).is_none()) {
        return false;
    }
    let before = Restitution {
        bounce: contact.surface.bounce,
        bounce_velocity: contact.surface.bounce_vel,
        normal_velocity: has(dContactMotionN).then_some(contact.surface.motionN),
        mu: has(dContactApprox1_1 | dContactApprox1_2).then_some(contact.surface.mu),
    };
    let (position, normal) = (convert::point(&contact.geom.pos), convert::vector(&contact.geom.normal));
    // SAFETY: the caller vouches for the geoms.
    let found = unsafe { before.without_gain(geoms, &position, &normal) };
    contact.surface.bounce = found.bounce;
    if let Some(normal_velocity) = found.normal_velocity {
        contact.surface.mode |= dContactMotionN as i32;
        contact.surface.motionN = normal_velocity;
    }
    found.bounce != before.bounce || found.normal_velocity != before.normal_velocity
}
