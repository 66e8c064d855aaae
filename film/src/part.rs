//! The parts of rigid virtual bodies: shapes, where they are in the body, what they weigh and how they look.

use crate::body_shape::check_drawable;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{Amount, Mass, Shape};
use ode_visual_hull::{Error, Result};

/// Density in kg/m3 unless another is given, about that of a parcel.
const DENSITY: f64 = 120.0;

/// A part of a rigid body, which collides with what other bodies are made of.
#[derive(Debug, Clone)]
pub struct Part {
    /// A box, a sphere or a capsule.
    pub shape: Shape,
    /// The pose of the part in the body's frame.
    pub body_from_part: Isometry3<f64>,
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// In kg/m3.
    pub density: f64,
    /// Whether the part collides and has a mass; otherwise it is only drawn.
    pub is_solid: bool,
}

impl Part {
    /// A part at the origin of the body's frame, of 120 kg/m3.
    pub fn new(shape: Shape, colour: [u8; 3]) -> Self {
        Self { shape, body_from_part: Isometry3::identity(), colour, density: DENSITY, is_solid: true }
    }

    /// A rod with round ends whose axis reaches from `from` to `to`.
    pub fn rod(from: Point3<f64>, to: Point3<f64>, radius: f64, colour: [u8; 3]) -> Self {
        let along = to - from;
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along)
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        let middle = from + 0.5 * along;
        let shape = Shape::Capsule { radius, length: along.norm() };
        Self::new(shape, colour).at(Isometry3::from_parts(middle.into(), turn))
    }

    /// This part at another pose in the body's frame.
    pub fn at(self, body_from_part: Isometry3<f64>) -> Self {
        Self { body_from_part, ..self }
    }

    /// This part with another density, in kg/m3.
    pub fn with_density(self, density: f64) -> Self {
        Self { density, ..self }
    }

    /// This part as a mere picture: it neither collides nor weighs anything.
    pub fn only_drawn(self) -> Self {
        Self { is_solid: false, ..self }
    }

    fn mass(&self) -> Result<Mass> {
        let own = Mass::of(&self.shape, Amount::Density(self.density))?;
        own.rotated(&self.body_from_part.rotation).translated(&self.body_from_part.translation.vector)
    }
}

/// The mass of the solid ones of `parts` as one rigid body, in the body's frame.
///
/// # Errors
/// A shape that is not drawn, a size or density that is not positive, a pose that is not finite, or no solid part.
pub(crate) fn mass_of(parts: &[Part]) -> Result<Mass> {
    for part in parts {
        check_drawable(&part.shape)?;
    }
    let mut masses = parts.iter().filter(|part| part.is_solid).map(Part::mass);
    let first = masses.next().ok_or_else(|| {
        Error::argument(format!(
            "body of {} parts: expected one that is solid, found none; add one that has a mass, or add the parts as fixed",
            parts.len()
        ))
    })?;
    masses.try_fold(first?, |sum, mass| sum.combined(&mass?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rod_reaches_from_one_point_to_the_other() {
        let (from, to) = (Point3::new(0.1, 0.2, 0.3), Point3::new(0.4, 0.2, -0.1));
        for (from, to) in [(from, to), (to, from), (from, from - Vector3::z())] {
            let rod = Part::rod(from, to, 0.01, [0; 3]);
            let Shape::Capsule { length, .. } = rod.shape else { panic!("expected a capsule") };
            let end = |sign: f64| rod.body_from_part * Point3::new(0.0, 0.0, 0.5 * sign * length);
            assert!((end(-1.0) - from).norm() < 1e-12 && (end(1.0) - to).norm() < 1e-12, "{from} to {to}");
        }
    }

    #[test]
    fn a_part_that_is_only_drawn_weighs_nothing() {
        let ball = Part::new(Shape::Sphere { radius: 0.1 }, [0; 3]);
        let picture =
            Part::new(Shape::cube(1.0), [0; 3]).at(Isometry3::translation(1.0, 0.0, 0.0)).only_drawn();
        let alone = mass_of(std::slice::from_ref(&ball)).unwrap();
        assert_eq!(mass_of(&[picture.clone(), ball]).unwrap(), alone);
        assert!(mass_of(&[picture]).unwrap_err().to_string().contains("expected one that is solid"));
    }
}
