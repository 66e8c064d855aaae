//! How two bodies would slip over each other in the next step without friction, along which friction acts.
//!
//! ODE limits friction in each of two directions, which it takes from the normal alone. A body that slips between them meets
//! up to 1.4 times the friction, and one that is pushed between them does not begin to move. With the first direction along
//! the slip both limits are Coulomb's.

use super::convert;
use nalgebra::{Point3, Vector3};
use ode_sys::{
    dBodyGetForce, dBodyGetGravityMode, dBodyGetMass, dBodyGetPointVel, dBodyGetWorld, dBodyID,
    dBodyIsKinematic, dContact, dContactFDir1, dGeomGetBody, dGeomID, dMass, dReal, dWorldGetGravity,
};

/// Slips slower than this have no direction, in m/s.
const NO_SLIP: f64 = 1e-6;

/// The unit direction in which the first of two geoms would slip over the second at a contact after a step of `stepsize`
/// seconds without friction; `None` where it would not. The normal is of unit length.
///
/// # Safety
/// Both geoms are living, and so are their bodies.
pub(super) unsafe fn friction_direction(
    geoms: [dGeomID; 2],
    position: &Point3<f64>,
    normal: &Vector3<f64>,
    stepsize: f64,
) -> Option<Vector3<f64>> {
    // SAFETY: the caller vouches for the geoms and their bodies.
    let [first, second] = geoms.map(|geom| unsafe { free_velocity(dGeomGetBody(geom), position, stepsize) });
    slip_direction(&(first - second), normal)
}

/// The unit direction of the part of a slip that is perpendicular to the unit vector `normal`; `None` where there is none.
pub(super) fn slip_direction(slip: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    let along = slip - normal * normal.dot(slip);
    let length = along.norm();
    (length > NO_SLIP && length.is_finite()).then(|| along / length)
}

/// The velocity of a body's point after a step without contacts; zero for the world.
///
/// # Safety
/// `body` is null or a living body.
pub(super) unsafe fn free_velocity(body: dBodyID, point: &Point3<f64>, stepsize: f64) -> Vector3<f64> {
    if body.is_null() {
        return Vector3::zeros();
    }
    let (mut velocity, mut gravity, mut mass) = ([0.0; 4], [0.0; 4], dMass::default());
    // SAFETY: the caller vouches for the body, which belongs to a world; all arrays hold four numbers.
    unsafe {
        dBodyGetPointVel(body, point.x, point.y, point.z, velocity.as_mut_ptr());
        if dBodyIsKinematic(body) != 0 {
            return convert::vector(&velocity);
        }
        if dBodyGetGravityMode(body) != 0 {
            dWorldGetGravity(dBodyGetWorld(body), gravity.as_mut_ptr());
        }
        dBodyGetMass(body, &mut mass);
        let force: *const dReal = dBodyGetForce(body);
        let acceleration = convert::vector(&gravity) + convert::vector_at(force) / mass.mass;
        convert::vector(&velocity) + acceleration * stepsize
    }
}

/// Directs the friction of a contact of ODE along the slip of the bodies in the next step, and returns whether it has: not
/// where the contact has a friction direction already, and not where nothing slips.
///
/// # Safety
/// The contact's geoms are living, and so are their bodies.
pub(crate) unsafe fn set_contact_friction(contact: &mut dContact, stepsize: f64) -> bool {
    if contact.surface.mode & dContactFDir1 as i32 != 0 {
        return false;
    }
    let (position, normal) = (convert::point(&contact.geom.pos), convert::vector(&contact.geom.normal));
    let geoms = [contact.geom.g1, contact.geom.g2];
    // SAFETY: the caller vouches for the geoms.
    let direction = unsafe { friction_direction(geoms, &position, &normal.normalize(), stepsize) };
    let Some(direction) = direction else { return false };
    contact.fdir1 = convert::ode_vector(&direction);
    contact.surface.mode |= dContactFDir1 as i32;
    true
}
