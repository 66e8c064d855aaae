//! Real calibration files of OpenCV and related tools are read, and survive a round trip through the crate's format.

use nalgebra::Point3;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::rig::{Calibration, Hints, Rig};
use ode_visual_hull_testing::captures;
use ode_visual_hull_testing::random::Random;
use std::path::Path;

/// Hints for files without an image size.
const HD: Hints = Hints { size: Some((1920, 1080)), metres_per_unit: None };
const SMALL_MM: Hints = Hints { size: Some((644, 486)), metres_per_unit: Some(1e-3) };

fn load(path: &Path, hints: &Hints) -> Calibration {
    Calibration::load(path, hints).unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts that the rig survives a round trip through the crate's format: 1000 points in front of each camera project
/// to within 1e-6 px of their old places.
fn assert_round_trip(rig: &Rig) {
    let again = Rig::from_toml(&rig.to_toml()).unwrap();
    assert_eq!(again.len(), rig.len());
    for (camera, other) in rig.cameras().iter().zip(again.cameras()) {
        assert_eq!((camera.name(), camera.size()), (other.name(), other.size()));
        let worst = points_before(camera)
            .map(|point| match (camera.project(&point), other.project(&point)) {
                (Some(a), Some(b)) => (a.u - b.u).hypot(a.v - b.v),
                (a, b) => panic!("{point}: {a:?}, {b:?}"),
            })
            .fold(0.0, f64::max);
        assert!(worst < 1e-6, "camera {}: {worst:.1e} px", camera.name());
    }
}

/// 1000 random points in the field of view, at depths of 0.5 to 10 m.
fn points_before(camera: &Camera) -> impl Iterator<Item = Point3<f64>> {
    let mut random = Random(1);
    let (width, height) = (f64::from(camera.size().0), f64::from(camera.size().1));
    let point =
        move || camera.unproject(width * random.unit(), height * random.unit(), random.between(0.5, 10.0));
    // Pixels beyond the range of the lens model have no viewing ray.
    std::iter::repeat_with(point).take(100_000).flatten().take(1000)
}

#[test]
fn easymocaps_cameras_surround_a_subject_and_keep_their_places_in_our_file() {
    let Some(folder) = captures::find("calibration_samples/easymocap") else { return };
    let calibration = load(&folder, &HD);
    let rig = &calibration.rig;

    assert_eq!(rig.cameras().iter().map(Camera::name).collect::<Vec<_>>(), ["2", "3", "4", "5", "6", "7"]);
    // By its documentation, z points up, the floor is at 0, and the cameras stand around the origin.
    for camera in rig.cameras() {
        let centre = camera.centre();
        assert!((1.0..10.0).contains(&centre.coords.norm()) && centre.z > 0.0, "{}", rig.describe());
        assert!(camera.forward().dot(&-centre.coords.normalize()) > 0.8, "{}", rig.describe());
    }

    assert_round_trip(rig);

    for file in ["intri.yml", "extri.yml"] {
        assert_eq!(load(&folder.join(file), &HD).rig, *rig);
    }
}

#[test]
fn easymocaps_lenses_without_poses_say_so() {
    let Some(path) = captures::find("calibration_samples/easymocap/intri_easymocap_example.yml") else {
        return;
    };
    let message = Rig::load(&path).unwrap_err().to_string();
    assert!(message.contains("expected extri_easymocap_example.yml beside it, found none"), "{message}");
    assert!(message.contains("it holds the poses, R_ and T_ of each camera"), "{message}");
}

#[test]
fn kalibrs_single_camera_is_at_the_origin_and_keeps_its_lens_in_our_file() {
    let Some(path) = captures::find("calibration_samples/kalibr/camchain.yaml") else { return };
    let calibration = load(&path, &Hints::default());
    let camera = &calibration.rig.cameras()[0];
    assert_eq!((camera.name(), camera.size(), camera.centre()), ("cam0", (1280, 720), Point3::origin()));
    assert!(calibration.notes[0].contains("no pose"), "{:?}", calibration.notes);
    assert_round_trip(&calibration.rig);
}

#[test]
fn opencvs_xml_in_two_spellings_is_in_millimetres_and_says_so() {
    for (file, name) in [
        ("uu_cam1_config.xml", "uu_cam1_config"),
        ("uu_cam1_config_othernames.xml", "uu_cam1_config_othernames"),
    ] {
        let Some(path) = captures::find(&format!("calibration_samples/opencv_xml/{file}")) else { return };
        let message = Rig::load(&path).unwrap_err().to_string();
        assert!(message.contains("metres per unit, 0.001 if these are millimetres"), "{message}");
        let message = Calibration::load(&path, &Hints { size: None, ..SMALL_MM }).unwrap_err().to_string();
        assert!(message.contains("expected to know the size of its images"), "{message}");
        let rig = load(&path, &SMALL_MM).rig;
        assert_eq!(rig.cameras()[0].name(), name);
        assert!((2.0..8.0).contains(&rig.cameras()[0].centre().coords.norm()), "{}", rig.describe());
        assert_round_trip(&rig);
    }
}

#[test]
fn a_folder_per_camera_has_the_lenses_of_its_refined_rig() {
    let (Some(folder), Some(refined)) =
        (captures::find("seated_person/original"), captures::find("seated_person/rig.toml"))
    else {
        return;
    };
    let (calibration, refined) = (load(&folder, &SMALL_MM), Rig::load(refined).unwrap());
    let rig = &calibration.rig;

    assert_eq!(rig.len(), 4);

    for (camera, refined) in rig.cameras().iter().zip(refined.cameras()) {
        assert_eq!((camera.name(), camera.size()), (refined.name(), refined.size()));
        // The file stores numbers in single precision.
        assert!((camera.intrinsics() - refined.intrinsics()).abs().max() < 1e-4);

        let (a, b) = (camera.lens().coefficients(), refined.lens().coefficients());
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8), "{a:?} {b:?}");
    }

    assert!(
        calibration.notes.iter().any(|note| note.starts_with("cam2/intrinsics.xml")),
        "{:?}",
        calibration.notes
    );
    // The refined rig has another world frame and another scale, and its poses are some degrees better. The relative
    // rotation of two cameras, and the direction from one to the other, do not depend on frame or scale.
    for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        let relative = |rig: &Rig| {
            let second_from_first =
                rig.cameras()[j].cam_from_world() * rig.cameras()[i].cam_from_world().inverse();
            (second_from_first.rotation, second_from_first.translation.vector)
        };
        let ((turn, place), (refined_turn, refined_place)) = (relative(rig), relative(&refined));
        assert!(turn.angle_to(&refined_turn).to_degrees() < 6.0, "{i} {j}");
        assert!(place.angle(&refined_place).to_degrees() < 8.0, "{i} {j}");
    }

    assert_round_trip(rig);
}
