//! Contacts with a hull that will begin within the next step, so that nothing fast passes through between two collides.

use super::query::{CollideContext, ContactQuery};
use super::surface_motion::free_velocity;
use crate::Error;
use crate::contact::tuning::WAKE_PX;
use crate::contact::{self, BodyMotion, SweptContact};
use crate::lock::lock;
use crate::ode::convert;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use std::sync::Mutex;
use ode_sys::{
    dBodyEnable, dBodyGetAngularVel, dBodyGetLinearVel, dBodyGetPosition, dBodyIsEnabled, dGeomGetAABB, dGeomGetBody,
    dGeomGetClass, dGeomGetSpace, dGeomID, dGeomIsSpace, dQuadTreeSpaceClass, dReal, dSpaceGetGeom, dSpaceGetNumGeoms,
    dSpaceID,
};

/// Number of bodies from which on announced contacts are forgotten: addresses accumulate.
const MAX_ANNOUNCED: usize = 1 << 12;

/// A body has moved by its velocity if its way differs by at most this part of itself. Gravity and forces change it a little.
const SAME_WAY: f64 = 0.05;

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
            return self.geom.record_error(Error::argument(
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
                let (centre, angular): (*const dReal, *const dReal) = (dBodyGetPosition(body), dBodyGetAngularVel(body));
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
        let outwards = velocity.map_or(0.0, |found| found.velocity.dot(&(world_from_hull * contact.direction)));
        outwards * (seconds - contact.seconds) > WAKE_PX * self.hull.pixel_size(&contact.point)
    }
}

/// The contacts that bodies were about to have when they were last collided, by the addresses of their geoms, which are
/// compared and never followed.
///
/// ODE moves a body over a whole step by the velocity that it has after the contact. So a contact leaves it as much of its
/// velocity as takes it to the surface. If it has slid off the surface by then, nothing would take the rest.
#[derive(Debug, Default)]
pub(super) struct LastSwept(Mutex<HashMap<usize, Announced>>);

#[derive(Debug, Clone, Copy, Default)]
struct Announced {
    /// The first contact that the body will have within the next step.
    first: Option<Touching>,
    /// The one that it was to have within the last step.
    before: Option<Touching>,
}

#[derive(Debug, Clone, Copy)]
struct Touching {
    /// The sample, in the body's frame.
    sample: Point3<f64>,
    /// The contact's direction, in the hull's frame.
    direction: Vector3<f64>,
    /// The body's origin, in the hull's frame, when the contact was found.
    origin: Point3<f64>,
}

impl LastSwept {
    /// Remembers the first of the contacts `found` of a body, and returns the one that it has had at the end of the last step.
    fn renew(
        &self,
        query: &ContactQuery,
        motion: &BodyMotion,
        seconds: f64,
        found: &[SweptContact],
    ) -> Option<SweptContact> {
        let pose = &query.stamp.hull_from_other;
        let origin = Point3::from(pose.translation.vector);
        let mut table = lock(&self.0);
        let Announced { first, before } = table.remove(&query.other).unwrap_or_default();

        // A body may be collided several times in a step. If it has not moved, the contacts are those of that collide.
        let is_next_step = first.is_some_and(|first| first.origin != origin);
        let before = if is_next_step { first } else { before };
        let way = motion.at(&origin) * seconds;
        let is_one_step_ago =
            |last: &Touching| (origin - last.origin - way).norm() <= SAME_WAY * way.norm();
        let before = before.filter(is_one_step_ago);

        let first = found.first().map(|contact| Touching {
            sample: pose.inverse_transform_point(&contact.point),
            direction: contact.direction,
            origin,
        });
        if first.is_some() || before.is_some() {
            if table.len() >= MAX_ANNOUNCED {
                table.clear();
            }
            table.insert(query.other, Announced { first, before });
        }
        before.map(|last| SweptContact { point: pose * last.sample, direction: last.direction, seconds: 0.0 })
    }
}

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
