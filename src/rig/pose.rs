//! Checks of rotations read from files, and the conversion between camera axes.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion};

/// How far `R^T R` of a rotation matrix may lie from the identity, per entry: files carry as few as four digits.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// The rotation nearest to `matrix`; or an error text that says how far the matrix is from a rotation.
pub(super) fn rotation(matrix: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, String> {
    let error = (matrix.transpose() * matrix - Matrix3::identity()).abs().max();
    if error.is_nan() || error > ROTATION_TOLERANCE || matrix.determinant() < 0.0 {
        return Err(format!(
            "expected an orthonormal matrix of determinant 1, found determinant {:.4} and R^T R {error:.1e} off the \
             identity; calibrate again",
            matrix.determinant()
        ));
    }
    let nearest = Rotation3::from_matrix_eps(matrix, 1e-15, 100, Rotation3::identity());
    Ok(UnitQuaternion::from_rotation_matrix(&nearest))
}

/// The rotation from OpenGL's camera axes (x right, y up, z backward) to OpenCV's, and back: 180 degrees about x.
pub(super) fn opengl_axes() -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, 0.0, 0.0))
}
