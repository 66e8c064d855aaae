use super::super::Hints;
use super::super::testing::{HINTS, assert_refused, load_folder};
use crate::camera::{Camera, Distortion};
use nalgebra::{Isometry3, Matrix3, Matrix3x4, Matrix4, Point3, Vector3, Vector4};

const RES: &str = "659 494\n659 494\n659 494\n";
const SIZE: (u32, u32) = (659, 494);

/// Three cameras with lenses around the origin, in arbitrary units.
fn rig() -> Vec<Camera> {
    let eyes = [[3.0, 0.1, 1.0], [-1.2, 2.5, 1.5], [-1.8, -2.3, 0.8]];
    let camera = |eye: [f64; 3]| {
        let eye = Point3::from(eye);
        let pose =
            *Camera::look_at("", SIZE, 1.0, eye, Point3::origin(), Vector3::z()).unwrap().cam_from_world();
        let k = Matrix3::new(422.0, 0.0, 330.0, 0.0, 424.0, 210.0, 0.0, 0.0, 1.0);
        let lens = Distortion::from_opencv(&[-0.28, 0.075, 0.0004, -0.0001]).unwrap();
        Camera::new("-", SIZE, k, lens, pose).unwrap()
    };
    eyes.into_iter().map(camera).collect()
}

fn matrix_text(p: &Matrix3x4<f64>) -> String {
    p.row_iter().map(|row| row.iter().map(|x| format!("{x:.16e} ")).collect::<String>() + "\n").collect()
}

fn rad_text(camera: &Camera) -> String {
    let (k, c) = (camera.intrinsics(), camera.lens().coefficients());
    let mut text = String::new();
    for (i, j) in (0..9).map(|n| (n / 3, n % 3)) {
        text += &format!("K{}{} = {}\n", i + 1, j + 1, k[(i, j)]);
    }
    text + &format!("\nkc1 = {}\nkc2 = {}\nkc3 = {}\nkc4 = {}\n\n", c[0], c[1], c[2], c[3])
}

/// The files of the folder, with each matrix multiplied by `world`.
fn files(world: &Matrix4<f64>) -> Vec<(String, String)> {
    let mut files = vec![("Res.dat".into(), RES.into())];
    for (i, camera) in rig().iter().enumerate() {
        let p = camera.projection_matrix() * world;
        files.push((format!("camera{}.Pmat.cal", i + 1), matrix_text(&p)));
        files.push((format!("basename{}.rad", i + 1), rad_text(camera)));
    }
    files
}

fn load(files: &[(String, String)], hints: &Hints) -> crate::Result<crate::rig::Calibration> {
    let files: Vec<_> = files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    load_folder(&files, hints)
}

/// The files with the file `name` replaced or added, or removed if `text` is empty.
fn with(name: &str, text: &str) -> Vec<(String, String)> {
    let mut files = files(&Matrix4::identity());
    files.retain(|(old, _)| old != name);
    if !text.is_empty() {
        files.push((name.into(), text.into()));
    }
    files
}

/// The largest distance in pixels between the images of some points in [`rig`] and in `found`.
fn largest_error(found: &[Camera], motion: impl Fn(Point3<f64>) -> Point3<f64>) -> f64 {
    let points = [[0.0; 3], [0.5, -0.4, 0.3], [-0.6, 0.2, 0.4]].map(Point3::from);
    let mut largest: f64 = 0.0;
    for (a, b) in rig().iter().zip(found) {
        for point in points {
            let (a, b) = (a.project(&point).unwrap(), b.project(&motion(point)).unwrap());
            // Pixel corners are whole numbers in a camera, centres in the files.
            largest = largest.max((a.u + 0.5 - b.u).abs()).max((a.v + 0.5 - b.v).abs());
        }
    }
    largest
}

#[test]
fn a_matrix_and_its_lens_give_the_original_camera() {
    let found = load(&files(&Matrix4::identity()), &HINTS).unwrap();
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    assert_eq!(found.rig.cameras()[1].size(), SIZE);
    assert_eq!(found.rig.cameras()[1].name(), "camera2");
    assert!(largest_error(found.rig.cameras(), |p| p) < 1e-9);
}

