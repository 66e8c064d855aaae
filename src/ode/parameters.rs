//! Parameters of the whole world: gravity, solver, sleeping and damping.

use nalgebra::Vector3;
use ode_sys::*;

use super::check;
use super::convert;
use super::world::World;
use crate::{Error, Result};

/// The conditions under which a resting body falls asleep: its average speed stays below both thresholds for a number
/// of steps and for a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutoDisable {
    /// The threshold of the linear speed, m/s.
    pub linear_threshold: f64,
    /// The threshold of the angular speed, rad/s.
    pub angular_threshold: f64,
    /// The number of steps below the thresholds; 0 sets no condition.
    pub steps: u32,
    /// The time below the thresholds, s; 0 sets no condition.
    pub time: f64,
    /// The number of steps over which the speed is averaged, 1 to 10 000; 1 uses the current speed.
    pub average_samples: u32,
}

impl Default for AutoDisable {
    /// ODE's defaults: 0.01 m/s, 0.01 rad/s and 10 steps.
    fn default() -> Self {
        Self { linear_threshold: 0.01, angular_threshold: 0.01, steps: 10, time: 0.0, average_samples: 1 }
    }
}

impl AutoDisable {
    /// Refuses negative numbers, NaN, and counts that ODE cannot hold.
    pub(super) fn check(&self) -> Result<()> {
        check::not_negative("linear threshold of auto-disable", self.linear_threshold)?;
        check::not_negative("angular threshold of auto-disable", self.angular_threshold)?;
        check::not_negative("time of auto-disable", self.time)?;

        if self.steps > i32::MAX as u32 || !(1..=10_000).contains(&self.average_samples) {
            return Err(Error::argument(format!(
                "auto-disable: expected at most {} steps and 1 to 10000 samples, found {} and {}",
                i32::MAX,
                self.steps,
                self.average_samples
            )));
        }
        Ok(())
    }

    /// Reads the parameters of a body.
    ///
    /// # Safety
    ///
    /// `body` is alive.
    pub(super) unsafe fn of_body(body: dBodyID) -> Self {
        // SAFETY: the caller guarantees a living body.
        unsafe {
            Self {
                linear_threshold: dBodyGetAutoDisableLinearThreshold(body),
                angular_threshold: dBodyGetAutoDisableAngularThreshold(body),
                steps: dBodyGetAutoDisableSteps(body) as u32,
                time: dBodyGetAutoDisableTime(body),
                average_samples: dBodyGetAutoDisableAverageSamplesCount(body) as u32,
            }
        }
    }

    /// Gives a body these values.
    ///
    /// # Safety
    ///
    /// `body` is alive, and [`check`](Self::check) has accepted `self`.
    pub(super) unsafe fn set_body(&self, body: dBodyID) {
        // SAFETY: the caller guarantees a living body and checked numbers.
        unsafe {
            dBodySetAutoDisableLinearThreshold(body, self.linear_threshold);
            dBodySetAutoDisableAngularThreshold(body, self.angular_threshold);
            dBodySetAutoDisableSteps(body, self.steps as i32);
            dBodySetAutoDisableTime(body, self.time);
            dBodySetAutoDisableAverageSamplesCount(body, self.average_samples);
        }
    }
}

/// Damping of velocities: in each step a velocity above its threshold loses the given part of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// The part of the linear velocity lost in each step, 0 to 1.
    pub linear: f64,
    /// The part of the angular velocity lost in each step, 0 to 1.
    pub angular: f64,
    /// The linear speed above which damping acts, m/s.
    pub linear_threshold: f64,
    /// The angular speed above which damping acts, rad/s.
    pub angular_threshold: f64,
}

impl Default for Damping {
    /// ODE's defaults: no damping, and thresholds of 0.01 m/s and 0.01 rad/s.
    fn default() -> Self {
        Self { linear: 0.0, angular: 0.0, linear_threshold: 0.01, angular_threshold: 0.01 }
    }
}

impl Damping {
    /// Refuses NaN and numbers out of range.
    pub(super) fn check(&self) -> Result<()> {
        check::within("linear damping", self.linear, 0.0, 1.0)?;
        check::within("angular damping", self.angular, 0.0, 1.0)?;
        check::not_negative("linear threshold of damping", self.linear_threshold)?;
        check::not_negative("angular threshold of damping", self.angular_threshold)?;
        Ok(())
    }

