//! nalgebra's types to ODE's arrays and back.

use nalgebra::{Isometry3, Matrix3, Point3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use ode_sys::{dGeomGetRelPointPos, dGeomID, dGeomVectorToWorld, dMatrix3, dQuaternion, dReal, dVector3};

/// The first three numbers of an ODE vector.
///
/// # Safety
///
/// `at` points to at least three readable numbers.
pub(super) unsafe fn vector_at(at: *const dReal) -> Vector3<f64> {
    // SAFETY: the caller vouches for three numbers.
    unsafe { Vector3::new(*at, *at.add(1), *at.add(2)) }
}

pub(super) fn vector(from: &dVector3) -> Vector3<f64> {
    Vector3::new(from[0], from[1], from[2])
}

pub(super) fn point(from: &dVector3) -> Point3<f64> {
    vector(from).into()
}

/// ODE's padded vector; the fourth number is unused.
pub(super) fn ode_vector(from: &Vector3<f64>) -> dVector3 {
    [from.x, from.y, from.z, 0.0]
}

/// ODE's quaternion: the real part comes first.
pub(super) fn ode_quaternion(from: &UnitQuaternion<f64>) -> dQuaternion {
    [from.w, from.i, from.j, from.k]
}

/// ODE keeps its quaternions normalised.
pub(super) fn rotation(from: &dQuaternion) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(from[0], from[1], from[2], from[3]))
}

pub(super) fn pose(position: &dVector3, quaternion: &dQuaternion) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(vector(position)), rotation(quaternion))
}

/// The pose of any geom, the identity for one that cannot be placed: through the functions that ODE answers for every
/// class.
///
/// # Safety
///
/// `geom` is alive.
pub(super) unsafe fn any_pose(geom: dGeomID) -> Isometry3<f64> {
    let axis = |x, y, z| {
        let mut turned = [0.0; 4];
        // SAFETY: the caller vouches for the geom; the array holds four numbers.
        unsafe { dGeomVectorToWorld(geom, x, y, z, turned.as_mut_ptr()) };
        vector(&turned)
    };
    let mut position = [0.0; 4];
    // SAFETY: as above.
    unsafe { dGeomGetRelPointPos(geom, 0.0, 0.0, 0.0, position.as_mut_ptr()) };
    let turned = Matrix3::from_columns(&[axis(1.0, 0.0, 0.0), axis(0.0, 1.0, 0.0), axis(0.0, 0.0, 1.0)]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turned));
    Isometry3::from_parts(Translation3::from(vector(&position)), rotation)
}

/// ODE's padded, row-major matrix.
pub(super) fn ode_matrix(from: &Matrix3<f64>) -> dMatrix3 {
    std::array::from_fn(|i| if i % 4 < 3 { from[(i / 4, i % 4)] } else { 0.0 })
}

pub(super) fn matrix(from: &dMatrix3) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| from[4 * row + column])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_survives_the_way_there_and_back() {
        let ours = Matrix3::from_fn(|row, column| (10 * row + column) as f64);
        let theirs = ode_matrix(&ours);
        assert_eq!(theirs, [0.0, 1.0, 2.0, 0.0, 10.0, 11.0, 12.0, 0.0, 20.0, 21.0, 22.0, 0.0]);
        assert_eq!(matrix(&theirs), ours);
    }

    #[test]
    fn a_quaternion_survives_the_way_there_and_back() {
        let ours = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
        assert_eq!(rotation(&ode_quaternion(&ours)), ours);
        assert_eq!(ode_quaternion(&UnitQuaternion::identity()), [1.0, 0.0, 0.0, 0.0]);
    }
}
