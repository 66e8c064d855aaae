//! Samples of a sphere: a subdivided icosahedron.

use super::limits::{MAX_SAMPLES, check_count, positive, spacing};
use super::{Sample, Samples, Smooth};
use crate::Result;
use nalgebra::{Point3, Vector3};

/// Samples of a sphere about the origin of `radius` metres: at least 12, evenly spread, each with its antipode.
///
/// # Errors
/// A radius or `min_feature` that is not finite and positive; more than [`super::MAX_SAMPLES`] samples.
pub fn sphere(radius: f64, min_feature: f64) -> Result<Samples> {
    spacing(min_feature)?;
    positive("sphere radius", radius)?;
    let name = format!("sphere of radius {radius} m");

    // A cap of points within distance d of its pole has the area pi d^2, which gives a lower bound on the count.
    let cover = min_feature / 2.0 / radius;
    check_count(&name, 4.0 / (cover * cover), min_feature)?;

    let icosahedron = Icosahedron::new();
    let mut divisions = ((4.0 / (cover * cover) - 2.0).max(0.0) / 10.0).sqrt().floor().max(1.0);
    let mut reached = icosahedron.covering_radius(divisions as usize);
    while reached > cover {
        divisions = (divisions + 1.0).max((divisions * reached / cover).floor());
        check_count(&name, 10.0 * divisions * divisions + 2.0, min_feature)?;
        reached = icosahedron.covering_radius(divisions as usize);
    }

    let samples = icosahedron.divided(divisions as usize, radius);
    debug_assert!(samples.len() <= MAX_SAMPLES);
    Ok(Samples::of_smooth(samples, reached * radius, Smooth::Sphere { radius }, radius))
}

/// An icosahedron with edges of length 2 about the origin.
struct Icosahedron {
    corners: Vec<Vector3<f64>>,
    edge_midpoints: Vec<[usize; 2]>,
    faces: Vec<[usize; 3]>,
}

impl Icosahedron {
    fn new() -> Self {
        let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let mut corners = Vec::with_capacity(12);
        for axis in 0..3 {
            for (x, y) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
                let mut corner = Vector3::zeros();
                (corner[axis], corner[(axis + 1) % 3]) = (x, y);
                corners.push(corner);
            }
        }

        // Edges have length 2; the next longer distance between corners is 2 golden = 3.2.
        let near = |a: usize, b: usize| (corners[a] - corners[b]).norm() < 2.5;
        let pairs = (0..12).flat_map(|a| (a + 1..12).map(move |b| [a, b]));
        let edges: Vec<_> = pairs.filter(|[a, b]| near(*a, *b)).collect();

        let triples = edges.iter().flat_map(|[a, b]| (b + 1..12).map(move |c| [*a, *b, c]));
        let faces = triples.filter(|[a, b, c]| near(*a, *c) && near(*b, *c)).collect();
        Self { corners, edge_midpoints: edges, faces }
    }

    /// The point of the unit sphere on `face` with weights `i` and `j` of `n` for the second and third corner.
    fn on_face(&self, face: &[usize; 3], n: usize, i: usize, j: usize) -> Vector3<f64> {
        let [a, b, c] = face.map(|corner| self.corners[corner]);
        (a * (n - i - j) as f64 + b * i as f64 + c * j as f64).normalize()
    }

    /// The covering radius on the unit sphere with every edge divided into `n`. All faces are congruent, so one is
    /// measured: the point farthest from a small triangle's corners is its circumcentre.
    fn covering_radius(&self, n: usize) -> f64 {
        let at = |i, j| self.on_face(&self.faces[0], n, i, j);
        let far = |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>| {
            let center = (b - a).cross(&(c - a)).normalize();
            (center * center.dot(&a).signum() - a).norm()
        };

        let mut farthest = 0.0_f64;
        for i in 0..n {
            for j in 0..n - i {
                farthest = farthest.max(far(at(i, j), at(i + 1, j), at(i, j + 1)));
                if i + j + 2 <= n {
                    farthest = farthest.max(far(at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)));
                }
            }
        }
        farthest
    }

    /// The samples with every edge divided into `n`: corners, edges, faces.
    fn divided(&self, n: usize, radius: f64) -> Vec<Sample> {
        let mut normals: Vec<_> = self.corners.iter().map(|corner| corner.normalize()).collect();
        for [a, b] in &self.edge_midpoints {
            let between = |i: usize| self.corners[*a] * (n - i) as f64 + self.corners[*b] * i as f64;
            normals.extend((1..n).map(|i| between(i).normalize()));
        }
        for face in &self.faces {
            for i in 1..n {
                normals.extend((1..n - i).map(|j| self.on_face(face, n, i, j)));
            }
        }
        let sample = |normal| Sample { point: Point3::from(normal * radius), normal };
        normals.into_iter().map(sample).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_covers, assert_unit_normals};
    use super::*;

    #[test]
    fn every_surface_point_is_near_a_sample() {
        for radius in [1e-3, 0.02, 0.11, 0.5] {
            for min_feature in [0.02, 0.03, 0.1] {
                let samples = sphere(radius, min_feature).unwrap();
                assert_covers(&samples, min_feature, |random| Point3::from(random.direction() * radius));
                assert!(samples.points().len() >= 12);
            }
        }
    }

    #[test]
    fn samples_lie_on_the_surface_with_outward_normals() {
        let samples = sphere(0.2, 0.03).unwrap();
        assert_unit_normals(&samples);
        for sample in samples.points() {
            assert!((sample.point.coords.norm() - 0.2).abs() < 1e-12);
            assert!((sample.normal * 0.2 - sample.point.coords).norm() < 1e-12);
        }
    }

    #[test]
    fn samples_are_few_and_distinct() {
        let samples = sphere(0.2, 0.03).unwrap();
        // The area of the caps of that covering radius bounds the count from below. The hexagonal
        // lattice of the plane needs 1.21 times as many; here the largest triangles of the subdivision decide.
        let caps = 4.0 * (0.2_f64 / 0.015).powi(2);
        assert!((samples.points().len() as f64) < 2.0 * caps);
        for (index, a) in samples.points().iter().enumerate() {
            assert!(samples.points()[..index].iter().all(|b| (a.point - b.point).norm() > 0.3 * 0.015));
        }
    }

    #[test]
    fn sizes_without_a_surface_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(sphere(bad, 0.03).is_err());
            assert!(sphere(0.1, bad).is_err());
        }
        let error = sphere(100.0, 0.01).unwrap_err().to_string();
        assert!(error.contains("radius 100 m") && error.contains("raise min_feature"), "{error}");
    }
}
