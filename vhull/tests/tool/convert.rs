//! `vhull convert`: rig files from calibrations of other formats.

use super::{folder, studio, vhull};
use ode_visual_hull::rig::Rig;

#[test]
fn a_rig_is_converted_and_existing_files_are_kept_without_force() {
    let folder = studio("convert", "ball");
    let run = vhull(&folder, &["convert", "studio/rig.toml", "copy.toml", "--unit", "0.5"]);
    assert_eq!(run.code, 0, "{}", run.error);

    let rig = |path: &str| Rig::load(folder.join(path)).unwrap();
    for (a, b) in rig("studio/rig.toml").cameras().iter().zip(rig("copy.toml").cameras()) {
        assert!((a.centre() * 0.5 - b.centre()).norm() < 1e-9);
    }

    let again = vhull(&folder, &["convert", "studio/rig.toml", "copy.toml"]);
    assert!(again.code == 1 && again.error.contains("--force"), "{}", again.error);
    assert_eq!(vhull(&folder, &["convert", "studio/rig.toml", "copy.toml", "--force"]).code, 0);
    let other = vhull(&folder, &["convert", "studio/rig.toml", "copy.yml"]);
    assert!(other.code == 1 && other.error.contains("ends in .toml"), "{}", other.error);
}

#[test]
fn errors_of_calibrations_without_size_or_unit_name_the_option_that_sets_it() {
    let folder = folder("convert_untold");
    let far = "500 0 320 0 0 500 240 0 0 0 1 -1500\n500 0 320 0 0 500 240 0 0 0 1 -2\n";
    std::fs::write(folder.join("matrices.txt"), far).unwrap();
    let millimetres = r#"{"a": {"K": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
                          "T": [0, 0, 2500], "size": [640, 480]}}"#;
    std::fs::write(folder.join("far.json"), millimetres).unwrap();

    for verb in [&["check"][..], &["convert", "--force"]] {
        let run = |words: &[&str]| {
            let out = if verb.len() == 2 { &["out.toml"][..] } else { &[] };
            vhull(&folder, &[&verb[..1], &words[..1], out, &verb[1..], &words[1..]].concat())
        };

        let size = run(&["matrices.txt"]);
        assert_eq!(size.code, 1);
        let parts = ["matrices.txt", "\"camera0\"", "give width and height", "--size WIDTHxHEIGHT"];
        parts.iter().for_each(|part| assert!(size.error.contains(part), "{}", size.error));

        let unit = run(&["far.json"]);
        assert_eq!(unit.code, 1);
        let parts = ["far.json", "2500.0 units", "0.001 if these are millimetres", "--unit METRES"];
        parts.iter().for_each(|part| assert!(unit.error.contains(part), "{}", unit.error));

        // A doubtful unit is only noted.
        let doubtful = run(&["matrices.txt", "--size", "640x480"]);
        assert!(doubtful.out.contains("are these metres?"), "{}", doubtful.out);
        assert!(doubtful.out.contains("note: set another unit with --unit METRES"), "{}", doubtful.out);
        let given = run(&["matrices.txt", "--size", "640x480", "--unit", "0.001"]);
        assert!(!given.out.contains("--unit"), "{}", given.out);
    }
}

#[test]
fn a_fisheye_lens_is_kept_in_the_rig_file() {
    let folder = folder("convert_fisheye");
    let chain = "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n  \
                 distortion_coeffs: [0.05, -0.01, 0.002, -0.0003]\n  intrinsics: [500.0, 510.0, 319.5, 239.5]\n  \
                 resolution: [640, 480]\n";
    std::fs::write(folder.join("camchain.yaml"), chain).unwrap();

    let run = vhull(&folder, &["convert", "camchain.yaml", "rig.toml"]);
    assert_eq!(run.code, 0, "{}", run.error);
    let text = std::fs::read_to_string(folder.join("rig.toml")).unwrap();
    assert!(text.contains("distortions = [0.05, -0.01, 0.002, -0.0003]"), "{text}");
    assert!(text.contains("fisheye = true"), "{text}");
    let lens = |path: &str| *Rig::load(folder.join(path)).unwrap().cameras()[0].lens();
    assert_eq!(lens("rig.toml"), lens("camchain.yaml"));
}
