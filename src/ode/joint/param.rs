//! Parameters of joints: stops, motor and softness.

use ode_sys::{
    dParamBounce, dParamCFM, dParamERP, dParamFMax, dParamFudgeFactor, dParamHiStop, dParamLoStop,
    dParamStopCFM, dParamStopERP, dParamVel,
};

use super::JointType;
use crate::Result;
use crate::ode::check;

/// A numeric parameter of a joint.
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
    /// Constraint force mixing: of hinges and sliders away from their stops, of ball and fixed joints always.
    Cfm,
    /// The error reduction parameter of ball and fixed joints, 0 to 1.
    Erp,
    /// The error reduction parameter of the stops, 0 to 1.
    StopErp,
    /// The constraint force mixing of the stops.
    StopCfm,
}

impl JointParam {
    /// ODE's number of this parameter.
    pub(super) fn number(self) -> i32 {
        // Constants of ODE's unnamed enums are unsigned, while its functions take a C int.
        let number = match self {
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
        };
        number as i32
    }

    /// Whether joints of this kind have the parameter.
    pub(super) fn is_of(self, kind: JointType) -> bool {
        match kind {
            JointType::Hinge | JointType::Slider => self != Self::Erp,
            JointType::Ball | JointType::Fixed => matches!(self, Self::Erp | Self::Cfm),
            JointType::Contact => false,
        }
    }

    /// Refuses NaN and values out of the parameter's range.
    pub(super) fn check(self, value: f64) -> Result<()> {
        // Only the stops may be infinite, each in the direction that means no stop.
        let name = format!("{self:?} of the joint");
        match self {
            Self::LowStop if value == f64::NEG_INFINITY => Ok(value),
            Self::HighStop if value == f64::INFINITY => Ok(value),
            Self::LowStop | Self::HighStop | Self::MotorVelocity => check::finite(&name, value),
            Self::MotorMaxForce | Self::Cfm | Self::StopCfm => check::not_negative(&name, value),
            Self::FudgeFactor | Self::Bounce | Self::Erp | Self::StopErp => {
                check::within(&name, value, 0.0, 1.0)
            }
        }
        .map(|_| ())
    }
}
