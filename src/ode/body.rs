//! Bodies: what has mass and moves.

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

/// A body to read. Vectors are in the world's frame.
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

    /// Its id.
    pub fn id(&self) -> BodyId {
        self.id
    }

    /// Where it is: world from body.
    pub fn pose(&self) -> Isometry3<f64> {
        let (mut position, mut quaternion) = ([0.0; 4], [0.0; 4]);
        // SAFETY: the view borrows the world, so the body is alive; both arrays hold four numbers.
        unsafe {
            dBodyCopyPosition(self.raw, position.as_mut_ptr());
            dBodyCopyQuaternion(self.raw, quaternion.as_mut_ptr());
        }
        convert::pose(&position, &quaternion)
    }

    /// Where its origin, the centre of mass, is.
    pub fn position(&self) -> Point3<f64> {
        let mut position = [0.0; 4];
        // SAFETY: the body is alive, and the array holds four numbers.
        unsafe { dBodyCopyPosition(self.raw, position.as_mut_ptr()) };
        convert::point(&position)
    }

    /// The velocity of its origin, m/s.
    pub fn linear_velocity(&self) -> Vector3<f64> {
        // SAFETY: the body is alive, and ODE returns four numbers in it.
        unsafe { convert::vector_at(dBodyGetLinearVel(self.raw)) }
    }

    /// Its angular velocity, rad/s.
    pub fn angular_velocity(&self) -> Vector3<f64> {
        // SAFETY: as above.
        unsafe { convert::vector_at(dBodyGetAngularVel(self.raw)) }
    }

    /// The velocity of the point of the body that is at `point` of the world, m/s.
    pub fn velocity_at(&self, point: &Point3<f64>) -> Vector3<f64> {
        let mut velocity = [0.0; 4];
        // SAFETY: the body is alive, and the array holds four numbers.
        unsafe { dBodyGetPointVel(self.raw, point.x, point.y, point.z, velocity.as_mut_ptr()) };
        convert::vector(&velocity)
    }

    /// The force that was added since the last step, N.
    pub fn force(&self) -> Vector3<f64> {
        // SAFETY: the body is alive, and ODE returns four numbers in it.
        unsafe { convert::vector_at(dBodyGetForce(self.raw)) }
    }

    /// The torque that was added since the last step, N m.
    pub fn torque(&self) -> Vector3<f64> {
        // SAFETY: as above.
        unsafe { convert::vector_at(dBodyGetTorque(self.raw)) }
    }

    /// Its mass.
    pub fn mass(&self) -> Mass {
        let mut mass = dMass::default();
        // SAFETY: the body is alive, and the structure is writable.
        unsafe { dBodyGetMass(self.raw, &mut mass) };
        Mass::from_ode(&mass)
    }

    /// Whether it is awake. A sleeping body does not move; a contact with an awake one wakes it.
    pub fn is_enabled(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyIsEnabled(self.raw) != 0 }
    }

    /// Whether it moves as it is told and cannot be pushed.
    pub fn is_kinematic(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyIsKinematic(self.raw) != 0 }
    }

    /// Whether gravity acts on it.
    pub fn has_gravity(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyGetGravityMode(self.raw) != 0 }
    }

    /// Whether it falls asleep when it rests.
    pub fn has_auto_disable(&self) -> bool {
        // SAFETY: the body is alive.
        unsafe { dBodyGetAutoDisableFlag(self.raw) != 0 }
    }

    /// When it falls asleep.
    pub fn auto_disable(&self) -> AutoDisable {
        // SAFETY: the body is alive.
        unsafe { AutoDisable::of_body(self.raw) }
    }

    /// How its motion fades.
    pub fn damping(&self) -> Damping {
        // SAFETY: the body is alive.
        unsafe { Damping::of_body(self.raw) }
    }

    /// ODE's own id.
    ///
    /// # Safety
    ///
    /// Valid until the body is removed. As for [`World::raw`](super::World::raw).
    pub unsafe fn raw(&self) -> dBodyID {
        self.raw
    }
}

