use super::*;
use image::GrayImage;

/// Cameras that see the whole heap, a part of it, its inside, and nothing.
fn cameras() -> Vec<Camera> {
    let look = |eye: [f64; 3], target: [f64; 3], fov: f64| {
        Camera::look_at("c", (90, 70), fov, eye.into(), target.into(), Vector3::z()).unwrap()
    };
    vec![
        distorting_camera(),
        look([2.0, 1.0, 0.7], [0.0, 0.0, 0.0], 0.7),
        look([2.0, 1.0, 0.7], [0.0, 0.8, 0.2], 0.6),
        look([0.6, 0.1, 0.1], [0.0, 0.5, 0.0], 1.5),
        look([0.05, 0.1, 0.1], [1.0, 0.5, 0.0], 1.5),
        look([2.0, 1.0, 0.7], [4.0, 2.0, 0.7], 0.7),
    ]
}

#[test]
fn silhouettes_equal_one_ray_for_each_pixel() {
    let subject = heap(Vector3::zeros());
    for camera in cameras() {
        let mask = silhouette(&camera, &subject);
        for (x, y, pixel) in mask.enumerate_pixels() {
            let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let hit = ray.is_some_and(|ray| subject.first_hit(&ray).is_some());
            assert_eq!(pixel.0[0], if hit { 255 } else { 0 }, "pixel {x}, {y}");
        }
    }
}

#[test]
fn coverage_equals_256_rays_for_each_pixel() {
    let subject = heap(Vector3::zeros());
    for camera in cameras() {
        for (x, y, pixel) in coverage(&camera, &subject).enumerate_pixels() {
            if (x + 2 * y) % 5 != 0 {
                continue; // one pixel in five, in all rows and columns, keeps the test short
            }
            let hits = (0..256u32).filter(|i| {
                let (du, dv) = (f64::from(i % 16) + 0.5, f64::from(i / 16) + 0.5);
                let ray = camera.ray(f64::from(x) + du / 16.0, f64::from(y) + dv / 16.0);
                ray.is_some_and(|ray| subject.is_hit(&ray))
            });
            let expected = (255.0 * hits.count() as f64 / 256.0).round();

            // The lens is linear between a pixel's corners: one or two of 256 rays that graze may differ.
            assert!((f64::from(pixel.0[0]) - expected).abs() <= 2.0, "pixel {x}, {y}: {pixel:?}, {expected}");
        }
    }
}

fn area(mask: &GrayImage) -> f64 {
    mask.iter().map(|&value| f64::from(value)).sum::<f64>() / 255.0
}

#[test]
fn a_ball_covers_the_area_of_its_circle() {
    let camera =
        Camera::look_at("c", (200, 200), 0.5, Point3::new(3.0, 0.0, 0.0), Point3::origin(), Vector3::z())
            .unwrap();
    let ball = Placed::new(Solid::sphere(0.3).unwrap(), Isometry3::identity(), Texture::plain([0; 3]));
    let subject = Subject::new(vec![ball]);
    let radius = camera.intrinsics()[(0, 0)] * (0.3f64 / 3.0).asin().tan();
    let expected = std::f64::consts::PI * radius * radius;
    // The error of counting lattice points in a circle: 0.02 % with 16 per pixel side, 0.3 % with 1.
    assert!((area(&coverage(&camera, &subject)) / expected - 1.0).abs() < 2e-4);
    assert!((area(&silhouette(&camera, &subject)) / expected - 1.0).abs() < 3e-3);
}

