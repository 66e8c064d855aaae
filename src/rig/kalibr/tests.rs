use super::*;
use crate::rig::Rig;
use crate::rig::testing::assert_refused;
use nalgebra::Point3;

/// A chain of three cameras, after the example in Kalibr's wiki.
pub(in crate::rig) const CHAIN: &str = "cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.1, 0.01, 0.001, -0.002]
  distortion_model: radtan
  intrinsics: [500.0, 510.0, 319.5, 239.5]
  resolution: [640, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.2]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [500.0, 510.0, 319.5, 239.5]
  resolution: [640, 480]
cam2:
  T_cn_cnm1:
  - [0.0, 0.0, -1.0, 0.0]
  - [0.0, 1.0, 0.0, 0.0]
  - [1.0, 0.0, 0.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [500.0, 510.0, 319.5, 239.5]
  resolution: [640, 480]
";

fn rig(text: &str) -> Result<Rig> {
    assert!(recognise(text));
    Ok(read(text)?.into_rig(&Hints::default())?.0)
}

#[test]
fn poses_are_products_of_the_chain_in_the_first_cameras_frame() {
    let rig = rig(CHAIN).unwrap();
    let [first, second, third] = rig.cameras() else { panic!("{rig:?}") };
    assert_eq!((first.name(), first.size(), first.centre()), ("cam0", (640, 480), Point3::origin()));
    assert_eq!(first.lens().coefficients()[..4], [-0.1, 0.01, 0.001, -0.002]);
    assert_eq!((first.intrinsics()[(0, 2)], first.intrinsics()[(1, 1)]), (320.0, 510.0));
    // Both stand 0.2 m to the right of the first; the third looks along the first one's x axis.
    for camera in [second, third] {
        assert!((camera.centre() - Point3::new(0.2, 0.0, 0.0)).norm() < 1e-12);
    }
    assert!((third.forward() - nalgebra::Vector3::x()).norm() < 1e-12);
}

#[test]
fn a_single_camera_stands_at_the_origin_and_a_note_says_so() {
    let one = &CHAIN[..CHAIN.find("cam1:").unwrap()];
    let calibration = read(one).unwrap();
    assert_eq!(calibration.notes, [NO_CHAIN]);
    assert_eq!(calibration.into_rig(&Hints::default()).unwrap().0.cameras()[0].centre(), Point3::origin());
    assert_eq!(read(CHAIN).unwrap().notes, [FIRST_FRAME]);
}

#[test]
fn other_lenses_and_broken_chains_are_refused_with_a_next_step() {
    let cases = [
        (
            CHAIN.replacen("radtan", "fov", 1),
            "camera \"cam0\": line 5, `distortion_model`: expected the distortion model radtan, equidistant or none, found fov",
        ),
        (
            CHAIN.replacen("model: pinhole", "model: omni", 1),
            "line 3, `camera_model`: expected the camera model pinhole, found omni",
        ),
        // Broken chains.
        (
            CHAIN.replacen("T_cn_cnm1", "T_cam_imu", 1),
            "camera \"cam1\": line 9: expected the key `T_cn_cnm1`, found the keys T_cam_imu",
        ),
        (CHAIN.replace("cam1:", "cam3:"), "expected the chain to go on with cam1, found cam2"),
        (
            CHAIN.replacen("[1.0, 0.0, 0.0, -0.2]", "[2.0, 0.0, 0.0, -0.2]", 1),
            "line 10, `T_cn_cnm1`: expected an orthonormal matrix of determinant 1, found determinant 2.0000",
        ),
        (
            CHAIN.replacen("[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 1.0]", 1),
            "line 14, `T_cn_cnm1`: expected rows of 4 numbers",
        ),
        // Invalid intrinsics and a damaged file.
        (
            CHAIN.replacen("[500.0, 510.0, 319.5, 239.5]", "[500.0, 319.5, 239.5]", 1),
            "line 6, `intrinsics`: expected 4 numbers, found 3",
        ),
        (CHAIN.replacen("500.0", ".nan", 1), "line 6, `intrinsics`: expected finite numbers, found NaN"),
        (
            CHAIN.replacen("500.0", "5", 1),
            "camera \"cam0\": expected a focal length of 0.1 to 100 image widths",
        ),
        (
            CHAIN.replace("cam2:", "cam1:"),
            "line 20: expected each key once, found `cam1` again, first on line 9",
        ),
        (CHAIN[..CHAIN.len() - 20].into(), "line "),
    ];

    for (text, part) in cases {
        assert_refused(rig(&text), &[part]);
    }
}
