use super::*;
use crate::rig::testing::{Folder, assert_refused};
use crate::rig::{Calibration, Rig};

/// A file in the form that `cv::FileStorage` writes, after OpenCV's documentation of the class.
pub(in crate::rig) const YAML: &str = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   \
cols: 3\n   dt: d\n   data: [ 500., 0., 319.5, 0., 510., 239.5, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   \
rows: 5\n   cols: 1\n   dt: d\n   data: [ -1.0e-01, 1.0e-02, 0., 0., 0. ]\nrvec: !!opencv-matrix\n   rows: 3\n   cols: 1\n   \
dt: d\n   data: [ 0., 0., 1.5707963267948966 ]\ntvec: [ 0.25, 0., 3. ]\n";

pub(in crate::rig) const XML: &str = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<Image_Size>640 480</Image_Size>\n\
<CameraMatrix type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>\n500. 0. 319.5 0. 510.\n239.5 0. 0. 1.\
</data></CameraMatrix>\n<DistortionCoeffs type_id=\"opencv-matrix\"><rows>1</rows><cols>5</cols><dt>d</dt>\n\
<data>-0.1 0.01 0. 0. 0.</data></DistortionCoeffs>\n<Rotation type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt>\n\
<data>0. -1. 0. 1. 0. 0. 0. 0. 1.</data></Rotation>\n<Translation>0.25 0. 3.</Translation>\n</opencv_storage>\n";

pub(in crate::rig) const JSON: &str = r#"{
    "imageSize": [ 640, 480 ],
    "K": { "type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
        "data": [ 500.0, 0.0, 319.5, 0.0, 510.0, 239.5, 0.0, 0.0, 1.0 ] },
    "dist": [ -0.1, 0.01, 0.0, 0.0, 0.0 ],
    "RT": [[0.0, -1.0, 0.0, 0.25], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 3.0]]
}"#;

fn rig(text: &str) -> Result<Rig> {
    load(text, &Hints::default()).map(|calibration| calibration.rig)
}

fn load(text: &str, hints: &Hints) -> Result<Calibration> {
    Calibration::load(Folder::new().write("left.yml", text), hints)
}

fn refused(text: &str) -> String {
    let message = rig(text).unwrap_err().to_string();
    assert!(
        message.contains("left.yml: camera \"left\": ") || message.contains("left.yml: line "),
        "{message}"
    );
    message
}

fn names(rig: &Rig) -> Vec<&str> {
    rig.cameras().iter().map(|camera| camera.name()).collect()
}

#[test]
fn yaml_xml_and_json_hold_the_same_camera() {
    let read = |text: &str| rig(text).unwrap_or_else(|e| panic!("{e}")).cameras()[0].clone();
    let camera = read(YAML);
    assert_eq!((camera.name(), camera.size()), ("left", (640, 480)));
    assert_eq!(camera.lens().coefficients()[..2], [-0.1, 0.01]);
    // A point on the axis appears at the principal point, half a pixel beyond its value in the file.
    let pixel = camera.project(&nalgebra::Point3::new(0.0, 0.25, 0.0)).unwrap();
    assert!(
        (pixel.u - 320.0).abs() < 1e-9 && (pixel.v - 240.0).abs() < 1e-9 && (pixel.depth - 3.0).abs() < 1e-9
    );

    for text in [XML, JSON, &JSON.replace('\n', "").replace("    ", "\t"), &YAML.replace('\n', "\r\n")] {
        let other = read(text);
        assert_eq!((other.size(), other.intrinsics()), (camera.size(), camera.intrinsics()), "{text}");
        assert!(other.cam_from_world().rotation.angle_to(&camera.cam_from_world().rotation) < 1e-12);
        assert!((other.centre() - camera.centre()).norm() < 1e-12);
    }
}

#[test]
fn the_parts_of_a_camera_are_read_under_all_their_usual_names() {
    let spellings = [
        (
            "camera_matrix",
            ["CameraMatrix", "cameraMatrix", "Camera_Matrix", "K", "mtx", "intrinsic_matrix"].as_slice(),
        ),
        (
            "distortion_coefficients",
            &["Distortion_Coefficients", "distCoeffs", "dist_coeffs", "DistortionCoeffs", "dist", "D"],
        ),
        ("rvec", &["R", "rotation", "Rotation_Vector", "rot"]),
        ("tvec", &["T", "t", "Translation", "translation_vector"]),
    ];

    let expected = rig(YAML).unwrap();
    for (key, others) in spellings {
        for other in others {
            let text = YAML.replace(&format!("\n{key}:"), &format!("\n{other}:"));
            assert!(text != YAML && rig(&text).unwrap() == expected, "{key} as {other}");
        }
    }
}

