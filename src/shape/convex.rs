//! Convex polyhedra, made from points and faces.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};

use super::{MIN_SIZE, check_point};
use crate::{Error, Result};

/// The tolerance for roundoff in planes, as a part of the polyhedron's size.
const FLAT: f64 = 1e-7;

/// A convex polyhedron in a geom's own frame, in metres, with the origin inside.
///
/// Geoms share a polyhedron through an `Arc`; see [`Shape::Convex`](super::Shape::Convex).
#[derive(Debug, Clone, PartialEq)]
pub struct Convex {
    points: Vec<Point3<f64>>,
    /// The plane of each face in ODE's layout: outward unit normal, then distance from the origin.
    planes: Vec<[f64; 4]>,
    /// The faces in ODE's layout: for each face the number of its points, then their indices.
    polygons: Vec<u32>,
}

impl Convex {
    /// A polyhedron with these faces, each given by the indices of its points, counter-clockwise seen from outside.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a point is not finite or beyond [`REACH`](super::REACH), if the faces are not plane or
    /// do not form a closed surface, if a point lies in front of a face, or if the origin is not inside. (ODE requires
    /// the origin inside: move the points, and give the geom a pose or an offset.)
    pub fn new(points: Vec<Point3<f64>>, faces: &[Vec<u32>]) -> Result<Self> {
        for (i, point) in points.iter().enumerate() {
            check_point(&format!("point {i} of the polyhedron"), point)?;
        }
        if points.len() < 4 || faces.len() < 4 {
            return Err(Error::argument(format!(
                "polyhedron: expected at least 4 points and 4 faces, found {} and {}",
                points.len(),
                faces.len()
            )));
        }

        let size = points.iter().map(|point| point.coords.norm()).fold(0.0, f64::max);
        check_closed(&points, faces, FLAT * size)?;

        let mut planes = Vec::with_capacity(faces.len());
        for (i, face) in faces.iter().enumerate() {
            planes.push(plane(&points, face, FLAT * size).map_err(|problem| face_error(i, &problem))?);
        }

        let polygons =
            faces.iter().flat_map(|face| [face.len() as u32].into_iter().chain(face.iter().copied()));
        let polygons = polygons.collect();
        Ok(Self { points, planes, polygons })
    }

    /// The points, in the order in which they were given.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// The faces, each as the indices of its points, counter-clockwise seen from outside.
    pub fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = self.polygons.as_slice();
        std::iter::from_fn(move || {
            let (&count, after) = rest.split_first()?;
            let (face, after) = after.split_at(count as usize);
            rest = after;
            Some(face)
        })
    }

    /// The plane of each face: outward unit normal, then distance from the origin in metres.
    pub fn planes(&self) -> &[[f64; 4]] {
        &self.planes
    }

    /// The faces in ODE's layout: for each face the number of its points, then their indices.
    #[cfg(feature = "ode")]
    pub(crate) fn polygons(&self) -> &[u32] {
        &self.polygons
    }
}

/// An error about a face of the polyhedron, named by its index.
fn face_error(face: usize, problem: &str) -> Error {
    Error::argument(format!("face {face} of the polyhedron: {problem}"))
}

/// Checks that the faces form a closed, consistently oriented surface: each edge occurs once in each direction.
fn check_closed(points: &[Point3<f64>], faces: &[Vec<u32>], tolerance: f64) -> Result<()> {
    let mut edges = HashMap::new();
    for (i, face) in faces.iter().enumerate() {
        // Indices first: the edges below are looked up with them.
        if face.len() < 3 {
            return Err(face_error(i, &format!("expected at least 3 points, found {}", face.len())));
        }
        if let Some(index) = face.iter().find(|&&index| index as usize >= points.len()) {
            return Err(face_error(i, &format!("expected indices below {}, found {index}", points.len())));
        }

        for (&a, &b) in face.iter().zip(face.iter().cycle().skip(1)) {
            if (points[a as usize] - points[b as usize]).norm() <= tolerance {
                return Err(face_error(
                    i,
                    &format!("expected an edge above length 0, but its points {a} and {b} coincide"),
                ));
            }
            if edges.insert((a, b), i).is_some() {
                return Err(face_error(
                    i,
                    &format!("another face has the edge from {a} to {b} already; reverse this face"),
                ));
            }
        }
    }

    match edges.iter().find(|((a, b), _)| !edges.contains_key(&(*b, *a))) {
        Some(((a, b), &i)) => {
            Err(face_error(i, &format!("no other face has its edge from {a} to {b}; close the surface")))
        }
        None => Ok(()),
    }
}

