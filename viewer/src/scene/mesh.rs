//! Bodies as triangles, as graphics hardware draws them.
//!
//! Edges are dark lines, and round bodies have lighter and darker octants, so that one sees how they turn.

mod round;

use nalgebra::{Point3, Vector3};
use ode_visual_hull::shape::{Convex, Heightfield, Shape, TriMesh};

/// Width of the dark line along an edge of a face, in metres, and its brightness.
const LINE: f64 = 0.004;
const LINE_BRIGHTNESS: f32 = 0.5;

/// A line is at most this part of the distance from the middle of its face.
const LARGEST_LINE: f64 = 0.2;

/// Half the side of the part of a plane that is drawn, in metres.
const PLANE_REACH: f64 = 10.0;

/// A corner of a triangle, in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Its position, in metres.
    pub position: Point3<f32>,
    /// The outward unit normal.
    pub normal: Vector3<f32>,
    /// The part of the body's colour that it has, 0 to 1.
    pub brightness: f32,
}

/// Triangles in the frame of a body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The corners.
    pub vertices: Vec<Vertex>,
    /// Three indices of corners each, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The surface of `shape`. A plane is drawn as a square of 20 m; a ray has no surface.
    pub fn of(shape: &Shape) -> Self {
        let mut mesh = Self::default();
        match shape {
            Shape::Box { sides } => mesh.add_box(&(0.5 * sides)),
            Shape::Sphere { radius } => mesh.add_capsule(*radius, 0.0),
            Shape::Capsule { radius, length } => mesh.add_capsule(*radius, *length),
            Shape::Cylinder { radius, length } => mesh.add_cylinder(*radius, *length),
            Shape::Plane { normal, offset } => mesh.add_plane(normal, *offset),
            Shape::Convex(convex) => mesh.add_convex(convex),
            Shape::TriMesh(triangles) => mesh.add_triangles(triangles),
            Shape::Heightfield(field) => mesh.add_heightfield(field),
            _ => (),
        }
        mesh
    }

    /// Whether `point`, in the body's frame, is inside the surface, which has to be closed: whether a ray from there crosses it
    /// an odd number of times.
    pub fn contains(&self, point: &Point3<f32>) -> bool {
        // No edge of a body is likely to lie in this direction.
        let direction = Vector3::new(0.183, 0.417, 0.891);
        let crosses = |triangle: &&[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| self.vertices[corner as usize].position - point);
            let side = |p: &Vector3<f32>, q: &Vector3<f32>| direction.dot(&p.cross(q)) > 0.0;
            let is_around = side(&a, &b) == side(&b, &c) && side(&b, &c) == side(&c, &a);
            let normal = (b - a).cross(&(c - a));
            is_around && normal.dot(&a) * normal.dot(&direction) > 0.0
        };
        self.triangles.iter().filter(crosses).count() % 2 == 1
    }

    fn add_box(&mut self, half: &Vector3<f64>) {
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |s: f64, t: f64| {
                    let mut corner = Point3::origin();
                    corner[axis] = sign * half[axis];
                    // The order turns with the side, so that it is counter-clockwise from outside.
                    (corner[a], corner[b]) = (s * half[a], sign * t * half[b]);
                    corner
                };
                self.add_face(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
            }
        }
    }

    fn add_convex(&mut self, convex: &Convex) {
        for face in convex.faces() {
            let corners: Vec<_> = face.iter().map(|&corner| convex.points()[corner as usize]).collect();
            self.add_face(&corners);
        }
    }

    fn add_triangles(&mut self, mesh: &TriMesh) {
        for triangle in mesh.triangles() {
            self.add_flat(&triangle.map(|corner| mesh.points()[corner as usize]));
        }
    }

    /// Cells of the grid as two triangles each; x and z span the field around its centre, y is the height.
    fn add_heightfield(&mut self, field: &Heightfield) {
        let ([columns, rows], [width, depth]) = (field.counts(), field.size());
        let at = |i: usize, j: usize| {
            let part = |k: usize, count: usize| k as f64 / (count - 1) as f64 - 0.5;
            Point3::new(width * part(i, columns), field.heights()[j * columns + i], depth * part(j, rows))
        };
        for (i, j) in (1..rows).flat_map(|j| (1..columns).map(move |i| (i, j))) {
            let [a, b, c, d] = [at(i - 1, j - 1), at(i, j - 1), at(i - 1, j), at(i, j)];
            self.add_flat(&[a, c, b]);
            self.add_flat(&[b, c, d]);
        }
    }

    fn add_plane(&mut self, normal: &Vector3<f64>, offset: f64) {
        let Some(up) = normal.try_normalize(0.0) else { return };
        let least = Vector3::ith(up.iamin(), 1.0);
        let along = up.cross(&least).normalize() * PLANE_REACH;
        let across = up.cross(&along);
        let middle = Point3::from(up * offset);
        self.add_flat(&[middle - along - across, middle + along - across, middle + along + across]);
        self.add_flat(&[middle - along - across, middle + along + across, middle - along + across]);
    }

    /// A convex face with a dark line along its border, as seen from outside with corners counter-clockwise.
    fn add_face(&mut self, corners: &[Point3<f64>]) {
        let middle =
            Point3::from(corners.iter().map(|p| p.coords).sum::<Vector3<f64>>() / corners.len() as f64);
        let count = corners.len();
        let normal = (0..count).map(|k| (corners[k] - middle).cross(&(corners[(k + 1) % count] - middle)));
        let Some(normal) = normal.sum::<Vector3<f64>>().try_normalize(0.0) else { return };

        let first = self.vertices.len() as u32;
        for k in 0..count {
            let (before, own, after) =
                (corners[(k + count - 1) % count], corners[k], corners[(k + 1) % count]);
            self.push(&own, &normal, LINE_BRIGHTNESS);
            self.push(&inset(&before, &own, &after, &middle, &normal), &normal, 1.0);
        }
        let corner = |k: usize| first + 2 * (k % count) as u32;
        for k in 0..count {
            let (own, next) = (corner(k), corner(k + 1));
            self.triangles.extend([[own, next, next + 1], [own, next + 1, own + 1]]);
        }
        self.triangles.extend((2..count).map(|k| [corner(0) + 1, corner(k - 1) + 1, corner(k) + 1]));
    }

    /// A triangle without lines.
    fn add_flat(&mut self, corners: &[Point3<f64>; 3]) {
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { return };
        let first = self.vertices.len() as u32;
        corners.iter().for_each(|corner| self.push(corner, &normal, 1.0));
        self.triangles.push([first, first + 1, first + 2]);
    }

    fn push(&mut self, position: &Point3<f64>, normal: &Vector3<f64>, brightness: f32) {
        self.vertices.push(Vertex { position: position.cast(), normal: normal.cast(), brightness });
    }
}

/// The corner `own` of a face, moved into it so that it is [`LINE`] away from both of its edges.
fn inset(
    before: &Point3<f64>,
    own: &Point3<f64>,
    after: &Point3<f64>,
    middle: &Point3<f64>,
    normal: &Vector3<f64>,
) -> Point3<f64> {
    let inwards = |from: &Point3<f64>, to: &Point3<f64>| normal.cross(&(to - from)).try_normalize(0.0);
    let (Some(a), Some(b)) = (inwards(before, own), inwards(own, after)) else { return *own };
    let farthest = LARGEST_LINE * (middle - own).norm();
    let along = (a + b) * (LINE / (1.0 + a.dot(&b)).max(1e-3));
    own + along * (farthest / along.norm().max(f64::MIN_POSITIVE)).min(1.0)
}

#[cfg(test)]
mod tests;
