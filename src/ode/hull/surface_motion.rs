//! The motion of the real surface at a contact, in the form in which ODE's contact joints take it.

use super::class;
use super::contact_time::contact_seconds;
use super::grip::soften_grip;
use super::restitution::set_restitution;
use super::swept::Swept;
use crate::hull::SurfaceVelocity;
use crate::ode::convert;
use crate::ode::slip::{free_velocity, set_contact_friction, slip_direction};
use nalgebra::{Point3, Vector3};
use ode_sys::{
    dBodyGetMass, dBodyGetPosition, dBodyGetWorld, dBodyID, dBodyVectorFromWorld, dContact, dContactBounce,
    dContactFDir1, dContactMotion1, dContactMotion2, dContactMotionN, dGeomGetAABB, dGeomGetBody, dGeomID,
    dMass, dWorldGetERP,
};

/// The least and the largest soft depth of a fast surface that moves towards a body, in metres. With less, the ridges of
/// noisy masks hit the body one after the other, and it leaves faster than the surface, and turning. With more, it sinks in
/// visibly.
const SOFT_DEPTHS: [f64; 2] = [0.016, 0.030];

/// The soft depth in standard deviations of the silhouettes' edges: the farther they are off, the softer is the surface.
/// Without noise they deviate by a millimetre, with a pixel of noise where a pixel is 8 mm by 3.5 mm.
const SOFT_DEVIATIONS: f64 = 9.5;

/// The largest soft depth, as a part of half the body's least extent: a small body would be passed by the surface before it
/// takes on its speed.
const SOFT_PART: f64 = 0.3;

/// Depth beyond the soft depth is corrected at this part of the surface's speed at most. Where a normal is across the
/// motion, the depth along it may be several times as large as the body is deep.
const CORRECTED: f64 = 0.1;

/// The time in seconds in which a slow surface moves by its soft depth, so that a surface at rest has none.
const SOFT_SECONDS: f64 = 0.05;

/// The least sine of the angle between a normal and a direction that has a part perpendicular to it.
const LEAST_SINE: f64 = 1e-6;

/// How the real surface moves at a contact of a body with a visual hull, for a contact joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceMotion {
    /// The velocity of the surface, m/s, in the world's frame.
    pub velocity: Vector3<f64>,
    /// The first tangential direction: along the slip of the body over the surface that this step would bring without
    /// friction. ODE limits friction in each of two directions; with the first one along the slip, it is Coulomb's.
    pub friction_direction: Vector3<f64>,
    /// The velocity of the surface in the first and second tangential direction, m/s (ODE's `motion1` and `motion2`).
    pub surface_velocity: [f64; 2],
    /// The velocity along the contact's direction out of the hull that the body takes on, m/s (ODE's `motionN`): that of
    /// the surface; in the first half of [`soft_depth`](Self::soft_depth), in proportion to the depth, a part of that. In
    /// this half it gives the body's centre no more than the surface's speed, so that a body that turns is not thrown, and
    /// from there to the end of the soft depth less and less so.
    pub normal_velocity: f64,
    /// The part of the contact's depth, in metres, that is not corrected, since the motion of the surface makes up for it:
    /// none where the surface does not move out of the hull; where it does, up to 16 mm, with noisy masks up to 30 mm, and
    /// what the world's ERP would correct at more than a tenth of the surface's speed.
    pub soft_depth: f64,
    /// How fast the body may still approach the surface in the next step, m/s, where they do not touch yet, so that it ends
    /// the step within the first half of [`soft_depth`](Self::soft_depth); 0 where they touch. It is subtracted in
    /// [`normal_velocity`](Self::normal_velocity) already.
    pub approach: f64,
}

impl SurfaceMotion {
    /// The normal velocity of a contact. ODE applies restitution to what a body is faster than that: a surface that bounces
    /// has to do so at the body's whole speed, a little early.
    pub(in crate::ode) fn normal_velocity_where(&self, bounces: bool) -> f64 {
        if bounces { self.normal_velocity + self.approach } else { self.normal_velocity }
    }
}

/// Where two geoms touch, in the world's frame.
#[derive(Debug, Clone, Copy)]
pub(in crate::ode) struct Touching {
    pub(in crate::ode) position: Point3<f64>,
    pub(in crate::ode) normal: Vector3<f64>,
    pub(in crate::ode) depth: f64,
    /// Seconds until they touch, 0 where they do.
    pub(in crate::ode) seconds: f64,
}

