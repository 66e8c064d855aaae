//! Combines a projection matrix for undistorted pixels and a `.rad` file into one lens.
//!
//! The calibration undid the distortion with the K of the `.rad` file and estimated the matrix `P = K_P [R t]` for the
//! undistorted pixels. An image point is therefore `K D(K^-1 K_P x)`, with x on the plane at depth 1 and the
//! distortion D. If `K_P` equals K this is a camera with K and D. They mostly differ by some percent; then the lens is
//! fitted to this mapping by least squares over the image, and the pose of P is kept. With a wide lens and principal
//! points 15 px apart the fit is off by 0.8 px on average, whereas K and D with that pose are off by 16 px.

use super::super::lines;
use crate::camera::Distortion;
use crate::{Error, Result};
use nalgebra::{Matrix3, Point2, SMatrix, SVector};

/// The distance between the fitted lens and the mapping that the two files give, in pixels.
pub(super) struct Misfit {
    /// The root mean square over the image.
    pub(super) rms_px: f64,
    pub(super) max_px: f64,
}

/// Cells of the grid of image points, along each side.
const GRID: u32 = 24;

/// Gauss-Newton steps; the start is near and they converge quadratically.
const GAUSS_NEWTON_STEPS: usize = 10;

/// fx, skew, cx, fy, cy, k1, k2, p1, p2, k3.
type Parameters = SVector<f64, 10>;

/// Intrinsic matrix and distortion of one camera.
pub(super) struct FittedLens {
    pub(super) k: Matrix3<f64>,
    pub(super) distortion: Distortion,
}

/// Reads a `.rad` file.
pub(super) fn read(text: &str) -> Result<FittedLens> {
    let value = |key: &str| {
        let mut lines = lines::lines(text).filter_map(|line| Some((line.text.split_once('=')?, line)));
        let found = lines.find(|((found, _), _)| found.trim() == key);
        found.map(|((_, value), line)| line.number_in(value.trim(), "write K11 = .. to kc4 = ..")).transpose()
    };

    let needed = |key: &str| {
        value(key)?.ok_or_else(|| {
            let found = lines::lines(text).count();
            Error::argument(format!(
                "expected a line `{key} = ..`, found none in {found} lines; fetch the whole file"
            ))
        })
    };

    let k = ["K11", "K12", "K13", "K21", "K22", "K23", "K31", "K32", "K33"].map(needed);
    let k = Matrix3::from_row_iterator(k.into_iter().collect::<Result<Vec<_>>>()?);
    let kc = ["kc1", "kc2", "kc3", "kc4"].map(needed).into_iter().collect::<Result<Vec<_>>>()?;
    let kc5 = value("kc5")?.unwrap_or_default();

    if k[(0, 0)] <= 0.0 || k[(1, 1)] <= 0.0 || k.try_inverse().is_none() {
        let (fx, fy) = (k[(0, 0)], k[(1, 1)]);
        return Err(Error::argument(format!(
            "expected positive focal lengths, found K11 = {fx}, K22 = {fy}; calibrate again"
        )));
    }

    Ok(FittedLens { k, distortion: Distortion::from_opencv(&[kc[0], kc[1], kc[2], kc[3], kc5])? })
}

impl FittedLens {
    /// The lens of `k` without distortion.
    pub(super) fn none(k: &Matrix3<f64>) -> Self {
        Self { k: *k, distortion: Distortion::none() }
    }

