use super::*;
use image::{GrayImage, Luma};
use nalgebra::{Isometry3, Matrix3, Point3};
use ode_visual_hull::camera::{Camera, Distortion};
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::synthetic::{PERSON_PERIOD, Subject, layout, silhouette};
use std::sync::Arc;

const SIZE: (u32, u32) = (240, 320);

/// Five cameras around a person, at three heights.
fn cameras() -> Vec<Camera> {
    layout::staggered(5, 3.2, &[0.6, 1.6, 2.3], Point3::new(0.0, 0.0, 0.9), SIZE, 0.6).unwrap()
}

/// A camera with its principal point moved.
fn moved(camera: &Camera, by: Vector2<f64>) -> Camera {
    let mut k: Matrix3<f64> = *camera.intrinsics();
    k[(0, 2)] += by.x;
    k[(1, 2)] += by.y;
    let pose: Isometry3<f64> = *camera.cam_from_world();
    Camera::new(camera.name(), camera.size(), k, Distortion::none(), pose).unwrap()
}

/// Hulls of a walking person at six times, from masks of the `real` cameras and the calibration of `calibrated`.
fn hulls(real: &[Camera], calibrated: &[Camera]) -> Vec<Arc<Hull>> {
    let data = HullData::new();
    data.add_views(calibrated).unwrap();
    data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, -0.2), Point3::new(1.0, 1.0, 2.2)).unwrap()).unwrap();

    let hull = |k: u32| {
        let subject = Subject::person_at(f64::from(k) * PERSON_PERIOD / 6.0);
        for (view, camera) in real.iter().enumerate() {
            data.set_mask(view, &silhouette(camera, &subject)).unwrap();
        }
        data.update(f64::from(k)).unwrap()
    };
    (0..6).map(hull).collect()
}

fn shifts(real: &[Camera], calibrated: &[Camera]) -> Vec<ViewShift> {
    let mut tangency = EpipolarTangency::new();
    hulls(real, calibrated).iter().for_each(|hull| tangency.add(hull));
    tangency.shifts()
}

#[test]
fn silhouettes_of_one_subject_agree() {
    let cameras = cameras();
    for shift in shifts(&cameras, &cameras) {
        // Binary masks: each edge is known to half a pixel.
        assert!(shift.error < 0.5 && shift.shift.norm() < 0.5 && shift.planes >= 24, "{shift:?}");
    }
}

#[test]
fn a_view_whose_principal_point_is_off_is_distinguished_from_the_others() {
    let real = cameras();
    let by = Vector2::new(6.0, -5.0);
    let mut calibrated = real.clone();
    calibrated[2] = moved(&real[2], by);

    let shifts = shifts(&real, &calibrated);
    for (view, found) in shifts.iter().enumerate() {
        // Few planes constrain some directions, and the prior shortens a shift there.
        let expected = if view == 2 { by } else { Vector2::zeros() };
        assert!((found.shift - expected).norm() < 1.5, "view {view}: {found:?}");
    }

    assert!(shifts[2].gain > 2.0 && shifts[2].error > 3.0 && shifts[2].error_after < 1.0, "{:?}", shifts[2]);
}

#[test]
fn a_part_that_only_one_view_sees_does_not_count() {
    let cameras = cameras();
    let data = HullData::new();
    data.add_views(&cameras).unwrap();
    data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, -0.2), Point3::new(1.0, 1.0, 2.2)).unwrap()).unwrap();

    for (view, camera) in cameras.iter().enumerate() {
        let mut mask = silhouette(camera, &Subject::person_at(0.0));
        if view == 1 {
            // A large patch in a corner that no other view confirms.
            (0..40).for_each(|x| (250..310).for_each(|y| mask.put_pixel(5 + x, y, Luma([255]))));
        }
        data.set_mask(view, &mask).unwrap();
    }

    let mut tangency = EpipolarTangency::new();
    tangency.add(&data.update(0.0).unwrap());
    assert!(tangency.shifts().iter().all(|shift| shift.error < 1.0 && shift.shift.norm() < 1.0));
}

#[test]
fn nothing_is_known_of_views_without_a_subject() {
    let cameras = cameras();
    let data = HullData::new();
    data.add_views(&cameras).unwrap();
    data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 2.0)).unwrap()).unwrap();
    (0..5).for_each(|view| data.set_mask(view, &GrayImage::new(SIZE.0, SIZE.1)).unwrap());
    let mut tangency = EpipolarTangency::new();
    tangency.add(&data.update(0.0).unwrap());
    for shift in tangency.shifts() {
        assert_eq!((shift.planes, shift.error, shift.shift), (0, 0.0, Vector2::zeros()));
    }
    assert!(EpipolarTangency::new().shifts().is_empty());
}