/// The motion of the surface at a contact of two geoms, in the world's frame, for a joint between the first geom's body
/// and the second's. `None` unless one of them is a hull in motion whose velocity is known there. `chosen` is the first tangential direction where the caller has chosen it.
///
/// ODE returns no body for a geom inside a geom transform, so that its velocity is missing in the slip. A hull inside
/// one has no motion, since its pose in the world is not known here.
///
/// # Safety
/// Both geoms are living, and so are their bodies.
pub(in crate::ode) unsafe fn surface_motion(
    geoms: [dGeomID; 2],
    touching: &Touching,
    stepsize: f64,
    chosen: Option<Vector3<f64>>,
) -> Option<SurfaceMotion> {
    let Touching { position, normal, seconds, .. } = touching;
    let hulls = geoms.map(class::find_current);
    let is_first = hulls[0].is_some();
    let hull = hulls.into_iter().flatten().next()?;
    hull.step_size.tell(stepsize);
    let [hull_geom, other] = if is_first { geoms } else { [geoms[1], geoms[0]] };
    // SAFETY: the caller vouches for the geoms, and ODE for their bodies.
    let (of_surface, hull_body, body) = unsafe {
        if !hull.is_where_it_collided(hull_geom) {
            return None;
        }
        let (hull_body, body) = (dGeomGetBody(hull_geom), dGeomGetBody(other));
        // A contact that has not begun lies where the body will touch.
        let way = (free_velocity(body, position, stepsize) - free_velocity(hull_body, position, stepsize))
            * *seconds;
        let still = SurfaceVelocity { velocity: Vector3::zeros(), mean: Vector3::zeros(), deviation: 0.0 };
        let found = hull.velocity(hull_geom, &(position + way));
        (found.or((*seconds > 0.0).then_some(still))?, hull_body, body)
    };
    let SurfaceVelocity { velocity, mean, deviation } = of_surface;
    // Normals may deviate from unit length by what `attach` allows.
    let normal = normal.normalize();
    let out_of_hull = if is_first { -normal } else { normal };
    // Depth corrects a normal velocity that is late, and nothing corrects noise; along the surface it is the other way round.
    let of_surface = velocity + out_of_hull * out_of_hull.dot(&(mean - velocity));

    // SAFETY: the caller vouches for the bodies.
    let slip = unsafe {
        free_velocity(body, position, stepsize) - free_velocity(hull_body, position, stepsize) - of_surface
    };
    let first = chosen
        .or_else(|| slip_direction(&slip, &out_of_hull))
        .unwrap_or_else(|| any_perpendicular(&out_of_hull));

    // ODE measures motions of its joint's first body, which is the only one where the other is the world.
    let is_hull_first_body = !hull_body.is_null() && (is_first || body.is_null());
    let (sign, into_first) = if is_hull_first_body { (-1.0, -out_of_hull) } else { (1.0, out_of_hull) };
    let second = into_first.cross(&first);
    // SAFETY: the caller vouches for the geom.
    let half_extent = unsafe { half_extent(other) };
    let soft_depth = (SOFT_DEVIATIONS * deviation).clamp(SOFT_DEPTHS[0], SOFT_DEPTHS[1]);
    // Springs hold a body between two sides; with a soft depth it would drift from the side that pushes to the other.
    let is_gripped = hull.last_contacts.is_gripped(other as usize);
    let soft_depth = if is_gripped { 0.0 } else { soft_depth.min(SOFT_PART * half_extent) };
    let outwards = of_surface.dot(&out_of_hull);
    let normal = NormalMotion {
        touching,
        out_of_hull,
        outwards,
        inwards: -slip.dot(&out_of_hull),
        soft_depth: (SOFT_SECONDS * outwards).clamp(0.0, soft_depth),
        bodies: [body, hull_body],
        stepsize,
    };
    // SAFETY: the caller vouches for the bodies.
    let (normal_velocity, uncorrected) =
        unsafe { (normal.velocity(hull.swept() == Swept::On), normal.uncorrected_depth(of_surface.norm())) };
    Some(SurfaceMotion {
        velocity: of_surface,
        friction_direction: first,
        surface_velocity: [first, second].map(|direction| sign * of_surface.dot(&direction)),
        normal_velocity,
        soft_depth: uncorrected,
        approach: if *seconds == 0.0 { 0.0 } else { normal.approach() },
    })
}

