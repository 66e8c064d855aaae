//! Samples of a triangle mesh.

use super::Samples;
use super::decimate::sample;
use super::facets::{Facet, Facets};
use super::limits::{finite, positive, spacing};
use super::weld::{TOLERANCE, extent, weld};
use crate::{Error, Result};
use nalgebra::Point3;
use std::collections::HashMap;

/// Samples of a triangle mesh (body frame, metres) with triangles wound counter-clockwise as seen from outside.
/// Vertices have the mean of their triangles' normals weighted by angle, edges the normalised sum of their triangles'
/// normals. The normals of a closed mesh that is wound inside out are flipped. Triangles without area are ignored; if
/// the triangles are much smaller than `min_feature`, only as many vertices as needed become samples, the sharpest
/// first.
///
/// # Errors
/// No triangle with an area, coordinates that are not finite, a `min_feature` that is not finite and positive; more
/// than [`super::MAX_SAMPLES`] samples.
pub fn trimesh(triangles: &[[Point3<f64>; 3]], min_feature: f64) -> Result<Samples> {
    spacing(min_feature)?;
    let vertices = triangles.as_flattened();
    finite("mesh vertex", vertices)?;

    let size = extent(vertices);
    let name = format!("mesh of {} triangles, {size:.3} m across,", triangles.len());

    let facets = facets(vertices, size);
    if facets.faces.is_empty() {
        return Err(Error::argument(format!(
            "{name} has no area: give triangles of three different corners"
        )));
    }
    positive("size of the mesh", size)?;

    let (samples, radius) = sample(&facets, &name, min_feature, false)?;
    let corners = facets.faces.iter().flat_map(|face| &face.outline).map(|corner| &facets.corners[*corner]);
    Ok(Samples::new(samples, radius).holding(corners))
}

/// The triangles with an area, with shared corners, wound outwards.
fn facets(vertices: &[Point3<f64>], size: f64) -> Facets {
    if vertices.is_empty() {
        return Facets { corners: Vec::new(), faces: Vec::new() };
    }
    let (corners, indices) = weld(vertices, size * TOLERANCE);

    let mut faces: Vec<Facet> = Vec::with_capacity(indices.len() / 3);
    for outline in indices.chunks_exact(3) {
        let [a, b, c] = [corners[outline[0]], corners[outline[1]], corners[outline[2]]];
        let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        let normal = (b - a).cross(&(c - a));
        if normal.norm() > 1e-9 * longest {
            faces.push(Facet { outline: outline.to_vec(), normal: normal.normalize() });
        }
    }

    if is_inside_out(&corners, &faces) {
        for face in &mut faces {
            face.outline.reverse();
            face.normal = -face.normal;
        }
    }

    Facets { corners, faces }
}

