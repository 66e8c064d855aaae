use super::super::Hints;
use super::super::testing::{Folder, HINTS, assert_refused, assert_sees, load_text};
use crate::rig::Calibration;
use image::GrayImage;

pub(in crate::rig) const TEXT: &str = "2
left.png 500 0 320 0 501 240 0 0 1 1 0 0 0 1 0 0 0 1 0.1 0.2 3
right.png 400 0 300 0 401 200 0 0 1 0 -1 0 1 0 0 0 0 1 0 0 2
";

#[test]
fn points_project_by_k_r_and_t() {
    let rig = load_text(TEXT, &HINTS).unwrap().rig;
    assert_eq!((rig.cameras()[0].name(), rig.cameras()[1].name()), ("left", "right"));
    // K counts pixel centres as whole numbers, so image points lie half a pixel farther.
    let z = 3.0 + 1.0;
    assert_sees(&rig.cameras()[0], [0.5, -0.3, 1.0], 500.0 * 0.6 / z + 320.5, 501.0 * -0.1 / z + 240.5);
    assert_sees(&rig.cameras()[1], [0.5, -0.3, 1.0], 400.0 * 0.3 / 3.0 + 300.5, 401.0 * 0.5 / 3.0 + 200.5);
}

#[test]
fn sizes_come_from_the_images_beside_the_file_or_from_the_hint() {
    let folder = Folder::of(&[("rig_par.txt", TEXT)]);
    folder.write("image/right.png", "no image");
    let path = folder.path().join("rig_par.txt");
    assert_refused(Calibration::load(&path, &HINTS), &["right.png: expected an image"]);

    GrayImage::new(64, 48).save(folder.path().join("left.png")).unwrap();
    GrayImage::new(60, 40).save(folder.path().join("image/right.png")).unwrap();

    let no_hints = Hints::default();
    // The focal lengths belong to larger images but are still plausible.
    let rig = Calibration::load(&path, &no_hints).unwrap().rig;
    assert_eq!((rig.cameras()[0].size(), rig.cameras()[1].size()), ((64, 48), (60, 40)));
    std::fs::remove_file(folder.path().join("image/right.png")).unwrap();
    assert_refused(Calibration::load(&path, &no_hints), &["camera \"right\"", "give width and height"]);
}

#[test]
fn bad_files_are_refused_by_line() {
    let with = |old: &str, new: &str| load_text(&TEXT.replace(old, new), &HINTS);
    assert_refused(with("2\n", "3\n"), &["calibration.txt: line 1: expected as many", "3, found 2"]);
    assert_refused(with(" 0 0 2\n", " 0\n"), &["line 3: expected 21 numbers, found 19"]);
    assert_refused(with("0.2 3\n", "NaN 3\n"), &["line 2: expected finite numbers, found NaN"]);
    assert_refused(with("0 -1 0 1 0 0", "0 -1 0 2 0 0"), &["line 3: rotation r11 .. r33", "determinant 2.0"]);
    assert_refused(with("right.png", "left.png"), &["camera \"left\": line 3", "on line 2 too"]);
    assert_refused(with("500 0 320 0 501", "5 0 320 0 5"), &["\"left\": expected a focal length"]);
    assert_refused(load_text("2\n", &HINTS), &["expected a calibration", "begins \"2\""]);
}