    /// Fits the lens for points that the matrix `k` maps to this lens's undistorted pixels, and measures the fit.
    /// Without `size` the principal point is taken as the image's centre.
    pub(super) fn behind(self, k: &Matrix3<f64>, size: Option<(u32, u32)>) -> (Self, Misfit) {
        if self.distortion.is_none() {
            return (Self::none(k), Misfit { rms_px: 0.0, max_px: 0.0 });
        }

        let middle = (2.0 * self.k[(0, 2)], 2.0 * self.k[(1, 2)]);
        let (width, height) = size.map_or(middle, |(width, height)| (width.into(), height.into()));
        let pairs = self.pairs(k, width, height);

        let coefficients = self.distortion.coefficients();
        let mut lens = Parameters::from([
            k[(0, 0)],
            k[(0, 1)],
            k[(0, 2)],
            k[(1, 1)],
            k[(1, 2)],
            coefficients[0],
            coefficients[1],
            coefficients[2],
            coefficients[3],
            coefficients[4],
        ]);

        // With equal intrinsics the start is the exact solution.
        if (self.k - k).amax() > 1e-9 * k[(0, 0)] {
            for _ in 0..GAUSS_NEWTON_STEPS {
                lens += step(&lens, &pairs).unwrap_or_else(Parameters::zeros);
            }
        }

        // pairs
        let errors = || pairs.iter().map(|(x, image)| (project(&lens, x).0 - image).norm_squared());
        let rms_px = (errors().sum::<f64>() / pairs.len().max(1) as f64).sqrt();
        let misfit = Misfit { rms_px, max_px: errors().fold(0.0, f64::max).sqrt() };

        let [fx, skew, cx, fy, cy, k1, k2, p1, p2, k3] = lens.into();
        let distortion =
            Distortion::from_opencv(&[k1, k2, p1, p2, k3]).unwrap_or_else(|_| Distortion::none());
        (Self { k: Matrix3::new(fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0), distortion }, misfit)
    }

    /// Pairs of a point on the plane at depth 1 in the frame of `k`, and its image point.
    fn pairs(&self, k: &Matrix3<f64>, width: f64, height: f64) -> Vec<(Point2<f64>, Point2<f64>)> {
        let (Some(rad_inverse), Some(inverse)) = (self.k.try_inverse(), k.try_inverse()) else {
            return Vec::new();
        };
        let at = |index: u32, side: f64| f64::from(index) / f64::from(GRID) * side - 0.5;
        let cells = (0..=GRID).flat_map(|j| (0..=GRID).map(move |i| (i, j)));
        let pair = |(i, j)| {
            let image = Point2::new(at(i, width), at(j, height));
            let distorted = rad_inverse * image.to_homogeneous();
            let undistorted = self.distortion.undistort(distorted.xy().into())?;
            Some(((inverse * self.k * undistorted.to_homogeneous()).xy().into(), image))
        };
        cells.filter_map(pair).collect()
    }
}

/// One Gauss-Newton step: solves the normal equations of the image errors.
fn step(lens: &Parameters, pairs: &[(Point2<f64>, Point2<f64>)]) -> Option<Parameters> {
    let (mut normal, mut right) = (SMatrix::<f64, 10, 10>::zeros(), Parameters::zeros());
    for (x, image) in pairs {
        let (found, jacobian) = project(lens, x);
        normal += jacobian.transpose() * jacobian;
        right += jacobian.transpose() * (image - found);
    }
    normal.cholesky().map(|normal| normal.solve(&right))
}

