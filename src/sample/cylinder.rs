//! Samples of a cylinder: the rims, concentric rings on the flat ends, and rings along the side.

use super::limits::{cells, check_count, positive, spacing};
use super::rings::{Ring, fewest_samples, revolve};
use super::{Samples, Smooth};
use crate::Result;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Samples of a cylinder about the local z axis, centred at the origin, of `radius` and full `length` in metres.
/// Samples on a rim have the normalised sum of the end's and the side's normal.
///
/// # Errors
/// A radius, length or `min_feature` that is not finite and positive; more than [`super::MAX_SAMPLES`] samples.
pub fn cylinder(radius: f64, length: f64, min_feature: f64) -> Result<Samples> {
    let spacing = spacing(min_feature)?;
    positive("cylinder radius", radius)?;
    positive("cylinder length", length)?;
    let name = format!("cylinder of radius {radius} m and length {length} m");
    let area = 2.0 * PI * radius * (length + radius);
    check_count(&name, fewest_samples(area, length + 2.0 * radius, spacing), min_feature)?;

    let (samples, cover) = revolve(&rings(radius, length, spacing), &name, min_feature)?;
    Ok(Samples::of_smooth(samples, cover, Smooth::Cylinder { radius, length }, radius.hypot(length / 2.0)))
}

/// The rings: the rims, then the ends from rim to centre, then the side; each from bottom to top.
fn rings(radius: f64, length: f64, spacing: f64) -> Vec<Ring> {
    let end_cells = cells(radius, spacing, 1.0) as i64;
    // With at least two cells the side has samples with its own normal.
    let side_cells = cells(length, spacing, 2.0) as i64;
    let end_reach = radius / end_cells as f64 / 2.0;
    let side_reach = length / side_cells as f64 / 2.0;

    let rim = |end: f64| Ring {
        radius,
        z: end * length / 2.0,
        normal: (FRAC_1_SQRT_2, end * FRAC_1_SQRT_2),
        reach: end_reach.max(side_reach),
        widest: radius,
    };

    let flat = |end: f64, k: i64| {
        let radius = radius * k as f64 / end_cells as f64;
        Ring {
            radius,
            z: end * length / 2.0,
            normal: (0.0, end),
            reach: end_reach,
            widest: radius + end_reach,
        }
    };

    let side = |k: i64| {
        let z = (2 * k - side_cells) as f64 / side_cells as f64 * length / 2.0;
        Ring { radius, z, normal: (1.0, 0.0), reach: side_reach, widest: radius }
    };

    let rims = [-1.0, 1.0].into_iter().map(rim);
    let ends = [-1.0, 1.0].into_iter().flat_map(|end| (0..end_cells).rev().map(move |k| flat(end, k)));
    rims.chain(ends).chain((1..side_cells).map(side)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Sample;
    use super::super::testing::{assert_covers, assert_unit_normals};
    use super::*;
    use nalgebra::{Point3, Vector3};
    use ode_visual_hull_random::Random;

    const SIZES: [(f64, f64); 5] = [(0.1, 0.3), (0.01, 3.0), (0.004, 0.003), (0.5, 0.002), (0.2, 0.021)];

    fn surface_point(radius: f64, length: f64, random: &mut Random) -> Point3<f64> {
        let (sin, cos) = random.between(0.0, 7.0).sin_cos();
        let (from_axis, height) = match random.below(3) {
            0 => (radius * random.between(0.0, 1.0).sqrt(), -0.5),
            1 => (radius * random.between(0.0, 1.0).sqrt(), 0.5),
            _ => (radius, random.between(-0.5, 0.5)),
        };
        Point3::new(from_axis * cos, from_axis * sin, height * length)
    }

    #[test]
    fn every_surface_point_is_near_a_sample() {
        for (radius, length) in SIZES {
            for min_feature in [0.03, 0.047, 0.2] {
                let samples = cylinder(radius, length, min_feature).unwrap();
                assert_covers(&samples, min_feature, |random| surface_point(radius, length, random));
            }
        }
    }

    #[test]
    fn samples_lie_on_the_surface_with_outward_normals() {
        for (radius, length) in SIZES {
            let samples = cylinder(radius, length, 0.03).unwrap();
            assert_unit_normals(&samples);
            for sample in samples.points() {
                let side = sample.point.coords.xy().norm() - radius;
                let end = sample.point.z.abs() - length / 2.0;
                assert!(side.max(end).abs() < 1e-12);

                let mut outward = Vector3::zeros();
                if side.abs() < 1e-12 {
                    outward += Vector3::new(sample.point.x, sample.point.y, 0.0) / radius;
                }
                if end.abs() < 1e-12 {
                    outward.z += 1.0_f64.copysign(sample.point.z);
                }
                assert!((outward.normalize() - sample.normal).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn a_rotation_by_180_degrees_maps_the_samples_onto_themselves() {
        let samples = cylinder(0.11, 0.2, 0.03).unwrap();
        for Sample { point, .. } in samples.points() {
            let opposite = Point3::new(0.0 - point.x, 0.0 - point.y, point.z);
            assert!(samples.points().iter().any(|other| other.point == opposite));
        }
    }

    #[test]
    fn sizes_without_a_surface_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(cylinder(bad, 0.1, 0.03).is_err());
            assert!(cylinder(0.1, bad, 0.03).is_err());
            assert!(cylinder(0.1, 0.1, bad).is_err());
        }
        assert!(cylinder(50.0, 1.0, 0.01).unwrap_err().to_string().contains("radius 50 m"));
    }
}
