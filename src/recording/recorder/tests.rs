use super::super::StreamOptions;
use super::super::tests::{Folder, assert_contains, camera};
use super::video_writer::VideoWriter;
use super::*;
use crate::source::{Frame, VideoFile};
use image::{GrayImage, Luma, Rgb};

const SIZES: [(u32, u32); 2] = [(32, 24), (40, 16)];

fn rig() -> Rig {
    Rig::new(vec![camera("left", SIZES[0]), camera("right", SIZES[1])]).unwrap()
}

/// A smooth image, which a codec keeps but for its quantisation.
fn image(number: u32, (width, height): (u32, u32)) -> RgbImage {
    let of = |value: u32| (value % 256) as u8;
    RgbImage::from_fn(width, height, |x, y| Rgb([of(60 + 10 * number), of(40 + 4 * x), of(200 - 4 * y)]))
}

/// A mask with coverage along its edge.
fn mask(number: u32, (width, height): (u32, u32)) -> GrayImage {
    let edge = 5 + number % 4;
    GrayImage::from_fn(width, height, |x, y| match x.cmp(&edge) {
        std::cmp::Ordering::Less => Luma([255]),
        std::cmp::Ordering::Equal => Luma([3 + 7 * y as u8]),
        std::cmp::Ordering::Greater => Luma([0]),
    })
}

/// The times of frame `number`, which no short decimal number equals.
fn times(number: u32) -> [f64; 2] {
    [f64::from(number) / 30.0 + 1e-7, f64::from(number) / 30.0 + 0.001]
}

fn frame(number: u32) -> (ImageSet, Vec<Option<PackedMask>>) {
    let images = SIZES
        .iter()
        .zip(times(number))
        .map(|(&size, time)| Some(Frame { number: number + 100, time, image: image(number, size).into() }));
    let set = ImageSet { images: images.collect(), time: times(number)[0], time_spread: 0.001 };
    (set, SIZES.iter().map(|&size| Some(PackedMask::new(&mask(number, size)))).collect())
}

/// Writes frame `number` and waits until the thread has taken it.
fn write(recorder: &mut Recorder, number: u32) {
    let (images, masks) = frame(number);
    recorder.write_frame(&images, &masks);
    while recorder.shared.waiting.load(Ordering::Acquire) > 0 && recorder.error().is_none() {
        std::thread::yield_now();
    }
}

/// Checks the frames of the recording at `dir`, which are frames 0, 1, .. of this test, and returns the number of sets
/// of images and of masks.
fn check(dir: &Path) -> (usize, usize) {
    let recording = Recording::open(dir).unwrap();
    let options = StreamOptions { bound: Some(0.002), ..StreamOptions::default() };
    let mut sets = 0;
    for (number, set) in (0..).zip(recording.synchronised(&options).unwrap()) {
        for ((found, &size), time) in set.unwrap().images.iter().zip(&SIZES).zip(times(number)) {
            // The videos of a recording that is being written may differ by an image.
            let Some(found) = found else { continue };
            assert_eq!((found.number, found.time), (number, time));
            assert!(differs_by(&found.image, &image(number, size)) < 8, "frame {number}");
        }
        sets += 1;
    }

    for &number in recording.frames() {
        assert_eq!(recording.masks(number).unwrap(), SIZES.map(|size| mask(number, size)));
    }
    (sets, recording.frames().len())
}

