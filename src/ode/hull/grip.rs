//! The softness of contacts of bodies that a hull presses from opposite sides.
//!
//! ODE makes contacts as stiff as its solver allows. A body between two surfaces that leave it a few millimetres too little
//! room is then pressed by thousands of times its weight, and what is left of such forces by errors of normals and of the
//! solver moves it out from between them. So these contacts are springs with dampers, as a hand's flesh is.

use super::class;
use crate::contact::Manifold;
use ode_sys::{
    dBodyGetMass, dBodyIsKinematic, dContact, dContactSoftCFM, dContactSoftERP, dGeomGetBody, dGeomID, dMass,
};

/// The largest cosine of the angle between two directions out of the hull that press a body from opposite sides. Nearer to 0,
/// bodies that lie in a groove count as held; nearer to -1, bodies between hands that are not parallel do not.
const OPPOSITE_COSINE: f64 = -0.5;

/// The natural frequency of a held body's springs, rad/s. A millimetre of depth presses a body by twice its weight. With a
/// higher frequency, noise shakes the body out; with a lower one, it slips before surfaces press deeply.
const FREQUENCY: f64 = 140.0;

/// The softness of a contact, in the terms of ODE's contact joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softness {
    /// The part of the depth that a step corrects (ODE's `soft_erp`).
    pub erp: f64,
    /// The constraint force mixing, m/s per N s (ODE's `soft_cfm`).
    pub cfm: f64,
}

impl Softness {
    /// That of a critically damped spring at a body of `mass` kilograms, in steps of `stepsize` seconds.
    fn of_grip(mass: f64, stepsize: f64) -> Self {
        let (stiffness, damping) = (mass * FREQUENCY * FREQUENCY, 2.0 * mass * FREQUENCY);
        let sum = stepsize * stiffness + damping;
        Self { erp: stepsize * stiffness / sum, cfm: 1.0 / sum }
    }
}

/// Whether two of a body's manifolds press it from opposite sides.
pub(super) fn is_gripped(manifolds: &[Manifold]) -> bool {
    least_cosine(manifolds) < OPPOSITE_COSINE
}

/// The least cosine of the angle between two of a body's manifolds; 1 where there are no two.
pub(super) fn least_cosine(manifolds: &[Manifold]) -> f64 {
    let others = |k: usize| manifolds[k + 1..].iter().map(move |second| (k, second));
    let pairs = (0..manifolds.len()).flat_map(others);
    pairs.map(|(k, second)| manifolds[k].direction.dot(&second.direction)).fold(1.0, f64::min)
}

/// The softness of a contact between two geoms, one of which is a hull that has pressed the other one's body from opposite
/// sides in the last steps; `None` for other contacts.
///
/// # Safety
/// Both geoms are living, and so are their bodies.
pub(in crate::ode) unsafe fn grip_softness(geoms: [dGeomID; 2], stepsize: f64) -> Option<Softness> {
    let hulls = geoms.map(class::find_current);
    let other = if hulls[0].is_some() { geoms[1] } else { geoms[0] };
    let hull = hulls.into_iter().flatten().next()?;
    if !hull.last_contacts.is_gripped(other as usize) {
        return None;
    }
    let mut mass = dMass::default();
    // SAFETY: the caller vouches for the geom and its body.
    unsafe {
        let body = dGeomGetBody(other);
        if body.is_null() || dBodyIsKinematic(body) != 0 {
            return None;
        }
        dBodyGetMass(body, &mut mass);
    }
    Some(Softness::of_grip(mass.mass, stepsize))
}

/// Makes a contact of ODE as soft as [`grip_softness`] says, and returns whether it has: not where the contact states a
/// softness of its own.
///
/// # Safety
/// The contact's geoms are living, and so are their bodies.
pub(super) unsafe fn soften_grip(contact: &mut dContact, stepsize: f64) -> bool {
    let softness = (dContactSoftERP | dContactSoftCFM) as i32;
    if contact.surface.mode & softness != 0 {
        return false;
    }
    // SAFETY: the caller vouches for the geoms.
    let Some(found) = (unsafe { grip_softness([contact.geom.g1, contact.geom.g2], stepsize) }) else {
        return false;
    };
    contact.surface.mode |= softness;
    (contact.surface.soft_erp, contact.surface.soft_cfm) = (found.erp, found.cfm);
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector3, vector};

    fn manifolds(directions: &[Vector3<f64>]) -> Vec<Manifold> {
        directions.iter().map(|direction| Manifold { direction: direction.normalize(), view: None }).collect()
    }

    #[test]
    fn a_body_between_two_sides_is_gripped_and_one_in_a_groove_is_not() {
        assert!(is_gripped(&manifolds(&[Vector3::x(), Vector3::z(), vector![-1.0, 0.3, 0.0]])));
        assert!(!is_gripped(&manifolds(&[vector![1.0, 0.0, 1.0], vector![-1.0, 0.0, 1.0]])));
        assert!(!is_gripped(&manifolds(&[Vector3::x()])));
    }

    /// ODE's user guide: ERP = h k / (h k + d) and CFM = 1 / (h k + d).
    #[test]
    fn a_grip_is_a_critically_damped_spring() {
        let (mass, stepsize) = (2.5, 0.004);
        let Softness { erp, cfm } = Softness::of_grip(mass, stepsize);
        let (stiffness, damping) = (erp / (stepsize * cfm), (1.0 - erp) / cfm);
        let critical = 2.0 * (stiffness * mass).sqrt();
        // Rounding of a few operations.
        assert!((damping / critical - 1.0).abs() < 1e-12);
        assert!((stiffness / (mass * FREQUENCY * FREQUENCY) - 1.0).abs() < 1e-12);
    }
}