/// Whether the mesh is closed (each edge belongs to two triangles, once in either direction) and has a negative
/// volume.
fn is_inside_out(corners: &[Point3<f64>], faces: &[Facet]) -> bool {
    let mut edges: HashMap<(usize, usize), [u32; 2]> = HashMap::new();
    let mut volume = 0.0;
    for Facet { outline, .. } in faces {
        let [a, b, c] = [0, 1, 2].map(|k| corners[outline[k]] - corners[0]);
        volume += a.dot(&b.cross(&c));
        for k in 0..3 {
            let (a, b) = (outline[k], outline[(k + 1) % 3]);
            edges.entry((a.min(b), a.max(b))).or_default()[usize::from(a > b)] += 1;
        }
    }
    volume < 0.0 && edges.values().all(|count| *count == [1, 1])
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_covers, assert_unit_normals};
    use super::super::{Sample, box_};
    use super::*;
    use nalgebra::Vector3;
    use ode_visual_hull_random::Random;

    /// A triangulated box with every face divided `n` times along each side; 12 triangles for `n = 1`.
    fn box_mesh(lengths: Vector3<f64>, n: usize) -> Vec<[Point3<f64>; 3]> {
        let mut triangles = Vec::new();
        for axis in 0..3 {
            for end in [-0.5_f64, 0.5] {
                let at = |i: usize, j: usize| {
                    let mut p = Vector3::repeat(end);
                    p[(axis + 1) % 3] = (i as f64 / n as f64 - 0.5) * end.signum();
                    p[(axis + 2) % 3] = j as f64 / n as f64 - 0.5;
                    Point3::from(p.component_mul(&lengths))
                };
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                    triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        triangles
    }

    fn on_mesh(triangles: &[[Point3<f64>; 3]], random: &mut Random) -> Point3<f64> {
        let [a, b, c] = triangles[random.below(triangles.len())];
        let (mut s, mut t) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        a + (b - a) * s + (c - a) * t
    }

    fn assert_box(samples: &Samples, lengths: &Vector3<f64>) {
        assert_unit_normals(samples);
        let half = lengths / 2.0;
        for Sample { point, normal } in samples.points() {
            assert!((point.coords.abs() - half).max().abs() < 1e-12);
            for axis in 0..3 {
                let on_face = (point[axis].abs() - half[axis]).abs() < 1e-12;
                assert_eq!(normal[axis] * point[axis].signum() > 1e-6, on_face);
            }
        }
    }

    #[test]
    fn a_triangulated_box_is_covered_like_the_box() {
        for (x, y, z) in [(0.4, 0.3, 0.2), (1.0, 1.0, 0.001), (0.01, 0.01, 0.01), (2.0, 0.02, 0.03)] {
            let lengths = Vector3::new(x, y, z);
            for (n, min_feature) in [(1, 0.03), (1, 0.07), (5, 0.03), (40, 0.05)] {
                let mesh = box_mesh(lengths, n);
                let samples = trimesh(&mesh, min_feature).unwrap();
                assert_covers(&samples, min_feature, |random| on_mesh(&mesh, random));
                assert_box(&samples, &lengths);
            }
        }
    }

    #[test]
    fn any_triangle_is_covered() {
        let mut random = Random(11);
        for _ in 0..40 {
            let squeeze = random.between(0.0, 1.0).powi(4);
            let mut corner = || {
                let d = random.direction();
                Point3::new(d.x, d.y * squeeze, d.z * 0.3)
            };
            let mesh = [[corner(), corner(), corner()]];
            let samples = trimesh(&mesh, 0.04).unwrap();
            assert_covers(&samples, 0.04, |random| on_mesh(&mesh, random));
            assert_unit_normals(&samples);
        }
    }

    #[test]
    fn a_fine_mesh_needs_no_more_samples_than_a_coarse_one() {
        let lengths = Vector3::new(0.4, 0.3, 0.2);
        let fine = trimesh(&box_mesh(lengths, 80), 0.05).unwrap();
        let plain = box_(lengths, 0.05).unwrap();
        assert!(fine.points().len() < 2 * plain.points().len(), "{}", fine.points().len());
        // The corners are the sharpest: they are kept and come first.
        assert!(fine.points()[..8].iter().all(|s| (s.point.coords.abs() - lengths / 2.0).amax() < 1e-12));
        assert!((fine.bounding_radius() - lengths.norm() / 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_closed_mesh_wound_inside_out_is_flipped() {
        let lengths = Vector3::new(0.4, 0.3, 0.2);
        let mut mesh = box_mesh(lengths, 1);
        mesh.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        assert_box(&trimesh(&mesh, 0.03).unwrap(), &lengths);
        // A mesh with a hole has no inside, so the winding is kept.
        mesh.pop();
        let open = trimesh(&mesh, 0.03).unwrap();
        assert!(open.points()[0].normal.dot(&open.points()[0].point.coords) < 0.0);
    }

    #[test]
    fn triangles_without_area_are_ignored() {
        let lengths = Vector3::new(0.4, 0.3, 0.2);
        let mut mesh = box_mesh(lengths, 1);
        let clean = trimesh(&mesh, 0.03).unwrap();
        let [a, b, _] = mesh[0];
        mesh.push([a, a, b]);
        mesh.push([a, b, nalgebra::center(&a, &b)]);
        assert_eq!(trimesh(&mesh, 0.03).unwrap().points(), clean.points());
        // Two sheets back to back have no outside.
        let sheet = [[a, b, Point3::origin()], [b, a, Point3::origin()]];
        assert!(trimesh(&sheet, 0.03).unwrap().points()[0].normal == Vector3::zeros());
    }

    #[test]
    fn meshes_without_a_surface_are_refused() {
        let p = Point3::new(1.0, 2.0, 3.0);
        assert!(trimesh(&[], 0.03).unwrap_err().to_string().contains("no area"));
        assert!(trimesh(&[[p, p, p]], 0.03).unwrap_err().to_string().contains("no area"));
        assert!(trimesh(&[[p, p * 2.0, p * 3.0]], 0.03).is_err());
        assert!(trimesh(&[[p, p, Point3::new(f64::NAN, 0.0, 0.0)]], 0.03).is_err());
        let mesh = box_mesh(Vector3::repeat(10.0), 1);
        assert!(trimesh(&mesh, 0.01).unwrap_err().to_string().contains("raise min_feature"));
        assert!(trimesh(&mesh, -1.0).is_err());
    }
}