#[test]
fn a_camera_without_size_takes_the_hint_and_one_without_distortion_has_none() {
    let text =
        YAML.replace("image_width", "a").replace("image_height", "b").replace("distortion_coefficients", "c");
    assert_refused(rig(&text), &["expected to know the size of its images"]);

    let calibration = load(&text, &Hints { size: Some((320, 200)), ..Hints::default() }).unwrap();
    let camera = &calibration.rig.cameras()[0];
    assert!(camera.size() == (320, 200) && camera.lens().is_none());
    assert_eq!(calibration.notes[0], length::NOTE);
}

#[test]
fn lengths_that_cannot_be_metres_require_a_unit() {
    let text = YAML.replace("0.25, 0., 3.", "250., 0., 3000.");
    let message = refused(&text);
    assert!(
        message.contains("3010.4 units from the world's origin")
            && message.contains("metres per unit, 0.001")
    );

    let hints = Hints { metres_per_unit: Some(0.001), ..Hints::default() };
    let calibration = load(&text, &hints).unwrap();
    assert!(
        (calibration.rig.cameras()[0].centre() - rig(YAML).unwrap().cameras()[0].centre()).norm() < 1e-12
    );
    assert!(!calibration.notes.iter().any(|note| note == length::NOTE));
}

#[test]
fn errors_name_the_missing_or_broken_part() {
    let without = |key: &str| YAML.replace(&format!("\n{key}:"), "\nother:");
    let cases = [
        (without("rvec"), "found a translation alone; add the pose of world to camera, rvec and tvec"),
        (without("tvec"), "found a rotation alone"),
        (without("camera_matrix"), "expected a camera matrix"),
        (
            YAML.replace("500., 0., 319.5", "500., 319.5"),
            "line 5, `camera_matrix`: expected 3 x 3 numbers as rows and cols",
        ),
        (YAML.replace("500.,", ".Nan,"), "line 5, `camera_matrix`: expected finite numbers, found NaN"),
        (YAML.replace("500.,", "5,"), "expected a focal length of 0.1 to 100 image widths"),
        (YAML.replace("rows: 5", "rows: 4"), "`distortion_coefficients`: expected 4 x 1 numbers"),
        (
            YAML.replace("640", "640.5"),
            "line 3, `image_width`: expected a whole number from 1 to 65535, found 640.5",
        ),
        (YAML.replace("tvec: [ 0.25,", "tvec: [ "), "`tvec`: expected 3 numbers, found 2"),
        (
            YAML.replace("image_width: 640", "image_width: 640\nimage_width: 640"),
            "line 4: expected each key once",
        ),
        (format!("{YAML}fisheye_model: 1\n"), "expected 0 or 4 fisheye coefficients (k1 k2 k3 k4), found 5"),
        (
            XML.replace("0. -1. 0.", "0. -2. 0."),
            "expected an orthonormal matrix of determinant 1, found determinant 2.0000",
        ),
    ];
    for (text, part) in cases {
        assert_refused(rig(&text), &[part]);
    }
    // A fisheye flag that is off is accepted.
    assert!(rig(&format!("{YAML}fisheye_model: 0\n")).is_ok());
}

#[test]
fn a_file_cut_short_anywhere_is_refused() {
    for text in [YAML, XML, JSON].map(str::trim_end) {
        for cut in 0..text.len() {
            let cut = &text[..cut];
            let camera = OpenCvFile::read(cut).and_then(|contents| contents.cameras("left"));
            assert!(camera.is_err(), "{cut}");
        }
    }
}