/// The plane of a face, or a description of the problem if the face is not a convex polygon with all points behind it.
fn plane(points: &[Point3<f64>], face: &[u32], tolerance: f64) -> std::result::Result<[f64; 4], String> {
    let at = |i: usize| points[face[i % face.len()] as usize].coords;
    let area: Vector3<f64> = (0..face.len()).map(|i| at(i).cross(&at(i + 1))).sum();

    // The sum is twice the area; the normal of a face thinner than the tolerance would be roundoff.
    let perimeter: f64 = (0..face.len()).map(|i| (at(i + 1) - at(i)).norm()).sum();
    if area.norm() <= tolerance * perimeter {
        return Err("expected an area above 0, found none".into());
    }

    let normal = area.normalize();
    let distance = (0..face.len()).map(|i| normal.dot(&at(i))).sum::<f64>() / face.len() as f64;

    for i in 0..face.len() {
        if (normal.dot(&at(i)) - distance).abs() > tolerance {
            return Err(format!("expected all points in one plane, found point {} off it", face[i]));
        }
        let bend = (at(i + 1) - at(i)).cross(&(at(i + 2) - at(i + 1))).dot(&normal);
        if bend < -tolerance * perimeter {
            return Err(format!(
                "expected a convex face, found a reflex corner at point {}",
                face[(i + 1) % face.len()]
            ));
        }
    }

    // All points behind every face make the polyhedron convex, and ODE requires the origin strictly inside.
    for (i, point) in points.iter().enumerate() {
        if normal.dot(&point.coords) - distance > tolerance {
            return Err(format!(
                "expected all points behind it, found point {i} in front: make it convex, or reverse clockwise faces"
            ));
        }
    }
    if distance <= tolerance.max(0.5 * MIN_SIZE) {
        return Err(format!(
            "expected the origin inside the polyhedron, at least {:e} m behind each face, found it {distance} m behind",
            0.5 * MIN_SIZE
        ));
    }
    Ok([normal.x, normal.y, normal.z, distance])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(half: f64) -> (Vec<Point3<f64>>, Vec<Vec<u32>>) {
        let sign = |i: u32, bit: u32| if i & bit == 0 { -half } else { half };
        let points = (0..8).map(|i| Point3::new(sign(i, 1), sign(i, 2), sign(i, 4))).collect();
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        (points, faces.iter().map(|face| face.to_vec()).collect())
    }

    #[test]
    fn the_planes_of_a_cube_are_its_faces() {
        let (points, faces) = cube(0.5);
        let convex = Convex::new(points, &faces).unwrap();
        let mut planes = convex.planes().to_vec();
        planes.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(planes[0], [-1.0, 0.0, 0.0, 0.5]);
        assert_eq!(planes[5], [1.0, 0.0, 0.0, 0.5]);
        assert!(convex.faces().eq(faces.iter().map(Vec::as_slice)));
    }

    #[test]
    fn points_and_faces_that_are_no_closed_convex_solid_are_refused() {
        let refused = |points: Vec<Point3<f64>>, faces: &[Vec<u32>], expected: &str| {
            let message = Convex::new(points, faces).unwrap_err().to_string();
            assert!(message.contains(expected), "expected {expected:?} in {message:?}");
        };
        let (points, faces) = cube(0.5);

        // Faces that do not form a closed surface, or face inwards.
        refused(points.clone(), &faces[..5], "close the surface");
        let mut one_reversed = faces.clone();
        one_reversed[0].reverse();
        refused(points.clone(), &one_reversed, "reverse this face");
        let inside_out: Vec<Vec<u32>> =
            faces.iter().map(|face| face.iter().rev().copied().collect()).collect();
        refused(points.clone(), &inside_out, "in front");

        // Points that are not on their planes, in front of a face, or around another origin.
        let mut dented = points.clone();
        dented[7] = Point3::new(0.2, 0.2, 0.2);
        refused(dented, &faces, "one plane");
        let mut outside = points.clone();
        outside.push(Point3::new(0.0, 0.0, 1.0));
        refused(outside, &faces, "in front");

        let moved = points.iter().map(|point| point + Vector3::x()).collect();
        refused(moved, &faces, "origin inside");

        // Numbers, indices and counts out of range.
        let mut nan = points.clone();
        nan[3].x = f64::NAN;
        refused(nan, &faces, "finite");
        let mut high = faces.clone();
        high[2][1] = 8;
        refused(points.clone(), &high, "below 8");
        let mut short = faces.clone();
        short[2].truncate(2);
        refused(points.clone(), &short, "at least 3");
        refused(vec![Point3::origin(); 8], &faces, "coincide");
        refused(points, &[], "at least 4");
    }
}
