//! The closed zero surface of a signed field, and its files in PLY and OBJ.

use super::field::SignedField;
use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use nalgebra::Vector3;
use std::fmt::Write;

/// A triangle mesh in the world, in metres.
pub struct Surface {
    /// Vertices.
    pub points: Vec<Vector3<f32>>,
    /// Outward unit normals, one for each point.
    pub normals: Vec<Vector3<f32>>,
    /// Indices of three points each, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Surface nets of the field (Gibson 1998); no triangles where no grid point is inside.
    pub fn of(field: &SignedField) -> Self {
        let mut buffer = SurfaceNetsBuffer::default();
        if field.distances.iter().any(|distance| *distance < 0.0) {
            let shape = RuntimeShape::<u32, 3>::new(field.counts);
            surface_nets(&field.distances, &shape, [0; 3], field.counts.map(|n| n - 1), &mut buffer);
        }

        let world = |p: &[f32; 3]| {
            let offset = Vector3::from(*p).cast::<f64>() * field.cell;
            (field.origin.coords + offset).cast::<f32>()
        };

        let points: Vec<_> = buffer.positions.iter().map(world).collect();
        let triangles = buffer.indices.as_chunks::<3>().0.to_vec();
        let normals = normals(&points, &triangles);
        Self { points, normals, triangles }
    }

    /// Volume in cubic metres: the sum of the signed tetrahedra between the triangles and the origin.
    pub fn volume(&self) -> f64 {
        let signed = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|k| self.points[k as usize].cast::<f64>());
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(signed).sum()
    }

    /// The mesh as a binary little-endian PLY file.
    pub fn to_ply(&self) -> Vec<u8> {
        let mut bytes = format!(
            "ply\nformat binary_little_endian 1.0\ncomment visual hull, metres\nelement vertex {}\nproperty float x\n\
             property float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
             element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
            self.points.len(),
            self.triangles.len()
        )
        .into_bytes();

        for (point, normal) in self.points.iter().zip(&self.normals) {
            point.iter().chain(normal.iter()).for_each(|x| bytes.extend(x.to_le_bytes()));
        }

        // Each face starts with its number of vertices.
        for triangle in &self.triangles {
            bytes.push(3);
            triangle.iter().for_each(|k| bytes.extend(k.to_le_bytes()));
        }
        bytes
    }

    /// The mesh as the text of an OBJ file.
    pub fn to_obj(&self) -> String {
        let mut text = "# visual hull, metres\n".to_owned();
        for p in &self.points {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        for n in &self.normals {
            let _ = writeln!(text, "vn {:.4} {:.4} {:.4}", n.x, n.y, n.z);
        }
        for [a, b, c] in self.triangles.iter().map(|triangle| triangle.map(|k| k + 1)) {
            let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}");
        }
        text
    }
}

/// Unit normals of the points: the area-weighted mean of the normals of the triangles around each.
fn normals(points: &[Vector3<f32>], triangles: &[[u32; 3]]) -> Vec<Vector3<f32>> {
    let mut normals = vec![Vector3::zeros(); points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|k| points[k as usize]);
        let normal = (b - a).cross(&(c - a));
        triangle.iter().for_each(|&k| normals[k as usize] += normal);
    }
    normals.iter().map(|normal| normal.try_normalize(0.0).unwrap_or_else(Vector3::z)).collect()
}
