//! Parameters of joints: stops, motors and softness, for each axis.

use std::f64::consts::PI;

use ode_sys::*;

use super::{Joint, JointAxis, JointMut, JointType};
use crate::Result;
use crate::ode::check;

/// A numeric parameter of a joint's axis. Ball and fixed joints, which have no axis, have those of a first axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum JointParam {
    /// The lowest angle (rad, effective above -pi) or position (m); minus infinity means no stop.
    LowStop,
    /// The highest angle (rad, effective below pi) or position (m); infinity means no stop.
    HighStop,
    /// The motor's target velocity, rad/s or m/s.
    MotorVelocity,
    /// The motor's largest torque (N m) or force (N); 0 means no motor.
    MotorMaxForce,
    /// The scale of the excess force with which the motor leaves a stop, 0 to 1.
    FudgeFactor,
    /// The restitution of the stops, 0 to 1.
    Bounce,
    /// Constraint force mixing: of an axis away from its stops while its motor runs, of ball and fixed joints always.
    Cfm,
    /// The error reduction parameter of ball and fixed joints, 0 to 1.
    Erp,
    /// The error reduction parameter of the stops, 0 to 1.
    StopErp,
    /// The constraint force mixing of the stops.
    StopCfm,
    /// The error reduction parameter of a hinge2 joint along its first axis, 0 to 1.
    ///
    /// A suspension of spring constant k (N/m) and damping constant c (N s/m) has ERP h k / (h k + c) and CFM
    /// 1 / (h k + c) with steps of h seconds (ODE manual, *How to use ERP and CFM*).
    SuspensionErp,
    /// The constraint force mixing of a hinge2 joint along its first axis; see [`SuspensionErp`](Self::SuspensionErp).
    SuspensionCfm,
}

impl JointParam {
    /// ODE's number of this parameter for the first axis.
    fn number(self) -> u32 {
        match self {
            Self::LowStop => dParamLoStop,
            Self::HighStop => dParamHiStop,
            Self::MotorVelocity => dParamVel,
            Self::MotorMaxForce => dParamFMax,
            Self::FudgeFactor => dParamFudgeFactor,
            Self::Bounce => dParamBounce,
            Self::Cfm => dParamCFM,
            Self::Erp => dParamERP,
            Self::StopErp => dParamStopERP,
            Self::StopCfm => dParamStopCFM,
            Self::SuspensionErp => dParamSuspensionERP,
            Self::SuspensionCfm => dParamSuspensionCFM,
        }
    }

    /// Whether this axis of joints of this kind has the parameter, and ODE heeds it.
    fn is_of(self, kind: JointType, axis: JointAxis) -> bool {
        let is_motor = matches!(self, Self::MotorVelocity | Self::MotorMaxForce | Self::Cfm);
        let is_suspension = matches!(self, Self::SuspensionErp | Self::SuspensionCfm);
        match (kind, axis) {
            (JointType::Contact, _) => false,
            (JointType::Ball | JointType::Fixed, axis) => {
                axis == JointAxis::First && matches!(self, Self::Erp | Self::Cfm)
            }
            (_, axis) if axis.index() >= kind.motions().len() => false,
            (JointType::Hinge2, JointAxis::First) => self != Self::Erp,
            (JointType::Hinge2, _) | (JointType::LinearMotor | JointType::Plane2d, _) => is_motor,
            _ => self != Self::Erp && !is_suspension,
        }
    }

    /// Refuses NaN and values out of the parameter's range.
    fn check(self, value: f64) -> Result<()> {
        // Only the stops may be infinite, each in the direction that means no stop.
        let name = format!("{self:?} of the joint");
        match self {
            Self::LowStop if value == f64::NEG_INFINITY => Ok(value),
            Self::HighStop if value == f64::INFINITY => Ok(value),
            Self::LowStop | Self::HighStop | Self::MotorVelocity => check::finite(&name, value),
            Self::MotorMaxForce | Self::Cfm | Self::StopCfm | Self::SuspensionCfm => {
                check::not_negative(&name, value)
            }
            Self::FudgeFactor | Self::Bounce | Self::Erp | Self::StopErp | Self::SuspensionErp => {
                check::within(&name, value, 0.0, 1.0)
            }
        }
        .map(|_| ())
    }
}

/// The stops that were set for a hinge.
///
/// ODE forgets to notice that a hinge which was at a stop has no stops any more, and then writes beyond the memory of a
/// step. So a hinge that once had stops keeps one where no angle, which is less than pi, reaches it.
#[derive(Debug, Clone, Copy)]
pub(super) struct HingeStops {
    low: f64,
    high: f64,
    once_had: bool,
}

impl Default for HingeStops {
    fn default() -> Self {
        Self { low: f64::NEG_INFINITY, high: f64::INFINITY, once_had: false }
    }
}

impl HingeStops {
    /// The value that was set.
    fn get(&self, param: JointParam) -> f64 {
        if param == JointParam::LowStop { self.low } else { self.high }
    }

