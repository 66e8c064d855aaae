//! The largest depth of a contact: no body leaves a hull that has appeared in it faster than a stated speed.
//!
//! ODE moves a body out of a contact at the depth times ERP over the step. So what depth is harmless depends on both.

use super::grip::least_cosine;
use super::query::CollideContext;
use crate::contact::tuning::LEAVING_SPEED;
use crate::contact::{BodyContacts, Manifold, Mode};
use crate::ode::convert;
use ode_sys::{
    dBodyGetAngularVel, dBodyGetLinearVel, dBodyGetMass, dBodyGetPosition, dBodyGetWorld, dBodyID,
    dBodyIsEnabled, dBodyVectorFromWorld, dGeomGetBody, dGeomID, dMass, dReal, dVector3,
    dWorldGetContactSurfaceLayer, dWorldGetERP,
};

/// The least part of [`LEAVING_SPEED`] along a direction, where the hull pushes the body in other directions too or it moves
/// aside or spins already. With less, a body that two sides hold is pressed too little to be lifted.
const LEAST_PART: f64 = 0.2;

impl CollideContext<'_> {
    /// Limits the depths of the contacts of `other` with the geom `hull`, so that ODE moves its body out of them at
    /// [`LEAVING_SPEED`] at most, beside the speed of the surface.
    ///
    /// [`Mode::Paper`] reports depths as they are, and so do geoms without a body, and all before the length of a step is
    /// known.
    ///
    /// # Safety
    /// Both geoms are living, and so is the body of `other`.
    pub(super) unsafe fn limit_depths(&self, hull: dGeomID, other: dGeomID, found: &mut BodyContacts) {
        // SAFETY: the caller vouches for the geom and its body; positions and velocities have three numbers.
        let (erp, surface_layer, velocity, of_spin) = unsafe {
            let body = dGeomGetBody(other);
            if body.is_null() || self.settings.mode == Mode::Paper {
                return;
            }
            let (position, velocity): (*const dReal, *const dReal) =
                (dBodyGetPosition(body), dBodyGetLinearVel(body));
            let (position, velocity) = (convert::vector_at(position), convert::vector_at(velocity));
            if dBodyIsEnabled(body) != 0 {
                self.geom.step_size.see(body as usize, position.into(), &velocity);
            }
            let world = dBodyGetWorld(body);
            (dWorldGetERP(world), dWorldGetContactSurfaceLayer(world), velocity, square_of_spin(body))
        };

        let Some(step) = self.geom.step_size.seconds() else { return };
        let depth_per_speed = step / erp;
        let wedge = square_of_part(&found.manifolds);
        let world_from_hull = self.hull_from_world.inverse();
        let BodyContacts { manifolds, points, .. } = found;
        // ODE does not correct the depth of the surface layer.
        let depth_at = |speed: f64| surface_layer + speed * depth_per_speed;
        for point in points {
            let direction = world_from_hull * manifolds[point.manifold].direction;
            let aside = (velocity - direction * direction.dot(&velocity)).norm_squared() + of_spin;
            let part = (wedge - aside / (LEAVING_SPEED * LEAVING_SPEED)).max(LEAST_PART * LEAST_PART).sqrt();
            let speed = LEAVING_SPEED * part;
            if point.depth > depth_at(speed) {
                // SAFETY: the caller vouches for the geom.
                let of_surface = unsafe { self.geom.velocity(hull, &(world_from_hull * point.point)) };
                let outwards = of_surface.map_or(0.0, |surface| surface.velocity.dot(&direction).max(0.0));
                point.depth = point.depth.min(depth_at(speed + outwards));
            }
        }
    }
}

/// The square of the part of a speed that a body may have along each of several directions, so that it has at most that
/// speed in all: between two directions that face one another it leaves a wedge, the faster the more they do.
fn square_of_part(manifolds: &[Manifold]) -> f64 {
    0.5 * (1.0 + least_cosine(manifolds))
}

/// The square of the speed at which a body's energy of rotation would move it: where its spin meets the hull, that becomes
/// speed.
///
/// # Safety
/// The body is alive.
unsafe fn square_of_spin(body: dBodyID) -> f64 {
    let (mut mass, mut spin) = (dMass::default(), dVector3::default());
    // SAFETY: the caller vouches for the body; its angular velocity has three numbers.
    unsafe {
        dBodyGetMass(body, &mut mass);
        let angular: *const dReal = dBodyGetAngularVel(body);
        let angular = convert::vector_at(angular);
        dBodyVectorFromWorld(body, angular.x, angular.y, angular.z, spin.as_mut_ptr());
    }
    let spin = convert::vector(&spin);
    spin.dot(&(convert::matrix(&mass.I) * spin)) / mass.mass
}
