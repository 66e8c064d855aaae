mod hostile;

use super::super::testing::{
    Folder, HINTS, Sample, assert_points_return, assert_refused, load_folder, load_text, several_files,
    single_files,
};
use super::{Calibration, Hints, UPSIDE_DOWN, colmap, easymocap, opencv, ros};
use crate::Result;
use std::collections::HashSet;

#[test]
fn a_world_whose_z_points_down_is_noted() {
    let notes = |heights: [f64; 2]| {
        let line = |z: f64| format!("500 0 320 0 0 500 240 0 0 0 1 {}\n", -z);
        load_text(&heights.map(line).concat(), &HINTS).unwrap().notes
    };
    let is_noted = |heights| notes(heights).iter().any(|note| note == UPSIDE_DOWN);
    assert!(is_noted([-2.0, -0.5]));
    assert!(!is_noted([-2.0, 0.5]) && !is_noted([2.0, 0.5]) && !is_noted([0.0, -2.0]));
}

#[test]
fn a_camera_too_far_for_metres_is_noted_unless_the_unit_was_given() {
    let text = "500 0 320 0 0 500 240 0 0 0 1 -1500\n500 0 320 0 0 500 240 0 0 0 1 -2\n";
    let load = |metres_per_unit| load_text(text, &Hints { metres_per_unit, ..HINTS }).unwrap();
    let is_noted = |calibration: Calibration| {
        let says = |note: &String| note.contains("m from the world's origin: are these metres?");
        assert_eq!(calibration.notes.iter().any(says), calibration.is_unit_doubtful);
        calibration.is_unit_doubtful
    };
    assert!(is_noted(load(None)) && !is_noted(load(Some(1.0))));
}

#[test]
fn unprojected_points_project_to_their_pixels_in_every_format() {
    let single =
        single_files().map(|Sample { name, text }| Calibration::parse(name, text.as_bytes(), &HINTS));
    let several = several_files().into_iter().map(|files| load_folder(files, &HINTS));
    for calibration in single.chain(several) {
        for camera in calibration.unwrap().rig.cameras() {
            // The strongest lens of these files folds back towards the image's corners.
            let reached = assert_points_return(camera);
            assert!(reached > 500, "{}: {reached}", camera.name());
        }
    }
}

/// The calibration, or the error's message with the first `old` replaced by `new`.
fn named(found: Result<Calibration>, old: &str, new: &str) -> std::result::Result<Calibration, String> {
    found.map_err(|e| e.to_string().replacen(old, new, 1))
}

#[test]
fn bytes_and_a_file_of_the_same_content_give_the_same_calibration() {
    let folder = Folder::new();
    for Sample { name, text } in single_files() {
        let path = folder.write(name, text);
        let path_text = path.to_str().unwrap();
        let mut formats = HashSet::new();
        for hints in [HINTS, Hints { size: None, ..HINTS }, Hints::default()] {
            let of_file = Calibration::load(&path, &hints);
            assert_eq!(Calibration::parse(path_text, text.as_bytes(), &hints), of_file);
            formats.extend(of_file.iter().map(|found| found.format));
            let of_bytes = named(Calibration::parse(name, text.as_bytes(), &hints), name, "-");
            assert_eq!(of_bytes, named(of_file, path_text, "-"), "{name}");
        }
        assert_eq!(formats.len(), 1, "{name}");
    }
}

#[test]
fn errors_about_bytes_and_about_their_file_differ_only_in_the_name() {
    let folder = Folder::new();
    let no_text = Sample { name: "cameras.bin", text: "" };
    for Sample { name, text } in single_files().chain([no_text]) {
        let half = [&text.as_bytes()[..text.len() / 2], b"\n1 x\n"].concat();
        for bytes in [half, [text.as_bytes(), &[0xff]].concat(), b"\r\n".to_vec()] {
            let path = folder.path().join(name);
            std::fs::write(&path, &bytes).unwrap();
            let of_file = named(Calibration::load(&path, &HINTS), path.to_str().unwrap(), "-");
            let of_bytes = named(Calibration::parse(name, &bytes, &HINTS), name, "-");
            assert!(of_bytes.is_err() && of_bytes == of_file, "{of_bytes:?}, and of the file {of_file:?}");
        }
    }
}

#[test]
fn bytes_that_are_not_text_are_refused_with_the_position() {
    let parts =
        ["cameras.bin: expected text, found a byte at 3 that is none; export", "colmap model_converter"];
    assert_refused(Calibration::parse("cameras.bin", b"abc\xff", &HINTS), &parts);
}

#[test]
fn a_part_of_a_calibration_in_several_files_names_the_missing_one() {
    let bare = |text: &str| text.lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>().join("\n");
    let (cameras, images) = (colmap::tests::CAMERAS, colmap::tests::IMAGES);
    let lens_alone = &opencv::tests::YAML[..opencv::tests::YAML.find("rvec").unwrap()];

    let cases = [
        ("upload-17", cameras, "expected images.txt beside it"),
        ("upload-17", &bare(cameras), "expected images.txt beside it"),
        ("images.txt", images, "expected cameras.txt beside it"),
        ("images.txt", &bare(images), "expected cameras.txt beside it"),
        ("intri_new.yml", easymocap::tests::INTRI, "expected extri_new.yml beside it"),
        ("extri.yml", easymocap::tests::EXTRI, "expected intri.yml beside it"),
        (
            "left.yaml",
            ros::tests::INFO,
            "expected its pose in left_pose.yaml or, under `left`, in poses.yaml",
        ),
        ("intrinsics.yml", lens_alone, "expected extrinsics.yml beside it"),
    ];

    for (name, text, part) in cases {
        let load = "save all of them into one folder and read it with Calibration::load";
        assert_refused(
            Calibration::parse(name, text.as_bytes(), &HINTS),
            &[&format!("{name}: "), part, load],
        );
    }
}

#[test]
fn nothing_is_read_from_disk_for_bytes() {
    let folder = Folder::of(several_files()[0]);
    let path = folder.path().join("cameras.txt");
    assert!(Calibration::load(&path, &HINTS).is_ok());
    let (cameras, name) = (colmap::tests::CAMERAS, path.to_str().unwrap());
    assert_refused(Calibration::parse(name, cameras.as_bytes(), &HINTS), &["expected images.txt beside it"]);
}

#[test]
fn a_camera_named_after_its_file_takes_the_name_of_the_bytes() {
    let name_of = |name: &str| {
        let found = Calibration::parse(name, opencv::tests::YAML.as_bytes(), &HINTS).unwrap();
        found.rig.cameras()[0].name().to_owned()
    };
    let names = ["left.yml", "studio/left.yml", "left/calib.yml", "calib.yml", ""].map(name_of);
    assert_eq!(names, ["left", "left", "left", "calib", "calibration"]);
}

#[test]
fn bytes_without_a_name_are_called_calibration() {
    assert_refused(Calibration::parse("", b"?", &HINTS), &["calibration: expected a calibration ("]);
}
