use super::*;
use crate::camera::Camera;
use image::{ImageBuffer, Luma, Rgb};
use nalgebra::{Point3, Vector3};

/// A temporary folder for one test, removed when it is dropped.
pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("ode-visual-hull-{}-{test}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(super) fn join(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub(super) fn camera(name: &str, size: (u32, u32)) -> Camera {
    let eye = Point3::new(3.0, 0.0, 1.0);
    Camera::look_at(name, size, 1.0, eye, Point3::origin(), Vector3::z()).unwrap()
}

fn rig() -> Rig {
    Rig::new(vec![camera("left", (8, 6)), camera("right", (10, 4))]).unwrap()
}

fn masks(value: u8) -> Vec<GrayImage> {
    let of = |c: &Camera| ImageBuffer::from_pixel(c.size().0, c.size().1, Luma([value]));
    rig().cameras().iter().map(of).collect()
}

fn images(value: u8) -> Vec<RgbImage> {
    let of = |c: &Camera| ImageBuffer::from_fn(c.size().0, c.size().1, |x, y| Rgb([value, x as u8, y as u8]));
    rig().cameras().iter().map(of).collect()
}

/// Writes a recording of two frames of masks, one frame of images, and backgrounds.
fn new_recording(folder: &Folder) -> Recording {
    let mut recording = Recording::create(folder.join("r"), &rig()).unwrap();
    recording.write_masks(12, &masks(255)).unwrap();
    recording.write_masks(3, &masks(200)).unwrap();
    recording.write_images(7, &images(9)).unwrap();
    recording.write_backgrounds(&images(50)).unwrap();
    recording
}

fn open_error(dir: PathBuf) -> String {
    Recording::open(dir).unwrap_err().to_string()
}

