//! One calibrated view: from the world to an image and back.
//!
//! ```text
//!        z (forward)          (0,0) ---- u
//!       /                       | pixel (i, j) covers [i, i+1) x [j, j+1)
//!      o---- x (right)          |
//!      |                        v
//!      y (down)
//! ```
//!
//! `cam_from_world` maps world to camera, `x_cam = R x_world + t`. The image's upper-left *corner* is (0, 0), the
//! first pixel's centre (0.5, 0.5): readers of files whose pixel centres are whole numbers (OpenCV and kin) shift
//! the principal point by one half. Lengths in metres, images in pixels.

mod distortion;
mod fisheye;
mod floor;
mod footprint;
pub(crate) mod frustum;
mod image_line;
mod lens;

pub use distortion::Distortion;
pub use fisheye::Fisheye;
pub(crate) use floor::{floor, floor_pixel};
pub(crate) use footprint::Footprint;
pub(crate) use image_line::{CellExit, ImageLine, border_ahead};
pub use lens::Lens;

use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3, Matrix3x4, Point2, Point3, Rotation3, UnitQuaternion, Vector3};

/// The smallest depth at which a camera sees a point: nearer ones count as behind it.
pub const MIN_DEPTH: f64 = 1e-6;

/// The most pixels that an image may have: no product of sizes overflows, and what is kept per pixel fits in memory.
const MOST_PIXELS: u64 = 1 << 28;

/// Where a world point appears in an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel {
    /// Rightwards, in pixels from the image's left edge.
    pub u: f64,
    /// Downwards, in pixels from the image's upper edge.
    pub v: f64,
    /// Distance along the camera's z axis, in metres.
    pub depth: f64,
}

/// A half-line in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Point3<f64>,
    /// Unit direction.
    pub direction: Vector3<f64>,
}

impl Ray {
    /// The point at distance `t` metres.
    pub fn at(&self, t: f64) -> Point3<f64> {
        self.origin + self.direction * t
    }
}

/// A calibrated camera: a pinhole, or one of OpenCV's lenses.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    name: String,
    width: u32,
    height: u32,
    intrinsics: Matrix3<f64>,
    intrinsics_inverse: Matrix3<f64>,
    lens: Lens,
    cam_from_world: Isometry3<f64>,
}

impl Camera {
    /// A camera of `size` (width, height) pixels with intrinsic matrix `k` (`[[fx, s, cx], [0, fy, cy], [0, 0, 1]]`
    /// in pixels, corner convention).
    ///
    /// # Errors
    /// A size of zero or above 65,535, more than 2^28 pixels in all, a number that is not finite, a focal length that
    /// is not positive, a last row other than `0 0 1`, a rotation that is none. A [`Fisheye`] whose image shows rays at
    /// 90 degrees or more from its axis, or whose model folds back all around the axis inside the image: a calibration
    /// finds corners at least up to the nearest border. What lies beyond a fold farther out is unseen.
    pub fn new(
        name: impl Into<String>,
        size: (u32, u32),
        k: Matrix3<f64>,
        lens: impl Into<Lens>,
        cam_from_world: Isometry3<f64>,
    ) -> Result<Self> {
        let name = name.into();
        let fail = |problem: String| Err(Error::camera(&name, problem));
        let (width, height) = size;
        if width == 0 || height == 0 || width > 65_535 || height > 65_535 {
            return fail(format!(
                "expected an image size from 1 to 65535 pixels, found {width} x {height}; give width and height as \
                 calibrated"
            ));
        }
        if u64::from(width) * u64::from(height) > MOST_PIXELS {
            return fail(format!(
                "expected at most {MOST_PIXELS} pixels in all, found {width} x {height}; scale the images down"
            ));
        }
        if !k.iter().all(|x| x.is_finite()) {
            return fail(format!("expected finite intrinsics, found K = {}; calibrate again", rows(&k)));
        }
        let pose = cam_from_world.to_homogeneous();
        if !pose.iter().all(|x| x.is_finite()) {
            return fail(
                "expected a finite pose, found NaN or infinity in rotation or translation; calibrate again"
                    .into(),
            );
        }
        let length = cam_from_world.rotation.norm();
        if (length - 1.0).abs() > 1e-6 {
            return fail(format!(
                "expected a rotation, found a quaternion of length {length}; normalise it or calibrate again"
            ));
        }
        if k[(0, 0)] <= 0.0 || k[(1, 1)] <= 0.0 {
            return fail(format!(
                "expected positive focal lengths, found fx = {}, fy = {}; K is singular or mirrored: calibrate again",
                k[(0, 0)],
                k[(1, 1)]
            ));
        }
        if k[(1, 0)] != 0.0 || k[(2, 0)] != 0.0 || k[(2, 1)] != 0.0 || (k[(2, 2)] - 1.0).abs() > 1e-9 {
            return fail(format!(
                "expected K upper triangular with last row 0 0 1, found K = {}; scale it or swap its rows",
                rows(&k)
            ));
        }
        let projection = k * pose.fixed_rows::<3>(0);
        let inverse =
            k.try_inverse().filter(|inverse| inverse.iter().chain(&projection).all(|x| x.is_finite()));
        let Some(intrinsics_inverse) = inverse else {
            return fail(format!(
                "expected an invertible K, found one out of the range of numbers, K = {}; calibrate again",
                rows(&k)
            ));
        };
        let none = Lens::none();
        let pinhole =
            Self { name, width, height, intrinsics: k, intrinsics_inverse, lens: none, cam_from_world };
        pinhole.with_lens(lens)
    }

