//! Cameras from bare projection matrices: which sign, and whether their world is mirrored.
//!
//! `P` and `-P` are the same camera, and files have either. The left 3x3 part of `K [R t]` has a positive determinant,
//! which decides the sign. In a mirrored world the determinant is negative; with the sign flipped the camera then
//! stands beyond the scene and looks away from it. One such camera is no evidence; if most of a rig look away from the
//! point at which their axes meet, the world is taken as mirrored, and its y axis is flipped.

use crate::camera::decompose;
use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3, Matrix3x4, Matrix4, Point3, Vector3, Vector4};

/// A projection matrix `K [R t]` in its factors.
pub(super) struct Pinhole {
    pub(super) k: Matrix3<f64>,
    pub(super) cam_from_world: Isometry3<f64>,
}

/// Decomposes the named matrices, and notes flipped signs, a mirrored world, and cameras that look away.
///
/// # Errors
/// A matrix that is singular or not finite.
pub(super) fn pinholes(named: &[(String, Matrix3x4<f64>)]) -> Result<(Vec<Pinhole>, Vec<String>)> {
    let as_found = decomposed(named)?;
    let looks_away = looking_away(&as_found);
    let away = looks_away.iter().filter(|&&away| away).count();

    let mut notes = Vec::new();
    if 2 * away <= named.len() {
        note_signs(named, &mut notes);
        if away > 0 {
            let list = list(named, &looks_away);
            notes.push(format!(
                "cameras that look away from the point where the axes meet: {list}; check their matrices"
            ));
        }
        return Ok((as_found, notes));
    }

    // Most cameras look away: the world is left-handed.
    let upright: Vec<_> = named.iter().map(|(name, p)| (name.clone(), p * mirror())).collect();
    notes.push(format!(
        "the world is mirrored (in a right-handed one {away} of {} cameras look away from where their axes \
         meet): its y axis is flipped",
        named.len()
    ));
    note_signs(&upright, &mut notes);
    Ok((decomposed(&upright)?, notes))
}

fn mirror() -> Matrix4<f64> {
    Matrix4::from_diagonal(&Vector4::new(1.0, -1.0, 1.0, 1.0))
}

fn decomposed(named: &[(String, Matrix3x4<f64>)]) -> Result<Vec<Pinhole>> {
    let pinhole = |(name, p): &(String, Matrix3x4<f64>)| {
        let (k, cam_from_world) = decompose(p).ok_or_else(|| {
            let problem = "expected a 3x4 projection matrix whose left 3x3 part can be inverted, found a singular \
                           one; calibrate again";
            Error::camera(name, problem)
        })?;
        Ok(Pinhole { k, cam_from_world })
    };
    named.iter().map(pinhole).collect()
}

/// Whether each camera has the point at which the axes meet behind it; all false where there is no such point.
fn looking_away(cameras: &[Pinhole]) -> Vec<bool> {
    let axes: Vec<_> = cameras.iter().map(|camera| axis(&camera.cam_from_world)).collect();
    let meeting = meeting_point(&axes);
    axes.iter().map(|(eye, forward)| meeting.is_some_and(|p| (p - eye).dot(forward) < 0.0)).collect()
}

/// The camera's centre and viewing direction, in the world.
fn axis(cam_from_world: &Isometry3<f64>) -> (Point3<f64>, Vector3<f64>) {
    let eye = cam_from_world.inverse_transform_point(&Point3::origin());
    (eye, cam_from_world.inverse_transform_vector(&Vector3::z()))
}

/// The point nearest to all lines in the least-squares sense; `None` where they are parallel within about a degree.
fn meeting_point(lines: &[(Point3<f64>, Vector3<f64>)]) -> Option<Point3<f64>> {
    let (mut across, mut offset) = (Matrix3::zeros(), Vector3::zeros());
    for (point, direction) in lines {
        let projection = Matrix3::identity() - direction * direction.transpose();
        across += projection;
        offset += projection * point.coords;
    }
    let least = across.symmetric_eigenvalues().min() / lines.len() as f64;
    (least > 1e-4).then(|| across.try_inverse())?.map(|inverse| Point3::from(inverse * offset))
}

fn note_signs(named: &[(String, Matrix3x4<f64>)], notes: &mut Vec<String>) {
    let negative = |(_, p): &(String, Matrix3x4<f64>)| p.fixed_columns::<3>(0).determinant() < 0.0;
    let negative: Vec<_> = named.iter().map(negative).collect();
    if negative.contains(&true) {
        notes.push(format!("signs flipped: the matrices of {} give negative depths", list(named, &negative)));
    }
}

