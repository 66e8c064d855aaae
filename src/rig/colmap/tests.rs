use super::super::Hints;
use super::super::testing::{Folder, HINTS, assert_refused, assert_sees, load_folder};
use crate::Result;
use crate::rig::Calibration;

pub(in crate::rig) const CAMERAS: &str = "# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 3
1 SIMPLE_PINHOLE 640 480 500 320 240
2 OPENCV 600 400 500 510 300 200 -0.1 0.02 0.001 -0.002
7 RADIAL 640 480 500 320 240 -0.1 0.02
";
pub(in crate::rig) const IMAGES: &str = "# Image list with two lines of data per image:
#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
1 1 0 0 0 0.1 0.2 3 1 left.png
12.5 300.1 -1 40 50 63
3 0.70710678118654757 0 0 0.70710678118654757 0 0 2 2 right.png

2 1 0 0 0 0 0 4 7 top.png
";

fn load(cameras: &str, images: &str) -> Result<Calibration> {
    load_folder(&[("cameras.txt", cameras), ("images.txt", images), ("points3D.txt", "")], &HINTS)
}

#[test]
fn views_keep_the_images_order_and_their_cameras_lenses() {
    let rig = load(CAMERAS, IMAGES).unwrap().rig;
    let names: Vec<_> = rig.cameras().iter().map(|camera| (camera.name(), camera.size())).collect();
    assert_eq!(names, [("left", (640, 480)), ("right", (600, 400)), ("top", (640, 480))]);
    // Pixel corners are whole numbers in the file as well.
    assert_sees(&rig.cameras()[0], [0.5, -0.3, 1.0], 500.0 * 0.6 / 4.0 + 320.0, 500.0 * -0.1 / 4.0 + 240.0);
    assert_eq!(rig.cameras()[1].lens().coefficients()[..5], [-0.1, 0.02, 0.001, -0.002, 0.0]);
    assert_eq!(rig.cameras()[2].lens().coefficients()[..5], [-0.1, 0.02, 0.0, 0.0, 0.0]);
}

#[test]
fn the_quaternion_rotates_from_world_to_camera() {
    let simple = CAMERAS.replace("-0.1 0.02 0.001 -0.002", "0 0 0 0");
    let rig = load(&simple, IMAGES).unwrap().rig;
    // A quarter turn around z: x to y, y to -x.
    assert_sees(&rig.cameras()[1], [0.5, -0.3, 1.0], 500.0 * 0.3 / 3.0 + 300.0, 510.0 * 0.5 / 3.0 + 200.0);
}

#[test]
fn either_file_loads_both_and_lines_of_points_may_be_missing() {
    let bare = IMAGES.replace("12.5 300.1 -1 40 50 63\n", "").replace("\n\n", "\n");
    let folder = Folder::of(&[("cameras.txt", CAMERAS), ("images.txt", &bare)]);
    for name in ["cameras.txt", "images.txt"] {
        assert_eq!(Calibration::load(folder.path().join(name), &HINTS).unwrap().rig.len(), 3);
    }
}

#[test]
fn a_full_lens_has_opencvs_eight_coefficients() {
    let full = CAMERAS
        .replace("RADIAL 640 480 500 320", "FULL_OPENCV 640 480 500 501 320")
        .replace("240 -0.1 0.02\n", "240 .1 .2 .3 .4 .5 .6 .7 .8\n");
    let rig = load(&full, IMAGES).unwrap().rig;
    assert_eq!(rig.cameras()[2].lens().coefficients()[..8], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]);
    assert_eq!(rig.cameras()[2].intrinsics()[(1, 1)], 501.0);
}

#[test]
fn the_scale_is_required_and_applied() {
    let files = [("cameras.txt", CAMERAS), ("images.txt", IMAGES)];
    assert_refused(load_folder(&files, &Hints::default()), &["any scale; give the metres per unit"]);
    let hints = Hints { metres_per_unit: Some(0.5), size: None };
    let rig = load_folder(&files, &hints).unwrap().rig;
    assert_eq!(rig.cameras()[2].cam_from_world().translation.vector.z, 2.0);
}

#[test]
fn binary_models_and_single_files_are_refused_with_the_command_to_run() {
    let binary = [("cameras.bin", "x"), ("images.bin", "x")];
    assert_refused(load_folder(&binary, &HINTS), &["found the binary form alone", "colmap model_converter"]);
    assert_refused(load_folder(&[("cameras.txt", CAMERAS)], &HINTS), &["expected images.txt in it"]);
    let folder = Folder::new();
    let path = folder.path().join("cameras.bin");
    std::fs::write(&path, [3, 0, 0, 0, 0xff, 0x8f]).unwrap();
    assert_refused(Calibration::load(&path, &HINTS), &["cameras.bin", "colmap model_converter"]);
}

#[test]
fn bad_cameras_are_refused_by_file_and_line() {
    let with = |old: &str, new: &str| load(&CAMERAS.replace(old, new), IMAGES);
    let unknown = ["cameras.txt: line 5", "found FOV", "undistort the images"];
    assert_refused(with("OPENCV", "FOV"), &unknown);
    assert_refused(with(" -0.002", ""), &["line 5: expected 8 parameters of OPENCV, found 7"]);
    assert_refused(with("500 320 240\n", "nan 320 240\n"), &["line 4: expected finite numbers, found nan"]);
    assert_refused(with("600 400", "600 x"), &["line 5: expected width and height"]);
    assert_refused(with("7 RADIAL", "2 RADIAL"), &["line 6: expected camera 2 once"]);
    assert_refused(with("500 320 240\n", "5 320 240\n"), &["\"left\": expected a focal length"]);
}

#[test]
fn bad_images_are_refused_by_file_and_line() {
    let with = |old: &str, new: &str| load(CAMERAS, &IMAGES.replace(old, new));
    assert_refused(with("0 0 2 2 right.png", ""), &["images.txt: line 5: expected an image, found 5 words"]);
    assert_refused(with("1 1 0 0 0 0.1", "1 0.9 0 0 0 0.1"), &["line 3", "found length 0.9000"]);
    assert_refused(
        with("0 4 7 top", "0 4 9 top"),
        &["line 7: expected camera 9 of this image in cameras.txt"],
    );
    assert_refused(with("right.png", "left.png"), &["camera \"left\": line 5", "on line 3 too"]);
    assert_refused(with("0.1 0.2 3 1", "0.1 inf 3 1"), &["line 3: expected finite numbers, found inf"]);
    assert_refused(load(CAMERAS, "# nothing\n"), &["images.txt: expected an image at least"]);
}