/// The largest difference of a channel. The codec's quantiser at q 3 rounds each coefficient to about 3 to 12 levels,
/// of which smooth images have few, and the conversion of colours adds 1 or 2.
fn differs_by(a: &RgbImage, b: &RgbImage) -> u8 {
    assert_eq!(a.dimensions(), b.dimensions());
    a.iter().zip(b.iter()).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn what_is_recorded_is_read_back() {
    let folder = Folder::new("recorder");
    let dir = folder.join("r");
    let backgrounds = SIZES.map(|size| image(9, size)).to_vec();
    let options = RecorderOptions { backgrounds: Some(backgrounds.clone()), ..RecorderOptions::default() };
    let mut recorder = Recorder::create(&dir, &rig(), options).unwrap();
    (0..12).for_each(|number| write(&mut recorder, number));
    assert_eq!(recorder.error(), None);

    let summary = recorder.finish().unwrap();
    assert_eq!(summary, RecordingSummary { dir: dir.clone(), frames: 12, left_out: 0, incomplete: 0 });
    assert_eq!(check(&dir), (12, 12));
    let recording = Recording::open(&dir).unwrap();
    assert_eq!(recording.rig().len(), 2);
    assert_eq!(recording.background(1).unwrap(), backgrounds[1]);
    assert_eq!(
        recording.frame_times(&StreamOptions::default()).unwrap(),
        Some((0..12).map(|number| times(number)[0]).collect())
    );
}

#[test]
fn frames_that_come_too_fast_are_left_out_and_counted() {
    let folder = Folder::new("recorder-fast");
    let dir = folder.join("r");
    let mut recorder = Recorder::create(&dir, &rig(), RecorderOptions::default()).unwrap();
    // As if the thread were busy with as many frames as may wait.
    recorder.shared.waiting.fetch_add(DEPTH, Ordering::AcqRel);
    let (images, masks) = frame(0);
    recorder.write_frame(&images, &masks);
    assert_eq!(recorder.left_out(), 1);
    recorder.shared.waiting.fetch_sub(DEPTH, Ordering::AcqRel);
    // The frame that was left out is no reason to leave out the next.
    recorder.write_frame(&images, &masks);
    let summary = recorder.finish().unwrap();
    assert_eq!((summary.frames, summary.left_out), (1, 1));
    assert_eq!(check(&dir), (1, 1));
}

#[test]
fn a_frame_without_a_camera_or_a_later_time_is_left_out_and_counted() {
    let folder = Folder::new("recorder-incomplete");
    let dir = folder.join("r");
    let mut recorder = Recorder::create(&dir, &rig(), RecorderOptions::default()).unwrap();
    write(&mut recorder, 0);
    let (mut images, masks) = frame(1);
    images.images[1] = None;
    recorder.write_frame(&images, &masks);
    let (images, mut masks) = frame(1);
    masks[0] = None;
    recorder.write_frame(&images, &masks);
    write(&mut recorder, 0);
    write(&mut recorder, 1);

    assert_eq!((recorder.incomplete(), recorder.left_out()), (3, 0));
    assert_eq!(recorder.finish().unwrap().frames, 2);
    assert_eq!(check(&dir), (2, 2));
}

#[test]
fn a_recording_is_readable_while_it_is_written_as_after_a_kill() {
    let folder = Folder::new("recorder-kill");
    let dir = folder.join("r");
    let mut recorder = Recorder::create(&dir, &rig(), RecorderOptions::default()).unwrap();
    let videos = ["left", "right"].map(|name| streams_path(&dir, name));

    // ffmpeg writes images some time after it has taken them.
    let mut number = 0;
    while videos.iter().any(|video| VideoFile::new(video).count().ok().flatten().unwrap_or(0) < 3) {
        write(&mut recorder, number);
        number += 1;
    }
    let copy = folder.join("copy");
    copy_folder(&dir, &copy);
    let (images, masks) = check(&copy);
    assert!(images >= 3 && masks >= images, "{images} {masks}");
    assert_eq!(recorder.finish().unwrap().frames, number);
}

fn streams_path(dir: &Path, camera: &str) -> PathBuf {
    super::super::streams::video_path(dir, camera)
}

fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
        let to = to.join(entry.file_name().unwrap());
        if entry.is_dir() {
            copy_folder(&entry, &to);
        } else {
            std::fs::copy(&entry, &to).unwrap();
        }
    }
}

#[test]
fn a_video_whose_ffmpeg_is_killed_is_an_error_and_keeps_its_images() {
    let folder = Folder::new("recorder-ffmpeg");
    let path = folder.join("video.mkv");
    let mut video = VideoWriter::start(&path, SIZES[0], 30.0).unwrap();
    while VideoFile::new(&path).count().ok().flatten().unwrap_or(0) < 3 {
        video.write(&image(0, SIZES[0])).unwrap();
    }
    video.kill();
    // A pipe takes images until its other end is closed.
    let error = (0..).find_map(|_| video.write(&image(0, SIZES[0])).err()).unwrap();
    assert_contains(&error.to_string(), &["video.mkv", "expected ffmpeg to write", "choose another folder"]);
    assert!(VideoFile::new(&path).count().unwrap().unwrap() >= 3);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_the_recording_with_an_error_and_keeps_the_frames_before() {
    let folder = Folder::new("recorder-full");
    let dir = folder.join("r");
    std::fs::create_dir_all(dir.join("right")).unwrap();
    std::os::unix::fs::symlink("/dev/full", streams_path(&dir, "right")).unwrap();
    let mut recorder = Recorder::create(&dir, &rig(), RecorderOptions::default()).unwrap();
    let mut number = 0;
    while recorder.error().is_none() {
        write(&mut recorder, number);
        number += 1;
    }

    let parts = ["view \"right\"", "video.mkv", "No space left", "make room"];
    assert_contains(&recorder.error().unwrap().to_string(), &parts);
    write(&mut recorder, number);
    assert_eq!(recorder.left_out(), 1);
    assert_contains(&recorder.finish().unwrap_err().to_string(), &parts);
    assert!(Recording::open(&dir).is_ok());
    assert!(VideoFile::new(streams_path(&dir, "left")).count().unwrap().unwrap() > 0);
}

#[test]
fn images_of_another_size_end_the_recording_and_a_recording_is_not_overwritten() {
    let folder = Folder::new("recorder-size");
    let dir = folder.join("r");
    let mut recorder = Recorder::create(&dir, &rig(), RecorderOptions::default()).unwrap();
    write(&mut recorder, 0);
    let (mut images, masks) = frame(1);
    images.images.swap(0, 1);
    recorder.write_frame(&images, &masks);
    let error = recorder.finish().unwrap_err();
    assert_contains(&error.to_string(), &["view \"left\"", "expected 32 x 24", "found 40 x 16"]);
    assert_eq!(check(&dir), (1, 1));

    let again = Recorder::create(&dir, &rig(), RecorderOptions::default());
    assert_contains(&again.unwrap_err().to_string(), &["rig file", "choose another folder"]);
    let rate = RecorderOptions { rate: 0.0, ..RecorderOptions::default() };
    let refused = Recorder::create(folder.join("new"), &rig(), rate);
    assert_contains(&refused.unwrap_err().to_string(), &["positive", "found 0"]);
}
