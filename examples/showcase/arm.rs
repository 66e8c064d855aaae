//! A real arm of capsules, whose forefinger points somewhere.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture};

/// The radius of the finger, in metres.
pub const FINGER: f64 = 0.014;

const SKIN: [u8; 3] = [226, 168, 138];
const SLEEVE: [u8; 3] = [44, 58, 164];

/// An arm that reaches along `reach` from out of the picture to a hand, whose forefinger points along `point` and ends at
/// `tip`.
pub fn arm(tip: Point3<f64>, point: Vector3<f64>, reach: Vector3<f64>) -> Result<Subject> {
    let (point, reach) = (point.normalize(), reach.normalize());
    let knuckle = tip - point * 0.09;
    let wrist = knuckle - (reach + 0.4 * point).normalize() * 0.09;
    let cuff = wrist - reach * 0.16;
    Ok(Subject::new(vec![
        limb(tip - point * FINGER, knuckle, FINGER, SKIN)?,
        limb(knuckle - point * 0.01, wrist, 0.033, SKIN)?,
        limb(wrist, cuff, 0.027, SKIN)?,
        limb(cuff, cuff - reach * 4.0, 0.045, SLEEVE)?,
    ]))
}

/// A part of a way that begins and ends gently: 0 until `start`, 1 from `end` on, times in seconds.
pub fn ease(time: f64, start: f64, end: f64) -> f64 {
    let s = ((time - start) / (end - start)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

/// A capsule whose caps are centred at `from` and `to`.
fn limb(from: Point3<f64>, to: Point3<f64>, radius: f64, colour: [u8; 3]) -> Result<Placed> {
    let along = to - from;
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    let pose = Isometry3::from_parts((from + 0.5 * along).into(), turn);
    Ok(Placed::new(Solid::capsule(radius, along.norm())?, pose, Texture::cloth(colour)))
}
