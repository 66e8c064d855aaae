//! The bodies of the spaces around a hull, and how fast they are.

use crate::ode::convert;
use nalgebra::Vector3;
use ode_sys::{
    dBodyGetAngularVel, dBodyGetLinearVel, dBodyGetPosition, dBodyIsEnabled, dGeomGetAABB, dGeomGetBody,
    dGeomGetClass, dGeomGetSpace, dGeomID, dGeomIsSpace, dQuadTreeSpaceClass, dReal, dSpaceGetGeom,
    dSpaceGetNumGeoms, dSpaceID,
};

/// The largest speed of a point of a body whose geom is in the same space as `geom`, or in a space around or inside that, in
/// m/s. Quadtrees are left out, since ODE 0.16 cannot enumerate them.
///
/// # Safety
/// `geom` is a living geom, and no thread changes or collides the spaces.
pub(super) unsafe fn fastest_neighbour(geom: dGeomID) -> f64 {
    // SAFETY: the caller vouches for the geom; spaces around it are living, and spaces are geoms.
    unsafe {
        let mut outermost = dGeomGetSpace(geom);
        while !outermost.is_null() {
            let around = dGeomGetSpace(outermost.cast());
            if around.is_null() {
                break;
            }
            outermost = around;
        }
        if outermost.is_null() { 0.0 } else { fastest_in(outermost) }
    }
}

/// The largest speed in a space, as [`fastest_neighbour`].
///
/// # Safety
/// As [`fastest_neighbour`], of `space`.
unsafe fn fastest_in(space: dSpaceID) -> f64 {
    // SAFETY: the caller vouches for the space, whose geoms are living.
    unsafe {
        if dGeomGetClass(space.cast()) == dQuadTreeSpaceClass as i32 {
            return 0.0;
        }
        let geoms = (0..dSpaceGetNumGeoms(space)).map(|k| dSpaceGetGeom(space, k));
        let speed = |geom: dGeomID| {
            if dGeomIsSpace(geom) != 0 { fastest_in(geom.cast()) } else { speed_of(geom) }
        };
        geoms.map(speed).fold(0.0, f64::max)
    }
}

/// The largest speed of a point of a geom's body that is awake, in m/s; 0 without one.
///
/// # Safety
/// `geom` is living.
unsafe fn speed_of(geom: dGeomID) -> f64 {
    // SAFETY: the caller vouches for the geom and ODE for its body; the box has six numbers, vectors at least three.
    unsafe {
        let body = dGeomGetBody(geom);
        if body.is_null() || dBodyIsEnabled(body) == 0 {
            return 0.0;
        }
        let (position, linear, angular): (*const dReal, *const dReal, *const dReal) =
            (dBodyGetPosition(body), dBodyGetLinearVel(body), dBodyGetAngularVel(body));
        let (position, linear, angular) =
            (convert::vector_at(position), convert::vector_at(linear), convert::vector_at(angular));
        let mut aabb = [0.0; 6];
        dGeomGetAABB(geom, aabb.as_mut_ptr());
        let reach = |k: usize| (aabb[2 * k] - position[k]).abs().max((aabb[2 * k + 1] - position[k]).abs());
        let speed = linear.norm() + angular.norm() * Vector3::new(reach(0), reach(1), reach(2)).norm();
        if speed.is_finite() { speed } else { 0.0 }
    }
}
