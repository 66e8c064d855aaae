//! What holds for the whole world: gravity, the solver, sleeping, damping.

use nalgebra::Vector3;
use ode_sys::*;

use super::check;
use super::convert;
use super::world::World;
use crate::{Error, Result};

/// When a body that rests falls asleep: when its average speed stays below both thresholds for so many steps and so
/// much time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutoDisable {
    /// m/s.
    pub linear_threshold: f64,
    /// rad/s.
    pub angular_threshold: f64,
    /// How many steps; 0 does not count.
    pub steps: u32,
    /// How long, s; 0 does not count.
    pub time: f64,
    /// Over how many steps the speed is averaged; 1 is the present speed. At most 10 000.
    pub average_samples: u32,
}

impl Default for AutoDisable {
    /// ODE's: 0.01 m/s, 0.01 rad/s, 10 steps.
    fn default() -> Self {
        Self { linear_threshold: 0.01, angular_threshold: 0.01, steps: 10, time: 0.0, average_samples: 1 }
    }
}

impl AutoDisable {
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

    /// # Safety
    ///
    /// `body` is alive.
    pub(super) unsafe fn of_body(body: dBodyID) -> Self {
        // SAFETY: as the caller vouches.
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

    /// # Safety
    ///
    /// `body` is alive, and `self` is checked.
    pub(super) unsafe fn set_body(&self, body: dBodyID) {
        // SAFETY: as the caller vouches.
        unsafe {
            dBodySetAutoDisableLinearThreshold(body, self.linear_threshold);
            dBodySetAutoDisableAngularThreshold(body, self.angular_threshold);
            dBodySetAutoDisableSteps(body, self.steps as i32);
            dBodySetAutoDisableTime(body, self.time);
            dBodySetAutoDisableAverageSamplesCount(body, self.average_samples);
        }
    }
}

/// How motion fades: above its threshold, a velocity loses this part of itself in each step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// Part of the linear velocity, 0 to 1.
    pub linear: f64,
    /// Part of the angular velocity, 0 to 1.
    pub angular: f64,
    /// m/s.
    pub linear_threshold: f64,
    /// rad/s.
    pub angular_threshold: f64,
}

impl Default for Damping {
    /// ODE's: none.
    fn default() -> Self {
        Self { linear: 0.0, angular: 0.0, linear_threshold: 0.01, angular_threshold: 0.01 }
    }
}

impl Damping {
    pub(super) fn check(&self) -> Result<()> {
        check::within("linear damping", self.linear, 0.0, 1.0)?;
        check::within("angular damping", self.angular, 0.0, 1.0)?;
        check::not_negative("linear threshold of damping", self.linear_threshold)?;
        check::not_negative("angular threshold of damping", self.angular_threshold)?;
        Ok(())
    }

    /// # Safety
    ///
    /// `body` is alive.
    pub(super) unsafe fn of_body(body: dBodyID) -> Self {
        // SAFETY: as the caller vouches.
        unsafe {
            Self {
                linear: dBodyGetLinearDamping(body),
                angular: dBodyGetAngularDamping(body),
                linear_threshold: dBodyGetLinearDampingThreshold(body),
                angular_threshold: dBodyGetAngularDampingThreshold(body),
            }
        }
    }

    /// # Safety
    ///
    /// `body` is alive, and `self` is checked.
    pub(super) unsafe fn set_body(&self, body: dBodyID) {
        // SAFETY: as the caller vouches.
        unsafe {
            dBodySetDamping(body, self.linear, self.angular);
            dBodySetLinearDampingThreshold(body, self.linear_threshold);
            dBodySetAngularDampingThreshold(body, self.angular_threshold);
        }
    }
}

/// A number of the world that ODE stores, with what it may be.
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
            // SAFETY: the world is alive, and the number is one that ODE takes.
            unsafe { $ode_set(self.raw, value) };
            Ok(())
        }
    };
}

