//! Tests of fisheye lenses in every format that has them.

use crate::Result;
use crate::camera::{Camera, Fisheye, Lens};
use crate::rig::testing::{Folder, HINTS, assert_points_return, assert_refused};
use crate::rig::{Calibration, Rig, colmap, kalibr, nerfstudio, opencv, ros, toml};
use nalgebra::Point3;

const COEFFICIENTS: [f64; 4] = [0.05, -0.01, 0.002, -0.0003];

/// A calibration in one or several files, the first of which is opened; all have a focal length of 500 px and images
/// of 640 x 480 or 600 x 400 pixels.
struct Sample {
    files: Vec<(&'static str, String)>,
    /// The file and line of the coefficients in messages.
    place: [&'static str; 2],
    /// The principal point's column in this crate's convention.
    cx: f64,
}

impl Sample {
    fn new(name: &'static str, text: String, line: &'static str) -> Self {
        Self { files: vec![(name, text)], place: [name, line], cx: 320.0 }
    }

    fn load(&self) -> Result<Rig> {
        let folder = Folder::new();
        let paths: Vec<_> = self.files.iter().map(|(name, text)| folder.write(name, text)).collect();
        Ok(Calibration::load(&paths[0], &HINTS)?.rig)
    }

    /// The camera with a fisheye lens.
    fn fisheye(&self) -> Camera {
        let rig = self.load().unwrap_or_else(|e| panic!("{e}"));
        let found = rig.cameras().iter().find(|camera| matches!(camera.lens(), Lens::Fisheye(_)));
        found.unwrap_or_else(|| panic!("no fisheye in {}", self.files[0].1)).clone()
    }
}

/// One sample per format with a list of coefficients, which may have any length.
fn samples(coefficients: &[f64]) -> Vec<Sample> {
    let count = coefficients.len();
    let text: Vec<_> = coefficients.iter().map(f64::to_string).collect();
    let (comma, space) = (text.join(", "), text.join(" "));
    let toml = toml::tests::CAMERA
        .replace("[-0.1, 0.01, 0.0, 1e-4, 0]", &format!("[{comma}]"))
        .replace("fisheye = false", "fisheye = true");

    let yaml = opencv::tests::YAML
        .replace("rows: 5", &format!("rows: {count}"))
        .replace("-1.0e-01, 1.0e-02, 0., 0., 0.", &comma)
        + "fisheye_model: 1\n";
    let xml = opencv::tests::XML
        .replace("<cols>5</cols>", &format!("<cols>{count}</cols>"))
        .replace("-0.1 0.01 0. 0. 0.", &space)
        .replace("</opencv_storage>", "<fisheye_model>1</fisheye_model>\n</opencv_storage>");

    let json = opencv::tests::JSON.replace("-0.1, 0.01, 0.0, 0.0, 0.0", &comma).replacen(
        '{',
        "{\n    \"fisheye\": true,",
        1,
    );

    let kalibr = kalibr::tests::CHAIN.replacen("-0.1, 0.01, 0.001, -0.002", &comma, 1).replacen(
        "radtan",
        "equidistant",
        1,
    );

    let ros = ros::tests::INFO
        .replace("plumb_bob", "equidistant")
        .replace("cols: 5", &format!("cols: {count}"))
        .replace("-0.1, 0.01, 0.0, 0.0, 0.0", &comma);
    let message = ros::tests::MESSAGE
        .replace("rational_polynomial", "equidistant")
        .replace("0.1, 0.2, 0.0, 0.0, 0.3, 0.4, 0.5, 0.6", &comma);

    let pose = ("left_pose.yaml", ros::tests::POSE.to_owned());

    let colmap =
        colmap::tests::CAMERAS.replace("OPENCV", "OPENCV_FISHEYE").replace("-0.1 0.02 0.001 -0.002", &space);

    vec![
        Sample::new("rig.toml", toml, "line 6"),
        Sample::new("left.yml", yaml, "line 10"),
        Sample::new("left.xml", xml, "line 7"),
        Sample::new("left.json", json, "line 6"),
        Sample::new("camchain.yaml", kalibr, "line 4"),
        Sample { files: vec![("left.yaml", ros), pose.clone()], place: ["left.yaml", "line 9"], cx: 320.0 },
        Sample { files: vec![("left.yaml", message), pose], place: ["left.yaml", "line 7"], cx: 320.0 },
        Sample {
            files: vec![("images.txt", colmap::tests::IMAGES.to_owned()), ("cameras.txt", colmap)],
            place: ["cameras.txt", "line 5"],
            cx: 300.0,
        },
    ]
}

/// A sample of nerfstudio's format, which has a key per coefficient.
fn nerfstudio_sample(coefficients: [f64; 4]) -> Sample {
    let [k1, k2, k3, k4] = coefficients;
    let top = format!("\"k1\": {k1}, \"k2\": {k2}, \"k3\": {k3}, \"k4\": {k4}");
    let text = nerfstudio::tests::TEXT
        .replace("\"OPENCV\"", "\"OPENCV_FISHEYE\"")
        .replace("\"k1\": -0.1, \"k2\": 0.02, \"p1\": 0.001, \"p2\": 0.002", &top)
        .replace("\"k1\": 0, \"k2\": 0, ", "");
    Sample::new("transforms.json", text, "line 3")
}

fn all_samples(coefficients: [f64; 4]) -> Vec<Sample> {
    let mut samples = samples(&coefficients);
    samples.push(nerfstudio_sample(coefficients));
    samples
}

#[test]
fn every_format_gives_its_coefficients_and_pixel_centres() {
    for sample in all_samples(COEFFICIENTS) {
        let camera = sample.fisheye();
        assert_eq!(*camera.lens(), Fisheye::from_opencv(&COEFFICIENTS).unwrap().into());
        assert_eq!(camera.intrinsics()[(0, 2)], sample.cx, "{}", sample.files[0].1);
    }
}

#[test]
fn unprojected_points_project_to_their_pixels_in_every_format() {
    for sample in all_samples(COEFFICIENTS) {
        assert_eq!(assert_points_return(&sample.fisheye()), 1000);
    }
}

#[test]
fn too_few_and_too_many_coefficients_are_refused_by_file_and_line() {
    for count in [0, 1, 2, 3, 5, 8] {
        for sample in samples(&[0.01; 8][..count]) {
            let expected = if sample.files.len() > 1 && sample.place[0] == "cameras.txt" {
                "expected 8 parameters of OPENCV_FISHEYE"
            } else {
                "4 fisheye coefficients (k1 k2 k3 k4)"
            };
            assert_refused(sample.load(), &[sample.place[0], sample.place[1], expected]);
        }
    }
}

#[test]
fn a_model_that_folds_back_in_the_image_is_refused_by_file_and_line() {
    // theta (1 - 2 theta^2) folds back 0.27 focal lengths from the axis; the nearest border is at 0.39.
    for sample in all_samples([-2.0, 0.0, 0.0, 0.0]) {
        assert_refused(sample.load(), &[sample.place[0], sample.place[1], "folds back inside the image"]);
    }
}

#[test]
fn an_image_of_180_degrees_is_refused_by_file_and_line() {
    // The model is monotonic and reaches 90 degrees 0.707 focal lengths from the axis; the corners are beyond 0.72.
    for sample in all_samples([-0.45, 0.092, 0.0, 0.0]) {
        let parts = ["rays less than 90 degrees from its axis", "crop the images"];
        assert_refused(sample.load(), &[&sample.place, &parts[..]].concat());
    }
}

#[test]
fn rig_files_keep_fisheyes_and_all_counts_of_coefficients() {
    let fisheye = Sample::fisheye(&samples(&COEFFICIENTS)[0]);
    let mut cameras = vec![fisheye.clone()];
    for count in [4, 5, 8, 12, 14] {
        let coefficients: Vec<_> = (1..=count).map(|i| 1e-3 * f64::from(i)).collect();
        let lens = crate::camera::Distortion::from_opencv(&coefficients).unwrap();
        let (k, pose) = (*fisheye.intrinsics(), *fisheye.cam_from_world());
        cameras.push(Camera::new(count.to_string(), fisheye.size(), k, lens, pose).unwrap());
    }

    let rig = Rig::new(cameras).unwrap();
    let text = rig.to_toml();
    assert_eq!(text.matches("fisheye = true").count(), 1);

    let again = Rig::from_toml(&text).unwrap();
    for (before, after) in rig.cameras().iter().zip(again.cameras()) {
        assert_eq!(before.lens(), after.lens(), "{}", before.name());
        let point = before.unproject(100.5, 50.25, 2.0).unwrap();
        let found = after.project(&Point3::from(point)).unwrap();
        // The last digits of rotation and principal point are lost.
        assert!((found.u - 100.5).abs() < 1e-6 && (found.v - 50.25).abs() < 1e-6);
    }
}

#[test]
fn a_fisheye_without_coefficients_is_refused() {
    let yaml = opencv::tests::YAML.replace("distortion_coefficients", "others") + "fisheye_model: 1\n";
    let sample = Sample::new("left.yml", yaml, "line 20");
    assert_refused(
        sample.load(),
        &["left.yml", "`fisheye_model`", "call them distortion_coefficients, or D"],
    );
}

#[test]
fn a_fisheye_mark_that_is_neither_on_nor_off_is_refused() {
    let yaml = opencv::tests::YAML.to_owned() + "fisheye_model: 3\n";
    let sample = Sample::new("left.yml", yaml, "");
    assert_refused(sample.load(), &["left.yml", "`fisheye_model`: expected 1 or true for a fisheye"]);
    let mirror = opencv::tests::YAML.to_owned() + "xi: 0.8\n";
    assert_refused(Sample::new("left.yml", mirror, "").load(), &["`xi`", "found a mirror"]);
}

#[test]
fn fisheyes_are_marked_once_per_file_or_per_camera() {
    let camera =
        "{K: [[500, 0, 319.5], [0, 500, 239.5], [0, 0, 1]], D: [0.01, 0, 0, 0], R: [0, 0, 0], T: [0, 0, 3]";
    let is_fisheye = |text: String| {
        let rig = Sample::new("rig.yml", text, "").load().unwrap();
        rig.cameras().iter().map(|camera| matches!(camera.lens(), Lens::Fisheye(_))).collect::<Vec<_>>()
    };
    assert_eq!(is_fisheye(format!("left: {camera}}}\nright: {camera}, fisheye: true}}\n")), [false, true]);
    assert_eq!(is_fisheye(format!("fisheye: true\nleft: {camera}}}\nright: {camera}}}\n")), [true, true]);
}

#[test]
fn nerfstudios_two_marks_of_a_fisheye_have_to_agree() {
    let sample = |old: &str, new: &str| {
        let text = nerfstudio_sample(COEFFICIENTS).files.remove(0).1.replace(old, new);
        Sample::new("transforms.json", text, "")
    };
    let model = "\"camera_model\": \"OPENCV_FISHEYE\"";
    assert_eq!(sample(model, "\"is_fisheye\": true").fisheye().lens().coefficients(), COEFFICIENTS);
    let both = format!("{model}, \"is_fisheye\": true");
    assert_eq!(sample(model, &both).fisheye().lens().coefficients(), COEFFICIENTS);

    let contradiction = format!("{model}, \"is_fisheye\": false");
    assert_refused(sample(model, &contradiction).load(), &["line 2, `is_fisheye`", "found OPENCV_FISHEYE"]);
    assert_refused(sample("\"k3\"", "\"p1\"").load(), &["line 3, `p1`", "expected a lens of k1, k2, k3, k4"]);
}

#[test]
fn colmaps_radial_fisheyes_are_opencvs_fisheyes_with_fewer_coefficients() {
    for (name, parameters, expected) in [
        ("SIMPLE_RADIAL_FISHEYE", "0.1", [0.1, 0.0, 0.0, 0.0]),
        ("RADIAL_FISHEYE", "0.1 -0.02", [0.1, -0.02, 0.0, 0.0]),
    ] {
        let line = format!("7 {name} 640 480 500 320 240 {parameters}\n");
        let cameras = colmap::tests::CAMERAS.replace("7 RADIAL 640 480 500 320 240 -0.1 0.02\n", &line);
        let files = vec![("images.txt", colmap::tests::IMAGES.to_owned()), ("cameras.txt", cameras)];
        let sample = Sample { files, place: [""; 2], cx: 320.0 };
        assert_eq!(sample.fisheye().lens().coefficients(), expected);
    }
}
