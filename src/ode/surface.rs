//! Contact surfaces: friction, bounce and softness.

use nalgebra::Vector3;
use ode_sys::{
    dContactApprox1_1, dContactApprox1_2, dContactApprox1_N, dContactAxisDep, dContactBounce, dContactFDir1,
    dContactMotion1, dContactMotion2, dContactMotionN, dContactRolling, dContactSlip1, dContactSlip2,
    dContactSoftCFM, dContactSoftERP, dSurfaceParameters,
};

use super::check;
use super::hull::{Softness, SurfaceMotion};
use crate::{Error, Result};

/// The largest cosine of the angle between a normal and a direction that counts as perpendicular to it, and the largest
/// difference of a unit vector's length from 1.
const UNIT: f64 = 1e-3;

/// Friction, bounce, softness and motion of the surface at one contact. A field that is `None` is off, or takes the
/// world's value.
///
/// ```
/// use ode_visual_hull::ode::Surface;
/// let rubber = Surface { mu: 1.0, bounce: Some(0.7), bounce_velocity: 0.1, ..Surface::default() };
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Coulomb's friction coefficient: 0 means no friction, infinity means no slip. See also
    /// [`approximation`](Self::approximation).
    pub mu: f64,
    /// The friction coefficient in the second tangential direction; `None` means `mu` in both.
    pub mu2: Option<f64>,
    /// The first tangential direction, a unit vector in the world's frame and perpendicular to the contact's normal
    /// (ODE's `fdir1`). The second is the cross product of the normal, as it points into the first body that is not the
    /// world, and the first direction. `None` leaves the choice to ODE, which depends on the normal alone.
    pub friction_direction: Option<Vector3<f64>>,
    /// The velocity that friction drives the first body at, relative to the second, in the first and second
    /// tangential direction, m/s (ODE's `motion1` and `motion2`): a conveyor belt. Without friction it has no effect.
    /// Against the world it is the velocity of the body, whichever of the two it is. It needs a
    /// [`friction_direction`](Self::friction_direction).
    pub surface_velocity: Option<[f64; 2]>,
    /// The velocity at which the contact pushes the bodies apart, m/s (ODE's `motionN`).
    pub normal_velocity: Option<f64>,
    /// The coefficient of restitution: 0 means no bounce, 1 returns the full speed.
    pub bounce: Option<f64>,
    /// The impact speed below which nothing bounces, m/s. It matters only with `bounce`.
    pub bounce_velocity: f64,
    /// The part of the depth that each step corrects, 0 to 1, instead of the world's ERP.
    pub soft_erp: Option<f64>,
    /// The first part of the depth that no step corrects, in metres.
    pub soft_depth: f64,
    /// The constraint force mixing of the normal force, instead of the world's CFM.
    pub soft_cfm: Option<f64>,
    /// Rolling and spinning friction, as the largest torque divided by the normal force, in metres.
    pub rolling: Option<f64>,
    /// Force-dependent slip in the first and second tangential direction, m/s per N.
    pub slip: Option<[f64; 2]>,
    /// The meaning of `mu`.
    pub approximation: Approximation,
}

/// The friction model: the meaning of [`Surface::mu`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Approximation {
    /// `mu` is the largest friction force, in newtons (ODE's `dContactApprox0`).
    Force,
    /// `mu` times the normal force is the largest friction force in each tangential direction (`dContactApprox1`).
    #[default]
    Pyramid,
}

impl Default for Surface {
    /// A friction coefficient of 0.5, and nothing else.
    fn default() -> Self {
        Self {
            mu: 0.5,
            mu2: None,
            friction_direction: None,
            surface_velocity: None,
            normal_velocity: None,
            bounce: None,
            bounce_velocity: 0.0,
            soft_erp: None,
            soft_depth: 0.0,
            soft_cfm: None,
            rolling: None,
            slip: None,
            approximation: Approximation::Pyramid,
        }
    }
}

impl Surface {
    /// A surface with this friction coefficient, and nothing else.
    pub fn with_friction(mu: f64) -> Self {
        Self { mu, ..Self::default() }
    }

    /// This surface, moving as the real one: with the friction direction and the velocities of `motion`, to which its
    /// own velocities are added, and its soft depth if that is larger.
    pub fn with_motion(self, motion: &SurfaceMotion) -> Self {
        let [first, second] = self.surface_velocity.unwrap_or_default();
        let [along_first, along_second] = motion.surface_velocity;
        Self {
            friction_direction: Some(motion.friction_direction),
            surface_velocity: Some([first + along_first, second + along_second]),
            normal_velocity: Some(
                self.normal_velocity.unwrap_or(0.0) + motion.normal_velocity_where(self.bounce.is_some()),
            ),
            soft_depth: self.soft_depth.max(motion.soft_depth),
            ..self
        }
    }

    /// This surface, as soft as a grip where it states no softness of its own.
    pub fn with_softness(self, softness: Softness) -> Self {
        if self.soft_erp.is_some() || self.soft_cfm.is_some() {
            return self;
        }
        Self { soft_erp: Some(softness.erp), soft_cfm: Some(softness.cfm), ..self }
    }