impl World {
    /// The acceleration of gravity, m/s^2.
    pub fn gravity(&self) -> Vector3<f64> {
        let mut gravity = [0.0; 4];
        // SAFETY: the world is alive, and the array holds four numbers.
        unsafe { dWorldGetGravity(self.raw, gravity.as_mut_ptr()) };
        convert::vector(&gravity)
    }

    /// Sets the acceleration of gravity, m/s^2. 0 at first.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if it is not finite.
    pub fn set_gravity(&mut self, gravity: &Vector3<f64>) -> Result<()> {
        check::vector("gravity", gravity)?;
        // SAFETY: the world is alive; the numbers are finite.
        unsafe { dWorldSetGravity(self.raw, gravity.x, gravity.y, gravity.z) };
        Ok(())
    }

    number!(
        /// The part of a joint's error that is corrected in each step.
        erp, dWorldGetERP,
        /// Sets the part of a joint's error that is corrected in each step, 0 to 1. 0.2 at first.
        set_erp, dWorldSetERP, |value| check::within("ERP", value, 0.0, 1.0)
    );
    number!(
        /// The constraint force mixing: how soft constraints are.
        cfm, dWorldGetCFM,
        /// Sets the constraint force mixing, 0 or more. 1e-10 at first; 1e-5 keeps the solvers steady.
        set_cfm, dWorldSetCFM, |value| check::not_negative("CFM", value)
    );
    number!(
        /// The largest velocity that a contact gives to push bodies apart, m/s.
        contact_max_correcting_velocity, dWorldGetContactMaxCorrectingVel,
        /// Sets the largest velocity that a contact gives to push bodies apart, m/s. Infinite at first.
        set_contact_max_correcting_velocity, dWorldSetContactMaxCorrectingVel,
        |value| check::not_negative_or_infinite("largest correcting velocity", value)
    );
    number!(
        /// The depth that contacts let stand, m.
        contact_surface_layer, dWorldGetContactSurfaceLayer,
        /// Sets the depth that contacts let stand, m, so that they do not flicker. 0 at first.
        set_contact_surface_layer, dWorldSetContactSurfaceLayer,
        |value| check::not_negative("contact surface layer", value)
    );
    number!(
        /// The over-relaxation of [`quick_step`](Self::quick_step).
        quick_step_w, dWorldGetQuickStepW,
        /// Sets the over-relaxation of [`quick_step`](Self::quick_step), 0.01 to 2. 1.3 at first.
        set_quick_step_w, dWorldSetQuickStepW, |value| check::within("over-relaxation", value, 0.01, 2.0)
    );
    number!(
        /// The fastest that new bodies may turn, rad/s.
        max_angular_speed, dWorldGetMaxAngularSpeed,
        /// Sets the fastest that bodies added from now on may turn, rad/s. Infinite at first.
        set_max_angular_speed, dWorldSetMaxAngularSpeed,
        |value| check::not_negative_or_infinite("largest angular speed", value)
    );

    /// The iterations of [`quick_step`](Self::quick_step).
    pub fn quick_step_iterations(&self) -> u32 {
        // SAFETY: the world is alive.
        let iterations = unsafe { dWorldGetQuickStepNumIterations(self.raw) };
        iterations as u32
    }

    /// Sets the iterations of [`quick_step`](Self::quick_step). 20 at first; 50 for stacks.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for 0 and for more than a million.
    pub fn set_quick_step_iterations(&mut self, iterations: u32) -> Result<()> {
        if !(1..=1_000_000).contains(&iterations) {
            return Err(Error::argument(format!("iterations: expected 1 to 1000000, found {iterations}")));
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

    /// Whether bodies added from now on fall asleep when they rest. Off at first.
    pub fn set_auto_disable(&mut self, on: bool) {
        // SAFETY: the world is alive.
        unsafe { dWorldSetAutoDisableFlag(self.raw, on.into()) };
    }

    /// When new bodies fall asleep.
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

    /// Sets when bodies added from now on fall asleep.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for negative numbers and NaN.
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

    /// How the motion of new bodies fades.
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

    /// Sets how the motion of bodies added from now on fades.
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
