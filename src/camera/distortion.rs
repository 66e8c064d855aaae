//! OpenCV's lens distortion: radial (polynomial or rational), tangential, thin prism and tilted sensor, on the plane at
//! depth 1.

use crate::{Error, Result};
use nalgebra::{Matrix2, Matrix3, Point2, Vector2};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

/// OpenCV's distortion coefficients `k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [taux tauy]]]]`; all zero means none.
///
/// With `r2 = x2 + y2`, `x' = x (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6) + 2 p1 x y + p2 (r2 + 2 x2) +
/// s1 r2 + s2 r4`, and likewise for `y` with `s3 r2 + s4 r4`. A sensor that is tilted by `taux` and `tauy` (radians)
/// then sees `(x', y', 1)` through a homography. Source: OpenCV's documentation of the module `calib3d`. The model is
/// used only out to the radius at which it would fold back on itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distortion {
    coefficients: [f64; COUNT],
    /// Squared radius at which the model stops growing (infinity where it never does).
    max_r2: f64,
    /// The homography of a tilted sensor.
    tilt: Option<Matrix3<f64>>,
}

/// The coefficients of the whole model.
const COUNT: usize = 14;

/// As many coefficients as OpenCV writes, each count for one more part of the model.
const COUNTS: [usize; 6] = [0, 4, 5, 8, 12, COUNT];

/// Newton steps of [`Distortion::undistort`]; it converges quadratically, to 1e-12 in at most 8 for real lenses.
const NEWTON_STEPS: usize = 20;

impl Distortion {
    /// No distortion.
    pub fn none() -> Self {
        Self { coefficients: [0.0; COUNT], max_r2: f64::INFINITY, tilt: None }
    }

    /// From 0, 4, 5, 8, 12 or 14 coefficients in OpenCV's order.
    ///
    /// # Errors
    /// Another count, a number that is not finite, or a sensor that is tilted by 90 degrees or more.
    pub fn from_opencv(coefficients: &[f64]) -> Result<Self> {
        let n = coefficients.len();
        if !COUNTS.contains(&n) {
            return Err(Error::argument(format!(
                "expected 0, 4, 5, 8, 12 or 14 distortion coefficients (k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 taux \
                 tauy), found {n}"
            )));
        }
        if !coefficients.iter().all(|c| c.is_finite()) {
            return Err(Error::argument(format!(
                "expected finite distortion coefficients, found {coefficients:?}"
            )));
        }
        let mut all = [0.0; COUNT];
        all[..n].copy_from_slice(coefficients);
        let [.., tau_x, tau_y] = all;
        if tau_x.abs() >= FRAC_PI_2 || tau_y.abs() >= FRAC_PI_2 {
            return Err(Error::argument(format!(
                "expected a sensor tilted by less than 90 degrees, found taux = {tau_x}, tauy = {tau_y} radians"
            )));
        }
        let tilt = (tau_x != 0.0 || tau_y != 0.0).then(|| sensor_tilt(tau_x, tau_y));
        let mut distortion = Self { coefficients: all, max_r2: f64::INFINITY, tilt };
        distortion.max_r2 = distortion.folding_r2();
        Ok(distortion)
    }

    /// All 14 coefficients, absent ones zero.
    pub fn coefficients(&self) -> &[f64; COUNT] {
        &self.coefficients
    }

    /// The coefficients in OpenCV's order without the zeros at the end, as far as OpenCV leaves them out: 0, 4, 5, 8,
    /// 12 or 14.
    pub fn shortest(&self) -> &[f64] {
        let used = self.coefficients.iter().rposition(|&c| c != 0.0).map_or(0, |last| last + 1);
        let count = COUNTS.into_iter().find(|&count| count >= used).unwrap_or(COUNT);
        &self.coefficients[..count]
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.coefficients.iter().all(|&c| c == 0.0)
    }