/// A contact with a surface that moves, along its normal.
struct NormalMotion<'t> {
    touching: &'t Touching,
    out_of_hull: Vector3<f64>,
    /// The velocity of the surface out of the hull, and that of the body against the surface, m/s.
    outwards: f64,
    inwards: f64,
    /// In metres; none where the surface does not move outwards.
    soft_depth: f64,
    /// That of the geom that touches the hull, and that of the hull.
    bodies: [dBodyID; 2],
    stepsize: f64,
}

impl NormalMotion<'_> {
    /// How fast the body may approach the surface so that it ends the step within the first half of the soft depth.
    fn approach(&self) -> f64 {
        let Touching { depth, seconds, .. } = self.touching;
        let gap = seconds * self.inwards.max(0.0);
        let way = if *seconds == 0.0 { 0.5 * self.soft_depth - depth } else { gap };
        way / self.stepsize
    }

    /// The velocity that the body takes on.
    ///
    /// # Safety
    /// The bodies are null or living.
    unsafe fn velocity(&self, is_swept: bool) -> f64 {
        let Touching { position, depth, seconds, .. } = self.touching;
        let half = 0.5 * self.soft_depth;
        let part = if *depth < half { depth / half } else { 1.0 };
        let mut velocity = part * self.outwards;
        // In a long step a fast surface would pass the soft depth, and the body's other side.
        let approach = self.approach();
        if is_swept && approach > 0.0 && approach.is_finite() {
            let allowed = self.outwards - approach;
            velocity = if *seconds == 0.0 { velocity.max(allowed) } else { allowed };
        }
        if !self.bodies[0].is_null() && *depth < self.soft_depth {
            // SAFETY: the caller vouches for the bodies.
            let most = unsafe {
                most_without_overtaking(
                    self.bodies,
                    position,
                    &self.out_of_hull,
                    self.outwards,
                    self.stepsize,
                )
            };
            let hard = ((depth - half) / half).max(0.0);
            let capped = velocity.min(most);
            velocity = capped + hard * (velocity - capped);
        }
        velocity
    }

    /// The part of the depth that is not corrected, where the surface moves at `speed`.
    ///
    /// # Safety
    /// The bodies are null or living.
    unsafe fn uncorrected_depth(&self, speed: f64) -> f64 {
        if self.soft_depth == 0.0 {
            return 0.0;
        }
        // SAFETY: the caller vouches for the bodies.
        let erp = unsafe { error_reduction(self.bodies) };
        self.soft_depth.max(self.touching.depth - CORRECTED * speed * self.stepsize / erp)
    }
}

/// Fills the motion of the surface into a contact of ODE with a hull, and returns whether it has changed the contact: where
/// that motion is not known, the friction direction alone is filled in. A friction direction that the contact has is projected
/// onto the tangent plane; one that has no part there is replaced. The contact of a body that the hull presses from opposite
/// sides becomes soft, and one that bounces adds no energy, see [`restitution`](super::restitution).
///
/// # Safety
/// The contact's geoms are living, and so are their bodies.
pub(crate) unsafe fn set_contact_motion(contact: &mut dContact, stepsize: f64) -> bool {
    // SAFETY: the caller vouches for the geoms.
    unsafe {
        let is_softened = soften_grip(contact, stepsize);
        let has_motion = fill_motion(contact, stepsize);
        let has_restitution = set_restitution(contact);
        is_softened || has_motion || has_restitution
    }
}

