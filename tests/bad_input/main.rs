//! Bad input is refused with an error that says where it is, what was expected, what was found and what to do. The last
//! good frame stays in force, nothing panics, and the states of all bodies stay finite.

mod bodies;
mod recordings;
mod surfaces;

use image::{GrayImage, Luma};
use nalgebra::{Isometry3, Matrix3, Matrix3x4, Point3, Quaternion, UnitQuaternion, Vector3, point, vector};
use ode_sys::{dCollide, dContactGeom, dCreateBox, dCreateSphere, dGeomDestroy};
use ode_visual_hull::camera::{Camera, Distortion, Ray};
use ode_visual_hull::hull::{Aabb, EdgeModel, EmptyReason, HullData, Unseen};
use ode_visual_hull::ode::{BodyId, Shape, SpaceKind, TriMesh, World};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::sample;
use ode_visual_hull::synthetic::{Subject, coverage};
use ode_visual_hull::{Error, Result};
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Asserts that `result` is an error whose message contains all of `parts`.
#[track_caller]
fn assert_says<T: Debug>(result: Result<T>, parts: &[&str]) {
    let message = result.expect_err("refused").to_string();
    for part in parts {
        assert!(message.contains(part), "expected {part:?} in: {message}");
    }
}

/// Asserts that the table's frame is in force: a box of 0.2 m falls 2 cm onto the table and comes to rest.
#[track_caller]
fn assert_table_in_force(data: &Arc<HullData>) {
    let (mut world, body) = drop_box_on(data);
    for _ in 0..200 {
        step(&mut world, 0.005);
        assert_finite(&world, body);
    }
    let above = height(&world, body) - TOP - 0.1;
    assert!(above.abs() < 0.002, "rests {above} m off the table's top");
}

#[track_caller]
fn assert_finite(world: &World, id: BodyId) {
    let body = world.body(id);
    let (pose, linear, angular) = (body.pose(), body.linear_velocity(), body.angular_velocity());
    let finite =
        pose.to_homogeneous().iter().chain(linear.iter()).chain(angular.iter()).all(|x| x.is_finite());
    assert!(finite, "{pose} {linear} {angular}");
}

/// Runs `fault` on the table's data and asserts that its latest frame is still the same object.
#[track_caller]
fn with_table_kept(fault: impl FnOnce(&Arc<HullData>)) {
    let data = table();
    let (serial, frame) = data.latest().unwrap();
    fault(&data);
    let (still, latest) = data.latest().unwrap();
    assert_eq!(serial, still);
    assert!(Arc::ptr_eq(&frame, &latest));
    assert_table_in_force(&data);
}

#[test]
fn a_mask_of_the_wrong_size_is_refused() {
    with_table_kept(|data| {
        for size in [(480, 640), (640, 479), (0, 0), (1, 640 * 480)] {
            let found = format!("found {} x {}", size.0, size.1);
            let mask = GrayImage::new(size.0, size.1);
            assert_says(
                data.set_mask(2, &mask),
                &["view \"cam2\"", "mask", "640 x 480", &found, "scale the mask"],
            );
        }
    });
}

#[test]
fn a_view_that_does_not_exist_is_refused() {
    with_table_kept(|data| {
        assert_says(data.set_mask(4, &GrayImage::new(640, 480)), &["index below 4", "found 4", "add_view"]);
        assert_says(data.set_view_enabled(usize::MAX, false), &["index below 4"]);
        assert_says(data.add_view(table_cameras().remove(1)), &["view \"cam1\"", "same name", "rename"]);
    });
}

