//! OpenCV's fisheye lens, the model of Kannala and Brandt with four coefficients, on the plane at depth 1.
//!
//! ```text
//!   theta_d                      . fold: from here on two rays would share a pixel
//!      |                  .   '     '
//!      |            .                  '
//!      |       .     theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
//!      |   .
//!      +---------------------------> theta, the angle between ray and axis
//! ```

use crate::{Error, Result};
use nalgebra::{Matrix3, Point2, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// OpenCV's fisheye coefficients `k1 k2 k3 k4` (`cv::fisheye` in OpenCV's documentation of the module `calib3d`).
///
/// A ray at the angle `theta` from the axis appears at `theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 +
/// k4 theta^8)` focal lengths from the principal point, in its own direction. The model is used below 90 degrees, and
/// only up to the angle at which `theta_d` stops growing. Without coefficients it is the equidistant projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fisheye {
    coefficients: [f64; 4],
    /// The angle at which `theta_d` stops growing; pi where it never does.
    fold_angle: f64,
}

/// Steps of [`Fisheye::angle_at`], which halve the interval where Newton's method leaves it.
const MAX_STEPS: usize = 100;

/// Steps of the scan for the fold, over half a turn.
const SCAN_STEPS: u32 = 4096;

impl Fisheye {
    /// From 0 or 4 coefficients in OpenCV's order.
    ///
    /// # Errors
    /// Another count, or a number that is not finite.
    pub fn from_opencv(coefficients: &[f64]) -> Result<Self> {
        let coefficients = match *coefficients {
            [] => [0.0; 4],
            [k1, k2, k3, k4] => [k1, k2, k3, k4],
            _ => {
                let n = coefficients.len();
                return Err(Error::argument(format!(
                    "expected 0 or 4 fisheye coefficients (k1 k2 k3 k4), found {n}"
                )));
            }
        };
        if !coefficients.iter().all(|c| c.is_finite()) {
            return Err(Error::argument(format!(
                "expected finite fisheye coefficients, found {coefficients:?}"
            )));
        }
        let mut fisheye = Self { coefficients, fold_angle: PI };
        fisheye.fold_angle = fisheye.find_fold();
        Ok(fisheye)
    }

    /// The four coefficients.
    pub fn coefficients(&self) -> &[f64; 4] {
        &self.coefficients
    }

    /// The distorted position of `p` on the plane at depth 1; `None` beyond the model's range.
    pub fn distort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        let r = p.coords.norm();
        let theta = r.atan();
        if r == 0.0 {
            return Some(p);
        }
        (theta < FRAC_PI_2 && theta <= self.fold_angle).then(|| p * (self.theta_d(theta) / r))
    }

    /// The position that [`distort`](Self::distort) maps to `p`; `None` beyond the model's range.
    pub fn undistort(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        let theta_d = p.coords.norm();
        if theta_d == 0.0 {
            return Some(p);
        }
        let theta = self.angle_at(theta_d).filter(|&theta| theta < FRAC_PI_2)?;
        Some(p * (theta.tan() / theta_d))
    }

    /// The radius on the plane at depth 1 up to which the model holds.
    pub(super) fn max_radius(&self) -> f64 {
        if self.fold_angle < FRAC_PI_2 { self.fold_angle.tan() } else { f64::INFINITY }
    }

    /// Whether this lens can have made an image of `size` pixels; `to_plane` maps pixels to the plane at depth 1.
    ///
    /// # Errors
    /// What was expected, found, and what to do: where the image shows rays at 90 degrees or more from the axis, which
    /// no pinhole sees; where the model folds back all around the axis before it reaches the border. A calibration
    /// finds corners all over the image, so that its model grows at least up to the nearest border; in the image's
    /// corners the polynomial often is an extrapolation, and what lies beyond a fold there is unseen.
    pub(super) fn check_image(
        &self,
        to_plane: &Matrix3<f64>,
        (width, height): (u32, u32),
    ) -> std::result::Result<(), String> {
        let (w, h) = (f64::from(width), f64::from(height));
        let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)]
            .map(|(u, v)| Point2::from((to_plane * Vector3::new(u, v, 1.0)).xy()));

        // The border is farthest from the axis at one of the image's corners.
        let farthest = corners.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        if self.fold_angle > FRAC_PI_2 && farthest >= self.theta_d(FRAC_PI_2) {
            let angle = self.angle_at(farthest).unwrap_or(self.fold_angle).to_degrees();
            return Err(format!(
                "expected a fisheye image of rays less than 90 degrees from its axis, found rays at {angle:.1} degrees \
                 at its border; crop the images, or undistort them first"
            ));
        }

        // How far each side lies from the axis; negative where the axis is beyond it.
        let sides = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| {
            let side = b - a;
            side.perp(&-a.coords) / side.norm()
        });
        if sides.fold(f64::INFINITY, f64::min) > self.theta_d(self.fold_angle) {
            let (angle, found) = (self.fold_angle.to_degrees(), &self.coefficients);
            return Err(format!(
                "expected a fisheye model that grows up to the image's border, found one that folds back inside the \
                 image, {angle:.1} degrees from its axis, with k1 to k4 = {found:?}; check their order and the size of \
                 the images, or calibrate again"
            ));
        }
        Ok(())
    }

    /// Where a ray at the angle `theta` appears, in focal lengths.
    fn theta_d(&self, theta: f64) -> f64 {
        let [k1, k2, k3, k4] = self.coefficients;
        let t2 = theta * theta;
        theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
    }

    /// The derivative of `theta_d`.
    fn slope(&self, theta: f64) -> f64 {
        let [k1, k2, k3, k4] = self.coefficients;
        let t2 = theta * theta;
        1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))
    }

    /// The angle that appears at `theta_d`; `None` beyond the fold.
    fn angle_at(&self, theta_d: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, self.fold_angle);
        let reached = self.theta_d(high);
        if theta_d.is_nan() || reached.is_nan() || theta_d > reached {
            return None;
        }
        let mut theta = theta_d.min(high);
        for _ in 0..MAX_STEPS {
            let error = self.theta_d(theta) - theta_d;
            let newton = theta - error / self.slope(theta);
            if error == 0.0 || (newton - theta).abs() <= f64::EPSILON * theta {
                break;
            }
            *(if error > 0.0 { &mut high } else { &mut low }) = theta;
            theta = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        }
        Some(theta)
    }

    /// The first angle at which `theta_d` stops growing, up to pi: by a scan, then by halving the step that it found.
    fn find_fold(&self) -> f64 {
        let grows = |theta: f64| self.slope(theta) > 0.0;
        let at = |i: u32| PI * f64::from(i) / f64::from(SCAN_STEPS);
        let Some(first) = (1..=SCAN_STEPS).find(|&i| !grows(at(i))) else { return PI };
        let (mut low, mut high) = (at(first - 1), at(first));
        // As many halvings as a number has bits.
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (low + high);
            *(if grows(middle) { &mut low } else { &mut high }) = middle;
        }
        low
    }
}

impl fmt::Display for Fisheye {
    /// `OpenCV fisheye [k1, k2, k3, k4]`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "OpenCV fisheye {:?}", self.coefficients)
    }
}

#[cfg(test)]
mod tests;
