//! Checks and conversions of the C functions' arguments.

use crate::camera::{Camera, Lens};
use crate::hull::HullData;
use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use ode_sys::{dContact, dGeomID, dReal};
use std::ffi::c_int;
use std::slice;

/// The largest deviation of a contact normal's length from 1.
const MAX_NORMAL_DEVIATION: f64 = 1e-3;

/// Refuses a geom that is NULL.
pub(super) fn not_null(geom: dGeomID, what: &str) -> Result<()> {
    if geom.is_null() { Err(Error::argument(format!("{what}: expected a geom, found NULL"))) } else { Ok(()) }
}

/// A view's index, which must not be negative.
pub(super) fn index(view: c_int) -> Result<usize> {
    usize::try_from(view)
        .map_err(|_| Error::argument(format!("view: expected an index from 0, found {view}")))
}

/// A count from 0 to `max`.
pub(super) fn count(n: c_int, max: c_int, what: &str) -> Result<usize> {
    if (0..=max).contains(&n) {
        Ok(n as usize)
    } else {
        Err(Error::argument(format!("{what}: expected 0 to {max}, found {n}")))
    }
}

/// A point, whose coordinates must be finite.
pub(super) fn finite_point(x: dReal, y: dReal, z: dReal) -> Result<Point3<f64>> {
    if [x, y, z].iter().all(|number| number.is_finite()) {
        Ok(Point3::new(x, y, z))
    } else {
        Err(Error::argument(format!("point: expected finite coordinates, found ({x}, {y}, {z})")))
    }
}

/// The length of a step in seconds, which must be finite and not negative.
pub(super) fn step_size(seconds: dReal) -> Result<f64> {
    if seconds >= 0.0 && seconds.is_finite() {
        Ok(seconds)
    } else {
        Err(Error::argument(format!(
            "stepsize: expected finite seconds, 0 or more, found {seconds}; pass the stepsize of the next step"
        )))
    }
}

/// The caller's contact, which must have two geoms, a finite position and a unit normal.
///
/// # Safety
/// `contact` is NULL, or points to a contact that nothing else uses as long as the result lives.
pub(super) unsafe fn contact<'a>(contact: *mut dContact) -> Result<&'a mut dContact> {
    // SAFETY: the caller guarantees a contact.
    let contact = unsafe { contact.as_mut() }
        .ok_or_else(|| Error::argument("contact: expected one that dCollide has filled, found NULL"))?;
    not_null(contact.geom.g1, "contact->geom.g1")?;
    not_null(contact.geom.g2, "contact->geom.g2")?;

    let [x, y, z, _] = contact.geom.pos;
    finite_point(x, y, z)?;
    let [x, y, z, _] = contact.geom.normal;
    let length = Vector3::new(x, y, z).norm();
    if length.is_nan() || (length - 1.0).abs() > MAX_NORMAL_DEVIATION {
        return Err(Error::argument(format!(
            "contact->geom.normal: expected a unit vector, found ({x}, {y}, {z}) of length {length}"
        )));
    }
    Ok(contact)
}

/// The calibration of a camera without its lens.
pub(super) struct CameraArguments {
    k: Matrix3<f64>,
    pose: Isometry3<f64>,
    size: (u32, u32),
}

impl CameraArguments {
    /// Reads the intrinsic matrix, and the rotation and translation from world to camera.
    ///
    /// # Safety
    /// `k` and `r` are NULL or point to nine numbers, and `t` is NULL or points to three.
    pub(super) unsafe fn read(
        k: *const dReal,
        r: *const dReal,
        t: *const dReal,
        width: c_int,
        height: c_int,
    ) -> Result<Self> {
        // SAFETY: the caller guarantees arrays of these lengths.
        let (k, r, t) = unsafe { (numbers(k, 9, "K")?, numbers(r, 9, "R")?, numbers(t, 3, "t")?) };
        let pose = Isometry3::from_parts(Translation3::new(t[0], t[1], t[2]), rotation(r)?);
        Ok(Self { k: Matrix3::from_row_slice(k), pose, size: image_size(width, height)? })
    }

