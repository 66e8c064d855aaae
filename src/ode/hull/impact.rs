//! The restitution with which an impact on a hull adds no energy.
//!
//! Newton's law of restitution and Coulomb's friction may add energy together (Kane and Levinson 1985, "Dynamics"): where
//! friction turns the slip about, a body leaves with more than it came with. So the coefficient of restitution is limited to
//! that with which the energy of an impact at this one contact stays the same.

use crate::ode::convert;
use nalgebra::{Matrix3, Point3, Vector3};
use ode_sys::{
    dBodyGetMass, dBodyGetPointVel, dBodyGetPosition, dBodyGetQuaternion, dBodyID, dBodyIsKinematic, dMass,
    dReal,
};

/// Halvings of the interval in which the coefficient of restitution is searched for: to a millionth.
const HALVINGS: u32 = 20;

/// Two bodies at the contact at which they meet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impact {
    /// The unit normal, into the first body.
    normal: Vector3<f64>,
    /// The velocity of the first body's point relative to the second's, m/s.
    velocity: Vector3<f64>,
    /// The change of that velocity by an impulse on the first body, (m/s) / (N s).
    mobility: Matrix3<f64>,
    /// Its inverse.
    inertia: Matrix3<f64>,
}

impl Impact {
    /// The impact of two bodies at a contact whose surfaces move apart at `normal_velocity` m/s, such as a hull's; `None` where
    /// no impulse moves a body.
    ///
    /// # Safety
    /// Each body is null or living.
    pub(super) unsafe fn new(
        bodies: [dBodyID; 2],
        position: &Point3<f64>,
        normal: &Vector3<f64>,
        normal_velocity: f64,
    ) -> Option<Self> {
        // SAFETY: the caller vouches for the bodies.
        let [first, second] = bodies.map(|body| unsafe { motion_at(body, position) });
        let mobility = first.mobility + second.mobility;
        let inertia = mobility.try_inverse()?;
        let velocity = first.velocity - second.velocity - normal * normal_velocity;
        Some(Self { normal: *normal, velocity, mobility, inertia })
    }

    /// How fast the surfaces part, m/s; negative where they approach.
    pub(super) fn parting(&self) -> f64 {
        self.normal.dot(&self.velocity)
    }

    /// The largest coefficient of restitution up to `bounce` with which the impact adds no energy, with the friction
    /// coefficient `mu`.
    pub(super) fn most_bounce(&self, bounce: f64, mu: f64) -> f64 {
        if self.parting() >= 0.0 || self.energy(bounce, mu) <= 0.0 {
            return bounce;
        }
        let (mut least, mut most) = (0.0, bounce);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (least + most);
            if self.energy(middle, mu) <= 0.0 {
                least = middle;
            } else {
                most = middle;
            }
        }
        least
    }

    /// The energy that the impact adds, in joules.
    fn energy(&self, bounce: f64, mu: f64) -> f64 {
        let impulse = self.impulse(bounce, mu);
        impulse.dot(&(self.velocity + 0.5 * self.mobility * impulse))
    }

    /// The impulse on the first body: that which stops the slip, or where that needs more friction than there is, with as much
    /// as there is in this direction.
    fn impulse(&self, bounce: f64, mu: f64) -> Vector3<f64> {
        let Self { normal, velocity, mobility, inertia } = self;
        let approach = -self.parting();
        let sticking = inertia * (normal * (bounce * approach) - velocity);
        let pressing = normal.dot(&sticking);
        let friction = sticking - normal * pressing;
        if friction.norm() <= mu * pressing {
            return sticking;
        }

        // Per unit of the normal impulse.
        let sliding = normal + friction.normalize() * mu;
        let effect = normal.dot(&(mobility * sliding));
        if effect > 0.0 { sliding * ((1.0 + bounce) * approach / effect) } else { sticking }
    }
}

/// How a point of a body moves.
#[derive(Debug, Clone, Copy, Default)]
struct MotionAt {
    velocity: Vector3<f64>,
    /// The change of the velocity by an impulse at the point, (m/s) / (N s).
    mobility: Matrix3<f64>,
}

/// How a body's point moves, and what an impulse there changes; nothing for the world.
///
/// # Safety
/// `body` is null or a living body.
unsafe fn motion_at(body: dBodyID, point: &Point3<f64>) -> MotionAt {
    if body.is_null() {
        return MotionAt::default();
    }
    let (mut velocity, mut mass): ([dReal; 4], _) = ([0.0; 4], dMass::default());
    // SAFETY: the caller vouches for the body; the arrays hold four numbers, the position three and the quaternion four.
    let (is_kinematic, centre, rotation) = unsafe {
        dBodyGetPointVel(body, point.x, point.y, point.z, velocity.as_mut_ptr());
        dBodyGetMass(body, &mut mass);
        let (centre, quaternion): (*const dReal, *const dReal) =
            (dBodyGetPosition(body), dBodyGetQuaternion(body));
        let rotation = convert::rotation(&*quaternion.cast());
        (dBodyIsKinematic(body) != 0, convert::vector_at(centre), rotation.to_rotation_matrix())
    };
    let velocity = convert::vector(&velocity);
    let inverse = convert::matrix(&mass.I).try_inverse().filter(|_| !is_kinematic);
    let Some(inverse) = inverse else { return MotionAt { velocity, ..MotionAt::default() } };
    let arm = (point.coords - centre).cross_matrix();
    let turning = rotation * inverse * rotation.inverse();
    MotionAt { velocity, mobility: Matrix3::identity() / mass.mass - arm * turning * arm }
}
