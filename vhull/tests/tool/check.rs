//! `vhull check`: recordings that are fine, wrong calibrations and masks, and wrong input.

use super::{folder, studio, vhull};
use image::GrayImage;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use ode_visual_hull::camera::{Camera, Distortion};
use ode_visual_hull::rig::{PoseConvention, Rig};
use ode_visual_hull::synthetic::layout;
use ode_visual_hull_testing::captures;
use std::path::Path;

/// The rig of the studio in `folder`, with the principal point of camera `moved` shifted by pixels.
fn with_camera_moved(folder: &Path, moved: usize, right: f64, down: f64) -> Rig {
    let rig = Rig::load(folder.join("studio/rig.toml")).unwrap();
    let camera = |(k, camera): (usize, &Camera)| {
        let mut matrix: Matrix3<f64> = *camera.intrinsics();
        if k == moved {
            matrix[(0, 2)] += right;
            matrix[(1, 2)] += down;
        }
        let pose: Isometry3<f64> = *camera.cam_from_world();
        Camera::new(camera.name(), camera.size(), matrix, Distortion::none(), pose).unwrap()
    };
    Rig::new(rig.cameras().iter().enumerate().map(camera).collect()).unwrap()
}

/// The last lines of the output, from the verdict on.
fn verdict(out: &str) -> &str {
    &out[out.find("verdict").unwrap()..]
}

#[test]
fn a_synthetic_recording_has_no_problems_and_its_overlays_have_the_size_of_its_images() {
    let folder = studio("check_fine", "person");
    let run = vhull(&folder, &["check", "studio", "--pictures", "overlays", "--frame", "1"]);
    assert_eq!((run.code, verdict(&run.out)), (0, "verdict: ok\n"), "{}{}", run.out, run.error);
    for k in 0..5 {
        let picture = image::open(folder.join(format!("overlays/cam{k}_000001.png"))).unwrap();
        assert_eq!((picture.width(), picture.height()), (200, 240));
    }

    // The rig file without the recording.
    assert_eq!(vhull(&folder, &["check", "studio/rig.toml"]).code, 0);
}

#[test]
fn overlays_are_drawn_on_masks_where_there_is_no_image_of_their_time() {
    let folder = studio("check_overlays", "box");
    let assert_corner = |colour: [u8; 3]| {
        let run = vhull(&folder, &["check", "studio", "--pictures", "overlays", "--frame", "1"]);
        assert_eq!(run.code, 0, "{}{}", run.out, run.error);
        let picture = image::open(folder.join("overlays/cam2_000001.png")).unwrap().into_rgb8();
        let is_near = picture.get_pixel(2, 2).0.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= 30);
        assert!(is_near, "{:?}", picture.get_pixel(2, 2));
    };

    // Without an image of frame 1 the mask is drawn, black in its corner.
    for camera in 0..5 {
        std::fs::remove_file(folder.join(format!("studio/cam{camera}/image/000001.png"))).unwrap();
    }
    assert_corner([0; 3]);

    // A blue video of 60 images per second has an image at the time of frame 1.
    for camera in 0..5 {
        std::fs::remove_dir_all(folder.join(format!("studio/cam{camera}/image"))).unwrap();
        let mut ffmpeg = std::process::Command::new("ffmpeg");
        ffmpeg.args(["-nostdin", "-loglevel", "error", "-f", "lavfi", "-i", "color=blue:s=200x240:r=60"]);
        ffmpeg
            .args(["-frames:v", "3", "-c:v", "ffv1"])
            .arg(folder.join(format!("studio/cam{camera}/video.mkv")));
        assert!(ffmpeg.status().expect("ffmpeg, which scripts/setup installs").success());
    }

    assert_corner([0, 0, 254]);
}

#[test]
fn a_camera_with_a_shifted_principal_point_is_the_only_problem() {
    let folder = studio("check_off", "person");
    with_camera_moved(&folder, 3, -7.0, 6.0).save(folder.join("off.toml")).unwrap();
    let run = vhull(&folder, &["check", "off.toml", "studio"]);
    let problems = verdict(&run.out);
    assert_eq!(run.code, 3, "{}", run.out);
    assert!(problems.contains("- cam3: its silhouettes lie"), "{problems}");
    assert_eq!(problems.lines().count(), 2, "{problems}");
}

#[test]
fn poses_with_opengl_axes_are_recognised() {
    let folder = studio("check_axes", "person");
    let rig = Rig::load(folder.join("studio/rig.toml")).unwrap();
    rig.read_as(PoseConvention::OpenGl).unwrap().save(folder.join("opengl.toml")).unwrap();
    for words in [&["check", "opengl.toml"][..], &["check", "opengl.toml", "studio"]] {
        let run = vhull(&folder, words);
        assert_eq!(run.code, 3, "{}{}", run.out, run.error);
        let problems = verdict(&run.out);
        assert!(problems.contains("is behind cam0, cam1, cam2, cam3, cam4"), "{problems}");
        assert!(problems.contains("y and z of the camera axes flipped (OpenGL"), "{problems}");
    }
}

#[test]
fn an_empty_mask_is_named_as_the_cause_of_an_empty_hull() {
    let folder = studio("check_empty", "ball");
    for frame in 0..3 {
        let path = folder.join(format!("studio/cam2/mask/{frame:06}.png"));
        GrayImage::new(200, 240).save(path).unwrap();
    }
    let run = vhull(&folder, &["check", "studio"]);
    assert_eq!(run.code, 3, "{}{}", run.out, run.error);
    assert!(verdict(&run.out).contains("the mask of cam2 holds no subject"), "{}", run.out);
}