#[test]
fn a_wire_thinner_than_a_pixel_is_not_lost() {
    let camera =
        Camera::look_at("c", (100, 100), 0.5, Point3::new(3.0, 0.0, 0.0), Point3::origin(), Vector3::z())
            .unwrap();
    let focal = camera.intrinsics()[(0, 0)];
    for (tilt, shift) in [(0.0, 0.0), (0.0, 0.004), (0.02, 0.0), (0.7, 0.0)] {
        let pose = Isometry3::new(Vector3::new(0.0, shift, 0.0), Vector3::x() * tilt);
        let wire = Placed::new(Solid::capsule(1e-3, 0.5).unwrap(), pose, Texture::plain([0; 3]));
        let mask = coverage(&camera, &Subject::new(vec![wire]));
        let expected = (2e-3 * 0.5) * (focal / 3.0).powi(2);
        // The wire is 0.13 px wide: two or three of 16 rays across a pixel meet it.
        assert!((area(&mask) / expected - 1.0).abs() < 0.5, "{} for {expected}", area(&mask));
    }
}

#[test]
fn images_equal_the_clean_plate_where_the_subject_is_not() {
    let scene = Scene { subject: heap(Vector3::new(0.0, 0.0, 0.7)), room: Room::default() };
    let camera = Camera::look_at(
        "c",
        (120, 90),
        0.6,
        Point3::new(2.5, 1.5, 1.5),
        Point3::new(0.0, 0.0, 0.7),
        Vector3::z(),
    )
    .unwrap();
    let (plate, image) = (clean_plate(&camera, &scene.room), render(&camera, &scene));

    let mask = coverage(&camera, &scene.subject);
    let (mut background, mut subject) = (0, 0);
    for (x, y, coverage) in mask.enumerate_pixels() {
        let (a, b) = (plate.get_pixel(x, y), image.get_pixel(x, y));
        match coverage.0[0] {
            0 => {
                assert_eq!(a, b, "pixel {x}, {y}");
                background += 1;
            }
            255 => {
                assert!((0..3).any(|c| a.0[c].abs_diff(b.0[c]) > 24), "pixel {x}, {y}: {a:?} {b:?}");
                subject += 1;
            }
            _ => {}
        }
    }

    assert!(background > 5000 && subject > 1000);
    assert_eq!(render_over(&camera, &scene, &plate).unwrap(), image);
}

#[test]
fn a_clean_plate_of_another_camera_is_refused() {
    let plate = image::RgbImage::new(10, 20);
    let error = render_over(&distorting_camera(), &Scene::default(), &plate).unwrap_err().to_string();
    assert!(
        error.starts_with("view \"distorting\": expected a clean plate of 160 x 120 pixels, found 10 x 20")
    );
}

#[test]
fn depths_lead_back_to_the_surfaces() {
    let scene =
        Scene { subject: heap(Vector3::zeros()), room: Room::new(Vector3::new(8.0, 6.0, 3.0)).unwrap() };
    let camera = distorting_camera();
    let (width, _) = camera.size();
    let mask = silhouette(&camera, &scene.subject);
    let depths = render_depth(&camera, &scene);
    for (x, y, pixel) in mask.enumerate_pixels() {
        let depth = f64::from(depths[(y * width + x) as usize]);
        let (u, v) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let point = camera.unproject(u, v, depth).unwrap();

        let ray = camera.ray(u, v).unwrap();
        // Depths are f32, with a relative error of about 2e-7.
        if pixel.0[0] == 255 {
            let (hit, _) = scene.subject.first_hit(&ray).unwrap();
            assert!((ray.at(hit.t) - point).norm() < 1e-6);
        } else {
            let to_faces = [4.0 - point.x.abs(), 3.0 - point.y.abs(), point.z, 3.0 - point.z];
            assert!(to_faces.iter().any(|d| d.abs() < 3e-6), "{point}");
        }
    }
}

#[test]
fn a_camera_that_looks_away_from_the_room_sees_nothing() {
    let camera = Camera::look_at(
        "c",
        (8, 8),
        0.3,
        Point3::new(20.0, 0.0, 2.0),
        Point3::new(40.0, 0.0, 2.0),
        Vector3::z(),
    )
    .unwrap();
    assert!(render_depth(&camera, &Scene::default()).iter().all(|d| d.is_infinite()));
    assert!(clean_plate(&camera, &Room::default()).iter().all(|&value| value == 24));
}
