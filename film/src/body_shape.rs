//! The shapes that bodies of a simulation may have, and their names and lengths in tables.

use nalgebra::Vector3;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::{Error, Result};

/// Checks that a shape can be drawn.
pub fn check_drawable(shape: &Shape) -> Result<()> {
    match shape {
        Shape::Box { .. } | Shape::Sphere { .. } => Ok(()),
        other => Err(Error::argument(format!(
            "body to draw: expected a box or a sphere, found {other:?}; draw it as the box around it"
        ))),
    }
}

/// The word for the shape in tables.
pub fn name(shape: &Shape) -> &'static str {
    match shape {
        Shape::Box { .. } => "box",
        Shape::Sphere { .. } => "ball",
        _ => "body",
    }
}

/// Full lengths along the body's axes.
pub fn lengths(shape: &Shape) -> Vector3<f64> {
    match *shape {
        Shape::Box { sides } => sides,
        Shape::Sphere { radius } => Vector3::repeat(2.0 * radius),
        _ => Vector3::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_boxes_and_spheres_are_drawn() {
        assert!(check_drawable(&Shape::cube(0.1)).is_ok());
        let message = check_drawable(&Shape::Ray { length: 1.0 }).unwrap_err().to_string();
        assert!(message.contains("expected a box or a sphere, found Ray"), "{message}");
    }
}
