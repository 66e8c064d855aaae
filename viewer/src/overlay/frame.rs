//! The axes of the world, and boxes such as the work volume.

use super::{Ink, Line, Overlay};
use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::Aabb;

/// The axes' colours and names.
const AXES: [([u8; 3], &str); 3] = [([240, 60, 50], "x"), ([70, 210, 70], "y"), ([110, 170, 255], "z")];

/// The corners at the ends of the edges of a box; bit `k` of a corner tells whether it is at the far end of axis `k`.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

impl Overlay {
    /// Adds the axes of the world of this length in metres: x is red, y green, z blue, and their names are at their ends.
    pub fn add_axes(&mut self, length: f64) {
        for (axis, (colour, name)) in AXES.into_iter().enumerate() {
            let end = Point3::from(Vector3::ith(axis, length));
            self.lines.push(Line { ends: [Point3::origin(), end], width: 2.0, ink: Ink::new(colour) });
            self.add_label(end, name, colour);
        }
    }

    /// Adds the edges of a box, such as the work volume; none of an empty one.
    pub fn add_box(&mut self, aabb: &Aabb, colour: [u8; 3]) {
        if aabb.is_empty() {
            return;
        }
        let Aabb { min, max } = aabb;
        let end = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
        let corner = |corner: usize| Point3::new(end(corner, 0), end(corner, 1), end(corner, 2));
        for [from, to] in EDGES {
            self.add_line(corner(from), corner(to), colour);
        }
    }
}
