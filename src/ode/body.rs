//! Rigid bodies: mass, pose, velocities and forces.

use std::marker::PhantomData;

use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{
    dBodyAddForce, dBodyAddForceAtPos, dBodyAddTorque, dBodyCopyPosition, dBodyCopyQuaternion, dBodyDisable,
    dBodyEnable, dBodyGetAngularVel, dBodyGetAutoDisableFlag, dBodyGetForce, dBodyGetGravityMode,
    dBodyGetLinearVel, dBodyGetMass, dBodyGetPointVel, dBodyGetTorque, dBodyID, dBodyIsEnabled,
    dBodyIsKinematic, dBodySetAngularVel, dBodySetAutoDisableFlag, dBodySetDynamic, dBodySetForce,
    dBodySetGravityMode, dBodySetGyroscopicMode, dBodySetKinematic, dBodySetLinearVel, dBodySetMass,
    dBodySetMaxAngularSpeed, dBodySetPosition, dBodySetQuaternion, dBodySetTorque, dMass,
};

use super::arena::BodyId;
use super::mass::Mass;
use super::parameters::{AutoDisable, Damping};
use super::{check, convert};
use crate::Result;

/// Read access to a body of a [`World`](super::World). Vectors and points are in the world's frame.
#[derive(Debug, Clone, Copy)]
pub struct Body<'w> {
    raw: dBodyID,
    id: BodyId,
    world: PhantomData<&'w super::World>,
}

impl Body<'_> {
    pub(super) fn new(raw: dBodyID, id: BodyId) -> Self {
        Self { raw, id, world: PhantomData }
    }

    /// The body's id.
    pub fn id(&self) -> BodyId {
        self.id
    }

    /// The transform from the body's frame to the world's.
    pub fn pose(&self) -> Isometry3<f64> {
        let (mut position, mut quaternion) = ([0.0; 4], [0.0; 4]);
        // SAFETY: the view borrows the world, so the body is alive; both arrays hold four numbers.
        unsafe {
            dBodyCopyPosition(self.raw, position.as_mut_ptr());
            dBodyCopyQuaternion(self.raw, quaternion.as_mut_ptr());
        }
        convert::pose(&position, &quaternion)
    }

    /// The position of the body's origin, which is its centre of mass.
    pub fn position(&self) -> Point3<f64> {
        let mut position = [0.0; 4];
        // SAFETY: the body is alive, and the array holds four numbers.
        unsafe { dBodyCopyPosition(self.raw, position.as_mut_ptr()) };
        convert::point(&position)
    }

    /// The velocity of the body's origin, m/s.
    pub fn linear_velocity(&self) -> Vector3<f64> {
        // SAFETY: the body is alive, and ODE returns four numbers in it.
        unsafe { convert::vector_at(dBodyGetLinearVel(self.raw)) }
    }

    /// The body's angular velocity, rad/s.
    pub fn angular_velocity(&self) -> Vector3<f64> {
        // SAFETY: the body is alive, and ODE returns four numbers in it.
        unsafe { convert::vector_at(dBodyGetAngularVel(self.raw)) }
    }

    /// The velocity of the body's material point at `point`, m/s.
    pub fn velocity_at(&self, point: &Point3<f64>) -> Vector3<f64> {
        let mut velocity = [0.0; 4];
        // SAFETY: the body is alive, and the array holds four numbers.
        unsafe { dBodyGetPointVel(self.raw, point.x, point.y, point.z, velocity.as_mut_ptr()) };
        convert::vector(&velocity)
    }

    /// The sum of the forces added since the last step, N.
    pub fn force(&self) -> Vector3<f64> {
        // SAFETY: the body is alive, and ODE returns four numbers in it.
        unsafe { convert::vector_at(dBodyGetForce(self.raw)) }
    }

    /// The sum of the torques added since the last step, N m.
    pub fn torque(&self) -> Vector3<f64> {
        // SAFETY: the body is alive, and ODE returns four numbers in it.
        unsafe { convert::vector_at(dBodyGetTorque(self.raw)) }
    }

    /// The body's mass and inertia.
    pub fn mass(&self) -> Mass {
        let mut mass = dMass::default();
        // SAFETY: the body is alive, and the structure is writable.
        unsafe { dBodyGetMass(self.raw, &mut mass) };
        Mass::from_ode(&mass)
    }

    /// Whether the body is awake. A sleeping body does not move; a contact with an awake body wakes it.
    pub fn is_enabled(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyIsEnabled(self.raw) != 0 }
    }

    /// Whether the body is kinematic: it moves with its set velocity, and nothing pushes it.
    pub fn is_kinematic(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyIsKinematic(self.raw) != 0 }
    }

    /// Whether gravity acts on the body.
    pub fn has_gravity(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyGetGravityMode(self.raw) != 0 }
    }

    /// Whether the body falls asleep when it rests.
    pub fn has_auto_disable(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyGetAutoDisableFlag(self.raw) != 0 }
    }

    /// The conditions under which the body falls asleep.
    pub fn auto_disable(&self) -> AutoDisable {
        // SAFETY: the body is alive.
        unsafe { AutoDisable::of_body(self.raw) }
    }

    /// The damping of the body's velocities.
    pub fn damping(&self) -> Damping {
        // SAFETY: the body is alive.
        unsafe { Damping::of_body(self.raw) }
    }

    /// ODE's own id of the body.
    ///
    /// # Safety
    ///
    /// The id is valid until the body is removed, and its use must follow the rules of
    /// [`World::raw`](super::World::raw).
    pub unsafe fn raw(&self) -> dBodyID {
        self.raw
    }
}

