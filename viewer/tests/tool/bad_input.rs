//! What cannot be drawn gets an error, or a picture and a note, that says why and what to do.

use super::{PERSON, command, finished, folder, recorded, view};
use image::RgbImage;
use std::path::Path;

/// Runs a still of the recording `person` in `folder` with more arguments, and expects an error that contains these words.
fn refused(folder: &Path, more: &[&str], expected: &str) {
    let run = view(folder, &[&["still", "person"], more].concat());
    assert!(!run.succeeded && run.error.contains(expected), "{more:?}: {}", run.error);
}

/// As [`refused`], but the picture is drawn and the words are a note.
fn noted(folder: &Path, more: &[&str], expected: &str) {
    let run = view(folder, &[&["still", "person", "--size", "64x48", "--samples", "1"], more].concat());
    assert!(
        run.succeeded && run.error.contains("note: ") && run.error.contains(expected),
        "{more:?}: {}",
        run.error
    );
}

#[test]
fn what_is_no_recording_or_has_no_such_frame_camera_or_image_is_refused() {
    let nothing = folder("nothing");
    refused(&nothing, &[], "person: expected the folder of a recording, found none");
    std::fs::create_dir(nothing.join("person")).expect("a folder");
    refused(&nothing, &[], "rig.toml");

    let folder = recorded("no_such", 5, 2);
    refused(
        &folder,
        &["--frame", "9"],
        "--frame: expected one of the 2 frames with masks from 0 to 1, found 9",
    );
    refused(&folder, &["--frame", "1"], "expected images of frame 1, found none; frames with images: 0");
    refused(&folder, &["--camera", "right"], "--camera: expected one of ");
    refused(&folder, &["--out", "still.xyz"], "expected to write a picture, .png or .jpg");
    refused(&folder, &["--eye", "0,0,0.9", "--target", "0,0,0.9"], "expected an eye away from its target");
}

#[test]
fn images_of_another_size_than_the_masks_are_refused_by_name() {
    let folder = recorded("other_size", 5, 2);
    let name = PERSON.cameras[1].name();
    RgbImage::new(80, 60).save(folder.join("person").join(name).join("image/000000.png")).expect("an image");
    refused(&folder, &[], name);
    refused(&folder, &[], "expected 160 x 120");
}

#[test]
fn a_subject_outside_the_work_volume_is_refused_and_one_that_reaches_its_end_is_noted() {
    let folder = recorded("volume", 5, 2);
    refused(
        &folder,
        &["--bounds", "0.6,0.8,-0.2,0.2,0.7,0.9"],
        "expected a subject in frame 0, found an empty hull",
    );
    noted(&folder, &["--bounds", "-1,1,-1,1,0,1.2"], "the subject reaches the end of the work volume");
}

#[test]
fn viewpoints_inside_the_subject_or_below_the_floor_are_noted() {
    let folder = recorded("inside", 5, 2);
    noted(&folder, &["--eye", "0,0,1.2"], "it is inside the subject");
    noted(&folder, &["--eye", "2,0,-0.5"], "it is 0.50 m below the floor");
}

#[test]
fn one_camera_alone_and_cameras_on_one_side_are_noted() {
    noted(&recorded("alone", 1, 2), &["--bounds", "-1,1,-1,1,-0.1,2.1"], "alone sees the subject");
    noted(&recorded("one_side", 2, 2), &["--bounds", "-1,1,-1,1,-0.1,2.1"], "are on one side of the subject");
}

#[test]
fn the_sweep_without_a_graphics_library_is_refused_with_what_else_to_do() {
    let folder = recorded("sweep", 5, 2);
    refused(&folder, &["--method", "sweep", "--renderer", "cpu"], "use --renderer gpu or --method blend");
}

#[cfg(all(feature = "gpu", target_os = "linux"))]
#[test]
fn without_an_adapter_the_gpu_is_refused_with_what_to_install_and_auto_draws_on_the_processor() {
    let folder = recorded("no_adapter", 5, 2);
    // Neither OpenGL nor Vulkan finds a driver.
    let without = |renderer: &str| {
        let mut command = command(&folder, &["still", "person", "--size", "64x48", "--renderer", renderer]);
        command.env("__EGL_VENDOR_LIBRARY_FILENAMES", "/dev/null").env("VK_DRIVER_FILES", "/dev/null");
        command.env("VK_ICD_FILENAMES", "/dev/null");
        finished(command)
    };
    let run = without("gpu");
    let says = "found no adapter of Vulkan or OpenGL; install Mesa";
    assert!(!run.succeeded && run.error.contains(says), "{}", run.error);
    let run = without("auto");
    assert!(run.succeeded && run.out.contains("drawn by the processor"), "{}{}", run.out, run.error);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_that_names_the_file() {
    let folder = recorded("full", 5, 2);
    std::os::unix::fs::symlink("/dev/full", folder.join("full.png")).expect("a link");
    refused(&folder, &["--out", "full.png"], "full.png");
}

#[test]
fn a_comparison_needs_a_frame_with_images() {
    let folder = recorded("no_images", 5, 1);
    let run = finished(command(&folder, &["compare", "person"]));
    assert!(
        !run.succeeded && run.error.contains("expected a frame with masks and images, found"),
        "{}",
        run.error
    );
}
