//! OpenCV's lens distortion: radial (polynomial or rational) and tangential, on the plane at depth 1.

use crate::{Error, Result};
use nalgebra::{Matrix2, Point2, Vector2};

/// OpenCV's distortion coefficients `k1 k2 p1 p2 [k3 [k4 k5 k6]]`; all zero means none.
///
/// With `r2 = x2 + y2`: `x' = x (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6) + 2 p1 x y + p2 (r2 + 2 x2)`
/// and likewise for `y`. The model is used only out to the radius at which it would fold back on itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distortion {
    coefficients: [f64; 8],
    /// Squared radius at which the radial part stops growing (infinity where it never does).
    max_r2: f64,
}

/// Newton steps of [`Distortion::undistort`]; it converges quadratically, to 1e-12 in at most 8 for real lenses.
const NEWTON_STEPS: usize = 20;

impl Distortion {
    /// No distortion.
    pub fn none() -> Self {
        Self { coefficients: [0.0; 8], max_r2: f64::INFINITY }
    }

    /// From 0, 4, 5 or 8 coefficients in OpenCV's order.
    ///
    /// # Errors
    /// Another count, or a number that is not finite.
    pub fn from_opencv(coefficients: &[f64]) -> Result<Self> {
        let n = coefficients.len();
        if !matches!(n, 0 | 4 | 5 | 8) {
            return Err(Error::argument(format!(
                "expected 0, 4, 5 or 8 distortion coefficients (k1 k2 p1 p2 k3 k4 k5 k6), found {n}"
            )));
        }
        if !coefficients.iter().all(|c| c.is_finite()) {
            return Err(Error::argument(format!(
                "expected finite distortion coefficients, found {coefficients:?}"
            )));
        }
        let mut all = [0.0; 8];
        all[..n].copy_from_slice(coefficients);
        let mut distortion = Self { coefficients: all, max_r2: f64::INFINITY };
        distortion.max_r2 = distortion.folding_r2();
        Ok(distortion)
    }

    /// The eight coefficients, absent ones zero.
    pub fn coefficients(&self) -> &[f64; 8] {
        &self.coefficients
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.coefficients.iter().all(|&c| c == 0.0)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.coefficients.iter().all(|c| c.is_finite())
    }

    /// The distorted position of `p` on the plane at depth 1; `None` beyond the model's range.
    pub fn distort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        if self.is_none() {
            return Some(p);
        }
        if p.coords.norm_squared() > self.max_r2 {
            return None;
        }
        Some(self.distort_with_jacobian(p).0)
    }

    /// The position that [`distort`](Self::distort) maps to `p`; `None` beyond the model's range.
    pub fn undistort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        if self.is_none() {
            return Some(p);
        }
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

    fn distort_with_jacobian(&self, p: Point2<f64>) -> (Point2<f64>, Matrix2<f64>) {
        let [_, _, p1, p2, ..] = self.coefficients;
        let (x, y) = (p.x, p.y);
        let r2 = x * x + y * y;
        let (radial, slope) = self.radial(r2);
        let tangential = Vector2::new(
            2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let image = Point2::from(p.coords * radial + tangential);
        let jacobian = Matrix2::new(
            radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
            2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
            radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        );
        (image, jacobian)
    }

    /// The radial factor at `r2`, and its derivative by `r2`.
    fn radial(&self, r2: f64) -> (f64, f64) {
        let [k1, k2, _, _, k3, k4, k5, k6] = self.coefficients;
        let above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
        let above_slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
        let below_slope = k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6);
        (above / below, (above_slope * below - above * below_slope) / (below * below))
    }

    /// The first `r2` at which the distorted radius stops growing with the true one, by a fine scan to radius 10
    /// (84 degrees off the axis).
    fn folding_r2(&self) -> f64 {
        if self.is_none() {
            return f64::INFINITY;
        }
        let growing = |r: f64| {
            let (radial, slope) = self.radial(r * r);
            radial > 0.0 && radial + 2.0 * r * r * slope > 0.0
        };
        let step = 1e-3;
        let first_fold = (0..10_000).map(|i| f64::from(i) * step).find(|&r| !growing(r));
        first_fold.map_or(f64::INFINITY, |r| (r - step).max(0.0).powi(2))
    }
}
