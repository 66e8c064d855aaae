//! A synthetic hand with its palm up.

use nalgebra::{Isometry3, UnitQuaternion, vector};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture};
use std::f64::consts::FRAC_PI_2;

/// The height of the palm above the hand's origin, along z, in metres.
pub const PALM: f64 = 0.014;

/// The place across the hand, along y, of one of the palm's highest lines, in metres.
pub const PALM_LINE: f64 = 0.011;

/// A hand about the origin of its frame: a palm of four capsules, four fingers along x, a thumb and a forearm.
///
/// # Panics
///
/// Never: all sizes are positive.
pub fn hand(pose: &Isometry3<f64>) -> Subject {
    let capsule = |radius: f64, length: f64, place: Isometry3<f64>| {
        Placed::new(Solid::capsule(radius, length).unwrap(), pose * place, Texture::plain([220, 170, 140]))
    };
    // Capsules are along z.
    let along_x = UnitQuaternion::from_euler_angles(0.0, FRAC_PI_2, 0.0);
    let lies = |x: f64, y: f64| Isometry3::from_parts(vector![x, y, 0.0].into(), along_x);

    let across = [-3.0, -1.0, 1.0, 3.0].map(|k| k * PALM_LINE);
    let mut parts: Vec<_> = across.iter().map(|&y| capsule(PALM, 0.07, lies(-0.02, y))).collect();
    parts.extend(across.iter().map(|&y| capsule(0.009, 0.06, lies(0.05, 1.3 * y))));
    let aside = UnitQuaternion::from_euler_angles(FRAC_PI_2 + 0.5, 0.0, 0.0);
    parts.push(capsule(0.011, 0.05, Isometry3::from_parts(vector![-0.03, 0.06, 0.01].into(), aside)));
    parts.push(capsule(0.035, 0.2, lies(-0.18, 0.0)));
    Subject::new(parts)
}
