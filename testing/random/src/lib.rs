//! Repeatable random numbers for tests, figures and benchmarks.
//!
//! This package does not depend on the library, so that the library's unit tests can use it too. A test binary cannot
//! link the library twice, because its C functions have global names.

use nalgebra::{Point3, UnitQuaternion, Vector3};

/// The generator SplitMix64 (Steele, Lea and Flood, *Fast Splittable Pseudorandom Number Generators*, 2014), by its
/// seed. A seed gives the same numbers on every machine.
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// A uniformly distributed number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A uniformly distributed number in [`low`, `high`).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A uniformly distributed integer from 0 to `end - 1`; 0 where `end` is 0.
    ///
    /// # Panics
    ///
    /// If `end` is negative.
    pub fn below<N: TryInto<u64> + TryFrom<u64>>(&mut self, end: N) -> N {
        let end: u64 = end.try_into().ok().expect("an end that is not negative");
        let number = (self.unit() * end as f64) as u64;
        N::try_from(number).ok().expect("a number below the end fits its type")
    }

    /// A uniformly distributed point in the box from `min` to `max`.
    pub fn point(&mut self, min: Point3<f64>, max: Point3<f64>) -> Point3<f64> {
        min + (max - min).map(|extent| extent * self.unit())
    }

    /// A unit vector of uniformly distributed direction.
    pub fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| 2.0 * self.unit() - 1.0);
            if v.norm() > 0.1 && v.norm() < 1.0 {
                return v.normalize();
            }
        }
    }

    /// A rotation by up to half a turn about a uniformly distributed axis.
    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::new(self.direction() * (std::f64::consts::PI * self.unit()))
    }
}
