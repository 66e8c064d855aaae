//! Samples of a capsule: rings along the side and latitude rings on the caps.

use super::limits::{cells, check_count, positive, spacing};
use super::rings::{Ring, fewest_samples, revolve};
use super::{Samples, Smooth};
use crate::{Error, Result};
use std::f64::consts::{FRAC_PI_2, PI};

/// Samples of a capsule about the local z axis: a cylinder of `radius` and `length` in metres with a hemisphere at
/// either end (`length` excludes them, and may be zero).
///
/// # Errors
/// A radius or `min_feature` that is not finite and positive, a length that is negative or not finite; more than
/// [`super::MAX_SAMPLES`] samples.
pub fn capsule(radius: f64, length: f64, min_feature: f64) -> Result<Samples> {
    let spacing = spacing(min_feature)?;
    positive("capsule radius", radius)?;
    if !(length.is_finite() && length >= 0.0) {
        return Err(Error::argument(format!(
            "capsule length is {length}: give a finite length of 0 or more, in metres"
        )));
    }
    let name = format!("capsule of radius {radius} m and length {length} m");
    let area = 2.0 * PI * radius * (length + 2.0 * radius);
    check_count(&name, fewest_samples(area, length + PI * radius, spacing), min_feature)?;

    let (samples, cover) = revolve(&rings(radius, length, spacing), &name, min_feature)?;
    Ok(Samples::of_smooth(samples, cover, Smooth::Capsule { radius, length }, length / 2.0 + radius))
}

/// The rings from the lower pole to the upper one.
fn rings(radius: f64, length: f64, spacing: f64) -> Vec<Ring> {
    let cap_cells = cells(radius * FRAC_PI_2, spacing, 2.0) as i64;
    let side_cells = if length > 0.0 { cells(length, spacing, 1.0) as i64 } else { 0 };
    let side_reach = if length > 0.0 { length / side_cells as f64 / 2.0 } else { 0.0 };
    let step = FRAC_PI_2 / cap_cells as f64;
    let cap_reach = 2.0 * radius * (step / 4.0).sin();

    let cap = |k: i64, end: f64| {
        let (sin, cos) = if k == cap_cells { (1.0, 0.0) } else { (k as f64 * step).sin_cos() };
        let widest = radius * ((k as f64 - 0.5) * step).cos();
        let z = end * (length / 2.0 + radius * sin);
        Ring { radius: radius * cos, z, normal: (cos, end * sin), reach: cap_reach, widest }
    };

    let side = |k: i64| {
        let at_end = k == 0 || k == side_cells;
        let z = if side_cells == 0 {
            0.0
        } else {
            (2 * k - side_cells) as f64 / side_cells as f64 * length / 2.0
        };
        // The first and last ring cover a band of the side and one of a cap.
        let reach = if at_end { side_reach.max(cap_reach) } else { side_reach };
        Ring { radius, z, normal: (1.0, 0.0), reach, widest: radius }
    };

    let lower = (1..=cap_cells).rev().map(|k| cap(k, -1.0));
    let upper = (1..=cap_cells).map(|k| cap(k, 1.0));
    lower.chain((0..=side_cells).map(side)).chain(upper).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_covers, assert_unit_normals};
    use super::*;
    use nalgebra::{Point3, Vector3};
    use ode_visual_hull_random::Random;

    const SIZES: [(f64, f64); 5] = [(0.1, 0.3), (0.02, 2.0), (0.005, 0.004), (0.2, 0.0), (0.3, 1e-4)];

    fn surface_point(radius: f64, length: f64, random: &mut Random) -> Point3<f64> {
        let direction = random.direction();
        // Half of the points on the caps, half on the side.
        if random.below(2) == 0 {
            let end = Vector3::z() * (length / 2.0).copysign(direction.z);
            return Point3::from(end + direction * radius);
        }
        let (sin, cos) = random.between(0.0, 7.0).sin_cos();
        Point3::new(radius * cos, radius * sin, random.between(-0.5, 0.5) * length)
    }

    #[test]
    fn every_surface_point_is_near_a_sample() {
        for (radius, length) in SIZES {
            for min_feature in [0.03, 0.047, 0.2] {
                let samples = capsule(radius, length, min_feature).unwrap();
                assert_covers(&samples, min_feature, |random| surface_point(radius, length, random));
            }
        }
    }

    #[test]
    fn samples_lie_on_the_surface_with_outward_normals() {
        for (radius, length) in SIZES {
            let samples = capsule(radius, length, 0.03).unwrap();
            assert_unit_normals(&samples);
            assert!(samples.points().len() >= 12);
            for sample in samples.points() {
                let on_axis = Vector3::z() * sample.point.z.clamp(-length / 2.0, length / 2.0);
                let outward = sample.point.coords - on_axis;
                assert!((outward.norm() - radius).abs() < 1e-12);
                // The normal of a point at the seam may be rounded to either side of it.
                assert!((outward / radius - sample.normal).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn sizes_without_a_surface_are_refused() {
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(capsule(bad, 0.1, 0.03).is_err());
            assert!(capsule(0.1, bad, 0.03).is_err());
            assert!(capsule(0.1, 0.1, bad).is_err());
        }
        assert!(capsule(0.0, 0.1, 0.03).is_err());
        // Listing this needle's rings would take the machine's memory.
        assert!(capsule(1e-12, 1e12, 1e-3).unwrap_err().to_string().contains("raise min_feature"));
    }
}