    /// Sets one of the stops of a hinge.
    ///
    /// # Safety
    ///
    /// `raw` is a living hinge.
    unsafe fn set(&mut self, raw: dJointID, param: JointParam, value: f64) {
        *if param == JointParam::LowStop { &mut self.low } else { &mut self.high } = value;

        // ODE's own condition for stops to have an effect.
        let effective = (self.low >= -PI || self.high <= PI) && self.low <= self.high;
        self.once_had |= effective;
        let (low, high) =
            if self.once_had && !effective { (f64::NEG_INFINITY, PI) } else { (self.low, self.high) };

        // SAFETY: the caller guarantees a living hinge.
        unsafe {
            dJointSetHingeParam(raw, dParamLoStop as i32, low);
            dJointSetHingeParam(raw, dParamHiStop as i32, high);
        }
    }
}

/// Whether it is one of the stops of a hinge.
fn is_hinge_stop(kind: JointType, param: JointParam) -> bool {
    kind == JointType::Hinge && matches!(param, JointParam::LowStop | JointParam::HighStop)
}

impl Joint<'_> {
    /// A parameter of the joint's first axis, if it has it. Those of the other axes are read with
    /// [`param_of_axis`](Self::param_of_axis).
    pub fn param(&self, param: JointParam) -> Option<f64> {
        self.param_of_axis(JointAxis::First, param)
    }

    /// A parameter of an axis, if the axis has it. ODE has no function to read those of plane2d joints.
    pub fn param_of_axis(&self, axis: JointAxis, param: JointParam) -> Option<f64> {
        let kind = self.joint_type();
        if is_hinge_stop(kind, param) && axis == JointAxis::First {
            return Some(self.record.hinge_stops.get(param));
        }
        let get = match kind {
            JointType::Ball => dJointGetBallParam,
            JointType::Hinge => dJointGetHingeParam,
            JointType::Slider => dJointGetSliderParam,
            JointType::Fixed => dJointGetFixedParam,
            JointType::Hinge2 => dJointGetHinge2Param,
            JointType::Universal => dJointGetUniversalParam,
            JointType::PrismaticRotoide => dJointGetPRParam,
            JointType::PrismaticUniversal => dJointGetPUParam,
            JointType::Piston => dJointGetPistonParam,
            JointType::LinearMotor => dJointGetLMotorParam,
            JointType::AngularMotor | JointType::EulerMotor => dJointGetAMotorParam,
            JointType::Contact | JointType::Plane2d => return None,
        };
        let number = param.number() + dParamGroup * axis.index() as u32;
        // SAFETY: the joint is alive and of the kind that `get` takes, and has the axis.
        param.is_of(kind, axis).then(|| unsafe { get(self.record.raw, number as i32) })
    }
}

impl JointMut<'_> {
    /// Sets a parameter of the joint's first axis.
    ///
    /// # Errors
    ///
    /// The errors of [`set_param_of_axis`](Self::set_param_of_axis).
    pub fn set_param(&mut self, param: JointParam, value: f64) -> Result<()> {
        self.set_param_of_axis(JointAxis::First, param, value)
    }

    /// Sets a parameter of an axis.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Argument`] if this axis of this kind of joint does not have the parameter, for NaN, and for
    /// numbers out of range.
    pub fn set_param_of_axis(&mut self, axis: JointAxis, param: JointParam, value: f64) -> Result<()> {
        let kind = self.view().joint_type();
        if !param.is_of(kind, axis) {
            return Err(self.has_no(&format!("{param:?} of its {axis:?} axis"), kind));
        }
        param.check(value)?;

        if is_hinge_stop(kind, param) {
            let record = self.record_mut();
            // SAFETY: the joint is alive, and a hinge.
            unsafe { record.hinge_stops.set(record.raw, param, value) };
            return Ok(());
        }
        let set = match kind {
            JointType::Ball => dJointSetBallParam,
            JointType::Hinge => dJointSetHingeParam,
            JointType::Slider => dJointSetSliderParam,
            JointType::Fixed => dJointSetFixedParam,
            JointType::Hinge2 => dJointSetHinge2Param,
            JointType::Universal => dJointSetUniversalParam,
            JointType::PrismaticRotoide => dJointSetPRParam,
            JointType::PrismaticUniversal => dJointSetPUParam,
            JointType::Piston => dJointSetPistonParam,
            JointType::LinearMotor => dJointSetLMotorParam,
            JointType::AngularMotor | JointType::EulerMotor => dJointSetAMotorParam,
            JointType::Plane2d => {
                [dJointSetPlane2DXParam, dJointSetPlane2DYParam, dJointSetPlane2DAngleParam][axis.index()]
            }
            JointType::Contact => return Err(self.has_no("parameters", kind)),
        };

        // The three functions of plane2d joints take the numbers of a first axis.
        let group = if kind == JointType::Plane2d { 0 } else { dParamGroup * axis.index() as u32 };
        // SAFETY: the joint is alive, of the kind that `set` takes, and has the axis; the number is checked.
        unsafe { set(self.raw(), (param.number() + group) as i32, value) };
        Ok(())
    }
}