    /// The distorted position of `p` on the plane at depth 1; `None` beyond the model's range.
    pub fn distort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        if self.is_none() {
            return Some(p);
        }
        if p.coords.norm_squared() > self.max_r2 {
            return None;
        }
        let untilted = self.distort_with_jacobian(p).0;
        self.tilt.map_or(Some(untilted), |tilt| in_front(&tilt, untilted))
    }

    /// The position that [`distort`](Self::distort) maps to `p`; `None` beyond the model's range.
    pub fn undistort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        if self.is_none() {
            return Some(p);
        }
        let p = match self.tilt {
            Some(tilt) => in_front(&tilt.try_inverse()?, p)?,
            None => p,
        };
        let mut q = p;
        for _ in 0..NEWTON_STEPS {
            let (image, jacobian) = self.distort_with_jacobian(q);
            let error = p - image;
            if error.norm() < 1e-13 {
                break;
            }
            let mut step = jacobian.try_inverse()? * error;
            // A long Newton step can jump past the fold, from where there is no way back.
            let longest = 0.3 * (1.0 + q.coords.norm());
            if step.norm() > longest {
                step *= longest / step.norm();
            }
            q += step;
            if q.coords.norm_squared() > self.max_r2 {
                q.coords *= (self.max_r2 / q.coords.norm_squared()).sqrt();
            }
        }
        let close = (self.distort_with_jacobian(q).0 - p).norm() < 1e-9;
        (close && q.coords.norm_squared() <= self.max_r2).then_some(q)
    }

    /// The radius on the plane at depth 1 up to which the model holds.
    pub(super) fn max_radius(&self) -> f64 {
        self.max_r2.sqrt()
    }

    /// The distorted position on a sensor that is not tilted.
    fn distort_with_jacobian(&self, p: Point2<f64>) -> (Point2<f64>, Matrix2<f64>) {
        let [_, _, p1, p2, ..] = self.coefficients;
        let (x, y) = (p.x, p.y);
        let r2 = x * x + y * y;
        let (radial, slope) = self.radial(r2);
        let tangential = Vector2::new(
            2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let mut image = Point2::from(p.coords * radial + tangential);
        let mut jacobian = Matrix2::new(
            radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
            2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
            radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        );
        if let Some([s1, s2, s3, s4]) = self.prism() {
            let slope = Vector2::new(s1 + 2.0 * s2 * r2, s3 + 2.0 * s4 * r2);
            image += Vector2::new(s1 + s2 * r2, s3 + s4 * r2) * r2;
            jacobian += slope * (2.0 * p.coords).transpose();
        }
        (image, jacobian)
    }

    /// The thin prism's coefficients, unless they are zero.
    fn prism(&self) -> Option<[f64; 4]> {
        let [.., s1, s2, s3, s4, _, _] = self.coefficients;
        let prism = [s1, s2, s3, s4];
        prism.iter().any(|&s| s != 0.0).then_some(prism)
    }

    /// The radial factor at `r2`, and its derivative by `r2`.
    fn radial(&self, r2: f64) -> (f64, f64) {
        let [k1, k2, _, _, k3, k4, k5, k6, ..] = self.coefficients;
        let above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
        let above_slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
        let below_slope = k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6);
        (above / below, (above_slope * below - above * below_slope) / (below * below))
    }

    /// The first `r2` at which the distorted radius stops growing with the true one, or at which a thin prism turns the
    /// image over, by a fine scan to radius 10 (84 degrees off the axis).
    fn folding_r2(&self) -> f64 {
        if self.is_none() {
            return f64::INFINITY;
        }
        let growing = |r: f64| {
            let (radial, slope) = self.radial(r * r);
            radial > 0.0
                && radial + 2.0 * r * r * slope > 0.0
                && (self.prism().is_none() || self.keeps_orientation(r))
        };
        let step = 1e-3;
        let first_fold = (0..10_000).map(|i| f64::from(i) * step).find(|&r| !growing(r));
        first_fold.map_or(f64::INFINITY, |r| (r - step).max(0.0).powi(2))
    }

    /// Whether neighbours keep their places on the circle of radius `r`; what a prism does to it has one period, and is
    /// looked at in 32 directions.
    fn keeps_orientation(&self, r: f64) -> bool {
        (0..32).all(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 32.0).sin_cos();
            self.distort_with_jacobian(Point2::new(r * cos, r * sin)).1.determinant() > 0.0
        })
    }
}

impl fmt::Display for Distortion {
    /// `OpenCV [k1, k2, ...]`, the coefficients as in [`Distortion::shortest`].
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "OpenCV {:?}", self.shortest())
    }
}

/// From the plane at depth 1 to a sensor turned by `tau_x` around the x axis, then by `tau_y` around the y axis, seen
/// along its normal (OpenCV's `computeTiltProjectionMatrix`).
fn sensor_tilt(tau_x: f64, tau_y: f64) -> Matrix3<f64> {
    let ((sx, cx), (sy, cy)) = (tau_x.sin_cos(), tau_y.sin_cos());
    let around_x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx);
    let around_y = Matrix3::new(cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy);
    let turn = around_y * around_x;
    let depth = turn[(2, 2)];
    Matrix3::new(depth, 0.0, -turn[(0, 2)], 0.0, depth, -turn[(1, 2)], 0.0, 0.0, 1.0) * turn
}

/// `p` under a homography; `None` where it goes to the horizon or behind it.
fn in_front(homography: &Matrix3<f64>, p: Point2<f64>) -> Option<Point2<f64>> {
    let image = homography * p.to_homogeneous();
    (image.z > 0.0).then(|| Point2::new(image.x / image.z, image.y / image.z))
}