#[test]
fn a_singular_or_nan_camera_is_refused() {
    let good = Matrix3::new(500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0);
    let camera = |k: Matrix3<f64>, pose| Camera::new("left", (640, 480), k, Distortion::none(), pose);
    let here = Isometry3::identity();

    let mut skewed = good;
    skewed[(1, 0)] = 1.0;
    let no_rotation = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, 0.0, 0.0));

    assert_says(camera(Matrix3::zeros(), here), &["camera \"left\"", "focal", "found fx = 0", "calibrate"]);
    assert_says(camera(good * f64::NAN, here), &["camera \"left\"", "finite", "NaN", "calibrate"]);
    assert_says(camera(skewed, here), &["camera \"left\"", "upper triangular", "found K"]);
    assert_says(camera(good, at(f64::NAN, 0.0, 0.0)), &["camera \"left\"", "finite pose", "calibrate"]);
    assert_says(camera(good, Isometry3::from_parts([0.0; 3].into(), no_rotation)), &["rotation", "length 0"]);

    let mut extreme = good;
    extreme[(0, 0)] = 1e308;

    assert_says(camera(extreme, at(10.0, 0.0, 1e10)), &["camera \"left\"", "range of numbers"]);

    let p: Matrix3x4<f64> = table_cameras()[0].projection_matrix();
    let mut flat = p;
    flat.set_row(1, &(p.row(0) * 2.0));
    for bad in [Matrix3x4::zeros(), p * f64::NAN, p * f64::INFINITY, p * 1e-310, p * 1e300, flat] {
        let refused = Camera::from_projection("left", (640, 480), &bad);
        assert_says(refused, &["camera \"left\"", "expected", "found", "calibrate"]);
    }

    let eye = point![1.0, 2.0, 3.0];
    for (target, up, fov) in [
        (eye, Vector3::z(), 1.0),
        (point![1.0, 2.0, 0.0], Vector3::z(), 1.0),
        (Point3::origin(), Vector3::zeros(), 1.0),
        (Point3::origin(), Vector3::z(), f64::NAN),
        (point![f64::NAN, 0.0, 0.0], Vector3::z(), 1.0),
    ] {
        assert!(Camera::look_at("left", (640, 480), fov, eye, target, up).is_err());
    }
}

#[test]
fn a_rig_file_with_a_bad_camera_is_refused_by_path_and_line() {
    let folder = Folder::new("rig");
    let path = folder.path("rig.toml");
    let good = Rig::new(table_cameras()).unwrap().to_toml();

    for (was, now, parts) in [
        ("[640, 480]", "[640]", &["cam0", "`size`", "2 numbers", "width"][..]),
        ("[640, 480]", "[65536, 480]", &["cam0", "`size`", "65535"][..]),
        ("0.0, 0.0, 1.0]", "0.0, 0.0, nan]", &["cam0", "`matrix`", "finite", "calibrate"][..]),
        ("name =", "nome", &["expected"][..]),
        ("fisheye = false", "fisheye = true", &["cam0", "`distortions`", "4 fisheye coefficients"][..]),
        ("translation", "transition", &["cam0", "`translation`", "found none", "metres"][..]),
    ] {
        let bad = good.replacen(was, now, 1);
        assert_ne!(bad, good, "{was}");
        std::fs::write(&path, bad).unwrap();
        let file = path.display().to_string();
        assert_says(Rig::load(&path), &[&[&file, "line "], parts].concat());
    }

    assert_says(Rig::load(folder.path("none.toml")), &["none.toml", "expected a calibration file"]);
}

#[test]
fn a_camera_that_looks_away_is_refused_until_it_is_disabled() {
    let looks_away = |name: &str| {
        let eye = point![3.0, 0.0, 0.3];
        Camera::look_at(name, (640, 480), 0.45, eye, point![6.0, 0.0, 0.3], Vector3::z()).unwrap()
    };

    let data = table();
    let before = data.latest().unwrap().0;
    let view = data.add_view(looks_away("back")).unwrap();

    assert_says(data.update(1.0), &["view \"back\"", "expected a mask", "found none", "disable the view"]);

    data.set_mask(view, &GrayImage::from_fn(640, 480, |x, _| Luma([if x < 320 { 255 } else { 0 }]))).unwrap();
    assert_says(
        data.update(1.0),
        &["view \"back\"", "sees the work volume", "found one at (3.000", "z forward"],
    );
    assert_eq!(data.latest().unwrap().0, before);
    assert_table_in_force(&data);

    data.set_view_enabled(view, false).unwrap();
    data.update(1.0).unwrap();

    assert_table_in_force(&data);
    // A view without a mask can be disabled too.
    let bare = data.add_view(looks_away("bare")).unwrap();
    data.set_view_enabled(bare, false).unwrap();
    data.update(2.0).unwrap();

    assert_table_in_force(&data);
}

#[test]
fn an_empty_silhouette_empties_the_hull_which_names_the_view() {
    let data = table();
    data.set_mask(2, &GrayImage::new(640, 480)).unwrap();
    let hull = data.update(1.0).unwrap();
    assert_eq!(hull.empty_reason(), Some(EmptyReason::EmptySilhouette { view: 2 }));
    assert_eq!(hull.views()[2].name(), "cam2");
    assert!(hull.aabb().is_empty() && !hull.inside(&ORIGIN));

    let (mut world, body) = drop_box_on(&data);
    for _ in 0..100 {
        step(&mut world, 0.005);
        assert_finite(&world, body);
    }
    assert!(height(&world, body) < TOP - 0.3, "falls through where the table was");
}

