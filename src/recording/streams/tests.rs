use super::super::tests::{Folder, assert_contains, camera};
use super::*;
use crate::rig::Rig;
use crate::source::Round;
use image::{Rgb, RgbImage};
use std::process::Command;

fn rig() -> Rig {
    Rig::new(vec![camera("left", (16, 8)), camera("right.b", (8, 16))]).unwrap()
}

/// A recording of two cameras without any images.
fn empty(folder: &Folder) -> PathBuf {
    let dir = folder.join("r");
    Recording::create(&dir, &rig()).unwrap();
    dir
}

fn write_video(path: &Path, frames: u32, size: &str) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let source = format!("color=black:s={size}:r=10,format=gray,geq=lum=10*N");
    let mut command = Command::new("ffmpeg");
    command.args(["-nostdin", "-loglevel", "error", "-f", "lavfi", "-i", &source, "-c:v", "ffv1"]);
    let done = command.args(["-frames:v", &frames.to_string()]).arg(path).status();
    assert!(done.expect("ffmpeg, which scripts/setup installs").success());
}

fn write_images(folder: &Path, numbers: &[u32], (width, height): (u32, u32)) {
    std::fs::create_dir_all(folder).unwrap();
    for &number in numbers {
        let image = RgbImage::from_pixel(width, height, Rgb([10 * number as u8; 3]));
        image.save(folder.join(format!("{number:06}.png"))).unwrap();
    }
}

/// The number and grey value of each camera's image, for each set.
fn sets(dir: &Path, options: &StreamOptions) -> Vec<Vec<Option<(u32, u8)>>> {
    let synchroniser = Recording::open(dir).unwrap().synchronised(options).unwrap();
    let number_and_grey = |frame: &crate::source::Frame| (frame.number, frame.image.get_pixel(3, 3).0[0]);
    synchroniser
        .map(|set| set.unwrap().images.iter().map(|image| image.as_ref().map(number_and_grey)).collect())
        .collect()
}

#[test]
fn videos_and_folders_of_images_form_sets_by_their_numbers() {
    let folder = Folder::new("mixed");
    let dir = empty(&folder);
    write_video(&dir.join("videos/right.b.MKV"), 4, "8x16");
    write_images(&dir.join("left/image"), &[0, 1, 3, 4], (16, 8));
    let recording = Recording::open(&dir).unwrap();
    assert!(recording.has_images() && recording.frames().is_empty() && recording.image_frames().is_empty());
    let synchroniser = recording.synchronised(&StreamOptions::default()).unwrap();
    // The folder has the video's rate of 10 images per second.
    assert_eq!((synchroniser.bound(), synchroniser.streams().len()), (0.05, 2));
    let expected = [0, 1, 2, 3, 4].map(|n| {
        let image = Some((n, 10 * n as u8));
        vec![image.filter(|_| n != 2), image.filter(|_| n != 4)]
    });
    assert_eq!(sets(&dir, &StreamOptions::default()), expected);
    assert_eq!(sets(&dir, &StreamOptions { first: 2, ..StreamOptions::default() }), expected[2..]);
}

#[test]
fn masks_have_the_times_of_the_first_cameras_images() {
    let folder = Folder::new("mask_times");
    let dir = empty(&folder);
    let masks = [image::GrayImage::new(16, 8), image::GrayImage::new(8, 16)];
    for frame in [1, 4] {
        Recording::open(&dir)
            .or_else(|_| Recording::resume(&dir, &rig()))
            .unwrap()
            .write_masks(frame, &masks)
            .unwrap();
    }

    let times = |rate| {
        let recording = Recording::open(&dir).unwrap();
        recording.frame_times(&StreamOptions { rate, ..StreamOptions::default() })
    };
    assert_eq!(times(None), Ok(None), "no source of times");
    assert_eq!(times(Some(2.0)), Ok(Some(vec![0.5, 2.0])));
    assert!(times(Some(0.0)).is_err());

    write_video(&dir.join("videos/right.b.avi"), 2, "8x16");
    assert_eq!(times(None), Ok(Some(vec![0.1, 0.4])), "another camera's video");
    write_video(&dir.join("left/video.avi"), 2, "16x8");
    assert_eq!(times(None), Ok(Some(vec![0.1, 0.4])), "its own");

    std::fs::write(dir.join("frames.csv"), "frame,left,right.b\n1,5,7\n4,5.25,8\n").unwrap();
    assert_eq!(times(None), Ok(Some(vec![5.0, 5.25])));
    std::fs::write(dir.join("frames.csv"), "frame,time\n1,5\n").unwrap();
    assert_contains(&times(None).unwrap_err().to_string(), &["left", "frames.csv", "frame 4"]);
}

