use super::super::Hints;
use super::super::testing::{HINTS, assert_refused, assert_sees, load_text};

pub(in crate::rig) const TEXT: &str = r#"{
"calibDataSource": "somewhere",
"cameras": [
  {"name": "00_00", "type": "hd", "resolution": [1920, 1080], "panel": 0, "node": 0,
   "K": [[1600, 0, 940], [0, 1610, 550], [0, 0, 1]],
   "distCoef": [0, 0, 0, 0, 0],
   "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
   "t": [[10], [20], [300]]},
  {"name": "00_01", "type": "hd", "resolution": [1920, 1080],
   "K": [[1600, 0, 940], [0, 1610, 550], [0, 0, 1]],
   "distCoef": [-0.2, 0.1, 0.001, 0.002, 0.05],
   "R": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
   "t": [[0], [0], [200]]}
]}"#;

#[test]
fn centimetres_become_metres_and_points_project_by_k_r_and_t() {
    let found = load_text(TEXT, &Hints::default()).unwrap();
    let camera = &found.rig.cameras()[0];
    assert_eq!((camera.name(), camera.size()), ("00_00", (1920, 1080)));
    assert_sees(camera, [0.5, -0.3, 1.0], 1600.0 * 0.6 / 4.0 + 940.5, 1610.0 * -0.1 / 4.0 + 550.5);
    let lens = found.rig.cameras()[1].lens();
    assert_eq!(lens.coefficients()[..5], [-0.2, 0.1, 0.001, 0.002, 0.05]);
    assert!(found.notes[0].contains("centimetres"));
}

#[test]
fn a_camera_without_a_resolution_takes_the_hint() {
    let text = TEXT.replace("\"resolution\": [1920, 1080],", "");
    assert_eq!(load_text(&text, &HINTS).unwrap().rig.cameras()[1].size(), (640, 480));

    assert_refused(load_text(&text, &Hints::default()), &["\"00_00\": expected to know the size"]);
}

#[test]
fn bad_files_are_refused_by_line_and_key() {
    let with = |old: &str, new: &str| load_text(&TEXT.replacen(old, new, 1), &HINTS);
    assert_refused(
        load_text(&TEXT[..500], &HINTS),
        &["calibration.txt: line 13: expected YAML or JSON", "cut off"],
    );
    assert_refused(
        with("\"K\": [[1600, 0, 940]", "\"K\": [[1600, 0]"),
        &["line 5, `cameras[0].K`: expected rows of 2 numbers like the first, found 3"],
    );

    assert_refused(with("[300]", "[NaN]"), &["line 8, `cameras[0].t`: expected finite numbers, found NaN"]);
    assert_refused(
        with("\"t\":", "\"x\":"),
        &["line 4, `cameras[0]`: expected the key `t`, found the keys name", "write name"],
    );
    assert_refused(
        with("0.001, 0.002, 0.05", "0.001"),
        &["line 11, `cameras[1].distCoef`: expected 0, 4, 5, 8, 12 or 14", "found 3"],
    );

    assert_refused(with("[0, -1, 0]", "[0, -1.5, 0]"), &["line 12, `cameras[1].R`", "determinant 1.5"]);

    assert_refused(with("00_01", "00_00"), &["camera \"00_00\": line 9", "on line 4 too"]);
    assert_refused(with("1600, 0", "16, 0"), &["\"00_00\": expected a focal length"]);
    assert_refused(
        with("1920, 1080", "1920"),
        &["line 4, `cameras[0].resolution`: expected width and height", "found [1920"],
    );
}
