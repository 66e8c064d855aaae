//! Colours of surfaces, uniform and patterned.

use super::random::{mix, unit};
use nalgebra::{Point3, Vector3};

/// The variation of a surface's colour.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Pattern {
    /// No variation.
    #[default]
    Plain,
    /// Alternate cubes of a grid are darker by a quarter.
    Checker {
        /// The edge length of the cubes, in metres.
        length: f64,
    },
    /// Small irregular variations, as of cloth or skin.
    Cloth,
}

/// A surface's colour without lighting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Red, green, blue, 0 to 255.
    pub colour: [u8; 3],
    /// The variation over the surface.
    pub pattern: Pattern,
}

impl Texture {
    /// A uniform colour.
    pub fn plain(colour: [u8; 3]) -> Self {
        Self { colour, pattern: Pattern::Plain }
    }

    /// A checkerboard in space with cubes of `length` metres, fixed to the solid's frame.
    pub fn checker(colour: [u8; 3], length: f64) -> Self {
        Self { colour, pattern: Pattern::Checker { length } }
    }

    /// Cloth or skin of this mean colour.
    pub fn cloth(colour: [u8; 3]) -> Self {
        Self { colour, pattern: Pattern::Cloth }
    }

    /// The colour at `point` of the surface's own frame, 0 to 255.
    pub(super) fn at(&self, point: &Point3<f64>) -> Vector3<f64> {
        let shade = match self.pattern {
            Pattern::Plain => 1.0,
            Pattern::Checker { length } => 1.0 - 0.25 * checker(point, length),
            Pattern::Cloth => 1.0 + 0.16 * (noise(point, 0.06) - 0.5),
        };
        Vector3::from(self.colour.map(f64::from)) * shade
    }
}

/// 0 or 1, alternating over the cubes of a grid.
pub(super) fn checker(point: &Point3<f64>, length: f64) -> f64 {
    // The grid planes avoid the origin, where faces of solids and the floor often lie.
    let fields = point.coords.map(|x| (x / length + 0.37).floor()).sum();
    fields.rem_euclid(2.0)
}

/// Smooth noise from 0 to 1 that varies over about `length` metres: random numbers on a grid, interpolated between.
pub(super) fn noise(point: &Point3<f64>, length: f64) -> f64 {
    let grid = point.coords / length;
    let corner = grid.map(f64::floor);
    let blend = (grid - corner).map(|x| x * x * (3.0 - 2.0 * x));
    let [x, y, z] = corner.map(|c| c as i64 as u64).into();

    let at = |dx: u64, dy: u64, dz: u64| {
        let cell = x.wrapping_add(dx).wrapping_mul(0x8DA6_B343)
            ^ y.wrapping_add(dy).wrapping_mul(0x0001_D816_3841)
            ^ z.wrapping_add(dz).wrapping_mul(0x00CB_1AB3_1F00_0001);
        unit(mix(cell))
    };

    let lerp = |a: f64, b: f64, s: f64| a + (b - a) * s;
    let along_x = |dy, dz| lerp(at(0, dy, dz), at(1, dy, dz), blend.x);
    let along_y = |dz| lerp(along_x(0, dz), along_x(1, dz), blend.y);
    lerp(along_y(0), along_y(1), blend.z)
}
