//! Samples of a box: one lattice per axis, shared by the faces, so that faces meet in common edge samples.

use super::limits::{cells, check_count, positive, spacing};
use super::{Sample, Samples};
use crate::Result;
use nalgebra::{Point3, Vector3};

/// Samples of a box with edge `lengths` in metres along the local axes, centred at the origin; at least its corners
/// and the centres of its edges and faces. They are symmetric under the box's reflections, to the last bit.
///
/// # Errors
/// A length or `min_feature` that is not finite and positive; more than [`super::MAX_SAMPLES`] samples.
pub fn box_(lengths: Vector3<f64>, min_feature: f64) -> Result<Samples> {
    let spacing = spacing(min_feature)?;
    for (axis, length) in ["x", "y", "z"].into_iter().zip(lengths.iter()) {
        positive(&format!("box length along {axis}"), *length)?;
    }

    // With at least two cells every face has a sample inside, with the face's own normal.
    let n = lengths.map(|length| cells(length, spacing, 2.0));
    let count = n.map(|n| n + 1.0).product() - n.map(|n| n - 1.0).product();
    let name = format!("box of {} x {} x {} m", lengths.x, lengths.y, lengths.z);
    check_count(&name, count, min_feature)?;

    let mut by_kind: [Vec<Sample>; 3] = Default::default();
    let n = n.map(|n| n as usize);
    for i in 0..=n.x {
        for j in 0..=n.y {
            let inner = i > 0 && i < n.x && j > 0 && j < n.y;
            for k in (0..=n.z).step_by(if inner { n.z } else { 1 }) {
                add(&mut by_kind, &lengths, [(i, n.x), (j, n.y), (k, n.z)]);
            }
        }
    }

    let cell = lengths.component_div(&n.map(|n| n as f64));
    let widest = cell.norm_squared() - cell.min() * cell.min();
    Ok(Samples::new(by_kind.into_iter().rev().flatten().collect(), widest.sqrt() / 2.0))
}

/// Adds the lattice point with index `i` of `n` cells per axis to its kind: on one face, two (an edge) or three (a
/// corner).
fn add(by_kind: &mut [Vec<Sample>; 3], lengths: &Vector3<f64>, lattice: [(usize, usize); 3]) {
    // (2 i - n) / n is antisymmetric about the middle to the last bit; i / n - 1/2 is not.
    let at = Vector3::from(lattice.map(|(i, n)| (2.0 * i as f64 - n as f64) / n as f64));
    let outward = Vector3::from(lattice.map(|(i, n)| f64::from(i == n) - f64::from(i == 0)));
    let faces = outward.abs().sum();
    let point = Point3::from(at.component_mul(lengths) / 2.0);
    by_kind[faces as usize - 1].push(Sample { point, normal: outward / faces.sqrt() });
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_covers, assert_unit_normals};
    use super::*;
    use ode_visual_hull_random::Random;
    use std::collections::HashSet;

    const SIZES: [(f64, f64, f64); 5] =
        [(0.4, 0.3, 0.2), (1.0, 1.0, 0.001), (0.01, 0.01, 0.01), (2.0, 0.02, 0.03), (0.03, 0.0300001, 0.5)];

    fn surface_point(lengths: &Vector3<f64>, random: &mut Random) -> Point3<f64> {
        let mut at = Vector3::from_fn(|_, _| random.between(-0.5, 0.5));
        let axis = random.below(3);
        at[axis] = if random.below(2) == 0 { -0.5 } else { 0.5 };
        Point3::from(at.component_mul(lengths))
    }

    #[test]
    fn every_surface_point_is_near_a_sample() {
        for (x, y, z) in SIZES {
            let lengths = Vector3::new(x, y, z);
            for min_feature in [0.03, 0.05, 0.11] {
                let samples = box_(lengths, min_feature).unwrap();
                assert_covers(&samples, min_feature, |random| surface_point(&lengths, random));
            }
        }
    }

    #[test]
    fn samples_lie_on_the_surface_with_outward_normals() {
        for (x, y, z) in SIZES {
            let half = Vector3::new(x, y, z) / 2.0;
            let samples = box_(half * 2.0, 0.03).unwrap();
            assert_unit_normals(&samples);
            for Sample { point, normal } in samples.points() {
                assert!((point.coords.abs() - half).max().abs() < 1e-12);
                for axis in 0..3 {
                    let on_face = (point[axis].abs() - half[axis]).abs() < 1e-12;
                    assert_eq!(normal[axis] * point[axis] > 0.0, on_face);
                    assert_eq!(normal[axis] == 0.0, !on_face);
                }
            }
        }
    }

    #[test]
    fn reflections_map_the_samples_onto_themselves() {
        let samples = box_(Vector3::new(0.37, 0.2, 0.1), 0.03).unwrap();
        let key = |point: &Point3<f64>| point.coords.map(|x| (x + 0.0).to_bits());
        let all: HashSet<_> = samples.points().iter().map(|s| key(&s.point)).collect();
        assert_eq!(all.len(), samples.points().len());
        for axis in 0..3 {
            for sample in samples.points() {
                let mut mirrored = sample.point;
                mirrored[axis] = 0.0 - mirrored[axis];
                assert!(all.contains(&key(&mirrored)));
            }
        }
    }

    #[test]
    fn corners_come_first_then_edges_then_faces() {
        let samples = box_(Vector3::new(0.4, 0.3, 0.2), 0.03).unwrap();
        let kinds: Vec<_> =
            samples.points().iter().map(|s| s.normal.iter().filter(|x| **x != 0.0).count()).collect();
        assert!(kinds.is_sorted_by(|a, b| a >= b));
        assert_eq!(kinds.iter().filter(|kind| **kind == 3).count(), 8);
        assert_eq!(box_(Vector3::repeat(1e-3), 0.03).unwrap().points().len(), 26);
    }

    #[test]
    fn sizes_without_a_surface_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(box_(Vector3::new(0.1, bad, 0.1), 0.03).is_err());
            assert!(box_(Vector3::repeat(0.1), bad).is_err());
        }
        let error = box_(Vector3::repeat(10.0), 0.01).unwrap_err().to_string();
        for part in ["10 x 10 x 10 m", "12013352", "0.01 m", "raise min_feature"] {
            assert!(error.contains(part), "{error}");
        }
    }
}