#[test]
fn a_world_of_any_scale_and_handedness_becomes_a_right_handed_one_in_metres() {
    let world = Matrix4::from_diagonal(&Vector4::new(0.5, 0.5, -0.5, 1.0));
    let found = load(&files(&world), &Hints { metres_per_unit: Some(0.5), size: None }).unwrap();
    // The file's world is 2 (x, y, -z); with its y axis flipped it is 2 (x, -y, -z).
    assert!(largest_error(found.rig.cameras(), |p| Point3::new(p.x, -p.y, -p.z)) < 1e-9);
    assert!(found.notes[0].contains("its y axis is flipped"), "{:?}", found.notes);
    let no_hint = Hints::default();
    assert_refused(load(&files(&world), &no_hint), &["any scale; give the metres per unit"]);
}

#[test]
fn a_lens_that_differs_from_the_matrix_keeps_the_pose_and_is_noted_if_large() {
    let cameras = rig();
    let mut k = *cameras[0].intrinsics();
    k[(0, 0)] *= 1.02;
    k[(1, 1)] *= 1.02;
    k[(1, 2)] += 3.0;

    let near = k * cameras[0].cam_from_world().to_homogeneous().fixed_rows::<3>(0);
    let found = load(&with("camera1.Pmat.cal", &matrix_text(&near)), &HINTS).unwrap();
    assert!(found.notes.is_empty(), "{:?}", found.notes);

    let motion: Isometry3<f64> =
        found.rig.cameras()[0].cam_from_world() * cameras[0].cam_from_world().inverse();
    assert!(motion.rotation.angle() < 1e-9 && motion.translation.vector.norm() < 1e-9);

    k[(1, 2)] += 80.0;
    let far = k * cameras[0].cam_from_world().to_homogeneous().fixed_rows::<3>(0);
    let found = load(&with("camera1.Pmat.cal", &matrix_text(&far)), &HINTS).unwrap();
    assert!(
        found.notes[0].starts_with("camera camera1: matrix and .rad file have different"),
        "{:?}",
        found.notes
    );
}

#[test]
fn names_come_from_the_order_file_or_the_configuration() {
    let names = |files: &[(String, String)]| {
        let found = load(files, &HINTS).unwrap();
        found.rig.cameras().iter().map(|camera| camera.name().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names(&with("camera_order.txt", "left\nright\ntop\n")), ["left", "right", "top"]);
    let config = "% config.files.basename = 'old';\n  config.files.basename = 'arctic';\n";
    assert_eq!(names(&with("configdata.m", config)), ["arctic1", "arctic2", "arctic3"]);
    assert_eq!(names(&with("configdata.m", &config.replace('%', " "))), ["camera1", "camera2", "camera3"]);
}

#[test]
fn files_that_are_missing_or_bad_are_refused_by_name() {
    let inputs = [("points.dat", "1 2"), ("IdMat.dat", "1"), ("basename1.rad", ""), ("Res.dat", RES)];
    assert_refused(load_folder(&inputs, &HINTS), &["found only what MultiCamSelfCal starts from; run it"]);

    let missing = ["expected one .rad file for camera 2", "found 0"];
    assert_refused(load(&with("basename2.rad", ""), &HINTS), &missing);
    assert_refused(
        load(&with("other2.rad", "x"), &HINTS),
        &["expected one .rad file for camera 2", "found 2"],
    );
    assert_refused(
        load(&with("basename2.rad", "K11 = 1\n"), &HINTS),
        &["basename2.rad: expected a line `K12"],
    );

    let short = with("Res.dat", "659 494\n659 494\n");

    assert_refused(load(&short, &HINTS), &["Res.dat: expected a line for camera 3, found 2"]);
    assert_refused(
        load(&with("Res.dat", "659 494\n659\n1 1\n"), &HINTS),
        &["Res.dat: line 2: expected width"],
    );
    assert_refused(
        load(&with("Res.dat", ""), &Hints { size: None, ..HINTS }),
        &["expected to know the size"],
    );
    assert_refused(
        load(&with("camera_order.txt", "a\nb\n"), &HINTS),
        &["camera_order.txt: expected a line for camera 3"],
    );
    assert_refused(
        load(&with("camera_order.txt", "a\nb\na\n"), &HINTS),
        &["camera \"a\": line 3", "on line 1 too"],
    );
    assert_refused(
        load(&with("camera2.Pmat.cal", "1 2 3 4\n1 2 3 4\n"), &HINTS),
        &["camera2.Pmat.cal: line 2: expected three rows"],
    );
    assert_refused(
        load(&with("Camera2.Pmat.cal", "1 2 3 4\n"), &HINTS),
        &["expected one matrix for camera 2, found two"],
    );
}
