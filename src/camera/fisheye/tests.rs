use super::*;
use crate::camera::Camera;
use nalgebra::Isometry3;

fn fisheye(coefficients: [f64; 4]) -> Fisheye {
    Fisheye::from_opencv(&coefficients).unwrap()
}

/// A camera of 640 x 480 pixels with this focal length, its axis at the middle of its image.
fn camera(focal: f64, lens: Fisheye) -> Result<Camera> {
    let k = Matrix3::new(focal, 0.0, 320.0, 0.0, focal, 240.0, 0.0, 0.0, 1.0);
    Camera::new("wide", (640, 480), k, lens, Isometry3::identity())
}

#[test]
fn rays_appear_at_theta_d_in_their_own_direction() {
    let lens = fisheye([0.1, -0.02, 0.003, 1e-4]);
    for degrees in [1e-9, 0.01, 1.0, 30.0, 60.0, 85.0, 89.9] {
        let theta = f64::to_radians(degrees);
        let theta_d =
            theta + 0.1 * theta.powi(3) - 0.02 * theta.powi(5) + 0.003 * theta.powi(7) + 1e-4 * theta.powi(9);
        let found = lens.distort(Point2::new(0.6, -0.8) * theta.tan()).unwrap();
        assert!((found - Point2::new(0.6, -0.8) * theta_d).norm() < 1e-12 * theta_d, "{degrees}: {found}");
    }
}

#[test]
fn the_axis_and_its_neighbours_stay_where_they_are() {
    let lens = fisheye([0.1, 0.0, 0.0, 0.0]);
    for x in [0.0, 1e-300, 1e-12] {
        let p = Point2::new(x, 0.0);
        assert_eq!((lens.distort(p), lens.undistort(p)), (Some(p), Some(p)));
    }
}

#[test]
fn what_is_90_degrees_or_more_from_the_axis_has_no_place_on_the_plane() {
    let lens = fisheye([0.0; 4]);
    assert!(lens.undistort(Point2::new(FRAC_PI_2 - 1e-6, 0.0)).is_some());
    for theta_d in [FRAC_PI_2, 1.6, 10.0, f64::INFINITY, f64::NAN] {
        assert_eq!(lens.undistort(Point2::new(0.0, theta_d)), None, "{theta_d}");
        assert_eq!(lens.distort(Point2::new(0.0, f64::INFINITY * theta_d)), None);
    }
}

#[test]
fn beyond_the_angle_at_which_theta_d_stops_growing_there_is_nothing() {
    // theta - 0.3 theta^3 stops growing at theta = 1 / sqrt 0.9, where theta_d is two thirds of that.
    let (lens, fold) = (fisheye([-0.3, 0.0, 0.0, 0.0]), 1.0 / 0.9_f64.sqrt());
    assert!((lens.max_radius() - fold.tan()).abs() < 1e-12);
    let at = |theta: f64| lens.distort(Point2::new(theta.tan(), 0.0));
    assert!(at(fold - 1e-9).is_some() && at(fold + 1e-9).is_none());
    let from = |theta_d: f64| lens.undistort(Point2::new(theta_d, 0.0));
    assert!(from(2.0 / 3.0 * fold - 1e-9).is_some() && from(2.0 / 3.0 * fold + 1e-9).is_none());
}

#[test]
fn an_image_that_shows_rays_at_90_degrees_is_refused_with_the_angle() {
    // The corners lie 400 px from the axis: 90 degrees at a focal length of 254.6 px, 100 at 229.2.
    assert!(camera(255.0, fisheye([0.0; 4])).is_ok());
    for (focal, angle) in [(254.0, "90.2 degrees"), (229.183, "100.0 degrees"), (100.0, "180.0 degrees")] {
        let message = camera(focal, fisheye([0.0; 4])).unwrap_err().to_string();
        assert!(
            message.starts_with("camera \"wide\": expected a fisheye image of rays less than 90"),
            "{message}"
        );
        assert!(message.contains(angle) && message.contains("crop the images"), "{message}");
    }
}

#[test]
fn a_fold_inside_the_image_is_refused_and_one_in_its_corners_is_unseen() {
    // The fold lies 0.7027 focal lengths from the axis, the nearest border 240 px, the corners 400 px.
    let lens = fisheye([-0.3, 0.0, 0.0, 0.0]);
    let message = camera(340.0, lens).unwrap_err().to_string();
    assert!(message.contains("folds back inside the image, 60.4 degrees from its axis"), "{message}");
    let in_the_corners = camera(343.0, lens).unwrap();
    assert!(in_the_corners.ray(320.0, 1.0).is_some() && in_the_corners.ray(1.0, 1.0).is_none());
    assert!(camera(570.0, lens).unwrap().ray(0.0, 0.0).is_some());
}

#[test]
fn a_fold_past_90_degrees_does_not_hide_that_the_image_shows_90_degrees() {
    // 1 - 0.3 theta^2 vanishes at 104.6 degrees, where theta_d is 1.217; at 90 degrees it is 1.183.
    let lens = fisheye([-0.1, 0.0, 0.0, 0.0]);
    for (focal, angle) in
        [(336.0, "at 91.7 degrees"), (200.0, "at 104.6 degrees"), (150.0, "at 104.6 degrees")]
    {
        let message = camera(focal, lens).unwrap_err().to_string();
        assert!(message.contains(angle), "{focal}: {message}");
    }
    assert!(camera(339.0, lens).is_ok());
}

#[test]
fn another_count_or_nan_is_no_fisheye() {
    for count in [1, 2, 3, 5, 8] {
        let message = Fisheye::from_opencv(&[0.01; 8][..count]).unwrap_err().to_string();
        assert_eq!(message, format!("expected 0 or 4 fisheye coefficients (k1 k2 k3 k4), found {count}"));
    }
    let message = Fisheye::from_opencv(&[0.0, f64::NAN, 0.0, 0.0]).unwrap_err().to_string();
    assert!(message.starts_with("expected finite fisheye coefficients"), "{message}");
}

#[test]
fn absurd_coefficients_are_refused_or_leave_a_lens_that_does_no_harm() {
    for k in [1e308, -1e308, 1e9, -1e9, f64::MIN_POSITIVE] {
        for i in 0..4 {
            let mut coefficients = [0.0; 4];
            coefficients[i] = k;
            coefficients[(i + 1) % 4] = -k;
            let lens = fisheye(coefficients);
            if let Ok(camera) = camera(500.0, lens) {
                let _ = (camera.ray(0.0, 0.0), camera.ray(320.0, 240.0), camera.ray(321.0, 240.0));
            }
        }
    }
}