#[test]
fn the_height_of_the_hull_above_a_table_is_the_measured_one() {
    let folder = folder("check_tent");
    let top = Point3::new(0.0, 0.0, 0.4);
    for (degrees, measured_mm) in [(30.0_f64, 109.0), (15.0, 51.0), (5.0, 17.0), (0.0, 0.0)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut cameras = layout::ring(6, 3.0 * cos, 0.4 + 3.0 * sin, top, (320, 240), 0.6).unwrap();
        let eye = Point3::new(0.0, 0.0, 3.4);
        cameras.push(Camera::look_at("above", (320, 240), 0.6, eye, top, Vector3::y()).unwrap());
        Rig::new(cameras).unwrap().save(folder.join("rig.toml")).unwrap();

        let run = vhull(&folder, &["check", "rig.toml", "--table", "0,0,0.4,0.4"]);
        assert_eq!(run.code, 0, "{}{}", run.out, run.error);
        let line = run.out.lines().find(|line| line.contains("the hull rises")).unwrap();
        let printed: f64 = line.split("rises ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        // Printed in whole millimetres.
        assert!((printed - measured_mm).abs() <= 0.05 * measured_mm + 0.5, "{degrees} degrees: {line}");
    }
}

#[test]
fn the_balancing_persons_published_calibration_is_off_in_two_cameras() {
    let Some(dir) = captures::find("balancing_person") else { return };
    let run = vhull(&dir, &["check", "rig_as_published.toml", "."]);
    let problems = verdict(&run.out);
    assert_eq!((run.code, problems.lines().count()), (3, 3), "{}{}", run.out, run.error);
    assert!(
        problems.contains("- cam01: its silhouettes") && problems.contains("- cam03: its silhouettes"),
        "{problems}"
    );

    let run = vhull(&dir, &["check", "rig.toml", "."]);
    assert_eq!((run.code, verdict(&run.out)), (0, "verdict: ok\n"), "{}{}", run.out, run.error);
}

#[test]
fn the_seated_person_seen_through_four_distorting_lenses_has_no_problems() {
    let Some(dir) = captures::find("seated_person") else { return };
    let run = vhull(&dir, &["check", "."]);
    assert_eq!((run.code, verdict(&run.out)), (0, "verdict: ok\n"), "{}{}", run.out, run.error);
}

#[test]
fn errors_of_wrong_input_name_the_file_and_the_next_step() {
    let folder = studio("check_wrong", "ball");
    std::fs::write(folder.join("notes.txt"), "cameras: three\n").unwrap();
    std::fs::write(folder.join("studio/cam1/mask/000001.png"), "not a png").unwrap();
    std::fs::create_dir(folder.join("nothing")).unwrap();

    for (words, parts) in [
        (&["check", "absent.toml"][..], &["absent.toml", "check the path"][..]),
        (&["check", "notes.txt"], &["notes.txt: expected a calibration", "cameras: three"]),
        (&["check", "studio/rig.toml", "nothing"], &["view \"cam0\"", "expected the folder nothing/cam0"]),
        (&["check", "studio"], &["view \"cam1\"", "000001.png: expected an image"]),
        (
            &["check", "studio", "--frame", "9", "--frames", "1"],
            &["--frame: expected one of the 3 frames with masks from 0 to 2", "found 9"],
        ),
        (&["check", "studio/rig.toml", "--pictures", "p"], &["expected a recording"]),
    ] {
        let run = vhull(&folder, words);
        assert_eq!(run.code, 1, "{words:?}: {}{}", run.out, run.error);
        assert!(parts.iter().all(|part| run.error.contains(part)), "{words:?}: {}", run.error);
    }
}

#[test]
fn errors_of_missing_input_name_the_option_or_path_and_the_next_step() {
    let folder = studio("check_next_step", "box");
    std::fs::create_dir(folder.join("empty")).unwrap();

    for (code, words, part) in [
        (
            1,
            &["check", "studio", "--frame", "9"][..],
            "--frame: expected one of the 3 frames with masks from 0 to 2",
        ),
        (1, &["check", "empty"], "found a folder without files; check the path"),
        (
            1,
            &["check", "studio/cam0"],
            "that is none of them; check the path, or give the calibration's own file",
        ),
        (1, &["check", "studio/rig.toml", "studio/cam0/background.png"], "found a file; give the folder"),
        (2, &["check", "studio", "--tolerance", "0"], "above zero, found 0"),
        (2, &["check", "studio", "--unit", "0"], "above zero, found 0"),
        (2, &["convert", "studio", "other.toml", "--scale", "x"], "above zero, found x"),
    ] {
        let run = vhull(&folder, words);
        assert_eq!(run.code, code, "{words:?}: {}{}", run.out, run.error);
        assert!(run.error.contains(part), "{words:?}: {}", run.error);
    }

    // A mask that is cut off in the middle.
    let mask = folder.join("studio/cam3/mask/000001.png");
    let png = std::fs::read(&mask).unwrap();
    std::fs::write(&mask, &png[..png.len() / 2]).unwrap();
    let run = vhull(&folder, &["check", "studio"]);
    let parts = ["view \"cam3\"", "cam3/mask/000001.png", "expected an image", "replace it by an intact one"];
    assert!(run.code == 1 && parts.iter().all(|part| run.error.contains(part)), "{}", run.error);
}
