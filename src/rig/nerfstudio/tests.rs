use super::super::Hints;
use super::super::testing::{HINTS, assert_refused, assert_sees, load_text};
use crate::{Error, MissingHint};

pub(in crate::rig) const TEXT: &str = r#"{
"camera_model": "OPENCV", "fl_x": 500, "fl_y": 501, "cx": 320, "cy": 240, "w": 640, "h": 480,
"k1": -0.1, "k2": 0.02, "p1": 0.001, "p2": 0.002,
"frames": [
  {"file_path": "images/frame_1.png", "k1": 0, "k2": 0, "p1": 0, "p2": 0,
   "transform_matrix": [[1, 0, 0, 0.1], [0, 1, 0, 0.2], [0, 0, 1, 3], [0, 0, 0, 1]]},
  {"file_path": "images/frame_2.png", "w": 600,
   "transform_matrix": [[0, 0, 1, 3], [1, 0, 0, 0.2], [0, 1, 0, 0.1], [0, 0, 0, 1]]}
]}"#;

#[test]
fn opengl_cameras_look_along_minus_z_with_y_up() {
    let rig = load_text(TEXT, &HINTS).unwrap().rig;
    let camera = &rig.cameras()[0];
    assert_eq!((camera.name(), camera.size()), ("frame_1", (640, 480)));
    // The point is 2 m in front of the camera, to the right of and above its axis.
    assert_sees(camera, [0.5, 0.5, 1.0], 500.0 * 0.4 / 2.0 + 320.0, 501.0 * -0.3 / 2.0 + 240.0);
    // The second camera stands on the x axis and looks towards -x.
    assert!((rig.cameras()[1].forward() + nalgebra::Vector3::x()).norm() < 1e-12);
}

#[test]
fn values_in_a_frame_override_those_at_the_top() {
    let rig = load_text(TEXT, &HINTS).unwrap().rig;
    assert!(rig.cameras()[0].lens().is_none());
    assert_eq!(rig.cameras()[1].lens().coefficients()[..5], [-0.1, 0.02, 0.001, 0.002, 0.0]);
    assert_eq!(rig.cameras()[1].size(), (600, 480));
}

#[test]
fn a_field_of_view_gives_the_focal_length() {
    let angle = 2.0 * (320.0_f64 / 500.0).atan();
    let text = TEXT.replace(
        "\"fl_x\": 500, \"fl_y\": 501, \"cx\": 320, \"cy\": 240, \"w\": 640, \"h\": 480",
        &format!("\"camera_angle_x\": {angle}"),
    );
    let rig = load_text(&text.replace(" \"w\": 600,", ""), &HINTS).unwrap().rig;
    let k = rig.cameras()[0].intrinsics();
    assert!((k[(0, 0)] - 500.0).abs() < 1e-9 && (k[(1, 1)] - 500.0).abs() < 1e-9);
    assert_eq!((k[(0, 2)], k[(1, 2)]), (320.0, 240.0));

    let no_size = Hints { size: None, ..HINTS };
    let refused = load_text(&text, &no_size);
    assert!(matches!(refused, Err(Error::MissingHint { what: MissingHint::Size, .. })));
    assert_refused(refused, &["calibration.txt: line 5, `frames[0]`", "or give width and height"]);
}

#[test]
fn the_scale_is_required() {
    let refused = load_text(TEXT, &Hints::default());
    assert!(matches!(refused, Err(Error::MissingHint { what: MissingHint::MetresPerUnit, .. })));
    assert_refused(refused, &["calibration.txt: ", "any scale; give the metres per unit"]);
}

#[test]
fn bad_files_are_refused_by_line_and_key() {
    let with = |old: &str, new: &str| load_text(&TEXT.replacen(old, new, 1), &HINTS);
    assert_refused(with("OPENCV", "FOV"), &["line 2, `camera_model`", "undistort the images"]);
    assert_refused(with("\"k1\": -0.1", "\"k4\": -0.1"), &["line 3, `k4`", "undistort the images"]);
    assert_refused(load_text(&TEXT[..400], &HINTS), &["calibration.txt: line 8: expected YAML or JSON"]);
    assert_refused(
        with("[0, 1, 0, 0.2], [0, 0, 1, 3], ", ""),
        &["line 6, `frames[0].transform_matrix`: expected 3 x 4 or 4 x 4 numbers, found 2 x 4"],
    );
    assert_refused(with("[0, 1, 0, 0.2]", "[0, -1, 0, 0.2]"), &["line 6", "determinant -1.0"]);
    assert_refused(with("frame_2", "frame_1"), &["camera \"images_frame_1\": line 7", "on line 5 too"]);
    assert_refused(with("\"fl_x\": 500", "\"fl_x\": 5e9"), &["\"frame_1\": expected a focal length"]);
}
