//! The numbers of a joint: stops, motor, softness.

use ode_sys::{
    dParamBounce, dParamCFM, dParamERP, dParamFMax, dParamFudgeFactor, dParamHiStop, dParamLoStop,
    dParamStopCFM, dParamStopERP, dParamVel,
};

use super::JointType;
use crate::Result;
use crate::ode::check;

/// A number of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum JointParam {
    /// Lowest angle (rad, above -pi to act) or position (m); minus infinity is none.
    LowStop,
    /// Highest angle (rad, below pi to act) or position (m); infinity is none.
    HighStop,
    /// What the motor aims at, rad/s or m/s.
    MotorVelocity,
    /// The largest torque (N m) or force (N) of the motor; 0 is no motor.
    MotorMaxForce,
    /// How much of an excess force at a stop is left, 0 to 1.
    FudgeFactor,
    /// Restitution of the stops, 0 to 1.
    Bounce,
    /// Constraint force mixing away from the stops; of ball and fixed joints, of the joint itself.
    Cfm,
    /// Error reduction of ball and fixed joints.
    Erp,
    /// Error reduction of the stops.
    StopErp,
    /// Constraint force mixing of the stops.
    StopCfm,
}

impl JointParam {
    pub(super) fn number(self) -> i32 {
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

    pub(super) fn is_of(self, kind: JointType) -> bool {
        match kind {
            JointType::Hinge | JointType::Slider => self != Self::Erp,
            JointType::Ball | JointType::Fixed => matches!(self, Self::Erp | Self::Cfm),
            JointType::Contact => false,
        }
    }

    pub(super) fn check(self, value: f64) -> Result<()> {
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
