//! Capsules, spheres and cylinders as triangles.

use super::{LINE, LINE_BRIGHTNESS, Mesh};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Meridians of a round body: a multiple of four, so that octants end at some. A ball's outline is off by 0.1 % of its
/// radius.
const MERIDIANS: usize = 64;

/// Circles of latitude from the equator to a pole.
const LATITUDES: usize = 16;

/// Brightness of every other octant.
const DARKER: f32 = 0.78;

impl Mesh {
    /// A capsule along z whose cylinder is `length` long; a sphere for 0.
    pub(super) fn add_capsule(&mut self, radius: f64, length: f64) {
        for upper in [false, true] {
            let sign = if upper { 1.0 } else { -1.0 };
            // From the pole to the equator, and on along the cylinder to the body's middle.
            let circle = |k: usize| {
                let (sin, cos) = (FRAC_PI_2 * k as f64 / LATITUDES as f64).sin_cos();
                Circle {
                    radius: radius * sin,
                    height: sign * (0.5 * length + radius * cos),
                    normal: (sin, sign * cos),
                    brightness: 1.0,
                }
            };
            let mut circles: Vec<_> = (0..=LATITUDES).map(circle).collect();
            if length > 0.0 {
                circles.push(Circle { height: 0.0, ..circles[LATITUDES] });
            }
            self.add_turned(&circles, upper);
        }
    }

    /// A cylinder along z with dark lines along its rims.
    pub(super) fn add_cylinder(&mut self, radius: f64, length: f64) {
        let line = LINE.min(0.2 * radius).min(0.2 * length);
        for upper in [false, true] {
            let sign = if upper { 1.0 } else { -1.0 };
            let top = |radius: f64, brightness: f32| Circle {
                radius,
                height: sign * 0.5 * length,
                normal: (0.0, sign),
                brightness,
            };
            self.add_turned(&[top(0.0, 1.0), top(radius - line, 1.0), top(radius, LINE_BRIGHTNESS)], upper);
            let side = |below: f64, brightness: f32| Circle {
                radius,
                height: sign * (0.5 * length - below),
                normal: (1.0, 0.0),
                brightness,
            };
            self.add_turned(&[side(0.0, LINE_BRIGHTNESS), side(line, 1.0), side(0.5 * length, 1.0)], upper);
        }
    }

    /// The surface that `circles` around z span, from the pole on, octant by octant.
    fn add_turned(&mut self, circles: &[Circle], upper: bool) {
        let quarter = MERIDIANS / 4;
        for octant in 0..4 {
            let tint = if (octant % 2 == 0) == upper { 1.0 } else { DARKER };
            let first = self.vertices.len() as u32;
            for circle in circles {
                for k in 0..=quarter {
                    let angle = TAU * (octant * quarter + k) as f64 / MERIDIANS as f64;
                    self.push(&circle.point(angle), &circle.normal_at(angle), tint * circle.brightness);
                }
            }
            let at = |circle: usize, k: usize| first + (circle * (quarter + 1) + k) as u32;
            for (c, k) in (1..circles.len()).flat_map(|c| (0..quarter).map(move |k| (c, k))) {
                let [a, b, d, e] = [at(c - 1, k), at(c - 1, k + 1), at(c, k), at(c, k + 1)];
                let (one, other) = ([a, d, e], [a, e, b]);
                let outwards = |[p, q, r]: [u32; 3]| if upper { [p, q, r] } else { [p, r, q] };
                self.triangles.extend([outwards(one), outwards(other)]);
            }
        }
    }
}

/// A circle around z.
#[derive(Clone, Copy)]
struct Circle {
    radius: f64,
    height: f64,
    /// The outward normal's part away from z, and along z.
    normal: (f64, f64),
    brightness: f32,
}

impl Circle {
    fn point(&self, angle: f64) -> Point3<f64> {
        let (sin, cos) = angle.sin_cos();
        Point3::new(self.radius * cos, self.radius * sin, self.height)
    }

    fn normal_at(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        Vector3::new(self.normal.0 * cos, self.normal.0 * sin, self.normal.1)
    }
}