#[test]
fn silhouettes_with_nothing_in_common_name_the_view_that_has_nothing_left() {
    let (data, cameras) = (table(), table_cameras());
    let elsewhere = Subject::new(vec![cuboid(vector![0.05, 0.05, 0.05], at(0.0, 0.0, 0.5))]);
    data.set_mask(3, &coverage(&cameras[3], &elsewhere)).unwrap();
    let hull = data.update(1.0).unwrap();
    assert_eq!(hull.empty_reason(), Some(EmptyReason::NothingInCommon { view: 3 }));
}

#[test]
fn a_full_silhouette_is_refused() {
    for unseen in [Unseen::Outside, Unseen::ABSTAIN] {
        with_table_kept(|data| {
            data.set_unseen(unseen).unwrap();
            for value in [128, 255] {
                let full = GrayImage::from_pixel(640, 480, Luma([value]));
                let parts = ["view \"cam1\"", "some background", "found every pixel", "segmentation"];
                assert_says(data.set_mask(1, &full), &parts);
            }
        });
    }
}

#[test]
fn without_views_there_is_no_hull() {
    let data = HullData::new();
    data.set_bounds(bounds()).unwrap();
    assert_says(data.update(0.0), &["at least one view", "found none", "add views"]);
    assert!(data.latest().is_none());
    assert_says(Rig::new(Vec::new()), &["at least one camera", "found none"]);
    assert_says(data.set_unseen(Unseen::Abstain { min_views: 0 }), &["min_views", "at least 1", "found 0"]);

    let data = table();
    (0..4).for_each(|view| data.set_view_enabled(view, false).unwrap());
    let hull = data.update(1.0).unwrap();
    assert_eq!(hull.empty_reason(), Some(EmptyReason::NoViews));
    assert!(!hull.inside(&ORIGIN));
}

#[test]
fn missing_or_inverted_bounds_are_refused() {
    let data = HullData::new();
    let cameras = table_cameras();
    for (view, camera) in cameras.iter().enumerate() {
        data.add_view(camera.clone()).unwrap();
        data.set_mask(view, &GrayImage::new(640, 480)).unwrap();
    }

    assert_says(data.update(0.0), &["expected a work volume", "found none", "set the bounds"]);

    with_table_kept(|data| {
        let (low, high) = (point![-1.0, -1.0, -1.0], point![1.0, 1.0, 1.0]);
        for (min, max) in [
            (high, low),
            (low, low),
            (low, point![1.0, 1.0, -1.0]),
            (low, point![1.0, f64::NAN, 1.0]),
            (point![f64::NEG_INFINITY, -1.0, -1.0], high),
            (low, point![1.0, 1.0, 1e300]),
        ] {
            assert_says(data.set_bounds(Aabb { min, max }), &["bounds", "min below max", "found min"]);
        }
    });
}

#[test]
fn a_frame_time_that_decreases_or_is_not_finite_is_refused() {
    with_table_kept(|data| {
        assert_says(data.update(f64::NAN), &["frame time", "found NaN", "clock"]);
        assert_says(data.update(f64::INFINITY), &["frame time", "found inf"]);
        assert_says(data.update(-1.0), &["not before the last frame's, 0 s", "found -1 s"]);
    });
}

#[test]
fn data_may_be_dropped_before_its_geoms_and_geoms_before_their_data() {
    let data = table();
    let (mut world, body) = drop_box_on(&data);
    drop(data);
    for _ in 0..200 {
        step(&mut world, 0.005);
    }

    assert!((height(&world, body) - TOP - 0.1).abs() < 0.002);

    let data = table();
    let (world, _) = drop_box_on(&data);
    drop(world);
    show(&data, &table_cameras(), &Subject::new(Vec::new()), 1.0);

    assert_eq!(Arc::strong_count(&data), 1);
}

#[test]
fn two_hulls_fail_and_are_removed_independently() {
    let (good, bad) = (table(), table());
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, &good).unwrap();
    let other = world.add_hull(root, &bad).unwrap();
    world.geom_mut(other).set_pose(&at(0.0, 0.0, 1e-3)).unwrap();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.12));

    for k in 0..600 {
        match k {
            150 => assert!(bad.update(f64::NAN).is_err()),
            200 => bad.set_mask(0, &GrayImage::new(640, 480)).unwrap(),
            250 => drop(bad.update(1.0).unwrap()),
            400 => assert!(world.remove_geom(other)),
            _ => {}
        }
        step(&mut world, 0.005);
        assert_finite(&world, body);
    }

    assert!((height(&world, body) - TOP - 0.1).abs() < 0.002);
    assert!(world.get_hull(other).is_err());
}

