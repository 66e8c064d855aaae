mod opencv;

use super::*;

fn seated_lens() -> Distortion {
    Distortion::from_opencv(&[-0.36, 0.18, 8e-4, -3e-4, -0.05]).unwrap()
}

/// Lenses of every model and count of coefficients: the figures are those of ordinary lenses, the tilted sensor's 3
/// degrees are many.
fn lenses() -> [Lens; 8] {
    let opencv = |coefficients: &[f64]| Distortion::from_opencv(coefficients).unwrap().into();
    let fisheye = |coefficients: &[f64]| Fisheye::from_opencv(coefficients).unwrap().into();
    let rational = [-0.2, 0.05, 1e-3, -5e-4, 0.01, 0.1, 0.02, 0.001];
    let prism = [0.012, -0.003, -0.008, 0.002];
    let tilt = [0.05, -0.03];
    [
        Lens::none(),
        opencv(&[-0.3, 0.09, 1e-3, -5e-4]),
        seated_lens().into(),
        opencv(&rational),
        opencv(&[&rational[..], &prism].concat()),
        opencv(&[&rational[..], &prism, &tilt].concat()),
        fisheye(&[]),
        fisheye(&[0.08, -0.02, 0.004, -0.0005]),
    ]
}

fn camera(lens: impl Into<Lens>) -> Camera {
    let k = Matrix3::new(490.0, 0.0, 330.0, 0.0, 493.0, 225.0, 0.0, 0.0, 1.0);
    let pose = Isometry3::new(Vector3::new(0.2, -0.1, 3.0), Vector3::new(1.2, 0.4, -0.3));
    Camera::new("test", (644, 486), k, lens, pose).unwrap()
}

#[test]
fn unproject_inverts_project() {
    for lens in lenses() {
        let camera = camera(lens);
        for (u, v, depth) in [(0.5, 0.5, 1.0), (330.0, 225.0, 3.0), (640.0, 480.0, 2.5), (12.3, 400.7, 9.0)] {
            let pixel = camera.project(&camera.unproject(u, v, depth).unwrap()).unwrap();
            // Newton's method stops at 1e-13 on the plane at depth 1; times the focal length of 490 px.
            assert!((pixel.u - u).abs() < 1e-9 && (pixel.v - v).abs() < 1e-9);
            assert!((pixel.depth - depth).abs() < 1e-9);
        }
    }
}

#[test]
fn undistort_inverts_distort_to_1e_12_and_distort_undistort() {
    for lens in lenses() {
        // As far out as the image of `camera` reaches, and some more.
        for (x, y) in
            (-10..=10).flat_map(|x| (-10..=10).map(move |y| (0.08 * f64::from(x), 0.06 * f64::from(y))))
        {
            let p = Point2::new(x, y);
            if let Some(there) = lens.distort(p) {
                let back = lens.undistort(there).unwrap();
                assert!((back - p).norm() < 1e-12, "{lens}: {p} {back}");
            }
            if let Some(there) = lens.undistort(p) {
                let back = lens.distort(there).unwrap();
                assert!((back - p).norm() < 1e-12, "{lens}: {p} {back}");
            }
        }
    }
}

#[test]
fn a_lens_is_described_by_its_model_and_coefficients() {
    let text = |lens: Lens| lens.to_string();
    assert_eq!(text(Lens::none()), "pinhole");
    assert_eq!(text(Distortion::from_opencv(&[0.0; 14]).unwrap().into()), "pinhole");
    assert_eq!(
        text(Distortion::from_opencv(&[-0.25, 0.0, 1e-3, 0.0, 0.0]).unwrap().into()),
        "OpenCV [-0.25, 0.0, 0.001, 0.0]"
    );
    assert_eq!(text(Fisheye::from_opencv(&[]).unwrap().into()), "OpenCV fisheye [0.0, 0.0, 0.0, 0.0]");
}

#[test]
fn a_ray_passes_through_every_depth_of_its_pixel() {
    let camera = camera(seated_lens());
    let ray = camera.ray(100.0, 77.0).unwrap();
    for depth in [0.5, 2.0, 20.0] {
        let offset = camera.unproject(100.0, 77.0, depth).unwrap() - ray.origin;
        assert!(offset.cross(&ray.direction).norm() < 1e-9 * depth);
    }
}

#[test]
fn a_projection_matrix_gives_back_its_camera() {
    let original = camera(Lens::none());
    for scale in [1.0, -3.5, 1e-6] {
        let p = original.projection_matrix() * scale;
        let again = Camera::from_projection("again", original.size(), &p).unwrap();
        assert!((again.projection_matrix() - original.projection_matrix()).norm() < 1e-9);
    }
}

#[test]
fn look_at_puts_the_target_in_the_middle_and_up_above() {
    let (eye, target) = (Point3::new(3.0, 1.0, 2.0), Point3::new(0.0, 0.0, 0.5));
    let camera = Camera::look_at("c", (640, 480), 0.9, eye, target, Vector3::z()).unwrap();
    let middle = camera.project(&target).unwrap();
    assert!((middle.u - 320.0).abs() < 1e-9 && (middle.v - 240.0).abs() < 1e-9);
    let above = camera.project(&(target + Vector3::z() * 0.1)).unwrap();
    assert!((above.u - 320.0).abs() < 1e-9 && above.v < 240.0);
    assert!((camera.centre() - eye).norm() < 1e-12);
}

#[test]
fn points_behind_the_camera_are_not_seen() {
    let camera = camera(Lens::none());
    assert!(camera.project(&(camera.centre() - camera.forward())).is_none());
}

#[test]
fn a_folding_lens_sees_nothing_beyond_its_fold() {
    // x (1 - 0.3 r2) stops growing at r2 = 1 / 0.9; a point beyond would alias back into the image.
    let lens = Distortion::from_opencv(&[-0.3, 0.0, 0.0, 0.0]).unwrap();
    assert!(lens.distort(Point2::new(1.05, 0.0)).is_some());
    assert!(lens.distort(Point2::new(1.06, 0.0)).is_none());
    assert!(lens.undistort(Point2::new(0.9, 0.0)).is_none());
}

#[test]
fn bad_calibrations_name_the_camera_and_the_fault() {
    let pose = Isometry3::identity();
    let with = |k: Matrix3<f64>| Camera::new("left", (640, 480), k, Lens::none(), pose).unwrap_err();
    let good = Matrix3::new(500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0);
    assert!(
        with(Matrix3::zeros()).to_string().starts_with("camera \"left\": expected positive focal lengths")
    );
    assert!(with(good * f64::NAN).to_string().contains("finite"));
    let empty = Camera::new("left", (0, 480), good, Lens::none(), pose).unwrap_err();
    assert!(empty.to_string().contains("found 0 x 480"));
    let singular = Camera::from_projection("left", (640, 480), &Matrix3x4::zeros()).unwrap_err();
    assert!(singular.to_string().contains("singular"));
    assert!(Distortion::from_opencv(&[0.1, 0.2]).unwrap_err().to_string().contains("found 2"));
    let tilted = Distortion::from_opencv(&[[0.0; 12].as_slice(), &[0.1, -1.6]].concat()).unwrap_err();
    assert!(tilted.to_string().contains("tauy = -1.6"), "{tilted}");
}