/// A body to change. Vectors are in the world's frame. Nothing here wakes a sleeping body but
/// [`set_enabled`](Self::set_enabled).
#[derive(Debug)]
pub struct BodyMut<'w> {
    raw: dBodyID,
    world: PhantomData<&'w mut super::World>,
}

impl BodyMut<'_> {
    pub(super) fn new(raw: dBodyID) -> Self {
        Self { raw, world: PhantomData }
    }

    /// Places the body.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if the pose is not finite or beyond [`REACH`](super::REACH).
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
    /// [`crate::Error::Argument`] if it is not finite.
    pub fn set_linear_velocity(&mut self, velocity: &Vector3<f64>) -> Result<()> {
        check::vector("linear velocity", velocity)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodySetLinearVel(self.raw, velocity.x, velocity.y, velocity.z) };
        Ok(())
    }

    /// Sets the angular velocity, rad/s.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if it is not finite.
    pub fn set_angular_velocity(&mut self, velocity: &Vector3<f64>) -> Result<()> {
        check::vector("angular velocity", velocity)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodySetAngularVel(self.raw, velocity.x, velocity.y, velocity.z) };
        Ok(())
    }

    /// Adds a force on the centre of mass during the next step, N.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if it is not finite.
    pub fn add_force(&mut self, force: &Vector3<f64>) -> Result<()> {
        check::vector("force", force)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodyAddForce(self.raw, force.x, force.y, force.z) };
        Ok(())
    }

    /// Adds a force that acts at `point` of the world during the next step, N.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if a number is not finite.
    pub fn add_force_at(&mut self, force: &Vector3<f64>, point: &Point3<f64>) -> Result<()> {
        check::vector("force", force)?;
        check::point("point of the force", point)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodyAddForceAtPos(self.raw, force.x, force.y, force.z, point.x, point.y, point.z) };
        Ok(())
    }

    /// Adds a torque during the next step, N m.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if it is not finite.
    pub fn add_torque(&mut self, torque: &Vector3<f64>) -> Result<()> {
        check::vector("torque", torque)?;
        // SAFETY: the body is alive; the numbers are finite.
        unsafe { dBodyAddTorque(self.raw, torque.x, torque.y, torque.z) };
        Ok(())
    }

    /// Forgets the forces and torques that were added since the last step.
    pub fn clear_forces(&mut self) {
        // SAFETY: the body is alive.
        unsafe {
            dBodySetForce(self.raw, 0.0, 0.0, 0.0);
            dBodySetTorque(self.raw, 0.0, 0.0, 0.0);
        }
    }

    /// Gives the body a mass. A kinematic body becomes a dynamic one.
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

    /// Makes the body move as its velocity says, pushing what is in its way and pushed by nothing; or no longer.
    pub fn set_kinematic(&mut self, kinematic: bool) {
        // SAFETY: the body is alive.
        unsafe { if kinematic { dBodySetKinematic(self.raw) } else { dBodySetDynamic(self.raw) } };
    }

    /// Whether gravity acts on the body.
    pub fn set_gravity(&mut self, on: bool) {
        // SAFETY: the body is alive.
        unsafe { dBodySetGravityMode(self.raw, on.into()) };
    }

    /// Whether the torque of its own rotation acts on the body. On at first; long, fast bodies are steadier without.
    pub fn set_gyroscopic(&mut self, on: bool) {
        // SAFETY: the body is alive.
        unsafe { dBodySetGyroscopicMode(self.raw, on.into()) };
    }

    /// Whether the body falls asleep when it rests. Switching that off wakes it, and resets its own steps and time to
    /// the world's.
    pub fn set_auto_disable(&mut self, on: bool) {
        // SAFETY: the body is alive.
        unsafe { dBodySetAutoDisableFlag(self.raw, on.into()) };
    }

    /// When the body falls asleep.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] for negative numbers and NaN.
    pub fn set_auto_disable_parameters(&mut self, parameters: &AutoDisable) -> Result<()> {
        parameters.check()?;
        // SAFETY: the body is alive, the numbers are checked.
        unsafe { parameters.set_body(self.raw) };
        Ok(())
    }

    /// How the body's motion fades.
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

    /// The fastest the body may turn, rad/s; infinity is no limit.
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
