//! The samples of a shape.

use super::{Samples, box_, capsule, convex, cylinder, sphere, trimesh};
use crate::shape::Shape;
use crate::{Error, Result};

impl Shape {
    /// Samples the surface so that no feature of diameter `min_feature` (metres) fits between the samples.
    ///
    /// # Errors
    ///
    /// A plane, a ray or a heightfield, which have no closed surface; else those of the function of the shape:
    /// [`sphere`], [`box_`], [`capsule`], [`cylinder`], [`convex`] and [`trimesh`].
    pub fn sample(&self, min_feature: f64) -> Result<Samples> {
        match self {
            Self::Sphere { radius } => sphere(*radius, min_feature),
            Self::Box { sides } => box_(*sides, min_feature),
            Self::Capsule { radius, length } => capsule(*radius, *length, min_feature),
            Self::Cylinder { radius, length } => cylinder(*radius, *length, min_feature),
            Self::Convex(polyhedron) => convex(polyhedron.points(), min_feature),
            Self::TriMesh(mesh) => {
                let corner = |index: u32| mesh.points()[index as usize];
                let triangles: Vec<_> = mesh.triangles().iter().map(|corners| corners.map(corner)).collect();
                trimesh(&triangles, min_feature)
            }
            Self::Plane { .. } => Err(no_surface("plane", "take a wide box whose top lies in it")),
            Self::Ray { .. } => Err(no_surface("ray", "ask the hull for it by `Hull::ray_cast`")),
            Self::Heightfield(_) => Err(no_surface("heightfield", "take a closed mesh of the ground")),
        }
    }
}

fn no_surface(found: &str, instead: &str) -> Error {
    Error::argument(format!(
        "shape to sample: expected one with a closed surface, found a {found}; {instead}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Heightfield;
    use nalgebra::Vector3;

    #[test]
    fn shapes_without_a_closed_surface_are_refused_with_another_way() {
        let plane = Shape::Plane { normal: Vector3::z(), offset: 0.0 };
        let ground = Heightfield::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).unwrap();
        for (shape, parts) in [
            (plane, ["plane", "wide box"]),
            (Shape::Ray { length: 1.0 }, ["ray", "ray_cast"]),
            (Shape::Heightfield(ground.into()), ["heightfield", "closed mesh"]),
        ] {
            let message = shape.sample(0.03).unwrap_err().to_string();
            assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        }
    }
}
