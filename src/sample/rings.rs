//! Surfaces of revolution about the local z axis, sampled by rings.
//!
//! ```text
//!   profile      a ring covers the points of the surface up to half way to the next rings
//!    o--.        (`reach` along the profile) and between two of its own samples (an angle of pi / n)
//!        o
//!        |
//!        o
//! ```

use super::Sample;
use super::limits::check_count;
use crate::Result;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Samples on a circle about the z axis, or on the axis itself if `radius` is zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring {
    /// The distance from the axis, in metres.
    pub radius: f64,
    /// The height along the axis, in metres.
    pub z: f64,
    /// The unit normal: its components away from the axis and along it.
    pub normal: (f64, f64),
    /// The largest distance, within the half-plane of the profile, of a point that this ring covers.
    pub reach: f64,
    /// The largest distance from the axis of a point that this ring covers.
    pub widest: f64,
}

impl Ring {
    /// The number of samples that cover the ring's band with radius `cover`: a multiple of four, which keeps the
    /// mirror symmetries.
    fn count(&self, cover: f64) -> f64 {
        if self.radius == 0.0 {
            return 1.0;
        }
        // For radii a and b, an angle t and a profile distance c between two points,
        // distance^2 = c^2 + 4 a b sin^2(t / 2).
        let sine = ((cover * cover - self.reach * self.reach) / (4.0 * self.radius * self.widest)).sqrt();
        let needed = FRAC_PI_2 / sine.min(1.0).asin();
        ((needed / 4.0).ceil() * 4.0).max(8.0)
    }

    /// The covering radius of the ring's band with `count` samples.
    fn cover(&self, count: f64) -> f64 {
        let sine = (FRAC_PI_2 / count).sin();
        (self.reach * self.reach + 4.0 * self.radius * self.widest * sine * sine).sqrt()
    }

    /// Appends `count` samples on the ring.
    fn sample(&self, count: usize, samples: &mut Vec<Sample>) {
        let (outward, upward) = self.normal;
        if self.radius == 0.0 {
            let normal = Vector3::new(0.0, 0.0, upward);
            return samples.push(Sample { point: Point3::new(0.0, 0.0, self.z), normal });
        }
        for k in 0..count {
            // Rotate the first quadrant by exact quarter turns, so that opposite samples are exactly opposite.
            let (sin, cos) = ((k % (count / 4)) as f64 * 2.0 * PI / count as f64).sin_cos();
            let (x, y) = [(cos, sin), (-sin, cos), (-cos, -sin), (sin, -cos)][k / (count / 4)];
            let point = Point3::new(self.radius * x, self.radius * y, self.z);
            samples.push(Sample { point, normal: Vector3::new(outward * x, outward * y, upward) });
        }
    }
}

/// The samples of all `rings` in their order, and their covering radius. `body` names the shape and its size.
pub(super) fn revolve(rings: &[Ring], body: &str, min_feature: f64) -> Result<(Vec<Sample>, f64)> {
    let counts: Vec<f64> = rings.iter().map(|ring| ring.count(min_feature / 2.0)).collect();
    check_count(body, counts.iter().sum(), min_feature)?;
    let mut samples = Vec::with_capacity(counts.iter().sum::<f64>() as usize);
    let mut cover = 0.0_f64;
    for (ring, count) in rings.iter().zip(counts) {
        ring.sample(count as usize, &mut samples);
        cover = cover.max(ring.cover(count));
    }
    Ok((samples, cover))
}

/// A lower bound on the number of samples, to refuse excessive sizes before their rings are listed.
pub(super) fn fewest_samples(area: f64, profile: f64, spacing: f64) -> f64 {
    area / (spacing * spacing) + 8.0 * (profile / spacing - 4.0).max(0.0) / 2.0
}
