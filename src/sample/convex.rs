//! Samples of the convex hull of a body's vertices.

use super::Samples;
use super::decimate::sample;
use super::facets::Facets;
use super::limits::{finite, spacing};
use super::weld::{TOLERANCE, extent, weld};
use super::wrap::wrap;
use crate::{Error, Result};
use nalgebra::Point3;

/// In bodies of at most this many faces every face has a sample of its own, however small it is.
const FEW_FACES: usize = 64;

/// Samples of the convex hull of `vertices` (body frame, metres). Faces follow from the vertices alone, and coplanar
/// ones are merged; duplicates, vertices inside the hull and noise below a millionth of the body's size have no
/// effect. Corners have the mean of their faces' normals weighted by angle, edges the normalised sum of two faces'
/// normals; in a body of few faces each face has a sample of its own.
///
/// # Errors
/// Fewer than four vertices, or all in one plane; coordinates that are not finite, a `min_feature` that is not finite
/// and positive; more than [`super::MAX_SAMPLES`] samples.
pub fn convex(vertices: &[Point3<f64>], min_feature: f64) -> Result<Samples> {
    spacing(min_feature)?;
    finite("convex vertex", vertices)?;

    let size = extent(vertices);
    let name = format!("convex body of {} vertices, {size:.3} m across,", vertices.len());
    let flat = || {
        Error::argument(format!(
            "{name} has no volume: give at least 4 vertices that do not all lie in one plane"
        ))
    };
    if vertices.len() < 4 || size == 0.0 {
        return Err(flat());
    }

    let (corners, _) = weld(vertices, size * TOLERANCE);
    let faces = wrap(&corners, size * TOLERANCE).ok_or_else(flat)?;
    let own = faces.len() <= FEW_FACES;
    let facets = Facets { corners, faces };

    let (samples, radius) = sample(&facets, &name, min_feature, own)?;
    let corners = facets.faces.iter().flat_map(|face| &face.outline).map(|corner| &facets.corners[*corner]);
    Ok(Samples::new(samples, radius).holding(corners))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_covers, assert_unit_normals};
    use super::super::{Sample, box_};
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};
    use ode_visual_hull_random::Random;

    fn box_corners(lengths: Vector3<f64>) -> Vec<Point3<f64>> {
        let at =
            |k: usize| Vector3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64).add_scalar(-0.5);
        (0..8).map(|k| Point3::from(at(k).component_mul(&lengths))).collect()
    }

    /// Asserts that no vertex lies farther along a sample's normal than the sample itself.
    fn assert_supports(samples: &Samples, vertices: &[Point3<f64>]) {
        let size = extent(vertices);
        for Sample { point, normal } in samples.points() {
            let beyond = vertices.iter().map(|v| (v - point).dot(normal)).fold(f64::NEG_INFINITY, f64::max);
            // Two tolerances per face, magnified at a sharp edge (here 4 degrees) by the sum of opposite normals.
            assert!(beyond.abs() <= 2.0 * TOLERANCE * size / 0.035, "{beyond}");
        }
    }

    #[test]
    fn the_corners_of_a_box_give_the_samples_of_the_box() {
        for (x, y, z) in [(0.4, 0.3, 0.2), (1.0, 1.0, 0.001), (0.01, 0.01, 0.01), (2.0, 0.02, 0.03)] {
            let lengths = Vector3::new(x, y, z);
            for min_feature in [0.03, 0.11] {
                let samples = convex(&box_corners(lengths), min_feature).unwrap();
                let plain = box_(lengths, min_feature).unwrap();
                assert_covers(&samples, min_feature, |random| {
                    let mut at = Vector3::from_fn(|_, _| random.between(-0.5, 0.5));
                    at[random.below(3)] = 0.5_f64.copysign(random.between(-1.0, 1.0));
                    Point3::from(at.component_mul(&lengths))
                });

                assert_unit_normals(&samples);
                assert_supports(&samples, &box_corners(lengths));

                // The box's lattice has at least two cells per side, a face of the hull one and a central sample.
                assert!(samples.points().len() <= plain.points().len());
                for sample in samples.points() {
                    let near = |s: &&Sample| (s.point - sample.point).norm() < 1e-12;
                    let same = plain.points().iter().find(near);
                    assert!(same.is_none_or(|s| (s.normal - sample.normal).norm() < 1e-9));
                }
            }
        }
    }

    #[test]
    fn duplicates_noise_inner_points_and_order_have_no_effect() {
        let mut random = Random(2);
        let rotation = UnitQuaternion::from_euler_angles(0.3, 1.1, -0.7);
        for noise in [0.0, 1e-15, 3e-8] {
            let mut vertices = box_corners(Vector3::new(0.4, 0.3, 0.2));
            let corners = vertices.clone();
            for _ in 0..60 {
                // Points on edges, on faces, on corners and inside.
                let (a, b) = (corners[random.below(8)], corners[random.below(8)]);
                vertices.push(a + (b - a) * random.between(0.0, 1.0));
                vertices.push(corners[random.below(8)]);
            }

            for k in 0..vertices.len() {
                vertices.swap(k, random.below(k + 1));
            }
            for v in &mut vertices {
                *v = rotation * *v + Vector3::from_fn(|_, _| random.between(-noise, noise));
            }

            let samples = convex(&vertices, 0.03).unwrap();
            let plain = box_(Vector3::new(0.4, 0.3, 0.2), 0.03).unwrap();
            assert_eq!(samples.points().len(), plain.points().len());
            for sample in samples.points() {
                let (point, normal) = (rotation.inverse() * sample.point, rotation.inverse() * sample.normal);
                let near = |s: &Sample| (s.point - point).norm() < 1e-6 && (s.normal - normal).norm() < 1e-5;
                assert!(plain.points().iter().any(near), "{point} {normal}");
            }
        }
    }

    #[test]
    fn random_hulls_are_covered_and_their_samples_are_support_points() {
        let mut random = Random(9);
        for n in [4, 5, 6, 9, 20, 60, 200] {
            for flattening in [1.0, 0.2, 0.003] {
                let vertex =
                    |d: Vector3<f64>| Point3::new(0.1 + 0.3 * d.x, 0.2 * d.y, 0.3 * flattening * d.z);
                let vertices: Vec<_> = (0..n).map(|_| vertex(random.direction())).collect();
                let samples = convex(&vertices, 0.04).unwrap();
                assert_unit_normals(&samples);
                assert_supports(&samples, &vertices);

                let planes: Vec<_> = wrap(&vertices, 1e-7).unwrap();
                let plane = |face: &super::super::facets::Facet| (vertices[face.outline[0]], face.normal);
                let planes: Vec<_> = planes.iter().map(plane).collect();
                let sum: Vector3<f64> = vertices.iter().map(|v| v.coords).sum();
                let center = Point3::from(sum / n as f64);

                assert_covers(&samples, 0.04, |random| {
                    let d = random.direction();
                    let exit = |(p, m): &(Point3<f64>, Vector3<f64>)| (p - center).dot(m) / d.dot(m).max(0.0);
                    center + d * planes.iter().map(exit).fold(f64::INFINITY, f64::min)
                });
            }
        }
    }

    #[test]
    fn the_hull_is_closed() {
        let mut random = Random(21);
        // Many points of a lattice lie in common planes and lines.
        for round in 0..60 {
            let n = 8 + round;
            let point = |random: &mut Random| Point3::new(random.below(4), random.below(4), random.below(3));
            let vertices: Vec<_> = (0..n).map(|_| point(&mut random).cast::<f64>()).collect();
            let (corners, _) = weld(&vertices, 1e-6);
            let faces = wrap(&corners, 1e-6).unwrap();

            let side = |outline: &Vec<usize>, k: usize| (outline[k], outline[(k + 1) % outline.len()]);
            let sides: Vec<_> =
                faces.iter().flat_map(|f| (0..f.outline.len()).map(|k| side(&f.outline, k))).collect();

            assert!(sides.iter().all(|(a, b)| sides.iter().filter(|other| **other == (*b, *a)).count() == 1));
            let used: std::collections::HashSet<_> = sides.iter().map(|(a, _)| a).collect();
            assert_eq!(used.len() + faces.len(), sides.len() / 2 + 2, "Euler's formula");
        }
    }

    #[test]
    fn vertices_without_a_volume_are_refused() {
        let corners = box_corners(Vector3::repeat(0.2));
        for flat in [&corners[..3], &corners[..4], &[corners[0]; 9], &[]] {
            assert!(convex(flat, 0.03).unwrap_err().to_string().contains("no volume"));
        }
        assert!(convex(&[corners.clone(), vec![Point3::new(0.0, f64::NAN, 0.0)]].concat(), 0.03).is_err());
        assert!(convex(&corners, 0.0).is_err());
        assert!(convex(&box_corners(Vector3::repeat(10.0)), 0.01).unwrap_err().to_string().contains("raise"));
    }
}
