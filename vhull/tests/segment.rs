//! `vhull segment` on the command line: folders, videos, and errors in them.

use image::{GrayImage, Rgb, RgbImage};
use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::rig::Rig;
use ode_visual_hull_testing::random::Random;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SIZE: (u32, u32) = (320, 240);
const CAMERAS: [&str; 2] = ["left", "right"];

/// A temporary folder of one test, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("vhull-segment-{}-{test}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn path(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The background without the subject.
fn background() -> RgbImage {
    RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| Rgb([60 + (x / 8) as u8, 90, 60 + (y / 8) as u8]))
}

/// Whether a pixel belongs to the subject, a square of 64 px that moves right by 4 px per frame.
fn is_subject(frame: u32, x: u32, y: u32) -> bool {
    (40 + 4 * frame..104 + 4 * frame).contains(&x) && (80..144).contains(&y)
}

/// The subject in red before the background.
fn image(frame: u32) -> RgbImage {
    let mut image = background();
    for (x, y, pixel) in image.enumerate_pixels_mut() {
        if is_subject(frame, x, y) {
            *pixel = Rgb([220, 40, 30]);
        }
    }
    image
}

/// A recording of two cameras with `frames` images and a background each.
fn record(folder: &Folder, frames: u32) -> PathBuf {
    let dir = folder.path("r");
    let camera = |name: &&str| {
        Camera::look_at(*name, SIZE, 1.0, Point3::new(3.0, 0.0, 1.0), Point3::origin(), Vector3::z()).unwrap()
    };
    let mut recording =
        Recording::create(&dir, &Rig::new(CAMERAS.iter().map(camera).collect()).unwrap()).unwrap();
    recording.write_backgrounds(&[background(), background()]).unwrap();
    for frame in 0..frames {
        recording.write_images(frame, &[image(frame), image(frame)]).unwrap();
    }
    dir
}

/// Replaces a camera's folder of images by a lossless video.
fn into_video(dir: &Path, camera: &str) {
    let images = dir.join(camera).join("image");
    let mut command = Command::new("ffmpeg");
    command.args(["-nostdin", "-loglevel", "error", "-framerate", "10", "-i"]).arg(images.join("%06d.png"));
    command.args(["-c:v", "ffv1", "-pix_fmt", "bgr0"]).arg(dir.join(camera).join("video.avi"));
    assert!(command.status().expect("ffmpeg, which scripts/setup installs").success());
    std::fs::remove_dir_all(images).unwrap();
}

/// Runs `vhull segment` on the recording in `dir`.
fn vhull(dir: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vhull"));
    command.arg("segment").arg(dir).args(arguments).output().unwrap()
}

/// Asserts success, and returns standard error.
#[track_caller]
fn assert_success(output: &Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{errors}");
    errors
}

/// Asserts an exit code and parts of standard error.
#[track_caller]
fn assert_error(output: &Output, code: i32, parts: &[&str]) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{text}");
    parts.iter().for_each(|part| assert!(text.contains(part), "{text:?} lacks {part:?}"));
}

/// Asserts that these frames and no others have masks, all of them equal to the square.
#[track_caller]
fn assert_masks(dir: &Path, frames: &[u32]) {
    let recording = Recording::open(dir).unwrap();
    assert_eq!(recording.frames(), frames);
    for &frame in frames {
        for mask in recording.masks(frame).unwrap() {
            let wrong =
                |(x, y, value): (u32, u32, &image::Luma<u8>)| (value.0[0] >= 128) != is_subject(frame, x, y);
            let wrong = mask.enumerate_pixels().filter(|pixel| wrong(*pixel)).count();
            // Cleaning the mask rounds the corners of its 4096 pixels.
            assert!(wrong < 40, "frame {frame}: {wrong} pixels");
        }
    }
}

/// Names of the files in a folder, sorted.
fn files(folder: &Path) -> Vec<String> {
    let names =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.collect();
    names.sort();
    names
}

