//! Triangle meshes.

use super::{MIN_SIZE, check_point};
use crate::{Error, Result};
use nalgebra::Point3;

/// A triangle lower than this part of its longest side counts as one without area: ODE's colliders may not return for
/// longer ones.
const FLAT: f64 = 1e-7;

/// A triangle mesh in a geom's own frame, in metres. Triangles are counter-clockwise seen from outside.
///
/// Geoms share a mesh through an `Arc`; see [`Shape::TriMesh`](super::Shape::TriMesh).
#[derive(Debug, Clone, PartialEq)]
pub struct TriMesh {
    points: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// A mesh of triangles, each given by three indices into `points`.
    ///
    /// Triangles lower than [`MIN_SIZE`], or than 1e-7 of their longest side, are left out, as are points that no triangle
    /// uses.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a point is not finite or beyond [`REACH`](super::REACH), if an index is out of range,
    /// or if no triangle has an area.
    pub fn new(points: Vec<Point3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        for (i, point) in points.iter().enumerate() {
            check_point(&format!("point {i} of the mesh"), point)?;
        }
        // ODE counts points, and three indices per triangle, in a C int.
        let max = i32::MAX as usize / 3;
        if points.len() > max || triangles.len() > max {
            return Err(Error::argument(format!(
                "mesh: expected at most {max} points and triangles, found {} and {}",
                points.len(),
                triangles.len()
            )));
        }
        for (i, triangle) in triangles.iter().enumerate() {
            if let Some(index) = triangle.iter().find(|&&index| index as usize >= points.len()) {
                return Err(Error::argument(format!(
                    "triangle {i} of the mesh: expected indices below {}, found {index}",
                    points.len()
                )));
            }
        }

        // Triangles without area collide with nothing.
        let given = triangles.len();
        let with_area = |triangle: &[u32; 3]| has_area(triangle.map(|index| points[index as usize]));
        let triangles: Vec<_> = triangles.into_iter().filter(with_area).collect();
        if triangles.is_empty() {
            return Err(Error::argument(format!(
                "mesh: expected at least one triangle with an area, found none among {given}"
            )));
        }
        Ok(Self { points, triangles }.without_loose_points())
    }

    /// This mesh without the points that no triangle uses, because ODE aborts if points outnumber edges.
    fn without_loose_points(self) -> Self {
        let mut used = vec![false; self.points.len()];
        self.triangles.as_flattened().iter().for_each(|&index| used[index as usize] = true);

        // The new index of a used point is the number of used points before it.
        let mut used_so_far = 0;
        let new_index: Vec<u32> = used
            .iter()
            .map(|&used| {
                used_so_far += u32::from(used);
                used_so_far.wrapping_sub(1)
            })
            .collect();

        let points = self.points.into_iter().zip(used).filter_map(|(point, used)| used.then_some(point));
        let triangles = self.triangles.into_iter().map(|corners| corners.map(|k| new_index[k as usize]));
        Self { points: points.collect(), triangles: triangles.collect() }
    }

    /// The points that triangles use, in the order in which they were given.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// The triangles that have an area, each as three indices into [`points`](Self::points).
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
}

/// Whether a triangle is high enough for ODE's colliders.
fn has_area([a, b, c]: [Point3<f64>; 3]) -> bool {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    // Twice the area is the longest side times the height above it.
    let height = (b - a).cross(&(c - a)).norm() / longest;
    height >= MIN_SIZE && height > FLAT * longest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<Point3<f64>> {
        vec![
            Point3::origin(),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.0, 1.0, 0.0),
            Point3::new(2.0, 0.0, 0.0),
        ]
    }

    #[test]
    fn triangles_without_area_are_left_out() {
        let mesh = TriMesh::new(corners(), vec![[0, 1, 2], [0, 0, 1], [0, 1, 3]]).unwrap();
        assert_eq!(mesh.triangles(), [[0, 1, 2]]);
    }

    #[test]
    fn points_that_no_triangle_uses_are_left_out() {
        let mesh = TriMesh::new(corners(), vec![[3, 2, 0], [0, 1, 3]]).unwrap();
        assert_eq!(mesh.triangles(), [[2, 1, 0]]);
        assert_eq!(mesh.points(), [corners()[0], corners()[2], corners()[3]]);
    }

    #[test]
    fn a_mesh_without_any_area_is_refused() {
        assert!(TriMesh::new(corners(), vec![]).is_err());
        assert!(TriMesh::new(corners(), vec![[0, 1, 3], [1, 1, 1]]).is_err());
        assert!(TriMesh::new(vec![], vec![]).is_err());
    }

    #[test]
    fn the_error_for_an_index_out_of_range_names_its_triangle() {
        let message = TriMesh::new(corners(), vec![[0, 1, 2], [0, 1, 4]]).unwrap_err().to_string();
        assert_eq!(message, "triangle 1 of the mesh: expected indices below 4, found 4");
    }

    #[test]
    fn a_point_that_is_not_finite_is_refused() {
        let mut points = corners();
        points[3].y = f64::NAN;
        assert!(TriMesh::new(points, vec![[0, 1, 2]]).is_err());
    }
}
