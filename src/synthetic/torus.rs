//! Intersection of a ray and a torus: a quartic, solved through its derivatives.
//!
//! Between two neighbouring turning points a polynomial changes sign at most once, and the turning points are the sign
//! changes of the derivative, found in the same way. So all roots are found and none is spurious, and whether a
//! grazing ray hits is decided by the polynomial's value at its own turning point.

use crate::camera::Ray;
use nalgebra::{Point3, Vector3};

/// The vector from the nearest point of the circle of radius `major` about z to `point`.
pub(super) fn from_circle(point: &Point3<f64>, major: f64) -> Vector3<f64> {
    let from_z = point.x.hypot(point.y);
    if from_z == 0.0 {
        return Vector3::new(-major, 0.0, point.z);
    }
    let along = 1.0 - major / from_z;
    Vector3::new(point.x * along, point.y * along, point.z)
}

/// The distance at which `ray` first crosses the surface.
pub(super) fn first_crossing(ray: &Ray, major: f64, minor: f64) -> Option<f64> {
    // Distances s are measured from the point nearest to the centre, so that all terms have the size of the torus.
    let nearest = -ray.origin.coords.dot(&ray.direction);
    let (p, d) = (ray.at(nearest).coords, ray.direction);

    // The part of the ray in a slightly larger ball around the torus.
    let bound = 1.001 * (major + minor);
    let square = bound * bound - p.norm_squared();
    let reach = (square > 0.0).then(|| square.sqrt())?;
    let first = (-reach).max(-nearest);
    if first >= reach {
        return None;
    }

    // (|x|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2), positive outside, at x = p + s d with p.d = 0.
    let k = p.norm_squared() + major * major - minor * minor;
    let four = 4.0 * major * major;
    let quartic = [
        k * k - four * p.xy().norm_squared(),
        -2.0 * four * p.xy().dot(&d.xy()),
        2.0 * k - four * d.xy().norm_squared(),
        0.0,
        1.0,
    ];
    sign_changes(&quartic, first, reach).iter().next().map(|s| nearest + s)
}

/// At most four numbers, ascending.
#[derive(Default)]
struct Few {
    numbers: [f64; 4],
    count: usize,
}

impl Few {
    fn push(&mut self, number: f64) {
        self.numbers[self.count] = number;
        self.count += 1;
    }

    fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        self.numbers[..self.count].iter().copied()
    }
}

/// The sign changes in `[from, to]` of a polynomial of degree 1 to 4 with ascending coefficients.
fn sign_changes(coefficients: &[f64], from: f64, to: f64) -> Few {
    let turns = if coefficients.len() > 2 {
        let slope = derivative(coefficients);
        sign_changes(&slope[..coefficients.len() - 1], from, to)
    } else {
        Few::default()
    };

    let mut found = Few::default();
    let mut left = from;
    for right in turns.iter().chain([to]) {
        if (value(coefficients, left) < 0.0) != (value(coefficients, right) < 0.0) {
            found.push(root_between(coefficients, left, right));
        }
        left = right;
    }
    found
}

/// The only root between `left` and `right`, where the signs differ: by Newton steps, or bisection where these leave
/// the interval.
fn root_between(coefficients: &[f64], left: f64, right: f64) -> f64 {
    let slope = derivative(coefficients);
    let slope = &slope[..coefficients.len() - 1];
    let left_is_negative = value(coefficients, left) < 0.0;

    let (mut left, mut right) = (left, right);
    let mut s = 0.5 * (left + right);
    for _ in 0..100 {
        let current = value(coefficients, s);
        if (current < 0.0) == left_is_negative {
            left = s;
        } else {
            right = s;
        }

        let newton = s - current / value(slope, s);
        let next = if newton > left && newton < right { newton } else { 0.5 * (left + right) };
        let done = (next - s).abs() <= 1e-15 * (left.abs() + right.abs());
        s = next;
        if done {
            break;
        }
    }
    s
}

fn derivative(coefficients: &[f64]) -> [f64; 4] {
    let mut slope = [0.0; 4];
    for (power, c) in coefficients.iter().enumerate().skip(1) {
        slope[power - 1] = c * power as f64;
    }
    slope
}

fn value(coefficients: &[f64], s: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * s + c)
}
