use super::super::Hints;
use super::super::testing::{assert_refused, assert_sees, load_text};

const HINTS: Hints = Hints { size: Some((360, 288)), metres_per_unit: None };

pub(in crate::rig) const TEXT: &str = r#"{
"10": {"R": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "T": [[1000], [-5000], [2000]],
  "fx": 438, "fy": 439, "cx": 185, "cy": 139, "k": [[0], [0], [0]], "p": [[0], [0]]},
"2": {"R": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "T": [0, -4000, 1000],
  "fx": 438, "fy": 439, "cx": 185, "cy": 139, "k": [0.1, 0.2, 0.3], "p": [0.4, 0.5]}
}"#;

#[test]
fn t_is_the_camera_centre_in_millimetres() {
    let rig = load_text(TEXT, &HINTS).unwrap().rig;
    let names: Vec<_> = rig.cameras().iter().map(|camera| camera.name()).collect();
    assert_eq!(names, ["10", "2"]);
    let distance = (rig.cameras()[0].centre() - nalgebra::Point3::new(1.0, -5.0, 2.0)).norm();
    assert!(distance < 1e-12, "{distance:e}");
    // The camera looks along +y, with the image's lower edge towards -z.
    assert_sees(&rig.cameras()[0], [1.5, 0.0, 1.0], 438.0 * 0.5 / 5.0 + 185.5, 439.0 * 1.0 / 5.0 + 139.5);
}

#[test]
fn radial_and_tangential_coefficients_go_to_their_places_in_opencvs_order() {
    let rig = load_text(TEXT, &HINTS).unwrap().rig;
    assert_eq!(rig.cameras()[1].lens().coefficients()[..5], [0.1, 0.2, 0.4, 0.5, 0.3]);
}

#[test]
fn bad_files_are_refused_by_line_and_key() {
    let with = |old: &str, new: &str| load_text(&TEXT.replacen(old, new, 1), &HINTS);
    assert_refused(load_text(&TEXT[..200], &HINTS), &["calibration.txt: line 4: expected YAML or JSON"]);
    assert_refused(load_text(TEXT, &Hints::default()), &["camera \"10\": expected to know the size"]);

    assert_refused(
        with("\"2\"", "\"10\""),
        &["line 4: expected each key once, found `10` again, first on line 2"],
    );
    assert_refused(
        with("[[1, 0, 0], [0, 0, -1]", "[[1, 0, 0], [0, 1, 0]"),
        &["line 2, `10.R`", "orthonormal"],
    );
    assert_refused(
        with("\"fx\": 438", "\"fx\": \"wide\""),
        &["line 3, `10.fx`: expected a number, found \"wide\""],
    );
    assert_refused(
        with("\"cy\": 139,", ""),
        &["line 2, `10`: expected the key `cy`, found the keys R, T, fx"],
    );

    assert_refused(with("0.1, 0.2, 0.3", "0.1, 0.2"), &["line 5, `2.k`: expected 3 numbers, found 2"]);
    assert_refused(with("438", "0"), &["\"10\": expected positive focal lengths"]);
}
