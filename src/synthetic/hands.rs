//! Two hands made of capsules, which face each other as if they held a box.

use super::person::{SHIRT, SKIN, limb};
use super::subject::{Placed, Subject};
use nalgebra::{Isometry3, Point3};

/// The radii of the palm, the fingers, the thumb, the wrist and the forearm, in metres.
const PALM: f64 = 0.016;
const FINGER: f64 = 0.010;
const THUMB: f64 = 0.011;
const WRIST: f64 = 0.026;
const FOREARM: f64 = 0.034;

/// Heights of the fingers, from the little finger up, and how far along y they reach, in metres.
const FINGERS: [(f64, f64); 4] = [(-0.036, 0.085), (-0.012, 0.105), (0.012, 0.112), (0.036, 0.105)];

impl Subject {
    /// Two hands of capsules, each a palm, four fingers, a thumb and a forearm. In their own frame, whose pose is
    /// `world_from_hands`, the palms face each other along x at a distance of `gap` metres, the fingers point along +y, the
    /// thumbs up, along +z, and the arms come from behind and above.
    pub fn hands(world_from_hands: &Isometry3<f64>, gap: f64) -> Self {
        Self::new(hand(-0.5 * gap, -1.0).chain(hand(0.5 * gap, 1.0)).collect()).transformed(world_from_hands)
    }
}

/// The hand on one side of the middle, -1 or 1 along x, whose inner surface lies at `inner` metres.
fn hand(inner: f64, side: f64) -> impl Iterator<Item = Placed> {
    let part = move |a: [f64; 3], b: [f64; 3], radius: f64, colour: [u8; 3]| {
        let outwards = |[x, y, z]: [f64; 3]| Point3::new(inner + side * (radius + x), y, z);
        limb(outwards(a), outwards(b), radius, colour)
    };
    let fingers = FINGERS.into_iter().flat_map(move |(z, reach)| {
        [
            part([0.0, -0.05, z], [0.0, 0.03, z], PALM, SKIN),
            part([0.0, 0.03, z], [0.0, reach, z], FINGER, SKIN),
        ]
    });
    fingers.chain([
        part([0.002, -0.03, 0.04], [0.0, 0.03, 0.078], THUMB, SKIN),
        part([0.0, -0.06, 0.0], [0.03, -0.12, 0.02], WRIST, SKIN),
        part([0.03, -0.12, 0.02], [0.11, -0.21, 0.08], FOREARM, SKIN),
        part([0.11, -0.21, 0.08], [0.28, -0.39, 0.22], FOREARM, SHIRT),
    ])
}