/// Fills the velocity of the surface and the friction direction into a contact; returns whether it has changed the contact.
///
/// # Safety
/// The contact's geoms are living, and so are their bodies.
unsafe fn fill_motion(contact: &mut dContact, stepsize: f64) -> bool {
    let (position, normal) = (convert::point(&contact.geom.pos), convert::vector(&contact.geom.normal));
    let (depth, seconds) = (contact.geom.depth, contact_seconds(&contact.geom));
    let touching = Touching { position, normal, depth, seconds };
    let has_direction = contact.surface.mode & dContactFDir1 as i32 != 0;
    let chosen = has_direction.then(|| tangent(&convert::vector(&contact.fdir1), &normal)).flatten();
    let geoms = [contact.geom.g1, contact.geom.g2];
    // SAFETY: the caller vouches for the geoms.
    let motion = unsafe { surface_motion(geoms, &touching, stepsize, chosen) };
    let Some(motion) = motion else {
        let has_hull = geoms.into_iter().any(|geom| class::find_current(geom).is_some());
        // SAFETY: the caller vouches for the geoms.
        return has_hull && unsafe { set_contact_friction(contact, stepsize) };
    };

    contact.fdir1 = convert::ode_vector(&motion.friction_direction);
    contact.surface.mode |= (dContactFDir1 | dContactMotion1 | dContactMotion2 | dContactMotionN) as i32;
    [contact.surface.motion1, contact.surface.motion2] = motion.surface_velocity;
    let bounces = contact.surface.mode & dContactBounce as i32 != 0;
    contact.surface.motionN = motion.normal_velocity_where(bounces);
    contact.geom.depth = (contact.geom.depth - motion.soft_depth).max(0.0);
    true
}

/// The largest velocity of a body's point along `normal` to which an impulse there can bring it without giving the body's
/// centre more than `speed` along the normal. Velocities are relative to the second body.
///
/// # Safety
/// The first body is living, the second null or living.
unsafe fn most_without_overtaking(
    [body, other]: [dBodyID; 2],
    point: &Point3<f64>,
    normal: &Vector3<f64>,
    speed: f64,
    stepsize: f64,
) -> f64 {
    // SAFETY: the caller vouches for the bodies; the position has three numbers, and all arrays hold four.
    unsafe {
        let centre = Point3::from(convert::vector_at(dBodyGetPosition(body)));
        let of_other = free_velocity(other, point, stepsize).dot(normal);
        let of_point = free_velocity(body, point, stepsize).dot(normal) - of_other;
        let of_centre = free_velocity(body, &centre, stepsize).dot(normal) - of_other;

        let mut mass = dMass::default();
        dBodyGetMass(body, &mut mass);
        let (arm, mut in_body) = ((point - centre).cross(normal), [0.0; 4]);
        dBodyVectorFromWorld(body, arm.x, arm.y, arm.z, in_body.as_mut_ptr());
        let arm = convert::vector(&in_body);
        let inertia = convert::matrix(&mass.I).cholesky();
        let turned = inertia.map_or(0.0, |inertia| arm.dot(&inertia.solve(&arm)));
        of_point + (speed - of_centre).max(0.0) * (1.0 + mass.mass * turned)
    }
}

/// Half the least extent of a geom's box.
///
/// # Safety
/// `geom` is living.
unsafe fn half_extent(geom: dGeomID) -> f64 {
    let mut aabb = [0.0; 6];
    // SAFETY: the caller vouches for the geom, and ODE's boxes have six numbers.
    unsafe { dGeomGetAABB(geom, aabb.as_mut_ptr()) };
    (0..3).map(|k| 0.5 * (aabb[2 * k + 1] - aabb[2 * k])).fold(f64::INFINITY, f64::min)
}

/// The ERP of the bodies' world.
///
/// # Safety
/// Each body is null or living.
unsafe fn error_reduction([body, other]: [dBodyID; 2]) -> f64 {
    let body = if body.is_null() { other } else { body };
    // SAFETY: the caller vouches for the body.
    if body.is_null() { 1.0 } else { unsafe { dWorldGetERP(dBodyGetWorld(body)) } }
}

/// The unit vector along the part of `direction` that is perpendicular to `normal`; `None` where there is none.
fn tangent(direction: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    let (direction, normal) = (direction.normalize(), normal.normalize());
    let part = direction - normal * normal.dot(&direction);
    // A direction of length zero is NaN here, which is refused too.
    if part.norm() > LEAST_SINE { Some(part.normalize()) } else { None }
}

/// A unit vector perpendicular to `normal`.
fn any_perpendicular(normal: &Vector3<f64>) -> Vector3<f64> {
    let axis = Vector3::ith(normal.iamin(), 1.0);
    normal.cross(&axis).normalize()
}
