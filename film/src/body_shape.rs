//! The shapes that bodies of a simulation may have, and their names and lengths in tables.

use crate::part::Part;
use nalgebra::{Matrix3, Vector3};
use ode_visual_hull::shape::Shape;
use ode_visual_hull::{Error, Result};

/// Checks that a shape can be drawn.
pub fn check_drawable(shape: &Shape) -> Result<()> {
    match shape {
        Shape::Box { .. } | Shape::Sphere { .. } | Shape::Capsule { .. } => Ok(()),
        other => Err(Error::argument(format!(
            "body to draw: expected a box, a sphere or a capsule, found {other:?}; draw it as the box around it"
        ))),
    }
}

/// The word for a body of these parts in tables.
pub fn name(parts: &[Part]) -> &'static str {
    match parts {
        [Part { shape: Shape::Box { .. }, .. }] => "box",
        [Part { shape: Shape::Sphere { .. }, .. }] => "ball",
        [Part { shape: Shape::Capsule { .. }, .. }] => "rod",
        _ => "body",
    }
}

/// Full lengths of the smallest box along the body's axes that holds its solid parts.
pub fn lengths(parts: &[Part]) -> Vector3<f64> {
    let (mut least, mut most) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for part in parts.iter().filter(|part| part.is_solid) {
        let (middle, half) = (part.body_from_part.translation.vector, half_lengths(part));
        (least, most) = (least.inf(&(middle - half)), most.sup(&(middle + half)));
    }
    most - least
}

/// Half the lengths of a part along the axes of its body.
fn half_lengths(part: &Part) -> Vector3<f64> {
    let turn: Matrix3<f64> = part.body_from_part.rotation.to_rotation_matrix().into_inner();
    match part.shape {
        Shape::Box { sides } => turn.abs() * (0.5 * sides),
        Shape::Sphere { radius } => Vector3::repeat(radius),
        Shape::Capsule { radius, length } => (turn.column(2).abs() * (0.5 * length)).add_scalar(radius),
        _ => Vector3::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, vector};

    #[test]
    fn only_boxes_spheres_and_capsules_are_drawn() {
        for shape in
            [Shape::cube(0.1), Shape::Sphere { radius: 0.1 }, Shape::Capsule { radius: 0.1, length: 0.2 }]
        {
            assert!(check_drawable(&shape).is_ok(), "{shape:?}");
        }
        let message = check_drawable(&Shape::Ray { length: 1.0 }).unwrap_err().to_string();
        assert!(message.contains("expected a box, a sphere or a capsule, found Ray"), "{message}");
    }

    #[test]
    fn the_lengths_of_a_body_are_those_of_the_box_around_its_parts() {
        let ball = Part::new(Shape::Sphere { radius: 0.1 }, [0; 3]);
        let rod = Part::rod(Point3::new(0.0, 0.0, -1.0), Point3::new(0.0, 0.4, -1.0), 0.05, [0; 3]);
        let found = lengths(&[ball, rod]);
        assert!((found - vector![0.2, 0.55, 1.15]).norm() < 1e-12, "{found}");
    }
}
