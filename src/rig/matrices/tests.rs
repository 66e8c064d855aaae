use super::super::testing::{HINTS, assert_refused, assert_sees, load_folder, load_text};
use super::super::{Hints, length};

pub(in crate::rig) const ROWS: &str = "# a rig of two\n# left:\n500 0 320 960\n0 500 240 720\n0 0 1 3\n\nright =\n[480 0 320 900;\n 0 480 240 700;\n 0 0 1 3]\n";

#[test]
fn rows_lines_and_folders_give_the_same_cameras() {
    let lines = "left 500 0 320 960 0 500 240 720 0 0 1 3\n// right\n480, 0, 320, 900, 0, 480, 240, 700, 0, 0, 1, 3\n";
    let files = [
        ("left.txt", "500 0 320 960\n0 500 240 720\n0 0 1 3\n"),
        ("README.txt", "two cameras\n"),
        ("right.txt", "480 0 320 900 0 480 240 700 0 0 1 3"),
        ("right.npy", "480 0"),
    ];
    let rows = load_text(ROWS, &HINTS).unwrap();

    let others = [load_text(lines, &HINTS).unwrap(), load_folder(&files, &HINTS).unwrap()];
    assert_eq!((rows.rig.cameras()[0].name(), rows.rig.cameras()[1].name()), ("left", "right"));
    assert_sees(
        &rows.rig.cameras()[0],
        [0.5, -0.3, 1.0],
        500.0 * 0.5 / 4.0 + 320.5,
        500.0 * -0.3 / 4.0 + 240.5,
    );
    assert!(others.iter().all(|other| other.rig == rows.rig));
    assert!(others[1].notes.contains(&"README.txt is left out: it holds no matrix".to_owned()));
}

#[test]
fn cameras_without_names_are_numbered() {
    let text = "500 0 320 960\n0 500 240 720\n0 0 1 3\n\n500 0 320 960\n0 500 240 720\n0 0 1 4\n";
    let rig = load_text(text, &HINTS).unwrap().rig;
    assert_eq!((rig.cameras()[0].name(), rig.cameras()[1].name()), ("camera0", "camera1"));
}

#[test]
fn metres_are_assumed_and_sizes_required() {
    let found = load_text(ROWS, &Hints { size: Some((640, 480)), metres_per_unit: None }).unwrap();
    assert_eq!(found.notes[0], length::NOTE);
    let millimetres = Hints { metres_per_unit: Some(0.001), ..HINTS };
    let rig = load_text(ROWS, &millimetres).unwrap().rig;
    assert!((rig.cameras()[0].cam_from_world().translation.vector.z - 0.003).abs() < 1e-15);
    assert_refused(load_text(ROWS, &Hints::default()), &["camera \"left\": expected to know the size"]);
}

#[test]
fn a_negative_sign_is_flipped_and_noted() {
    let negative = ROWS
        .replace("500 0 320 960\n0 500 240 720\n0 0 1 3", "-500 0 -320 -960\n0 -500 -240 -720\n0 0 -1 -3");
    let found = load_text(&negative, &HINTS).unwrap();
    assert_sees(
        &found.rig.cameras()[0],
        [0.5, -0.3, 1.0],
        500.0 * 0.5 / 4.0 + 320.5,
        500.0 * -0.3 / 4.0 + 240.5,
    );
    assert_eq!(found.notes[0], "signs flipped: the matrices of left give negative depths");
}

#[test]
fn bad_files_are_refused_by_line() {
    let with = |old: &str, new: &str| load_text(&ROWS.replacen(old, new, 1), &HINTS);
    assert_refused(with("0 0 1 3\n\n", "\n"), &["calibration.txt: line 6: expected three rows", "found 2"]);
    assert_refused(with(" 0 0 1 3]\n", ""), &["line 9: expected three rows", "found 2"]);
    assert_refused(with("0 500 240 720", "0 500 240"), &["line 4: expected 4 numbers, found 3"]);
    assert_refused(with("0 500 240 720", "0 500 240 nan"), &["line 4: expected finite numbers, found nan"]);
    assert_refused(with("0 500 240 720", "0 5oo 240 720"), &["line 4: expected a number, found \"5oo\""]);
    assert_refused(with("right", "left"), &["camera \"left\": line 8", "on line 3 too"]);
    assert_refused(with("0 0 1 3", "0 500 240 1"), &["camera \"left\": expected a 3x4", "singular"]);
    assert_refused(with("500 0 320", "5 0 320"), &["\"left\": expected a focal length"]);
    let two = [("left.txt", ROWS)];
    assert_refused(load_folder(&two, &HINTS), &["left.txt: expected one 3x4 matrix, found 2"]);
}
