use super::*;
use crate::rig::testing::{Folder, assert_refused, load_folder};
use crate::rig::{Calibration, Rig};
use nalgebra::Point3;

/// A file in the form of EasyMocap's own writer, line ends included.
pub(in crate::rig) const INTRI: &str = "%YAML:1.0\r\n---\r\nnames:\r\n  - \"left\"\r\n  - \"07\"\r\nK_left: !!opencv-matrix\r\n  rows: 3\r\n  \
cols: 3\r\n  dt: d\r\n  data: [500.0, 0.0, 319.5, 0.0, 510.0, 239.5, 0.0, 0.0, 1.0]\r\ndist_left: !!opencv-matrix\r\n  \
rows: 1\r\n  cols: 5\r\n  dt: d\r\n  data: [-0.1, 0.01, 0.0, 0.0, 0.0]\r\nH_left: 480\r\nW_left: 640\r\nK_07: !!opencv-matrix\r\n  \
rows: 3\r\n  cols: 3\r\n  dt: d\r\n  data: [500.0, 0.0, 319.5, 0.0, 510.0, 239.5, 0.0, 0.0, 1.0]\r\nH_07: -1\r\nW_07: -1\r\n";

pub(in crate::rig) const EXTRI: &str = "%YAML:1.0\n---\nnames:\n  - \"left\"\n  - \"07\"\nR_left: !!opencv-matrix\n  rows: 3\n  cols: 1\n  dt: d\n  \
data: [0.0, 0.0, 1.570796]\nRot_left: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n  \
data: [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\nT_left: !!opencv-matrix\n  rows: 3\n  cols: 1\n  dt: d\n  \
data: [0.25, 0.0, 3.0]\nR_07: [0, 0, 0]\nT_07: [0, 0, 3]\n";

const SIZE: Hints = Hints { size: Some((320, 240)), metres_per_unit: None };

fn load(intri: &str, extri: &str) -> Result<Calibration> {
    load_folder(&[("intri.yml", intri), ("extri.yml", extri)], &SIZE)
}

#[test]
fn the_folder_and_either_file_give_the_same_rig() {
    let folder = Folder::new();
    let paths =
        [folder.write("intri.yml", INTRI), folder.write("extri.yml", EXTRI), folder.path().to_owned()];
    for path in paths {
        let calibration = Calibration::load(path, &SIZE).unwrap();
        assert_eq!((calibration.format, calibration.notes[0].as_str()), (FORMAT.name, length::NOTE));
        let [left, other] = calibration.rig.cameras() else { panic!("{:?}", calibration.rig) };
        assert_eq!((left.name(), left.size(), left.intrinsics()[(0, 2)]), ("left", (640, 480), 320.0));
        assert_eq!(left.lens().coefficients()[..2], [-0.1, 0.01]);
        // x_cam = R x_world + T with a quarter turn about z: the centre is -R^T T.
        assert!((left.centre() - Point3::new(0.0, 0.25, -3.0)).norm() < 1e-9);

        assert_eq!((other.name(), other.size()), ("07", (320, 240)));
        assert!(other.lens().is_none());
        assert_eq!(other.centre(), Point3::new(0.0, 0.0, -3.0));
    }
}

#[test]
fn a_file_without_the_other_says_which_is_missing_and_what_it_holds() {
    for (name, text, part) in [
        (
            "intri.yml",
            INTRI,
            "extri.yml PLACE it, found none; put it there: it holds the poses, R_ and T_ of each camera",
        ),
        (
            "extri.yml",
            EXTRI,
            "intri.yml PLACE it, found none; put it there: it holds the lenses, K_ of each camera",
        ),
    ] {
        let folder = Folder::new();
        let path = folder.write(name, text);
        for (path, place) in [(path.as_path(), "beside"), (folder.path(), "in")] {
            assert_refused(Rig::load(path), &[&part.replace("PLACE", place)]);
        }
    }
}

#[test]
fn a_pose_without_a_lens_is_left_out_and_noted() {
    let intri = INTRI.replace("  - \"07\"\r\n", "");
    let calibration = load(&intri, EXTRI).unwrap();
    assert_eq!(calibration.rig.len(), 1);
    assert!(calibration.notes[1].contains("a pose of camera 07"), "{:?}", calibration.notes);
}

#[test]
fn errors_name_the_file_the_camera_and_the_line() {
    let intri = [
        (INTRI.replace("K_07", "K_08"), "intri.yml: camera \"07\": line 3: expected the key `K_07`"),
        (
            INTRI.replacen("rows: 3", "rows: 4", 1),
            "intri.yml: camera \"left\": line 6, `K_left`: expected 4 x 3 numbers",
        ),
        (
            INTRI.replacen("500.0", ".nan", 1),
            "intri.yml: camera \"left\": line 6, `K_left`: expected finite numbers",
        ),
        (INTRI.replace("\"07\"", "\"left\""), "camera \"left\": expected unique names"),
        (
            INTRI.replace("H_left: 480", "H_left: 0"),
            "line 16, `H_left`: expected a whole number from 1 to 65535",
        ),
        (
            INTRI.replace("500.0, 0.0, 319.5", "0.5, 0.0, 319.5"),
            "expected a focal length of 0.1 to 100 image widths",
        ),
        (INTRI[..INTRI.find("0.01").unwrap()].into(), "intri.yml: line "),
    ];

    let extri = [
        (EXTRI.replace("T_07", "U_07"), "extri.yml: camera \"07\": line 3: expected the key `T_07`"),
        (
            EXTRI.replace("1.570796", "1.5"),
            "line 11, `Rot_left`: expected the same rotation as in R_left, found one 4.06 degrees off it",
        ),
        (
            EXTRI.replace("0.0, -1.0", "0.0, 1.0"),
            "`Rot_left`: expected an orthonormal matrix of determinant 1, found determinant -1.0000",
        ),
        (
            EXTRI.replace("[0.25, 0.0, 3.0]", "[250, 0.0, 3000]"),
            "camera \"left\": expected lengths in metres, found a camera 3010.4 units",
        ),
        (EXTRI[..EXTRI.find("1.570796").unwrap()].into(), "extri.yml: line "),
    ];

    let all = intri.iter().map(|(text, part)| (text.as_str(), EXTRI, part));
    for (intri, extri, part) in all.chain(extri.iter().map(|(text, part)| (INTRI, text.as_str(), part))) {
        assert_refused(load(intri, extri), &[part]);
    }
}