    /// This camera with another lens.
    ///
    /// # Errors
    /// A [`Fisheye`] that cannot have made its image, as [`Camera::new`] has it.
    pub fn with_lens(self, lens: impl Into<Lens>) -> Result<Self> {
        let lens = lens.into();
        let size = (self.width, self.height);
        lens.check_image(&self.intrinsics_inverse, size)
            .map_err(|problem| Error::camera(&self.name, problem))?;
        Ok(Self { lens, ..self })
    }

    /// A pinhole camera from its projection matrix `p` (world to image, any scale but zero).
    ///
    /// # Errors
    /// A matrix that is not finite or whose left 3x3 part is singular, and all that [`Camera::new`] refuses.
    pub fn from_projection(name: impl Into<String>, size: (u32, u32), p: &Matrix3x4<f64>) -> Result<Self> {
        let name = name.into();
        let Some((k, cam_from_world)) = decompose(p) else {
            let problem = "expected a finite 3x4 projection matrix whose left 3x3 part can be inverted, found a \
                           singular or NaN one; calibrate again";
            return Err(Error::camera(name, problem));
        };
        Self::new(name, size, k, Lens::none(), cam_from_world)
    }

    /// A pinhole camera at `eye` that looks at `target`, its image's upper edge towards `up`, with
    /// square pixels and a horizontal field of view in radians.
    ///
    /// # Errors
    /// `eye` equal to `target`, `up` parallel to the view, a field of view outside (0, pi).
    pub fn look_at(
        name: impl Into<String>,
        size: (u32, u32),
        horizontal_fov: f64,
        eye: Point3<f64>,
        target: Point3<f64>,
        up: Vector3<f64>,
    ) -> Result<Self> {
        let name = name.into();
        let view = target - eye;
        let across = view.cross(&up).norm();
        if across.is_nan() || across <= 1e-9 * up.norm() {
            let problem =
                "expected eye and target apart, and up not parallel to the view between them; move one";
            return Err(Error::camera(name, problem));
        }
        if !(horizontal_fov > 0.0 && horizontal_fov < std::f64::consts::PI) {
            let problem =
                format!("expected a field of view between 0 and pi radians, found {horizontal_fov}");
            return Err(Error::camera(name, problem));
        }
        let focal = f64::from(size.0) / 2.0 / (horizontal_fov / 2.0).tan();
        let (cx, cy) = (f64::from(size.0) / 2.0, f64::from(size.1) / 2.0);
        let k = Matrix3::new(focal, 0.0, cx, 0.0, focal, cy, 0.0, 0.0, 1.0);
        // OpenCV's camera frame is the right-handed look-at frame turned half around its x axis.
        let graphics = Isometry3::look_at_rh(&eye, &target, &up);
        let opencv = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        Self::new(name, size, k, Lens::none(), Isometry3::from_parts([0.0; 3].into(), opencv) * graphics)
    }

    /// The camera's name, unique in its rig.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Image width and height, in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The intrinsic matrix, in pixels, corner convention.
    pub fn intrinsics(&self) -> &Matrix3<f64> {
        &self.intrinsics
    }

    /// The lens.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// World to camera.
    pub fn cam_from_world(&self) -> &Isometry3<f64> {
        &self.cam_from_world
    }

    /// The centre of projection in the world.
    pub fn centre(&self) -> Point3<f64> {
        self.cam_from_world.inverse_transform_point(&Point3::origin())
    }

