//! A person made of capsules who walks on the spot and waves.
//!
//! The feet follow given paths, on the floor or above it, and the knees follow from the feet. A standing foot is
//! therefore exactly at z = 0, and all motion is smooth and periodic with [`PERSON_PERIOD`].

use super::solid::Solid;
use super::subject::{Placed, Subject};
use super::texture::Texture;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// The period of [`Subject::person_at`] in seconds: two steps.
pub const PERSON_PERIOD: f64 = 1.2;

pub(super) const SKIN: [u8; 3] = [226, 168, 138];
const HAIR: [u8; 3] = [66, 36, 26];
pub(super) const SHIRT: [u8; 3] = [205, 48, 44];
const TROUSERS: [u8; 3] = [44, 58, 164];
const SHOES: [u8; 3] = [150, 34, 120];

const THIGH: f64 = 0.43;
const SHIN: f64 = 0.42;
const HIP_HEIGHT: f64 = 0.90;
const ANKLE_HEIGHT: f64 = 0.08;

impl Subject {
    /// A person of 1.75 m at time `t` in seconds, facing +x, who walks on the spot about the z axis with the soles at
    /// z = 0 and waves the right hand. The colours differ from the [`Room`](super::Room)'s. A time that is not finite
    /// counts as 0.
    pub fn person_at(t: f64) -> Self {
        let phase = if t.is_finite() { TAU * (t / PERSON_PERIOD).rem_euclid(1.0) } else { 0.0 };
        // The body sinks by up to 2 cm between two steps.
        let sink = Vector3::new(0.0, 0.0, -0.01 * (1.0 - (2.0 * phase).cos()));
        let mut solids = trunk(sink);
        solids.extend(leg(1.0, phase, sink));
        solids.extend(leg(-1.0, phase + 0.5 * TAU, sink));
        solids.extend(swinging_arm(phase, sink));
        solids.extend(waving_arm(phase, sink));
        Self::new(solids)
    }
}

fn trunk(sink: Vector3<f64>) -> Vec<Placed> {
    let part = |a: [f64; 3], b: [f64; 3], radius: f64, colour: [u8; 3]| {
        limb(Point3::from(a) + sink, Point3::from(b) + sink, radius, colour)
    };
    vec![
        part([0.01, 0.0, 1.60], [0.01, 0.0, 1.64], 0.095, SKIN),
        part([-0.02, 0.0, 1.645], [-0.02, 0.0, 1.652], 0.098, HAIR),
        part([0.0, 0.0, 1.42], [0.0, 0.0, 1.55], 0.055, SKIN),
        part([0.0, -0.13, 1.37], [0.0, 0.13, 1.37], 0.075, SHIRT),
        part([0.0, 0.04, 1.03], [0.0, 0.075, 1.30], 0.105, SHIRT),
        part([0.0, -0.04, 1.03], [0.0, -0.075, 1.30], 0.105, SHIRT),
        part([0.0, -0.07, 0.94], [0.0, 0.07, 0.94], 0.10, TROUSERS),
    ]
}

/// The leg of the given side (1 left, -1 right); its foot swings forwards through the air while `cos(phase) > 0` and
/// slides back on the floor otherwise.
fn leg(side: f64, phase: f64, sink: Vector3<f64>) -> Vec<Placed> {
    let hip = Point3::new(0.0, 0.09 * side, HIP_HEIGHT) + sink;
    let lift = 0.10 * phase.cos().max(0.0).powi(2);
    let ankle = Point3::new(0.17 * phase.sin(), 0.09 * side, ANKLE_HEIGHT + lift);
    let knee = knee_between(hip, ankle);
    let sole = |forward: f64| ankle + Vector3::new(forward, 0.0, 0.04 - ANKLE_HEIGHT);
    vec![
        limb(hip, knee, 0.072, TROUSERS),
        limb(knee, ankle, 0.054, TROUSERS),
        limb(sole(-0.05), sole(0.15), 0.04, SHOES),
    ]
}

/// The knee of a leg in a plane across y, bent forwards: the third corner of the triangle of hip, knee and ankle.
fn knee_between(hip: Point3<f64>, ankle: Point3<f64>) -> Point3<f64> {
    let leg = ankle - hip;
    let length = leg.norm();
    let down = leg / length;
    let forward = Vector3::new(-down.z, 0.0, down.x);
    let along = (THIGH * THIGH - SHIN * SHIN + length * length) / (2.0 * length);
    let bend = (THIGH * THIGH - along * along).max(0.0).sqrt();
    hip + down * along + forward * bend
}

/// The left arm, which swings opposite to the left leg.
fn swinging_arm(phase: f64, sink: Vector3<f64>) -> Vec<Placed> {
    let swing = -0.45 * phase.sin();
    let shoulder = Point3::new(0.0, 0.185, 1.39) + sink;
    let upper = Vector3::new(swing.sin(), 0.14, -swing.cos());
    let lower = Vector3::new((swing + 0.5).sin(), 0.06, -(swing + 0.5).cos());
    arm_capsules(shoulder, upper, lower)
}

/// The right arm, stretched out to the side with the forearm up.
fn waving_arm(phase: f64, sink: Vector3<f64>) -> Vec<Placed> {
    let wave = 0.15 + 0.5 * (2.0 * phase).sin();
    let shoulder = Point3::new(0.0, -0.185, 1.39) + sink;
    let upper = Vector3::new(0.15, -0.95, 0.1);
    let lower = Vector3::new(0.2, -wave.sin(), wave.cos());
    arm_capsules(shoulder, upper, lower)
}

/// Upper arm, forearm and hand along the directions `upper` and `lower`.
fn arm_capsules(shoulder: Point3<f64>, upper: Vector3<f64>, lower: Vector3<f64>) -> Vec<Placed> {
    let elbow = shoulder + upper.normalize() * 0.28;
    let wrist = elbow + lower.normalize() * 0.24;
    let knuckles = wrist + lower.normalize() * 0.08;
    vec![
        limb(shoulder, elbow, 0.048, SHIRT),
        limb(elbow, wrist, 0.037, SKIN),
        limb(wrist, knuckles, 0.039, SKIN),
    ]
}

/// A capsule whose caps are centred at `a` and `b`.
pub(super) fn limb(a: Point3<f64>, b: Point3<f64>, radius: f64, colour: [u8; 3]) -> Placed {
    let along = b - a;
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.5 * TAU));
    let middle = a + along * 0.5;
    let solid = Solid::Capsule { radius, length: along.norm() };
    Placed::new(solid, Isometry3::from_parts(middle.coords.into(), turn), Texture::cloth(colour))
}