/// The image of `x`, and its derivatives by the parameters.
fn project(lens: &Parameters, x: &Point2<f64>) -> (Point2<f64>, SMatrix<f64, 2, 10>) {
    let [fx, skew, cx, fy, cy, k1, k2, p1, p2, k3] = (*lens).into();

    let (r2, xy) = (x.coords.norm_squared(), x.x * x.y);
    let radial = x.coords * (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)));
    let by_p1 = SVector::from([2.0 * xy, r2 + 2.0 * x.y * x.y]);
    let by_p2 = SVector::from([r2 + 2.0 * x.x * x.x, 2.0 * xy]);
    let distorted = radial + by_p1 * p1 + by_p2 * p2;
    let image = Point2::new(fx * distorted.x + skew * distorted.y + cx, fy * distorted.y + cy);

    // Columns: fx, skew, cx, fy, cy.
    let mut jacobian = SMatrix::<f64, 2, 10>::zeros();
    jacobian[(0, 0)] = distorted.x;
    jacobian[(0, 1)] = distorted.y;
    jacobian[(0, 2)] = 1.0;
    jacobian[(1, 3)] = distorted.y;
    jacobian[(1, 4)] = 1.0;

    // Columns: k1, k2, p1, p2, k3.
    let (k1, k2, k3) = (x.coords * r2, x.coords * (r2 * r2), x.coords * (r2 * r2 * r2));
    for (column, by) in [k1, k2, by_p1, by_p2, k3].into_iter().enumerate() {
        jacobian[(0, 5 + column)] = fx * by.x + skew * by.y;
        jacobian[(1, 5 + column)] = fy * by.y;
    }

    (image, jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAD: &str = "K11 = 422.2\nK12 = 0.0\nK13 = 330.1\nK21 = 0\nK22 = 424.2\nK23 = 210.3\nK31 = 0\nK32 = 0\nK33 = 1\n\n\
                       kc1 = -0.281\nkc2 = 0.075\nkc3 = 0.0004\nkc4 = -0.0001\n";
    const SIZE: Option<(u32, u32)> = Some((659, 494));

    #[test]
    fn a_matrix_with_the_files_k_is_a_camera_of_k_and_kc() {
        let lens = read(RAD).unwrap();
        let (k, distortion) = (lens.k, lens.distortion);
        let (found, misfit) = lens.behind(&k, SIZE);
        assert_eq!((found.k, found.distortion), (k, distortion));
        // The precision at which distortion is undone, times the focal length.
        assert!(misfit.max_px < 1e-6, "{}", misfit.max_px);
    }

    #[test]
    fn a_matrix_of_another_focal_length_is_fitted_exactly() {
        let rad = read(RAD).unwrap();
        let scaled = |factor: f64| {
            let mut k = rad.k;
            k[(0, 0)] *= factor;
            k[(1, 1)] *= factor;
            k
        };
        // Scaled radial and tangential coefficients absorb a scale of the focal length.
        let (lens, misfit) = read(RAD).unwrap().behind(&scaled(1.05), SIZE);
        assert!(misfit.max_px < 1e-6, "{}", misfit.max_px);
        assert!((lens.distortion.coefficients()[0] + 0.281 * 1.05_f64.powi(2)).abs() < 1e-6);
    }

    #[test]
    fn a_shifted_principal_point_is_fitted_except_in_the_corners() {
        let mut k = read(RAD).unwrap().k;
        k[(0, 2)] -= 6.0;
        k[(1, 2)] += 15.0;
        let (_, misfit) = read(RAD).unwrap().behind(&k, SIZE);
        // An independent minimiser finds 0.766 and 6.07 px on another grid.
        assert!((misfit.rms_px - 0.77).abs() < 0.03 && (misfit.max_px - 6.07).abs() < 0.1);
    }

    #[test]
    fn without_distortion_the_matrix_alone_is_the_lens() {
        let text =
            RAD.replace("-0.281", "0").replace("0.075", "0").replace("0.0004", "0").replace("-0.0001", "0");
        let k = Matrix3::new(400.0, 1.0, 300.0, 0.0, 410.0, 200.0, 0.0, 0.0, 1.0);
        let (lens, misfit) = read(&text).unwrap().behind(&k, None);
        assert_eq!((lens.k, misfit.max_px), (k, 0.0));
        assert!(lens.distortion.is_none());
    }

    #[test]
    fn a_truncated_file_and_a_nan_are_refused() {
        let message = |text: &str| read(text).err().unwrap().to_string();
        let cut = message(&RAD[..51]);
        assert!(cut.starts_with("expected a line `K23 = ..`, found none in 5 lines"), "{cut}");
        let nan = message(&RAD.replace("424.2", "nan"));
        assert_eq!(nan, "line 5: expected finite numbers, found nan; calibrate again");
        assert!(message(&RAD.replace("422.2", "-1")).contains("K11 = -1"));
    }
}