    /// The unit viewing direction in the world.
    pub fn forward(&self) -> Vector3<f64> {
        self.cam_from_world.inverse_transform_vector(&Vector3::z())
    }

    /// `P = K [R t]`, the projection without the lens; its third component is the depth in metres.
    pub fn projection_matrix(&self) -> Matrix3x4<f64> {
        self.intrinsics * self.cam_from_world.to_homogeneous().fixed_rows::<3>(0)
    }

    /// Where `world` appears, lens included; `None` when it is behind the camera, or so far off the axis that the lens
    /// model folds back.
    pub fn project(&self, world: &Point3<f64>) -> Option<Pixel> {
        let cam = self.cam_from_world * world;
        if cam.z.is_nan() || cam.z <= MIN_DEPTH {
            return None;
        }
        let distorted = self.lens.distort(Point2::new(cam.x / cam.z, cam.y / cam.z))?;
        let image = self.intrinsics * distorted.to_homogeneous();
        Some(Pixel { u: image.x, v: image.y, depth: cam.z })
    }

    /// Whether `world` appears in the image, lens included.
    pub fn sees(&self, world: &Point3<f64>) -> bool {
        let (w, h) = (f64::from(self.width), f64::from(self.height));
        self.project(world).is_some_and(|p| (0.0..w).contains(&p.u) && (0.0..h).contains(&p.v))
    }

    /// The world point at `depth` metres behind image position `(u, v)`; `None` beyond the lens model's range.
    pub fn unproject(&self, u: f64, v: f64, depth: f64) -> Option<Point3<f64>> {
        let image = self.intrinsics_inverse * Vector3::new(u, v, 1.0);
        let flat = self.lens.undistort(Point2::new(image.x, image.y))?;
        let cam = Point3::new(flat.x * depth, flat.y * depth, depth);
        Some(self.cam_from_world.inverse_transform_point(&cam))
    }

    /// The viewing ray of image position `(u, v)`, from the camera's centre.
    pub fn ray(&self, u: f64, v: f64) -> Option<Ray> {
        let through = self.unproject(u, v, 1.0)?;
        let origin = self.centre();
        Some(Ray { origin, direction: (through - origin).normalize() })
    }
}

/// Intrinsic matrix and pose of a projection matrix of any scale and either sign; `None` where it is not finite or its
/// left 3x3 part singular.
pub(crate) fn decompose(p: &Matrix3x4<f64>) -> Option<(Matrix3<f64>, Isometry3<f64>)> {
    let left: Matrix3<f64> = p.fixed_columns::<3>(0).into();
    let scale = left.row(2).norm();
    let condition = left.determinant().abs() / left.row(0).norm() / left.row(1).norm() / scale;
    if !p.iter().all(|x| x.is_finite()) || condition.is_nan() || condition <= 1e-12 {
        return None;
    }
    let p = p * (left.determinant().signum() / scale);
    let left: Matrix3<f64> = p.fixed_columns::<3>(0).into();
    let (k, r) = upper_triangular_times_rotation(&left);
    let t = k.try_inverse()? * p.column(3);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(r));
    Some((k, Isometry3::from_parts(t.into(), rotation)))
}

/// `m = k r` with `k` upper triangular, positive diagonal, `k[2][2] = 1`, and `r` a rotation, for `m` of positive
/// determinant whose last row has length 1.
fn upper_triangular_times_rotation(m: &Matrix3<f64>) -> (Matrix3<f64>, Matrix3<f64>) {
    let (m0, m1, m2) = (m.row(0).transpose(), m.row(1).transpose(), m.row(2).transpose());
    let r2 = m2.normalize();
    let cy = m1.dot(&r2);
    let fy = (m1 - r2 * cy).norm();
    let r1 = (m1 - r2 * cy) / fy;
    let cx = m0.dot(&r2);
    let skew = m0.dot(&r1);
    let r0 = r1.cross(&r2);
    let fx = m0.dot(&r0);
    let k = Matrix3::new(fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0);
    (k, Matrix3::from_rows(&[r0.transpose(), r1.transpose(), r2.transpose()]))
}

fn rows(m: &Matrix3<f64>) -> String {
    let row = |r: usize| format!("[{}, {}, {}]", m[(r, 0)], m[(r, 1)], m[(r, 2)]);
    format!("[{}, {}, {}]", row(0), row(1), row(2))
}

#[cfg(test)]
mod tests;