/// The names of the marked cameras.
fn list(named: &[(String, Matrix3x4<f64>)], marked: &[bool]) -> String {
    let names: Vec<_> =
        named.iter().zip(marked).filter(|(_, marked)| **marked).map(|((name, _), _)| &**name).collect();
    if names.len() == named.len() { "all cameras".into() } else { names.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    /// Four cameras around the origin, no two at the same height or distance.
    fn ring() -> Vec<(String, Matrix3x4<f64>)> {
        let eyes = [[3.0, 0.1, 1.0], [0.2, 2.5, 1.5], [-2.8, 0.3, 0.8], [-0.4, -3.1, 2.0]];
        let camera = |(i, eye): (usize, [f64; 3])| {
            let name = format!("cam{i}");
            let eye = Point3::from(eye);
            let camera =
                Camera::look_at(&name, (640, 480), 1.0, eye, Point3::origin(), Vector3::z()).unwrap();
            (name, camera.projection_matrix())
        };
        eyes.into_iter().enumerate().map(camera).collect()
    }

    /// The largest distance in pixels between the projections of some points by the matrices and by the cameras.
    fn projection_error(
        matrices: &[(String, Matrix3x4<f64>)],
        cameras: &[Pinhole],
        turn: Matrix4<f64>,
    ) -> f64 {
        let points = [[0.0, 0.0, 0.0, 1.0], [0.3, -0.2, 0.5, 1.0], [-0.4, 0.1, 0.2, 1.0]].map(Vector4::from);
        let mut largest: f64 = 0.0;

        for ((_, p), camera) in matrices.iter().zip(cameras) {
            let ours = camera.k * camera.cam_from_world.to_homogeneous().fixed_rows::<3>(0);
            for point in points {
                let (a, b) = (p * point, ours * turn * point);
                assert!(b.z > 0.0);

                largest = largest.max((a.xy() / a.z - b.xy() / b.z).amax());
            }
        }
        largest
    }

    #[test]
    fn scale_and_sign_of_a_matrix_do_not_change_the_camera() {
        let plain = ring();
        let (cameras, notes) = pinholes(&plain).unwrap();
        assert!(notes.is_empty() && projection_error(&plain, &cameras, Matrix4::identity()) < 1e-9);

        let mut turned = ring();
        turned[1].1 *= -7.5;
        turned[2].1 *= 1e-3;
        let (cameras, notes) = pinholes(&turned).unwrap();
        assert!(projection_error(&plain, &cameras, Matrix4::identity()) < 1e-9);
        assert_eq!(notes, ["signs flipped: the matrices of cam1 give negative depths"]);
    }

    #[test]
    fn a_mirrored_world_is_mirrored_back_whatever_the_signs() {
        for sign in [1.0, -1.0] {
            let mut mirrored = ring();
            for (_, p) in &mut mirrored {
                *p *= Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, -1.0, 1.0));
            }

            mirrored[3].1 *= sign;
            let (cameras, notes) = pinholes(&mirrored).unwrap();
            assert!(projection_error(&mirrored, &cameras, mirror()) < 1e-9);
            assert!(
                notes[0].contains("4 of 4 cameras look away") && notes[0].contains("y axis"),
                "{notes:?}"
            );
            assert_eq!(notes.len(), if sign < 0.0 { 2 } else { 1 }, "{notes:?}");
        }
    }

    #[test]
    fn a_single_camera_or_parallel_ones_are_never_taken_as_mirrored() {
        let mut one = ring();
        one.truncate(1);
        one[0].1 *= mirror();
        assert_eq!(pinholes(&one).unwrap().1.len(), 1);
        let twice = vec![one[0].clone(), one[0].clone()];
        assert!(pinholes(&twice).unwrap().1[0].starts_with("signs flipped: the matrices of all cameras"));
    }

    #[test]
    fn a_single_camera_that_looks_away_is_named() {
        let mut rig = ring();
        let eye = Point3::new(2.0, 2.0, 1.2);
        let away = Camera::look_at("away", (640, 480), 1.0, eye, eye + eye.coords, Vector3::z()).unwrap();
        rig.push(("away".into(), away.projection_matrix()));
        let notes = pinholes(&rig).unwrap().1;
        assert_eq!(
            notes,
            ["cameras that look away from the point where the axes meet: away; check their matrices"]
        );
    }

    #[test]
    fn a_singular_matrix_is_refused_by_name() {
        let mut rig = ring();
        rig[2].1.row_mut(1).fill(0.0);
        let message = pinholes(&rig).err().unwrap().to_string();
        assert!(message.starts_with("camera \"cam2\": expected a 3x4 projection matrix"), "{message}");
    }
}
