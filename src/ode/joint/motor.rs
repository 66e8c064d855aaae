//! Axes of linear and angular motors: their number, and the body that they move with.

use nalgebra::Vector3;
use ode_sys::*;

use super::axes::to_world;
use super::{Joint, JointAxis, JointMut, JointRecord, JointType};
use crate::ode::{check, convert};
use crate::{Error, Result};

/// An axis of a linear or angular motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorAxis {
    /// The direction in the world's frame at the bodies' current poses, of any length but 0.
    pub direction: Vector3<f64>,
    /// What the axis moves with.
    pub frame: AxisFrame,
}

/// What an axis of a motor moves with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum AxisFrame {
    /// Nothing: the direction stays as it is.
    #[default]
    World,
    /// The joint's first body.
    FirstBody,
    /// The joint's second body, which must not be the world.
    SecondBody,
}

impl MotorAxis {
    /// An axis that keeps its direction in the world.
    pub fn of_world(direction: Vector3<f64>) -> Self {
        Self { direction, frame: AxisFrame::World }
    }

    /// An axis that turns with the joint's first body.
    pub fn of_first_body(direction: Vector3<f64>) -> Self {
        Self { direction, frame: AxisFrame::FirstBody }
    }

    /// An axis that turns with the joint's second body.
    pub fn of_second_body(direction: Vector3<f64>) -> Self {
        Self { direction, frame: AxisFrame::SecondBody }
    }
}

/// Refuses directions that are not finite or of length 0, axes behind an unused one, and axes of a second body that
/// is the world: ODE would read a direction that it never set.
pub(super) fn check_axes(axes: &[Option<MotorAxis>; 3], has_second_body: bool) -> Result<()> {
    for axis in axes.iter().flatten() {
        check::direction("axis of the motor", &axis.direction)?;
    }
    if axes.windows(2).any(|pair| pair[0].is_none() && pair[1].is_some()) {
        return Err(Error::argument(
            "axes of the motor: expected the used axes before the unused ones, found a gap: close it",
        ));
    }
    check_frames(&axes.map(|axis| axis.map(|axis| axis.frame)), has_second_body)
}

/// Refuses axes of a second body that is the world.
pub(super) fn check_frames(frames: &[Option<AxisFrame>; 3], has_second_body: bool) -> Result<()> {
    if !has_second_body && frames.contains(&Some(AxisFrame::SecondBody)) {
        return Err(Error::argument(
            "axes of the motor: expected a second body, with which one of them moves, found the world: attach two \
             bodies, or use `AxisFrame::World`",
        ));
    }
    Ok(())
}

impl JointRecord {
    /// Sets the axes of a linear or angular motor that is attached; they are checked.
    pub(super) fn set_motor_axes(&mut self, axes: &[Option<MotorAxis>; 3]) {
        let (set, set_number): (unsafe extern "C" fn(_, _, _, _, _, _), unsafe extern "C" fn(_, _)) =
            match self.kind {
                JointType::LinearMotor => (dJointSetLMotorAxis, dJointSetLMotorNumAxes),
                JointType::AngularMotor => (dJointSetAMotorAxis, dJointSetAMotorNumAxes),
                _ => return,
            };

        // SAFETY: the joint is alive, attached and of the kind that the functions take; numbers of axes are 0 to 2.
        // The frames are declared in the order of ODE's numbers 0 to 2, and a second body is there where it is named.
        unsafe {
            for (index, axis) in axes.iter().flatten().enumerate() {
                let MotorAxis { direction, frame } = axis;
                set(self.raw, index as i32, *frame as i32, direction.x, direction.y, direction.z);
            }
            set_number(self.raw, axes.iter().flatten().count() as i32);
        }
        self.motor_frames = axes.map(|axis| axis.map(|axis| axis.frame));
    }

    /// The number of axes that the joint has at present.
    pub(super) fn axis_count(&self) -> usize {
        match self.kind {
            JointType::LinearMotor | JointType::AngularMotor => self.motor_frames.iter().flatten().count(),
            kind => kind.motions().len(),
        }
    }

