use super::*;
use crate::rig::Rig;
use crate::rig::testing::{Folder, assert_refused};
use nalgebra::{Point3, Vector3};

/// A file in the form that camera_calibration writes.
pub(in crate::rig) const INFO: &str = "image_width: 640
image_height: 480
camera_name: left
camera_matrix:
  rows: 3
  cols: 3
  data: [500.0, 0.0, 319.5, 0.0, 510.0, 239.5, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.1, 0.01, 0.0, 0.0, 0.0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
projection_matrix:
  rows: 3
  cols: 4
  data: [480.0, 0.0, 319.5, 0.0, 0.0, 480.0, 239.5, 0.0, 0.0, 0.0, 1.0, 0.0]
";

/// A message in the form that `rostopic echo` prints: long lists, and the names of its fields.
pub(in crate::rig) const MESSAGE: &str = "header:
  seq: 1
  frame_id: left
height: 480
width: 640
distortion_model: \"rational_polynomial\"
D: [0.1, 0.2, 0.0, 0.0, 0.3, 0.4, 0.5, 0.6]
K: [500.0, 0.0, 319.5, 0.0, 510.0, 239.5, 0.0, 0.0, 1.0]
R: [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
P: [480.0, 0.0, 319.5, 0.0, 0.0, 480.0, 239.5, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
---
height: 1
";

/// A camera 2 m up that looks along the world's x axis: the optical frame's z is the world's x, its x the world's -y.
pub(in crate::rig) const POSE: &str =
    "translation: {x: 1.0, y: 0.0, z: 2.0}\nrotation:\n  x: -0.5\n  y: 0.5\n  z: -0.5\n  w: 0.5\n";

fn with_pose(info: &str, pose: &str) -> Result<Rig> {
    let folder = Folder::new();
    folder.write("left_pose.yaml", pose);
    Rig::load(folder.write("left.yaml", info))
}

#[test]
fn the_pose_is_the_optical_frame_in_the_world() {
    let indented = POSE.replace('\n', "\n  ");
    let poses = [
        POSE.to_owned(),
        format!("transform:\n  {indented}"),
        format!("header:\n  frame_id: world\ntransform:\n  {indented}\n"),
        format!(
            "pose:\n  {}",
            indented.replace("translation", "position").replace("rotation", "orientation")
        ),
    ];

    for pose in poses {
        let rig = with_pose(INFO, &pose).unwrap();
        let camera = &rig.cameras()[0];
        assert_eq!((camera.name(), camera.size()), ("left", (640, 480)));
        assert!((camera.centre() - Point3::new(1.0, 0.0, 2.0)).norm() < 1e-12);
        assert!((camera.forward() - Vector3::x()).norm() < 1e-12);
        let pixel = camera.project(&Point3::new(3.0, 0.0, 2.0)).unwrap();
        assert!((pixel.u - 320.0).abs() < 1e-9 && (pixel.v - 240.0).abs() < 1e-9);
        // A higher point appears higher in the image.
        assert!(camera.project(&Point3::new(3.0, 0.0, 2.1)).unwrap().v < 240.0);
    }
}

#[test]
fn a_printed_message_is_read_and_its_rectification_ignored() {
    let rig = with_pose(MESSAGE, POSE).unwrap();
    let camera = &rig.cameras()[0];
    assert_eq!((camera.name(), camera.size()), ("left", (640, 480)));
    assert_eq!(camera.lens().coefficients()[..8], [0.1, 0.2, 0.0, 0.0, 0.3, 0.4, 0.5, 0.6]);
    assert!((camera.forward() - Vector3::x()).norm() < 1e-12);
}

#[test]
fn a_folder_is_a_rig_with_its_poses_in_one_file() {
    let folder = Folder::new();
    folder.write("a.yaml", INFO);
    folder.write("b.yaml", &INFO.replace("camera_name: left\n", ""));
    let indented = POSE.replace('\n', "\n  ");
    folder.write("poses.yaml", &format!("left:\n  {indented}\nb:\n  transform: {{translation: {{x: 0, y: 0, z: 0}}, rotation: {{x: 0, y: 0, z: 0, w: 1}}}}\n"));

    let calibration = folder.load().unwrap();
    assert_eq!(calibration.format, FORMAT.name);
    let [left, b] = calibration.rig.cameras() else { panic!("{calibration:?}") };
    assert_eq!((left.name(), b.name(), b.centre()), ("left", "b", Point3::origin()));
    folder.write("poses.yaml", &format!("right:\n  {indented}\n"));
    let missing = "poses.yaml: line 1: expected the key `left`, found the keys right; give translation";
    assert_refused(folder.load(), &[missing]);
}

#[test]
fn the_error_about_a_missing_pose_says_what_to_add() {
    let folder = Folder::new();
    let parts = [
        "cam.yaml: camera \"left\": expected its pose in cam_pose.yaml",
        "`left`, in poses.yaml",
        "optical frame in the world",
    ];
    assert_refused(Rig::load(folder.write("cam.yaml", INFO)), &parts);
}

#[test]
fn errors_name_the_file_and_the_line() {
    let infos = [
        (
            INFO.replace("plumb_bob", "fov"),
            "left.yaml: camera \"left\": line 8, `distortion_model`: expected plumb_bob, rational_polynomial or equidistant, found \"fov\"",
        ),
        (
            INFO.replacen("rows: 3", "rows: 2", 1),
            "line 4, `camera_matrix`: expected 2 x 3 numbers as rows and cols say, found 9 in data",
        ),
        (INFO.replacen("500.0", ".nan", 1), "line 4, `camera_matrix`: expected finite numbers, found NaN"),
        (
            INFO.replace("image_height", "height_px"),
            "expected the key `image_height`, found the keys image_width, height_px",
        ),
        (INFO.replacen("500.0", "5e9", 1), "expected a focal length of 0.1 to 100 image widths"),
        (INFO[..INFO.find("0.01").unwrap()].into(), "left.yaml: line "),
    ];

    let poses = [
        (
            POSE.replace("w: 0.5", "w: 0.9"),
            "left_pose.yaml: line 2: expected a quaternion of length 1, found one of length 1.2490",
        ),
        (
            POSE.replace("w: 0.5", "v: 0.5"),
            "left_pose.yaml: line 2: expected the key `w`, found the keys x, y, z, v",
        ),
        (
            POSE.replace("rotation", "rot"),
            "left_pose.yaml: line 1: expected the key `rotation`, found the keys translation, rot",
        ),
        (
            POSE.replace("x: 1.0", "x: .inf"),
            "left_pose.yaml: line 1, `x`: expected finite numbers, found inf",
        ),
        (POSE[..20].into(), "left_pose.yaml: line "),
    ];

    let all = infos.iter().map(|(text, part)| (text.as_str(), POSE, part));
    for (info, pose, part) in all.chain(poses.iter().map(|(text, part)| (INFO, text.as_str(), part))) {
        assert_refused(with_pose(info, pose), &[part]);
    }
}