#[test]
fn sizes_whose_product_overflows_are_refused_before_memory_is_allocated() {
    let k = Matrix3::new(9e4, 0.0, 3e4, 0.0, 9e4, 3e4, 0.0, 0.0, 1.0);
    let lens = Distortion::from_opencv(&[-0.3, 0.1, 0.0, 0.0]).unwrap();
    for size in [(65_535, 65_535), (65_536, 65_536), (u32::MAX, u32::MAX), (u32::MAX, 1), (40_000, 40_000)] {
        let refused = Camera::new("huge", size, k, lens, at(0.0, 0.0, 3.0));
        let found = format!("found {} x {}", size.0, size.1);
        assert_says(refused, &["camera \"huge\"", "pixels", &found]);
    }

    // The largest allowed size, which undistorting would exceed.
    let largest = Camera::new("wide", (16_384, 16_384), k, lens, at(0.0, 0.0, 3.0)).unwrap();
    assert_says(
        HullData::new().add_view(largest),
        &["view \"wide\"", "found 16384 x 16384", "scale the images down"],
    );

    // Image files that consist of a header alone.
    let folder = Folder::new("sizes");
    for (name, header) in [
        ("a.pgm", "P5 65535 65535 255\n"),
        ("b.pgm", "P5 4294967295 4294967295 255\n"),
        ("c.pgm", "P5 99999999999999999999 2 255\n"),
        ("d.ppm", "P6 65535 65535 65535\n"),
    ] {
        std::fs::write(folder.path(name), header).unwrap();
        let mask = ode_visual_hull::silhouette::load_mask(folder.path(name));
        assert_says(mask, &[name, "expected an image", "found"]);
    }

    let sides = vector![1e9, 1e9, 1e9];
    let far = [1e9, 2e9].map(|x| point![x, -x, x]);
    let triangle = [far[0], far[1], point![0.0, 1e9, 0.0]];
    let tetrahedron = [triangle[0], triangle[1], triangle[2], point![0.0, 0.0, -1e9]];
    let shapes = [
        Shape::Sphere { radius: 1e9 },
        Shape::Box { sides },
        Shape::Capsule { radius: 1e9, length: 1e9 },
        Shape::Cylinder { radius: 1e9, length: 1e9 },
    ];

    for min_feature in [1e-3, 1e-300] {
        let too_many = ["min_feature", "at most 1000000", "raise min_feature"];
        shapes.iter().for_each(|shape| assert_says(shape.sample(min_feature), &too_many));
        assert_says(sample::convex(&tetrahedron, min_feature), &too_many);
        assert_says(sample::trimesh(&[triangle; 3], min_feature), &too_many);
    }

    let wide = [point![-1e9, -1e9, -1e9], point![1e9, 1e9, 1e9]];
    assert_says(sample::implicit(|p| p.x, wide, 1e-6), &["grid nodes", "raise min_feature or tighten"]);
}

#[test]
fn queries_at_points_that_are_not_finite_return_nothing() {
    let hull = table().latest().unwrap().1;
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308] {
        let p = point![0.0, bad, 0.0];
        assert!(!hull.inside(&p) && hull.respond(&p).is_none() && hull.exit_vector(&p).is_none());
        assert!(hull.pixel_size(&p).is_finite());

        for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
            assert!(!hull.inside_by(&p, edge));
            assert!(!hull.exit(&ORIGIN, &vector![0.0, bad, 0.0], edge).is_nan());
            assert!(!hull.exit(&p, &Vector3::z(), edge).is_nan());
        }

        let rays = [
            Ray { origin: p, direction: Vector3::z() },
            Ray { origin: ORIGIN, direction: vector![bad, 0.0, 0.0] },
        ];
        for ray in rays.iter().filter(|_| bad.is_nan()) {
            assert!(hull.ray_cast(ray).is_none());
        }
    }

    assert!(!hull.exit(&ORIGIN, &Vector3::zeros(), EdgeModel::Pixel).is_nan());
}

/// A temporary folder for one test, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("ode-visual-hull-bad-{}-{test}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