/// Write access to a body of a [`World`](super::World). Vectors and points are in the world's frame.
///
/// None of these functions wakes a sleeping body, except [`set_enabled`](Self::set_enabled) and switching auto-disable
/// off.
#[derive(Debug)]
pub struct BodyMut<'w> {
    raw: dBodyID,
    world: PhantomData<&'w mut super::World>,
}

impl BodyMut<'_> {
    pub(super) fn new(raw: dBodyID) -> Self {
        Self { raw, world: PhantomData }
    }

    /// Sets the transform from the body's frame to the world's.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the pose is not finite or its position is beyond [`REACH`](super::REACH).
    pub fn set_pose(&mut self, pose: &Isometry3<f64>) -> Result<()> {
        check::pose("pose of the body", pose)?;
        let (position, quaternion) = (pose.translation.vector, convert::ode_quaternion(&pose.rotation));
        // SAFETY: the view borrows the world, so the body is alive; the numbers are finite, the quaternion is not 0.
        unsafe {
            dBodySetPosition(self.raw, position.x, position.y, position.z);
            dBodySetQuaternion(self.raw, quaternion.as_ptr());
        }
        Ok(())
    }

    /// Sets the velocity of the body's origin, m/s.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the velocity is not finite.
    pub fn set_linear_velocity(&mut self, velocity: &Vector3<f64>) -> Result<()> {
        check::vector("linear velocity", velocity)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodySetLinearVel(self.raw, velocity.x, velocity.y, velocity.z) };
        Ok(())
    }

    /// Sets the body's angular velocity, rad/s.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the velocity is not finite.
    pub fn set_angular_velocity(&mut self, velocity: &Vector3<f64>) -> Result<()> {
        check::vector("angular velocity", velocity)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodySetAngularVel(self.raw, velocity.x, velocity.y, velocity.z) };
        Ok(())
    }

    /// Adds a force, N, that acts on the centre of mass during the next step.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the force is not finite.
    pub fn add_force(&mut self, force: &Vector3<f64>) -> Result<()> {
        check::vector("force", force)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodyAddForce(self.raw, force.x, force.y, force.z) };
        Ok(())
    }

    /// Adds a force, N, that acts at `point` during the next step.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the force is not finite or the point is beyond [`REACH`](super::REACH).
    pub fn add_force_at(&mut self, force: &Vector3<f64>, point: &Point3<f64>) -> Result<()> {
        check::vector("force", force)?;
        check::point("point of the force", point)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodyAddForceAtPos(self.raw, force.x, force.y, force.z, point.x, point.y, point.z) };
        Ok(())
    }

    /// Adds a torque, N m, that acts during the next step.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the torque is not finite.
    pub fn add_torque(&mut self, torque: &Vector3<f64>) -> Result<()> {
        check::vector("torque", torque)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodyAddTorque(self.raw, torque.x, torque.y, torque.z) };
        Ok(())
    }

    /// Removes the forces and torques added since the last step.
    pub fn clear_forces(&mut self) {
        // SAFETY: the body is alive.
        unsafe {
            dBodySetForce(self.raw, 0.0, 0.0, 0.0);
            dBodySetTorque(self.raw, 0.0, 0.0, 0.0);
        }
    }

    /// Sets the body's mass and inertia. A kinematic body becomes dynamic.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the centre of mass is not the body's origin; see [`Mass::centred`].
    pub fn set_mass(&mut self, mass: &Mass) -> Result<()> {
        let mass = mass.to_ode()?;
        // SAFETY: the body is alive; the mass is positive, its inertia positive definite, its centre the origin.
        unsafe { dBodySetMass(self.raw, &mass) };
        Ok(())
    }

    /// Wakes the body, or puts it to sleep.
    pub fn set_enabled(&mut self, enabled: bool) {
        // SAFETY: the body is alive.
        unsafe { if enabled { dBodyEnable(self.raw) } else { dBodyDisable(self.raw) } };
    }

    /// Makes the body kinematic or dynamic again. A kinematic body moves with its set velocity, pushes other bodies,
    /// and nothing pushes it.
    pub fn set_kinematic(&mut self, kinematic: bool) {
        // SAFETY: the body is alive.
        unsafe { if kinematic { dBodySetKinematic(self.raw) } else { dBodySetDynamic(self.raw) } };
    }

    /// Sets whether gravity acts on the body.
    pub fn set_gravity(&mut self, on: bool) {
        // SAFETY: the body is alive.
        unsafe { dBodySetGravityMode(self.raw, on.into()) };
    }

    /// Sets whether the gyroscopic torque of the body's own rotation acts on it. It is on by default; long bodies that
    /// spin fast are more stable without it.
    pub fn set_gyroscopic(&mut self, on: bool) {
        // SAFETY: the body is alive.
        unsafe { dBodySetGyroscopicMode(self.raw, on.into()) };
    }

    /// Sets whether the body falls asleep when it rests. Switching this off wakes the body, and resets its steps and
    /// time of [`AutoDisable`] to the world's.
    pub fn set_auto_disable(&mut self, on: bool) {
        // SAFETY: the body is alive.
        unsafe { dBodySetAutoDisableFlag(self.raw, on.into()) };
    }

    /// Sets the conditions under which the body falls asleep.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] for negative numbers, NaN, and counts that are out of range.
    pub fn set_auto_disable_parameters(&mut self, parameters: &AutoDisable) -> Result<()> {
        parameters.check()?;
        // SAFETY: the body is alive, the numbers are checked.
        unsafe { parameters.set_body(self.raw) };
        Ok(())
    }

    /// Sets the damping of the body's velocities.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] for NaN and numbers out of range.
    pub fn set_damping(&mut self, damping: &Damping) -> Result<()> {
        damping.check()?;
        // SAFETY: the body is alive, the numbers are checked.
        unsafe { damping.set_body(self.raw) };
        Ok(())
    }

    /// Sets the limit of the body's angular speed, rad/s; infinity means no limit.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] for a negative number and NaN.
    pub fn set_max_angular_speed(&mut self, speed: f64) -> Result<()> {
        check::not_negative_or_infinite("largest angular speed", speed)?;
        // SAFETY: the body is alive; the number is not NaN.
        unsafe { dBodySetMaxAngularSpeed(self.raw, speed) };
        Ok(())
    }
}