#[test]
fn a_folder_of_files_is_a_rig_and_so_is_a_folder_of_folders() {
    let folder = Folder::new();
    folder.write("left.xml", XML);
    folder.write("right.yml", YAML);
    folder.write("board.xml", "<opencv_storage><Width>8</Width></opencv_storage>");
    folder.write("notes.txt", "nothing");
    let calibration = folder.load().unwrap();
    assert_eq!(names(&calibration.rig), ["left", "right"]);
    assert!(calibration.notes[0].contains("board.xml holds no complete camera"), "{:?}", calibration.notes);

    let folder = Folder::new();
    folder.write("board.xml", "<opencv_storage><Width>8</Width></opencv_storage>");
    folder.write("cam1/config.xml", XML);
    folder.write("cam2/config.xml", XML);
    folder.write("cam3/video.avi", "no text");
    let calibration = folder.load().unwrap();
    assert_eq!(names(&calibration.rig), ["cam1", "cam2"]);
    assert!(calibration.notes[0].contains("cam3 holds no calibration"));
    // The camera of a single file with a generic name is named after its folder.
    assert_eq!(names(&Rig::load(folder.path().join("cam1/config.xml")).unwrap()), ["cam1"]);

    folder.write("cam2/other.yml", YAML);
    assert_refused(folder.load(), &["cam2: expected the calibration of one camera, found cam2, other"]);
    folder.write("cam2/other.yml", &YAML[..YAML.find("-1.0e-01").unwrap()]);
    assert_refused(folder.load(), &["cam2/other.yml: line "]);
}

#[test]
fn intrinsics_and_extrinsics_complete_each_other() {
    let at = YAML.find("rvec").unwrap();
    let folder = Folder::new();
    let intrinsics = folder.write("cam1/intrinsics.yml", &YAML[..at]);
    let missing = "cam1: camera \"cam1\": expected a rotation and a translation, found neither";
    assert_refused(folder.load(), &[missing]);

    folder.write("cam1/extrinsics.yml", &format!("%YAML:1.0\n---\n{}", &YAML[at..]));
    let expected = rig(YAML).unwrap();
    for rig in [folder.load().unwrap().rig, Rig::load(intrinsics).unwrap()] {
        assert_eq!(names(&rig), ["cam1"]);
        assert_eq!(rig.cameras()[0].projection_matrix(), expected.cameras()[0].projection_matrix());
    }
}

#[test]
fn a_stereo_pair_stands_in_the_frame_of_its_first_camera() {
    let k = "[[500, 0, 319.5], [0, 500, 239.5], [0, 0, 1]]";
    let folder = Folder::new();
    folder.write(
        "intrinsics.yml",
        &format!("%YAML:1.0\n---\nM1: {k}\nD1: [0, 0, 0, 0]\nM2: {k}\nD2: [0, 0, 0, 0]\nsize: [640, 480]\n"),
    );
    let one = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
    folder.write(
        "extrinsics.yml",
        &format!("%YAML:1.0\n---\nR: {one}\nT: [-0.2, 0, 0]\nR1: {one}\nR2: {one}\n"),
    );

    let rig = folder.load().unwrap().rig;
    assert_eq!(names(&rig), ["1", "2"]);
    assert_eq!(rig.cameras()[0].centre(), nalgebra::Point3::origin());
    assert_eq!(rig.cameras()[1].centre(), nalgebra::Point3::new(0.2, 0.0, 0.0));
}

#[test]
fn one_file_may_hold_several_cameras() {
    let camera = |x: f64| {
        format!(
            "{{\"K\": [[500, 0, 319.5], [0, 500, 239.5], [0, 0, 1]], \"dist\": [], \"rvec\": [0, 0, 0], \"tvec\": [{x}, 0, 3]}}"
        )
    };
    let named = format!(
        "{{\"width\": 640, \"height\": 480, \"cameras\": {{\"left\": {}, \"right\": {}}}}}",
        camera(0.0),
        camera(1.0)
    );

    let calibration = rig(&named).unwrap();
    assert_eq!(names(&calibration), ["left", "right"]);
    assert_eq!(calibration.cameras()[1].centre(), nalgebra::Point3::new(-1.0, 0.0, -3.0));
    let broken = named.replacen("[0, 0, 0]", "[0, 0]", 1);
    assert_refused(rig(&broken), &["camera \"left\": line 1, `rvec`: expected 3 x 3 numbers, found 2"]);

    let k = "[[500, 0, 319.5], [0, 500, 239.5], [0, 0, 1]]";
    let numbered = format!(
        "K_0: {k}\nK_1: {k}\nR_0: [0, 0, 0]\nR_1: [0, 0, 0]\nT_0: [0, 0, 3]\nT_1: [1, 0, 3]\nresolution: [640, 480]\n"
    );
    assert_eq!(names(&rig(&numbered).unwrap()), ["0", "1"]);
}