#[test]
fn images_and_videos_are_segmented_and_existing_masks_are_kept_or_refused() {
    let folder = Folder::new("masks");
    let dir = record(&folder, 6);
    into_video(&dir, "right");
    assert_success(&vhull(&dir, &["--frames", "1..3"]));
    assert_masks(&dir, &[1, 2]);
    assert_error(&vhull(&dir, &[]), 1, &["found masks of 2 frames", "--resume", "--force", "--out"]);
    assert_success(&vhull(&dir, &["--resume"]));
    assert_masks(&dir, &[0, 1, 2, 3, 4, 5]);

    let out = folder.path("out");
    assert_success(&vhull(&dir, &["--frames", "4..", "--out", out.to_str().unwrap()]));
    assert_masks(&out, &[4, 5]);
    assert_eq!(files(&out), ["frames.csv", "left", "rig.toml", "right"]);
}

#[test]
fn masks_as_run_lengths_equal_masks_as_png_and_take_one_file_per_camera() {
    let folder = Folder::new("rle");
    let dir = record(&folder, 4);
    let [pictures, runs] = ["pictures", "runs"].map(|name| folder.path(name));
    assert_success(&vhull(&dir, &["--out", pictures.to_str().unwrap()]));
    assert_success(&vhull(&dir, &["--rle", "--frames", "..2", "--out", runs.to_str().unwrap()]));
    assert_success(&vhull(&dir, &["--rle", "--resume", "--out", runs.to_str().unwrap()]));
    assert_eq!(files(&runs.join("left")), ["mask.rle"]);

    let masks = |dir| {
        let recording = Recording::open(dir).unwrap();
        recording.frames().iter().map(|&frame| recording.masks(frame).unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(masks(&runs), masks(&pictures));
    assert_masks(&runs, &[0, 1, 2, 3]);

    // The error for an invalid file names it.
    std::fs::write(runs.join("right/mask.rle"), "no masks").unwrap();
    let resumed = vhull(&dir, &["--rle", "--resume", "--out", runs.to_str().unwrap()]);
    assert_error(&resumed, 1, &["right", "mask.rle", "segment again, or move the file away"]);
}

#[test]
fn masks_in_a_folder_of_their_own_keep_the_times_of_the_recording() {
    let folder = Folder::new("own_times");
    let dir = record(&folder, 4);
    let out = folder.path("out");
    let segment =
        |more: &[&str]| assert_success(&vhull(&dir, &[&["--out", out.to_str().unwrap()], more].concat()));
    let times = || Recording::open(&out).unwrap().frame_times(&StreamOptions::default()).unwrap();

    segment(&["--frames", "..1"]);
    assert_eq!(times(), None, "the recording has no times");

    std::fs::write(dir.join("frames.csv"), "frame,left,right\n0,5,5\n1,5.5,5.5\n2,6.25,6.25\n3,8,8\n")
        .unwrap();
    segment(&["--frames", "..1", "--force"]);
    segment(&["--frames", "..3", "--resume"]);
    assert_eq!(times(), Some(vec![5.0, 5.5, 6.25]));

    segment(&["--force", "--rate", "2"]);
    assert_eq!(times(), Some(vec![0.0, 0.5, 1.0, 1.5]), "--rate takes precedence over frames.csv");

    std::fs::write(out.join("frames.csv"), "frame,left,right\n0,0,0\n1,1,1\n2,2,2\n3,3,3\n").unwrap();
    segment(&["--force"]);
    assert_eq!(times(), Some(vec![0.0, 1.0, 2.0, 3.0]), "a table from the user is kept");
}

#[test]
fn the_background_can_be_a_folder_of_images_a_video_or_the_first_images() {
    let folder = Folder::new("empty");
    let dir = record(&folder, 4);
    for camera in CAMERAS {
        std::fs::remove_file(dir.join(camera).join("background.png")).unwrap();
    }
    assert_error(
        &vhull(&dir, &[]),
        1,
        &["view \"left\"", "left/background", "without the subject", "--empty"],
    );

    let backgrounds = folder.path("backgrounds");
    std::fs::create_dir(&backgrounds).unwrap();
    for camera in CAMERAS {
        background().save(backgrounds.join(format!("{camera}.png"))).unwrap();
    }
    assert_success(&vhull(&dir, &["--background", backgrounds.to_str().unwrap()]));
    assert_masks(&dir, &[0, 1, 2, 3]);
    for camera in CAMERAS {
        // The first two images show the background alone.
        for number in 0..2 {
            background().save(dir.join(camera).join(format!("image/{number:06}.png"))).unwrap();
        }
        let video = dir.join(camera).join("empty.avi");
        let mut command = Command::new("ffmpeg");
        command
            .args(["-nostdin", "-loglevel", "error", "-loop", "1", "-i"])
            .arg(backgrounds.join(format!("{camera}.png")));
        command.args(["-frames:v", "60", "-c:v", "ffv1", "-pix_fmt", "bgr0"]).arg(video);
        assert!(command.status().unwrap().success());
    }

    std::fs::create_dir(folder.path("a")).unwrap();
    for (out, arguments) in [("a/1", ["--empty", "2"]), ("a/2", ["--background", "empty.avi"])] {
        let out = folder.path(out);
        let out = out.to_str().unwrap();
        assert_success(&vhull(&dir, &[&arguments[..], &["--frames", "2..", "--out", out]].concat()));
        assert_masks(Path::new(out), &[2, 3]);
    }
    assert_error(&vhull(&dir, &["--background", "none.avi", "--force"]), 1, &["left/none.avi", "found none"]);
}

#[test]
fn frames_before_a_corrupt_image_are_kept_and_resume_continues_after_it() {
    let folder = Folder::new("corrupt");
    let dir = record(&folder, 5);
    let bad = dir.join("right/image/000003.png");
    let png = std::fs::read(&bad).unwrap();
    std::fs::write(&bad, &png[..png.len() / 2]).unwrap();

    let parts = [
        "view \"right\"",
        "right/image/000003.png",
        "expected an image",
        "after frame 2",
        "3 frames are done",
    ];
    assert_error(&vhull(&dir, &[]), 1, &parts);
    assert_masks(&dir, &[0, 1, 2]);

    std::fs::remove_file(&bad).unwrap();
    let notes = assert_success(&vhull(&dir, &["--resume"]));
    assert!(notes.contains("1 frames left out") && notes.contains("frame 3, without right"), "{notes}");
    assert_masks(&dir, &[0, 1, 2, 4]);
}

#[test]
fn frames_of_a_video_that_ends_early_are_kept_and_unequal_lengths_are_noted() {
    let folder = Folder::new("early");
    let dir = record(&folder, 12);
    into_video(&dir, "right");
    for frame in 8..12 {
        std::fs::remove_file(dir.join(format!("left/image/{frame:06}.png"))).unwrap();
    }
    let notes = assert_success(&vhull(&dir, &[]));
    assert!(notes.contains("4 frames left out") && notes.contains("frame 8, without left"), "{notes}");
    assert_masks(&dir, &(0..8).collect::<Vec<_>>());

    // A video that is cut off.
    let video = dir.join("right/video.avi");
    let bytes = std::fs::read(&video).unwrap();
    std::fs::write(&video, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let output = vhull(&dir, &["--force"]);
    assert_error(
        &output,
        1,
        &["view \"right\"", "video.avi", "expected 12 images", "frames are done", "--resume"],
    );
}

#[test]
fn the_error_of_a_full_disk_names_the_frame_and_no_partial_file_is_left() {
    let folder = Folder::new("full");
    let dir = record(&folder, 4);

    // Frame 2 has random blocks, whose mask is a large file.
    let mut random = Random(1);
    let mut noise = RgbImage::from_pixel(64, 48, Rgb([0; 3]));
    for pixel in noise.pixels_mut() {
        *pixel = if random.below(2) == 0 { Rgb([250, 0, 0]) } else { Rgb([60, 90, 60]) };
    }
    let noise = image::imageops::resize(&noise, SIZE.0, SIZE.1, image::imageops::FilterType::Nearest);
    for camera in CAMERAS {
        noise.save(dir.join(camera).join("image/000002.png")).unwrap();
    }

    // Limit files to 2 KiB, as if the disk were full.
    let script = "trap '' XFSZ; ulimit -f 4; exec \"$0\" segment \"$1\"";
    let mut command = Command::new("sh");
    let output = command.args(["-c", script, env!("CARGO_BIN_EXE_vhull")]).arg(&dir).output().unwrap();
    let parts = ["frame 2: ", "left/mask/000002.png", "make room", "2 frames are done", "--resume"];
    assert_error(&output, 1, &parts);
    assert_masks(&dir, &[0, 1]);
    for camera in CAMERAS {
        assert_eq!(files(&dir.join(camera).join("mask")), ["000000.png", "000001.png"]);
    }

    assert_success(&vhull(&dir, &["--resume"]));
    assert_eq!(Recording::open(&dir).unwrap().frames(), [0, 1, 2, 3]);
}

#[test]
fn without_ffmpeg_videos_are_refused_and_nothing_is_written() {
    let folder = Folder::new("without-ffmpeg");
    let dir = record(&folder, 2);
    into_video(&dir, "right");
    let (out, mut command) = (folder.path("out"), Command::new(env!("CARGO_BIN_EXE_vhull")));
    let output =
        command.arg("segment").arg(&dir).arg("--out").arg(&out).env("PATH", "/nowhere").output().unwrap();
    assert_error(&output, 1, &["right/video.avi", "install ffmpeg", "apt-get install ffmpeg"]);
    assert!(!out.exists());
}

#[test]
fn errors_of_wrong_input_name_the_option_or_file() {
    let folder = Folder::new("cannot");
    let dir = record(&folder, 2);
    assert_error(&vhull(&folder.path("none"), &[]), 1, &["none", "folder of a recording"]);
    assert_error(&vhull(&dir, &["--frames", "7.."]), 1, &["expected frames", "found none", "--bound"]);
    assert_error(&vhull(&dir, &["--frames", "3..2"]), 2, &["3..2", "20..60"]);
    assert_error(&vhull(&dir, &["--rate", "0"]), 2, &["positive", "found 0"]);
    assert_error(&vhull(&dir, &["--method", "magic"]), 2, &["clean-plate"]);
    assert_error(&vhull(&dir, &["--key", "1,2,3"]), 1, &["--key", "--method chroma-key"]);
    assert_error(&vhull(&dir, &["--method", "chroma-key", "--empty", "1"]), 1, &["--empty", "chroma-key"]);
    assert_error(&vhull(&dir, &["--empty", "99"]), 1, &["view \"left\"", "--empty", "99 images"]);

    RgbImage::new(8, 8).save(dir.join("left/background.png")).unwrap();
    assert_error(&vhull(&dir, &[]), 1, &["view \"left\"", "background.png", "320 x 240", "found 8 x 8"]);

    // A recording of masks without images.
    let mask = GrayImage::new(SIZE.0, SIZE.1);
    Recording::resume(&dir, Recording::open(&dir).unwrap().rig())
        .unwrap()
        .write_masks(0, &[mask.clone(), mask])
        .unwrap();
    for camera in CAMERAS {
        std::fs::remove_dir_all(dir.join(camera).join("image")).unwrap();
    }
    assert_error(&vhull(&dir, &[]), 1, &["found masks alone", "nothing to segment"]);
}

#[test]
fn a_running_gaussian_finds_the_masks() {
    let folder = Folder::new("learnt");
    let dir = record(&folder, 3);
    assert_success(&vhull(&dir, &["--method", "running-gaussian"]));
    assert_masks(&dir, &[0, 1, 2]);
}

#[test]
fn refine_corrects_an_outdated_background() {
    let folder = Folder::new("refine");
    let dir = record(&folder, 30);
    let mut outdated = background();
    for (x, y) in (230..300).flat_map(|x| (10..70).map(move |y| (x, y))) {
        outdated.put_pixel(x, y, Rgb([20, 30, 220]));
    }
    Recording::open(&dir).unwrap().write_backgrounds(&[outdated.clone(), outdated]).unwrap();
    assert_success(&vhull(&dir, &["--refine", "--frames", "10..12"]));
    assert_masks(&dir, &[10, 11]);
    assert_error(
        &vhull(&dir, &["--refine", "--method", "chroma-key", "--force"]),
        1,
        &["--refine", "clean-plate"],
    );
    assert_error(
        &vhull(&dir, &["--method", "chroma-key", "--key", "1,2"]),
        2,
        &["red, green and blue", "1,2"],
    );
}
