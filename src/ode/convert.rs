//! Conversions between nalgebra's types and ODE's arrays.

use crate::hull::Aabb;
use nalgebra::{Isometry3, Matrix3, Point3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use ode_sys::{
    dGeomGetAABB, dGeomGetRelPointPos, dGeomID, dGeomVectorToWorld, dMatrix3, dQuaternion, dReal, dVector3,
};

/// The first three numbers of an ODE vector.
///
/// # Safety
///
/// `at` points to at least three readable numbers.
pub(super) unsafe fn vector_at(at: *const dReal) -> Vector3<f64> {
    // SAFETY: the caller guarantees three readable numbers.
    unsafe { Vector3::new(*at, *at.add(1), *at.add(2)) }
}

/// The vector in the first three numbers of ODE's padded vector.
pub(super) fn vector(from: &dVector3) -> Vector3<f64> {
    Vector3::new(from[0], from[1], from[2])
}

/// The point in the first three numbers of ODE's padded vector.
pub(super) fn point(from: &dVector3) -> Point3<f64> {
    vector(from).into()
}

/// ODE's padded vector, whose fourth number is unused.
pub(super) fn ode_vector(from: &Vector3<f64>) -> dVector3 {
    [from.x, from.y, from.z, 0.0]
}

/// ODE's quaternion, with the real part first.
pub(super) fn ode_quaternion(from: &UnitQuaternion<f64>) -> dQuaternion {
    [from.w, from.i, from.j, from.k]
}

/// The rotation of one of ODE's quaternions, which ODE keeps normalised.
pub(super) fn rotation(from: &dQuaternion) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(from[0], from[1], from[2], from[3]))
}

/// The pose made of a position and one of ODE's normalised quaternions.
pub(super) fn pose(position: &dVector3, quaternion: &dQuaternion) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(vector(position)), rotation(quaternion))
}

/// The pose of a geom of any class: the transform from its frame to the world's. It is the identity for a geom that
/// cannot be placed, such as a plane.
///
/// # Safety
///
/// `geom` is alive.
pub(super) unsafe fn any_pose(geom: dGeomID) -> Isometry3<f64> {
    // Both functions also accept geoms that cannot be placed, for which ODE's getters of position and rotation abort.
    let axis_in_world = |x, y, z| {
        let mut axis = [0.0; 4];
        // SAFETY: the caller guarantees a living geom; the array holds four numbers.
        unsafe { dGeomVectorToWorld(geom, x, y, z, axis.as_mut_ptr()) };
        vector(&axis)
    };
    let mut position = [0.0; 4];
    // SAFETY: the caller guarantees a living geom; the array holds four numbers.
    unsafe { dGeomGetRelPointPos(geom, 0.0, 0.0, 0.0, position.as_mut_ptr()) };

    let axes = Matrix3::from_columns(&[
        axis_in_world(1.0, 0.0, 0.0),
        axis_in_world(0.0, 1.0, 0.0),
        axis_in_world(0.0, 0.0, 1.0),
    ]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    Isometry3::from_parts(Translation3::from(vector(&position)), rotation)
}

/// The bounding box of a geom or a space.
///
/// # Safety
///
/// `geom` is alive.
pub(super) unsafe fn aabb_of(geom: dGeomID) -> Aabb {
    let mut bounds = [0.0; 6];
    // SAFETY: the caller guarantees a living geom; the array holds six numbers.
    unsafe { dGeomGetAABB(geom, bounds.as_mut_ptr()) };
    let [x0, x1, y0, y1, z0, z1] = bounds;
    Aabb { min: Point3::new(x0, y0, z0), max: Point3::new(x1, y1, z1) }
}

/// ODE's row-major 3x3 matrix, each row padded to four numbers.
pub(super) fn ode_matrix(from: &Matrix3<f64>) -> dMatrix3 {
    std::array::from_fn(|i| if i % 4 < 3 { from[(i / 4, i % 4)] } else { 0.0 })
}

/// The matrix in ODE's row-major 3x3 matrix, each row padded to four numbers.
pub(super) fn matrix(from: &dMatrix3) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| from[4 * row + column])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_is_unchanged_by_the_conversion_to_ode_and_back() {
        let ours = Matrix3::from_fn(|row, column| (10 * row + column) as f64);
        let theirs = ode_matrix(&ours);
        assert_eq!(theirs, [0.0, 1.0, 2.0, 0.0, 10.0, 11.0, 12.0, 0.0, 20.0, 21.0, 22.0, 0.0]);
        assert_eq!(matrix(&theirs), ours);
    }

    #[test]
    fn a_quaternion_is_unchanged_by_the_conversion_to_ode_and_back() {
        let ours = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
        assert_eq!(rotation(&ode_quaternion(&ours)), ours);
        assert_eq!(ode_quaternion(&UnitQuaternion::identity()), [1.0, 0.0, 0.0, 0.0]);
    }
}