    /// The direction of a linear motor's axis in the world's frame. The joint is attached and has the axis.
    pub(super) fn linear_motor_axis(&self, axis: JointAxis) -> Vector3<f64> {
        let mut direction = [0.0; 4];
        // SAFETY: the joint is alive and a linear motor; the array holds four numbers.
        unsafe { dJointGetLMotorAxis(self.raw, axis.index() as i32, direction.as_mut_ptr()) };

        // ODE returns the axis in the frame that it moves with.
        let [first, second] = self.raw_bodies();
        let body = match self.motor_frames[axis.index()] {
            Some(AxisFrame::FirstBody) => first,
            Some(AxisFrame::SecondBody) => second,
            Some(AxisFrame::World) | None => std::ptr::null_mut(),
        };
        // SAFETY: the body is alive or null.
        unsafe { to_world(body, &convert::vector(&direction)) }
    }
}

impl Joint<'_> {
    /// What an axis of a linear or angular motor moves with.
    pub fn axis_frame(&self, axis: JointAxis) -> Option<AxisFrame> {
        self.record.motor_frames[axis.index()]
    }
}

impl JointMut<'_> {
    /// Sets the axes of a linear or angular motor; those that are used come first.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint, for a joint without bodies, for directions that are not finite or
    /// of length 0, for a gap between the axes, and for an axis of the second body where that is the world.
    pub fn set_motor_axes(&mut self, axes: &[Option<MotorAxis>; 3]) -> Result<()> {
        let kind = self.view().joint_type();
        if !matches!(kind, JointType::LinearMotor | JointType::AngularMotor) {
            return Err(self.has_no("motor axes", kind));
        }
        self.expect_attached()?;
        check_axes(axes, self.view().bodies()[1].is_some())?;
        self.record_mut().set_motor_axes(axes);
        Ok(())
    }

    /// Sets the angle about an axis of an angular motor, in radians, which ODE cannot measure and compares with the
    /// stops. An Euler motor measures its angles itself.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint, for an axis that the motor does not have, and for angles that are
    /// not finite.
    pub fn set_motor_angle(&mut self, axis: JointAxis, angle: f64) -> Result<()> {
        check::finite("angle of the motor", angle)?;
        let kind = self.view().joint_type();
        if kind != JointType::AngularMotor {
            return Err(self.has_no("a motor angle to set", kind));
        }
        self.expect_axis(axis)?;
        // SAFETY: the joint is alive, an angular motor in user mode, and has the axis.
        unsafe { dJointSetAMotorAngle(self.raw(), axis.index() as i32, angle) };
        Ok(())
    }

    /// Adds a torque, N m, about an axis during the next step: on the first body, and the opposite on the second.
    ///
    /// Hinge, hinge2, universal and PR joints and angular motors take torques.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint, for an axis about which this one does not turn, for a joint
    /// without bodies or with parallel axes, and for torques that are not finite.
    pub fn add_torque(&mut self, axis: JointAxis, torque: f64) -> Result<()> {
        check::finite("torque of the joint", torque)?;
        let (kind, raw) = (self.view().joint_type(), self.raw());
        self.expect_attached()?;
        self.expect_axis(axis)?;
        self.expect_crossed()?;

        let only = |of: JointAxis| if axis == of { torque } else { 0.0 };
        let [first, second, third] = JointAxis::ALL.map(only);
        // SAFETY: the joint is alive, attached and of the kind that each function takes; its axes are not parallel.
        unsafe {
            match (kind, axis) {
                (JointType::Hinge, JointAxis::First) => dJointAddHingeTorque(raw, torque),
                (JointType::Hinge2, _) => dJointAddHinge2Torques(raw, first, second),
                (JointType::Universal, _) => dJointAddUniversalTorques(raw, first, second),
                (JointType::PrismaticRotoide, JointAxis::Second) => dJointAddPRTorque(raw, torque),
                (JointType::AngularMotor | JointType::EulerMotor, _) => {
                    dJointAddAMotorTorques(raw, first, second, third);
                }
                _ => return Err(self.has_no(&format!("torques about its {axis:?} axis"), kind)),
            }
        }
        Ok(())
    }

    /// Adds a force, N, along the axis of a slider or piston during the next step: on the first body, and the opposite
    /// on the second.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint, for a joint without bodies, and for forces that are not finite.
    pub fn add_force(&mut self, force: f64) -> Result<()> {
        check::finite("force of the joint", force)?;
        let kind = self.view().joint_type();
        let add = match kind {
            JointType::Slider => dJointAddSliderForce,
            JointType::Piston => dJointAddPistonForce,
            _ => return Err(self.has_no("forces along its axis", kind)),
        };
        self.expect_attached()?;
        // SAFETY: the joint is alive, attached and of the kind that `add` takes.
        unsafe { add(self.raw(), force) };
        Ok(())
    }
}