    /// The surface as ODE's structure.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a number is NaN or out of its range, or if a surface velocity has no direction.
    pub(super) fn to_ode(self) -> Result<dSurfaceParameters> {
        // ODE reads an optional number only if its bit of the mode is set.
        let mut mode = 0;
        let mut flag = |bits: u32, on: bool| mode |= if on { bits } else { 0 };
        flag(dContactAxisDep, self.mu2.is_some());
        flag(dContactFDir1, self.friction_direction.is_some());
        flag(dContactMotion1 | dContactMotion2, self.surface_velocity.is_some());
        flag(dContactMotionN, self.normal_velocity.is_some());
        flag(dContactBounce, self.bounce.is_some());
        flag(dContactSoftERP, self.soft_erp.is_some());
        flag(dContactSoftCFM, self.soft_cfm.is_some());
        // For a rolling coefficient of 0 ODE reserves rows of the solver and leaves them unfilled, so 0 switches it
        // off.
        flag(dContactRolling, self.rolling.is_some_and(|rho| rho > 0.0));
        flag(dContactSlip1 | dContactSlip2, self.slip.is_some());
        flag(
            dContactApprox1_1 | dContactApprox1_2 | dContactApprox1_N,
            self.approximation == Approximation::Pyramid,
        );

        let rho = check::not_negative_or_infinite("rolling friction", self.rolling.unwrap_or(0.0))?;
        let [slip1, slip2] = self.slip.unwrap_or_default();
        let [motion1, motion2] = self.surface_velocity.unwrap_or_default();
        if self.surface_velocity.is_some() && self.friction_direction.is_none() {
            return Err(Error::argument(
                "surface velocity: expected a direction to go with it, found none: set `friction_direction`",
            ));
        }
        Ok(dSurfaceParameters {
            mode: mode as i32,
            mu: check::not_negative_or_infinite("mu", self.mu)?,
            mu2: check::not_negative_or_infinite("mu2", self.mu2.unwrap_or(self.mu))?,
            rho,
            rho2: rho,
            rhoN: rho,
            bounce: check::within("bounce", self.bounce.unwrap_or(0.0), 0.0, 1.0)?,
            bounce_vel: check::not_negative("bounce velocity", self.bounce_velocity)?,
            soft_erp: check::within("soft ERP", self.soft_erp.unwrap_or(0.0), 0.0, 1.0)?,
            soft_cfm: check::not_negative("soft CFM", self.soft_cfm.unwrap_or(0.0))?,
            slip1: check::not_negative("slip", slip1)?,
            slip2: check::not_negative("slip", slip2)?,
            motion1: check::finite("surface velocity", motion1)?,
            motion2: check::finite("surface velocity", motion2)?,
            motionN: check::finite("normal velocity", self.normal_velocity.unwrap_or(0.0))?,
        })
    }

    /// The first tangential direction at a contact with this unit normal, or zero where ODE chooses it.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if it is no unit vector, or not perpendicular to the normal.
    pub(super) fn friction_direction_at(&self, normal: &Vector3<f64>) -> Result<Vector3<f64>> {
        let Some(direction) = self.friction_direction else { return Ok(Vector3::zeros()) };
        let (length, along_normal) = (direction.norm(), direction.dot(normal));
        // Written so that NaN is refused too.
        if (length - 1.0).abs() <= UNIT && along_normal.abs() <= UNIT {
            return Ok(direction);
        }
        Err(Error::argument(format!(
            "friction direction: expected a unit vector perpendicular to the normal of the contact, found length \
             {length} and {along_normal} along the normal: project it onto the contact's tangent plane, and normalise it"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_fields_that_are_set_switch_a_mode_bit_on() {
        let plain = Surface::default().to_ode().unwrap();
        assert_eq!(plain.mode, ode_sys::dContactApprox1 as i32);
        assert_eq!((plain.mu, plain.mu2), (0.5, 0.5));

        let force = Surface { approximation: Approximation::Force, ..Surface::with_friction(f64::INFINITY) };
        assert_eq!(force.to_ode().unwrap().mode, 0);

        let all = Surface {
            mu2: Some(0.1),
            friction_direction: Some(Vector3::x()),
            surface_velocity: Some([0.8, 0.9]),
            normal_velocity: Some(1.0),
            bounce: Some(0.2),
            soft_erp: Some(0.3),
            soft_cfm: Some(0.4),
            rolling: Some(0.5),
            slip: Some([0.6, 0.7]),
            ..Surface::default()
        };

        let ode = all.to_ode().unwrap();
        assert_eq!(ode.mode as u32, 0x7ff | 0x7000);
        let numbers = [ode.mu2, ode.bounce, ode.soft_erp, ode.soft_cfm, ode.rho, ode.slip1, ode.slip2];
        assert_eq!(numbers, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]);
        assert_eq!([ode.motion1, ode.motion2, ode.motionN], [0.8, 0.9, 1.0]);
    }

    #[test]
    fn nan_and_numbers_out_of_range_are_refused() {
        let plain = Surface::default();
        for bad in [
            Surface { mu: f64::NAN, ..plain },
            Surface { mu: -0.1, ..plain },
            Surface { mu2: Some(f64::NAN), ..plain },
            Surface { bounce: Some(1.1), ..plain },
            Surface { bounce_velocity: f64::INFINITY, ..plain },
            Surface { soft_erp: Some(-0.1), ..plain },
            Surface { soft_cfm: Some(f64::INFINITY), ..plain },
            Surface { rolling: Some(f64::NAN), ..plain },
            Surface { slip: Some([0.0, f64::NAN]), ..plain },
        ] {
            assert!(bad.to_ode().is_err(), "{bad:?}");
        }
    }
}