    /// The camera with this lens, named after the index that the next view of `data` gets.
    pub(super) fn with_lens(self, data: &HullData, lens: impl Into<Lens>) -> Result<Camera> {
        Camera::new(format!("view {}", data.view_count()), self.size, self.k, lens, self.pose)
    }
}

/// The coefficients of a lens model.
///
/// # Safety
/// `from` is NULL or points to `n` numbers, which outlive the result. It may be NULL if `n` is 0.
pub(super) unsafe fn coefficients<'a>(from: *const dReal, n: usize, what: &str) -> Result<&'a [dReal]> {
    // SAFETY: the caller guarantees `n` numbers.
    if n == 0 { Ok(&[]) } else { unsafe { numbers(from, n, what) } }
}

/// The size of an image, which must not be negative. `Camera` refuses 0.
pub(super) fn image_size(width: c_int, height: c_int) -> Result<(u32, u32)> {
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width), Ok(height)) => Ok((width, height)),
        _ => Err(Error::argument(format!(
            "expected an image size of 1 pixel or more, found {width} x {height}"
        ))),
    }
}

/// The caller's array of `n` numbers.
///
/// # Safety
/// `from` is NULL or points to `n` numbers, which outlive the result.
pub(super) unsafe fn numbers<'a>(from: *const dReal, n: usize, what: &str) -> Result<&'a [dReal]> {
    if from.is_null() {
        return Err(Error::argument(format!("{what}: expected {n} numbers, found NULL")));
    }
    // SAFETY: the caller guarantees `n` numbers.
    Ok(unsafe { slice::from_raw_parts(from, n) })
}

/// A copy of the caller's array of `n` vectors.
///
/// # Safety
/// `from` is NULL or points to `n` vectors of three numbers, `stride` bytes apart.
pub(super) unsafe fn vectors(
    from: *const dReal,
    n: usize,
    stride: c_int,
    what: &str,
) -> Result<Vec<Vector3<f64>>> {
    const MIN_STRIDE: c_int = 3 * size_of::<dReal>() as c_int;
    if from.is_null() || stride < MIN_STRIDE || !(stride as usize).is_multiple_of(align_of::<dReal>()) {
        let found = if from.is_null() { "NULL".to_owned() } else { format!("a stride of {stride} bytes") };
        return Err(Error::argument(format!(
            "{what}: expected vectors of dReal at least {MIN_STRIDE} bytes apart, found {found}"
        )));
    }

    // SAFETY: the caller guarantees `n` vectors, which are aligned, since the stride is a multiple of the alignment.
    let at = |k: usize| unsafe { slice::from_raw_parts(from.byte_add(k * stride as usize), 3) };
    Ok((0..n).map(|k| Vector3::from_row_slice(at(k))).collect())
}

/// Writes a vector to the caller's memory.
///
/// # Safety
/// `into` is NULL or points to writable memory for three numbers.
pub(super) unsafe fn write_vector(vector: Vector3<f64>, into: *mut dReal, what: &str) -> Result<()> {
    if into.is_null() {
        return Err(Error::argument(format!("{what}: expected memory for a vector, found NULL")));
    }
    for (k, number) in vector.iter().enumerate() {
        // SAFETY: the caller guarantees memory for three numbers.
        unsafe { into.add(k).write(*number) };
    }
    Ok(())
}

/// The rotation of a row-major matrix, which may deviate from orthonormal by the rounding of a calibration file.
fn rotation(rows: &[dReal]) -> Result<UnitQuaternion<f64>> {
    let matrix = Matrix3::from_row_slice(rows);
    let deviation = matrix * matrix.transpose() - Matrix3::identity();
    // Written so that NaN is refused too.
    if !deviation.iter().all(|x| x.abs() <= 1e-4) || matrix.determinant() < 0.0 {
        return Err(Error::argument(format!(
            "R: expected a rotation matrix of world to camera, row-major, found {rows:?}"
        )));
    }
    Ok(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&matrix)))
}