#[test]
fn listed_times_decide_which_images_form_a_set() {
    let folder = Folder::new("listed");
    let dir = empty(&folder);
    write_images(&dir.join("left/image"), &[0, 1], (16, 8));
    write_video(&dir.join("right.b/video.avi"), 3, "8x16");
    // The right camera started one frame earlier.
    std::fs::write(dir.join("frames.csv"), "frame,left,right.b\n0,5.1,5.0\n1,5.2,5.1\n2,,5.2\n").unwrap();
    let expected = [[None, Some((0, 0))], [Some((0, 0)), Some((1, 10))], [Some((1, 10)), Some((2, 20))]];
    assert_eq!(sets(&dir, &StreamOptions::default()), expected);

    // A rate in the options overrides the list.
    assert_eq!(
        sets(&dir, &StreamOptions { rate: Some(10.0), ..StreamOptions::default() })[0][0],
        Some((0, 0))
    );

    std::fs::write(dir.join("frames.csv"), "frame,left\n").unwrap();
    let refused = Recording::open(&dir).unwrap().synchronised(&StreamOptions::default());
    assert_contains(&refused.unwrap_err().to_string(), &["frames.csv", "line 1", "right.b"]);
}

#[test]
fn a_camera_without_images_or_with_two_videos_is_named() {
    let folder = Folder::new("without");
    let dir = empty(&folder);
    write_video(&dir.join("left/video.avi"), 1, "16x8");
    let opened = Recording::open(&dir).unwrap_err().to_string();
    assert_contains(&opened, &["\"left\" has no frames", "\"right.b\" has no frames"]);

    write_video(&dir.join("right.b/video.avi"), 1, "8x16");
    write_video(&dir.join("videos/right.b.mkv"), 1, "8x16");
    let opened = Recording::open(&dir).unwrap_err().to_string();
    assert_contains(&opened, &["view \"right.b\"", "one video", "video.avi", "videos/right.b.mkv", "remove"]);
    std::fs::remove_file(dir.join("videos/right.b.mkv")).unwrap();

    let recording = Recording::open(&dir).unwrap();
    let options = StreamOptions::default();
    assert_contains(&recording.source(2, &options).err().unwrap().to_string(), &["below 2, found 2"]);
    let bound = StreamOptions { bound: Some(-1.0), ..options };
    assert_contains(&recording.synchronised(&bound).unwrap_err().to_string(), &["bound", "-1"]);
}

#[test]
fn a_video_of_another_size_than_the_rig_names_the_view_and_both_sizes() {
    let folder = Folder::new("video-size");
    let dir = empty(&folder);
    write_video(&dir.join("left/video.avi"), 1, "16x8");
    write_video(&dir.join("right.b/video.avi"), 1, "16x8");
    let refused = Recording::open(&dir).unwrap().synchronised(&StreamOptions::default());
    let parts = ["view \"right.b\"", "right.b/video.avi", "expected 8 x 16", "found 16 x 8"];
    assert_contains(&refused.unwrap_err().to_string(), &parts);
}

#[test]
fn a_recording_is_resumed_only_with_its_own_cameras() {
    let folder = Folder::new("resume");
    let dir = folder.join("new");
    assert!(Recording::resume(&dir, &rig()).unwrap().frames().is_empty());
    let mut recording = Recording::resume(&dir, &rig()).unwrap();
    let masks =
        rig().cameras().iter().map(|c| image::GrayImage::new(c.size().0, c.size().1)).collect::<Vec<_>>();
    recording.write_masks(5, &masks).unwrap();
    assert_eq!(Recording::resume(&dir, &rig()).unwrap().frames(), [5]);
    let other = Rig::new(vec![camera("left", (16, 8))]).unwrap();
    assert_contains(&Recording::resume(&dir, &other).unwrap_err().to_string(), &["rig.toml", "found others"]);
}

#[test]
fn a_round_spans_the_images_of_all_cameras() {
    let folder = Folder::new("round");
    let dir = empty(&folder);
    let round = |options: &StreamOptions| Recording::open(&dir).unwrap().round(options);
    write_images(&dir.join("left/image"), &[1, 2, 4], (16, 8));
    // The header of an mkv does not count its images.
    write_video(&dir.join("right.b/video.mkv"), 4, "8x16");
    let default = StreamOptions::default();
    // 10 images per second, as the video.
    assert_eq!(round(&default), Round::new(0..5, 0.0, 0.4, 0.1));
    assert_eq!(round(&StreamOptions { first: 2, ..default }), Round::new(2..5, 0.2, 0.4, 0.1));
    assert_eq!(round(&StreamOptions { rate: Some(2.0), ..default }), Round::new(0..5, 0.0, 2.0, 0.5));
    assert_contains(
        &round(&StreamOptions { first: 4, ..default }).unwrap_err().to_string(),
        &["right.b", "4"],
    );

    let times = "frame,left,right.b\n0,,5.0\n1,5.25,5.26\n2,5.5,5.51\n3,,5.76\n4,6.0,\n";
    std::fs::write(dir.join("frames.csv"), times).unwrap();
    assert_eq!(round(&default), Round::new(0..5, 5.0, 6.0, 0.25));
    std::fs::write(dir.join("frames.csv"), "frame,time\n1,5\n").unwrap();
    assert_contains(&round(&default).unwrap_err().to_string(), &["frames.csv", "two images", "found one"]);
}
