use super::super::Hints;
use super::super::testing::{assert_refused, assert_sees, load_text};
use crate::Result;
use crate::rig::Calibration;

pub(in crate::rig) const TEXT: &str = r#"<?xml version="1.0"?>
<calibration created="2026-01-01" qtm-version="2026.1" type="regular">
<cameras>
<camera active="1" serial="26580" model="Miqus Video" viewrotation="0">
<fov_video left="0" top="0" right="1919" bottom="1087"/>
<transform x="100" y="200" z="3000" r11="1" r12="0" r13="0" r21="0" r22="1" r23="0" r31="0" r32="0" r33="1"/>
<intrinsic sensorMaxU="122879" sensorMaxV="69631" focalLengthU="108800" focalLengthV="108864" centerPointU="61440"
 centerPointV="34816" skew="0" radialDistortion1="0" radialDistortion2="0" radialDistortion3="0"
 tangentalDistortion1="0" tangentalDistortion2="0"/>
</camera>
<camera active="1" serial="12059" model="Oqus 300+" viewrotation="0"></camera>
</cameras>
</calibration>
"#;

fn load(text: &str) -> Result<Calibration> {
    load_text(text, &Hints::default())
}

#[test]
fn the_third_axis_points_backwards_and_64_units_are_a_pixel() {
    let found = load(TEXT).unwrap();
    let camera = &found.rig.cameras()[0];
    assert_eq!((camera.name(), camera.size()), ("26580", (1920, 1088)));
    assert!((camera.centre() - nalgebra::Point3::new(0.1, 0.2, 3.0)).norm() < 1e-12);
    assert_sees(camera, [0.5, 0.5, 1.0], 1700.0 * 0.4 / 2.0 + 960.5, 1701.0 * -0.3 / 2.0 + 544.5);
}

#[test]
fn cameras_without_video_or_calibration_are_left_out_with_a_note() {
    assert_eq!(load(TEXT).unwrap().notes, ["camera 12059 is left out: it records no video"]);
    let marker = TEXT.replace("Miqus Video", "Oqus 700");
    assert_refused(load(&marker), &["line 11, <camera>: expected a <fov_marker> in it, found none"]);
    let off = marker.replace("active=\"1\" serial=\"12059\"", "active=\"0\" serial=\"12059\"");
    assert_eq!(load(&off).unwrap().notes, ["camera 12059 is left out: it is not calibrated"]);
}

#[test]
fn crop_and_scale_move_the_principal_point() {
    let cut = TEXT.replace("left=\"0\" top=\"0\"", "left=\"100\" top=\"60\"");
    let rig = load(&cut).unwrap().rig;
    assert_eq!(rig.cameras()[0].size(), (1820, 1028));
    assert_sees(&rig.cameras()[0], [0.1, 0.2, 1.0], 860.5, 484.5);

    let half =
        cut.replace("viewrotation=\"0\">\n<fov", "viewrotation=\"90\" video_resolution=\"540p\">\n<fov");
    let found = load(&half).unwrap();
    assert_eq!(found.rig.cameras()[0].size(), (910, 514));
    assert_sees(&found.rig.cameras()[0], [0.5, 0.2, 1.0], 850.0 * 0.4 / 2.0 + 860.5 / 2.0, 484.5 / 2.0);
    assert!(found.notes.iter().any(|note| note.contains("rotated by 90 degrees")));
}

#[test]
fn distortion_coefficients_go_to_their_places_in_opencvs_order() {
    let text = TEXT
        .replace("Distortion1=\"0\"", "Distortion1=\"0.1\"")
        .replace("Distortion3=\"0\"", "Distortion3=\"0.3\"");
    let rig = load(&text).unwrap().rig;
    assert_eq!(rig.cameras()[0].lens().coefficients()[..5], [0.1, 0.0, 0.1, 0.0, 0.3]);
}

#[test]
fn bad_files_are_refused_by_line() {
    let with = |old: &str, new: &str| load(&TEXT.replacen(old, new, 1));
    assert_refused(load(&TEXT[..500]), &["calibration.txt: line 8: expected XML", "it may be cut off"]);
    assert_refused(with("r22=\"1\"", "r22=\"0.9\""), &["line 6, <transform>: r11 .. r33", "determinant 0.9"]);
    assert_refused(
        with("x=\"100\"", "x=\"nan\""),
        &["line 6, <transform>: expected a finite number in x, found \"nan\""],
    );
    assert_refused(with("skew=\"0\"", ""), &["line 7, <intrinsic>: expected an attribute skew"]);
    assert_refused(
        with("right=\"1919\"", "right=\"-5\""),
        &["line 5, <fov_video>: expected an image of 1 to"],
    );

    assert_refused(with("108800", "1088"), &["\"26580\": expected a focal length"]);
    assert_refused(with("Oqus 300+", "Miqus Video"), &["line 11"]);
    let twice = TEXT.replace("12059\" model=\"Oqus 300+", "26580\" model=\"Miqus Video");
    assert_refused(load(&twice), &["camera \"26580\": line 11", "on line 4 too"]);
    let none = TEXT.replace("active=\"1\"", "active=\"0\"");
    assert_refused(load(&none), &["expected a calibrated camera at least, found 2 <camera>"]);
}
