use super::*;
use nalgebra::{Point3, Rotation3};

pub(in crate::rig) const CAMERA: &str = r#"
[cam_0]
name = "left"
size = [640, 480]
matrix = [[500.0, 0.0, 319.5], [0.0, 501, 239.5], [0, 0, 1]]
distortions = [-0.1, 0.01, 0.0, 1e-4, 0]
rotation = [1.5, 0.2, -0.3]
translation = [0.1, 1, 3.0]
fisheye = false
"#;

fn message(text: &str) -> String {
    Rig::from_toml(text).unwrap_err().to_string()
}

/// The error for the sample with the value of `line`'s key replaced.
fn message_with(line: &str) -> String {
    let key = line.split_whitespace().next().unwrap();
    let lines = CAMERA.lines().map(|old| if old.starts_with(key) { line } else { old });
    message(&lines.collect::<Vec<_>>().join("\n"))
}

fn assert_contains(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

#[test]
fn a_file_is_read_with_its_pixel_centres_moved_by_one_half() {
    let rig = Rig::from_toml(CAMERA).unwrap();
    let camera = &rig.cameras()[0];
    assert_eq!((camera.name(), camera.size()), ("left", (640, 480)));
    assert_eq!((camera.intrinsics()[(0, 2)], camera.intrinsics()[(1, 2)]), (320.0, 240.0));
    assert_eq!(camera.lens().coefficients()[..5], [-0.1, 0.01, 0.0, 1e-4, 0.0]);
    let translation = camera.cam_from_world() * Point3::origin();
    assert_eq!(translation, Point3::new(0.1, 1.0, 3.0));
}

#[test]
fn cameras_keep_the_files_order_and_metadata_is_no_camera() {
    let table =
        |title: &str| CAMERA.replace("[cam_0]", title).replace("left", &title.replace(['[', ']'], ""));
    let text = ["[metadata]\nerror = 0.1", &table("[cam_10]"), &table("[b]"), &table("[cam_2]")].join("\n");
    let rig = Rig::from_toml(&text).unwrap();
    let names: Vec<_> = rig.cameras().iter().map(Camera::name).collect();
    assert_eq!(names, ["cam_10", "b", "cam_2"]);
}

#[test]
fn a_camera_without_a_name_is_named_after_its_table() {
    let rig = Rig::from_toml(&CAMERA.replace("name = \"left\"", "")).unwrap();
    assert_eq!(rig.cameras()[0].name(), "cam_0");
}

#[test]
fn writing_and_reading_gives_the_same_rig() {
    let lens = ["[]", "[0.1, 0, 0, 0.2]", "[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]"];
    let tables = (0..12).map(|i| {
        CAMERA
            .replace("cam_0", &format!("cam_{i}"))
            .replace("left", &format!("caméra \\\"{i}\\\" \\\\ [x]\\t\\u0007"))
            .replace("[-0.1, 0.01, 0.0, 1e-4, 0]", lens[i % lens.len()])
            .replace("1.5, 0.2", &format!("{i}e-1, 3.0"))
    });

    let rig = Rig::from_toml(&tables.collect::<String>()).unwrap();
    let text = rig.to_toml();
    let again = Rig::from_toml(&text).unwrap();
    assert!(text.contains("[cam_00]") && text.contains("[cam_11]") && text.contains("[metadata]"));

    for (a, b) in rig.cameras().iter().zip(again.cameras()) {
        assert_eq!((a.name(), a.size(), a.lens()), (b.name(), b.size(), b.lens()));
        // Roundings of the half pixel and of the way from quaternion to rotation vector and back.
        assert!((a.intrinsics() - b.intrinsics()).abs().max() < 1e-12);
        let motion = a.cam_from_world() * b.cam_from_world().inverse();
        assert!(motion.rotation.angle() < 1e-14 && motion.translation.vector.norm() < 1e-13);
    }
}

#[test]
fn a_rotation_may_be_a_vector_a_column_or_a_matrix() {
    let expected = Rotation3::from_scaled_axis(Vector3::new(1.5, 0.2, -0.3));
    let m = expected.matrix();
    let row = |r: usize| format!("[{:.5}, {:.5}, {:.5}]", m[(r, 0)], m[(r, 1)], m[(r, 2)]);
    let matrix = format!("[{}, {}, {}]", row(0), row(1), row(2));
    // The matrix is rounded to five digits, the others are exact.

    for (rotation, tolerance) in
        [("[1.5, 0.2, -0.3]", 1e-15), ("[[1.5], [0.2], [-0.3]]", 1e-15), (&matrix, 2e-5)]
    {
        let rig = Rig::from_toml(&CAMERA.replace("[1.5, 0.2, -0.3]", rotation)).unwrap();
        let found = rig.cameras()[0].cam_from_world().rotation.to_rotation_matrix();
        assert!((found.matrix() - expected.matrix()).abs().max() < tolerance, "{rotation}");
        assert!((found.matrix().determinant() - 1.0).abs() < 1e-14);
    }
}

#[test]
fn sizes_may_be_written_as_whole_floats() {
    let rig = Rig::from_toml(&CAMERA.replace("[640, 480]", "[640.0, 480.0]")).unwrap();
    assert_eq!(rig.cameras()[0].size(), (640, 480));
    assert_contains(&message_with("size = [640.5, 480]"), &["whole numbers", "640.5"]);
    assert_contains(&message_with("size = [640, -1]"), &["whole numbers", "-1"]);
    assert_contains(&message_with("size = [640]"), &["line 4", "expected 2 numbers, found 1;"]);
}

#[test]
fn errors_name_line_camera_table_key_and_next_step() {
    let place = ["camera \"left\"", "table [cam_0]"];
    for (line, parts) in [
        ("matrix = [[1, 0], [0, 1]]", ["line 5", "`matrix`", "expected 3 x 3 numbers, found 2 x 2", "write"]),
        ("matrix = [[1, 0, 0], [0, 1]]", ["line 5", "`matrix`", "equal length", "write"]),
        ("matrix = 500", ["line 5", "`matrix`", "found a single number", "write"]),
        ("matrix = [[nan, 0, 1], [0, 1, 1], [0, 0, 1]]", ["line 5", "`matrix`", "found NaN", "calibrate"]),
        ("distortions = [1, 2, 3]", ["line 6", "`distortions`", "found 3", "write"]),
        ("rotation = [\"a\", 0, 0]", ["line 7", "`rotation`", "expected numbers, found a value", "write"]),
        ("rotation = [0, 0, 0, 1]", ["line 7", "`rotation`", "found 4", "Rodrigues"]),
        (
            "rotation = [[2, 0, 0], [0, 1, 0], [0, 0, 1]]",
            ["line 7", "`rotation`", "orthonormal", "determinant 2.0"],
        ),
        (
            "rotation = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]",
            ["line 7", "`rotation`", "orthonormal", "determinant -1"],
        ),
        ("translation = [0, inf, 0]", ["line 8", "`translation`", "found inf", "calibrate"]),
        ("fisheye = true", ["line 6", "`distortions`", "4 fisheye coefficients", "found 5"]),
        ("fisheye = 0", ["line 9", "`fisheye`", "true or false", "integer 0"]),
    ] {
        let message = message_with(line);
        assert_contains(&message, &place);
        assert_contains(&message, &parts);
    }
    assert_contains(&message_with("name = 3"), &["line 3", "`name`", "expected a string, found integer 3"]);
}

#[test]
fn a_missing_key_is_named_with_the_tables_line() {
    for key in ["size", "matrix", "distortions", "rotation", "translation"] {
        let text: String =
            CAMERA.lines().filter(|l| !l.starts_with(key)).map(|l| l.to_owned() + "\n").collect();
        assert_contains(&message(&text), &["line 2", &format!("`{key}`"), "found none", "write"]);
    }
}

#[test]
fn errors_of_the_whole_file_are_reported() {
    assert_contains(&message("[cam_0]\nsize = [1,\nmatrix"), &["line 3", "expected TOML"]);
    assert_contains(&message("[cam_0]\nsize = 1\nsize = 2"), &["line 3", "duplicate"]);
    assert_contains(&message(""), &["at least one camera"]);
    assert_contains(&message("[metadata]\nerror = 1"), &["at least one camera"]);
    assert_contains(&message("unit = 3"), &["line 1", "`unit`", "integer 3", "[metadata]"]);
    assert_contains(
        &message(&(CAMERA.to_owned() + &CAMERA.replace("cam_0", "cam_1"))),
        &["\"left\"", "unique"],
    );
    assert_contains(
        &message_with("matrix = [[-5, 0, 1], [0, 5, 1], [0, 0, 1]]"),
        &["\"left\"", "positive focal"],
    );
}

#[test]
fn a_file_cut_short_anywhere_is_an_error_or_a_rig() {
    for end in 0..CAMERA.len() {
        if let Ok(rig) = Rig::from_toml(&CAMERA[..end]) {
            assert!(CAMERA[end..].trim_start().starts_with("fisheye") || end + 20 > CAMERA.len());
            assert_eq!(rig.len(), 1);
        }
    }
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let message = Rig::load("/nowhere/rig.toml").unwrap_err().to_string();
    assert_contains(&message, &["/nowhere/rig.toml: expected a calibration file", "No such file"]);
}