pub(super) fn assert_contains(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

#[test]
fn what_is_written_is_read_back() {
    let folder = Folder::new("round-trip");
    let created = new_recording(&folder);
    let opened = Recording::open(folder.join("r")).unwrap();
    for recording in [created, opened] {
        assert_eq!(recording.frames(), [3, 12]);
        assert_eq!(recording.image_frames(), [7]);
        assert_eq!(recording.masks(3).unwrap(), masks(200));
        assert_eq!(recording.masks(12).unwrap(), masks(255));
        assert_eq!(recording.images(7).unwrap(), images(9));
        assert_eq!(recording.background(1).unwrap(), images(50)[1]);
        assert_eq!(recording.rig().index_of("right"), Some(1));
    }
}

#[test]
fn only_frames_that_all_cameras_have_count() {
    let folder = Folder::new("common");
    new_recording(&folder);
    std::fs::remove_file(folder.join("r/right/mask/000003.png")).unwrap();
    std::fs::write(folder.join("r/left/mask/notes.txt"), "").unwrap();
    std::fs::write(folder.join("r/left/mask/3_old.png"), "").unwrap();
    let recording = Recording::open(folder.join("r")).unwrap();
    assert_eq!(recording.frames(), [12]);
    let message = recording.masks(3).unwrap_err().to_string();
    assert_contains(&message, &["view \"right\"", "right/mask/000003", "only frame 12", "choose one"]);
}

#[test]
fn a_frame_replaces_files_of_another_format() {
    let folder = Folder::new("overwrite");
    new_recording(&folder);
    for name in ["left", "right"] {
        let dir = folder.join("r").join(name).join("image");
        std::fs::rename(dir.join("000007.png"), dir.join("7.ppm")).unwrap();
    }
    let mut recording = Recording::open(folder.join("r")).unwrap();
    recording.write_images(7, &images(99)).unwrap();
    assert_eq!(Recording::open(folder.join("r")).unwrap().images(7).unwrap(), images(99));
}

#[test]
fn missing_parts_are_named() {
    let folder = Folder::new("missing");
    assert_contains(&open_error(folder.join("none")), &["none: expected the folder of a recording"]);
    assert_contains(
        &open_error(folder.join("")),
        &["rig.toml: expected the recording's rig file, found none"],
    );

    let recording = new_recording(&folder);
    std::fs::remove_file(folder.join("r/left/background.png")).unwrap();
    let message = recording.background(0).unwrap_err().to_string();
    assert_contains(&message, &["view \"left\"", "left/background.png: expected an image"]);
    assert_contains(&recording.background(2).unwrap_err().to_string(), &["below 2, found 2"]);
    assert_contains(&recording.images(8).unwrap_err().to_string(), &["view \"left\"", "left/image/000008"]);

    std::fs::remove_dir_all(folder.join("r/right")).unwrap();
    assert_contains(&open_error(folder.join("r")), &["view \"right\"", "r/right, found none"]);
    std::fs::write(folder.join("r/rig.toml"), "[cam_0").unwrap();
    assert_contains(&open_error(folder.join("r")), &["r/rig.toml: line 1: expected TOML"]);
}

#[test]
fn the_error_about_no_common_frame_lists_the_cameras_frames() {
    let folder = Folder::new("nothing-in-common");
    new_recording(&folder);
    std::fs::remove_file(folder.join("r/right/mask/000003.png")).unwrap();
    std::fs::remove_file(folder.join("r/right/mask/000012.png")).unwrap();
    let message = open_error(folder.join("r"));
    let parts = ["mask/%06d.png", "\"left\" has 2 frames from 3 to 12", "\"right\" has no frames", "add"];
    assert_contains(&message, &parts);

    // A recording of images without any mask is valid.
    std::fs::remove_dir_all(folder.join("r/left/mask")).unwrap();
    let recording = Recording::open(folder.join("r")).unwrap();
    assert!(recording.frames().is_empty());
    assert_eq!(recording.image_frames(), [7]);
    std::fs::remove_dir_all(folder.join("r/left/image")).unwrap();
    assert_contains(&open_error(folder.join("r")), &["\"left\" has no frames", "\"right\" has only frame 7"]);
}

#[test]
fn errors_about_a_size_name_the_file_and_both_sizes() {
    let folder = Folder::new("size");
    let mut recording = new_recording(&folder);
    masks(9)[0].save(folder.join("r/right/mask/000012.png")).unwrap();
    let message = recording.masks(12).unwrap_err().to_string();
    assert_contains(&message, &["view \"right\"", "right/mask/000012.png", "expected 10 x 4", "found 8 x 6"]);

    let swapped: Vec<_> = masks(9).into_iter().rev().collect();
    let message = recording.write_masks(20, &swapped).unwrap_err().to_string();
    assert_contains(&message, &["view \"left\"", "expected 8 x 6", "found 10 x 4"]);
    assert!(!folder.join("r/left/mask/000020.png").exists());
    let message = recording.write_images(20, &images(1)[..1]).unwrap_err().to_string();
    assert_contains(&message, &["expected 2 images", "found 1"]);
}

#[test]
fn masks_of_zeros_and_ones_are_refused_by_file_and_view() {
    let folder = Folder::new("zero-one");
    let mut recording = new_recording(&folder);
    recording.write_masks(4, &masks(1)).unwrap();
    let message = recording.masks(4).unwrap_err().to_string();
    assert_contains(
        &message,
        &["view \"left\"", "left/mask/000004.png", "greatest value of 1; multiply by 255"],
    );
}

#[test]
fn two_files_of_one_frame_are_refused() {
    let folder = Folder::new("twice");
    new_recording(&folder);
    std::fs::copy(folder.join("r/left/mask/000003.png"), folder.join("r/left/mask/3.png")).unwrap();
    assert_contains(&open_error(folder.join("r")), &["view \"left\"", "one file for frame 3", "remove one"]);
}

#[test]
fn nothing_is_created_over_a_recording_or_outside_its_folder() {
    let folder = Folder::new("create");
    new_recording(&folder);
    let message = Recording::create(folder.join("r"), &rig()).unwrap_err().to_string();
    assert_contains(&message, &["found a rig file", "choose another"]);
    for name in ["..", "a/b", "a\\b"] {
        let outside = Rig::new(vec![camera(name, (8, 6))]).unwrap();
        let message = Recording::create(folder.join("new"), &outside).unwrap_err().to_string();
        assert_contains(&message, &["a folder name", "rename"]);
        assert!(!folder.join("new").exists());
    }
}

#[test]
fn masks_with_the_suffix_mask_may_lie_beside_the_images() {
    let folder = Folder::new("suffix");
    let mut recording = Recording::create(folder.join("r"), &rig()).unwrap();
    recording.write_images(4, &images(9)).unwrap();
    for (camera, mask) in recording.rig().cameras().iter().zip(masks(255)) {
        mask.save(folder.join("r").join(camera.name()).join("image/000004_mask.png")).unwrap();
    }

    let beside = Recording::open(folder.join("r")).unwrap();
    assert_eq!((beside.frames(), beside.image_frames()), (&[4][..], &[4][..]));
    assert_eq!(beside.masks(4).unwrap(), masks(255));

    for (camera, mask) in recording.rig().cameras().iter().zip(masks(200)) {
        let own = folder.join("r").join(camera.name()).join("mask");
        std::fs::create_dir(&own).unwrap();
        // A cut-out image: black, with the mask as its alpha channel.
        let cut_out = ImageBuffer::from_fn(mask.width(), mask.height(), |_, _| image::Rgba([0, 0, 0, 200u8]));
        cut_out.save(own.join("5_mask.png")).unwrap();
    }

    let own = Recording::open(folder.join("r")).unwrap();
    assert_eq!(own.frames(), [5]);
    assert_eq!(own.masks(5).unwrap(), masks(200));
}

#[test]
fn masks_as_run_lengths_equal_masks_in_files() {
    let folder = Folder::new("run-lengths");
    let mut recording = new_recording(&folder);
    let packed: Vec<_> = masks(200).iter().map(PackedMask::new).collect();
    recording.write_packed_masks(30, &packed).unwrap();

    // Frame 12 has mask images, which the run lengths replace; below, images replace run lengths.
    recording.write_packed_masks(12, &packed).unwrap();
    for recording in [recording.clone(), Recording::open(folder.join("r")).unwrap()] {
        assert_eq!(recording.masks(30).unwrap(), masks(200));
        assert_eq!(recording.masks(12).unwrap(), masks(200));
        assert!(recording.frames().contains(&30) && recording.frames().contains(&12));
    }

    recording.write_masks(30, &masks(255)).unwrap();
    assert_eq!(recording.masks(30).unwrap(), masks(255));
    assert_eq!(Recording::open(folder.join("r")).unwrap().masks(30).unwrap(), masks(255));
}

#[test]
fn two_masks_of_one_frame_are_refused() {
    let folder = Folder::new("two-masks");
    let mut recording = new_recording(&folder);
    let packed: Vec<_> = masks(200).iter().map(PackedMask::new).collect();
    recording.write_packed_masks(30, &packed).unwrap();
    let picture = folder.join("r/left/mask/000030.png");
    masks(255)[0].save(&picture).unwrap();
    let message = Recording::open(folder.join("r")).unwrap_err().to_string();
    assert!(
        message.contains("left") && message.contains("000030.png") && message.contains("mask.rle"),
        "{message}"
    );
}

#[test]
fn a_truncated_mask_is_reported_if_no_frame_is_left() {
    let folder = Folder::new("cut-off");
    let mut recording = Recording::create(folder.join("r"), &rig()).unwrap();
    let packed: Vec<_> = masks(200).iter().map(PackedMask::new).collect();
    recording.write_packed_masks(7, &packed).unwrap();
    let path = folder.join("r/right/mask.rle");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    let message = Recording::open(folder.join("r")).unwrap_err().to_string();
    assert!(message.contains("mask.rle ends within the mask of frame 7"), "{message}");
}

#[test]
fn if_one_mask_cannot_be_written_as_run_lengths_none_is() {
    let folder = Folder::new("all-or-none");
    let mut recording = Recording::create(folder.join("r"), &rig()).unwrap();
    let packed = |value| masks(value).iter().map(PackedMask::new).collect::<Vec<_>>();
    recording.write_packed_masks(7, &packed(200)).unwrap();
    let path = folder.join("r/left/mask.rle");
    let before = std::fs::read(&path).unwrap();

    // A folder takes the place of the second camera's file.
    let other = folder.join("r/right/mask.rle");
    std::fs::remove_file(&other).unwrap();
    std::fs::create_dir(&other).unwrap();
    for frame in [7, 8] {
        let message = recording.write_packed_masks(frame, &packed(150)).unwrap_err().to_string();
        assert!(message.contains("right") && message.contains("mask.rle"), "{message}");
        assert_eq!(std::fs::read(&path).unwrap(), before);
    }
    assert_eq!(recording.frames(), [7]);
}