    /// Reads the damping of a body.
    ///
    /// # Safety
    ///
    /// `body` is alive.
    pub(super) unsafe fn of_body(body: dBodyID) -> Self {
        // SAFETY: the caller guarantees a living body.
        unsafe {
            Self {
                linear: dBodyGetLinearDamping(body),
                angular: dBodyGetAngularDamping(body),
                linear_threshold: dBodyGetLinearDampingThreshold(body),
                angular_threshold: dBodyGetAngularDampingThreshold(body),
            }
        }
    }

    /// Gives a body these values.
    ///
    /// # Safety
    ///
    /// `body` is alive, and [`check`](Self::check) has accepted `self`.
    pub(super) unsafe fn set_body(&self, body: dBodyID) {
        // SAFETY: the caller guarantees a living body and checked numbers.
        unsafe {
            dBodySetDamping(body, self.linear, self.angular);
            dBodySetLinearDampingThreshold(body, self.linear_threshold);
            dBodySetAngularDampingThreshold(body, self.angular_threshold);
        }
    }
}

/// Defines the getter and the checked setter of one number that ODE stores in the world.
macro_rules! number {
    ($(#[$get_doc:meta])* $get:ident, $ode_get:ident, $(#[$set_doc:meta])* $set:ident, $ode_set:ident,
     $check:expr) => {
        $(#[$get_doc])*
        pub fn $get(&self) -> f64 {
            // SAFETY: the world is alive.
            unsafe { $ode_get(self.raw) }
        }

        $(#[$set_doc])*
        ///
        /// # Errors
        ///
        /// [`Error::Argument`] for NaN and numbers out of range.
        pub fn $set(&mut self, value: f64) -> Result<()> {
            let check: fn(f64) -> Result<f64> = $check;
            let value = check(value)?;
            // SAFETY: the world is alive, and the check has accepted the number.
            unsafe { $ode_set(self.raw, value) };
            Ok(())
        }
    };
}

impl World {
    /// The acceleration due to gravity, m/s^2.
    pub fn gravity(&self) -> Vector3<f64> {
        let mut gravity = [0.0; 4];
        // SAFETY: the world is alive, and the array holds four numbers.
        unsafe { dWorldGetGravity(self.raw, gravity.as_mut_ptr()) };
        convert::vector(&gravity)
    }

    /// Sets the acceleration due to gravity, m/s^2. A new world has none.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the acceleration is not finite.
    pub fn set_gravity(&mut self, gravity: &Vector3<f64>) -> Result<()> {
        check::vector("gravity", gravity)?;
        // SAFETY: the world is alive; the numbers are finite.
        unsafe { dWorldSetGravity(self.raw, gravity.x, gravity.y, gravity.z) };
        Ok(())
    }

    number!(
        /// The error reduction parameter: the part of a joint's error that each step corrects.
        erp, dWorldGetERP,
        /// Sets the error reduction parameter: the part of a joint's error that each step corrects, 0 to 1. The default
        /// is 0.2.
        set_erp, dWorldSetERP, |value| check::within("ERP", value, 0.0, 1.0)
    );
    number!(
        /// The constraint force mixing: the softness of constraints.
        cfm, dWorldGetCFM,
        /// Sets the constraint force mixing, 0 or more. The default is 1e-10; 1e-5 keeps the solvers stable.
        set_cfm, dWorldSetCFM, |value| check::not_negative("CFM", value)
    );
    number!(
        /// The largest velocity with which a contact pushes bodies apart, m/s.
        contact_max_correcting_velocity, dWorldGetContactMaxCorrectingVel,
        /// Sets the largest velocity with which a contact pushes bodies apart, m/s. The default is infinite.
        set_contact_max_correcting_velocity, dWorldSetContactMaxCorrectingVel,
        |value| check::not_negative_or_infinite("largest correcting velocity", value)
    );
    number!(
        /// The penetration depth that contacts leave uncorrected, m.
        contact_surface_layer, dWorldGetContactSurfaceLayer,
        /// Sets the penetration depth that contacts leave uncorrected, m, so that they do not come and go. The default
        /// is 0.
        set_contact_surface_layer, dWorldSetContactSurfaceLayer,
        |value| check::not_negative("contact surface layer", value)
    );
    number!(
        /// The over-relaxation factor of [`quick_step`](Self::quick_step).
        quick_step_w, dWorldGetQuickStepW,
        /// Sets the over-relaxation factor of [`quick_step`](Self::quick_step), 0.01 to 2. The default is 1.3.
        set_quick_step_w, dWorldSetQuickStepW, |value| check::within("over-relaxation", value, 0.01, 2.0)
    );
    number!(
        /// The limit of the angular speed of new bodies, rad/s.
        max_angular_speed, dWorldGetMaxAngularSpeed,
        /// Sets the limit of the angular speed of bodies added from now on, rad/s. The default is infinite.
        set_max_angular_speed, dWorldSetMaxAngularSpeed,
        |value| check::not_negative_or_infinite("largest angular speed", value)
    );

    /// The number of solver iterations in [`quick_step`](Self::quick_step).
    pub fn quick_step_iterations(&self) -> u32 {
        // SAFETY: the world is alive.
        let iterations = unsafe { dWorldGetQuickStepNumIterations(self.raw) };
        iterations as u32
    }

    /// Sets the number of solver iterations in [`quick_step`](Self::quick_step). The default is 20; stacks need 50.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for 0 and for more than a million.
    pub fn set_quick_step_iterations(&mut self, iterations: u32) -> Result<()> {
        if !(1..=1_000_000).contains(&iterations) {
            return Err(Error::argument(format!(
                "solver iterations: expected 1 to 1000000, found {iterations}"
            )));
        }
        // SAFETY: the world is alive; the number is positive and fits.
        unsafe { dWorldSetQuickStepNumIterations(self.raw, iterations as i32) };
        Ok(())
    }

    /// Whether new bodies fall asleep when they rest.
    pub fn has_auto_disable(&self) -> bool {
        // SAFETY: the world is alive.
        unsafe { dWorldGetAutoDisableFlag(self.raw) != 0 }
    }

    /// Sets whether bodies added from now on fall asleep when they rest. This is off by default.
    pub fn set_auto_disable(&mut self, on: bool) {
        // SAFETY: the world is alive.
        unsafe { dWorldSetAutoDisableFlag(self.raw, on.into()) };
    }

    /// The conditions under which new bodies fall asleep.
    pub fn auto_disable(&self) -> AutoDisable {
        // SAFETY: the world is alive.
        unsafe {
            AutoDisable {
                linear_threshold: dWorldGetAutoDisableLinearThreshold(self.raw),
                angular_threshold: dWorldGetAutoDisableAngularThreshold(self.raw),
                steps: dWorldGetAutoDisableSteps(self.raw) as u32,
                time: dWorldGetAutoDisableTime(self.raw),
                average_samples: dWorldGetAutoDisableAverageSamplesCount(self.raw) as u32,
            }
        }
    }

    /// Sets the conditions under which bodies added from now on fall asleep.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for negative numbers, NaN, and counts that are out of range.
    pub fn set_auto_disable_parameters(&mut self, parameters: &AutoDisable) -> Result<()> {
        parameters.check()?;

        // SAFETY: the world is alive, the numbers are checked.
        unsafe {
            dWorldSetAutoDisableLinearThreshold(self.raw, parameters.linear_threshold);
            dWorldSetAutoDisableAngularThreshold(self.raw, parameters.angular_threshold);
            dWorldSetAutoDisableSteps(self.raw, parameters.steps as i32);
            dWorldSetAutoDisableTime(self.raw, parameters.time);
            dWorldSetAutoDisableAverageSamplesCount(self.raw, parameters.average_samples);
        }
        Ok(())
    }

    /// The damping of the velocities of new bodies.
    pub fn damping(&self) -> Damping {
        // SAFETY: the world is alive.
        unsafe {
            Damping {
                linear: dWorldGetLinearDamping(self.raw),
                angular: dWorldGetAngularDamping(self.raw),
                linear_threshold: dWorldGetLinearDampingThreshold(self.raw),
                angular_threshold: dWorldGetAngularDampingThreshold(self.raw),
            }
        }
    }

    /// Sets the damping of the velocities of bodies added from now on.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for NaN and numbers out of range.
    pub fn set_damping(&mut self, damping: &Damping) -> Result<()> {
        damping.check()?;

        // SAFETY: the world is alive, the numbers are checked.
        unsafe {
            dWorldSetDamping(self.raw, damping.linear, damping.angular);
            dWorldSetLinearDampingThreshold(self.raw, damping.linear_threshold);
            dWorldSetAngularDampingThreshold(self.raw, damping.angular_threshold);
        }
        Ok(())
    }
}
