//! Repeatable random numbers.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use ode_visual_hull::hull::Aabb;

/// SplitMix64 (Steele, Lea, Flood 2014): the same seed gives the same numbers everywhere.
pub struct Random(pub u64);

impl Random {
    /// Even in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Even in a box.
    pub fn point(&mut self, aabb: &Aabb) -> Point3<f64> {
        aabb.min + (aabb.max - aabb.min).map(|extent| extent * self.unit())
    }

    /// A unit vector, even over the sphere.
    pub fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| 2.0 * self.unit() - 1.0);
            if v.norm() > 0.1 && v.norm() < 1.0 {
                return v.normalize();
            }
        }
    }

    /// A rotation by up to half a turn about any axis.
    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::new(self.direction() * (std::f64::consts::PI * self.unit()))
    }
}
