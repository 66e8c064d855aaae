use super::super::testing::{Folder, assert_says, grey_image, write_video};
use super::*;
use std::collections::BTreeMap;
use std::process::Command;
use std::sync::Arc;

/// All images of a video, the error that ends it, and its notes.
fn all(mut video: Video) -> (Vec<Frame>, Option<Error>, Vec<String>) {
    let mut frames = Vec::new();
    loop {
        match video.next_frame() {
            Some(Ok(frame)) => frames.push(frame),
            Some(Err(e)) => {
                assert!(video.next_frame().is_none());
                return (frames, Some(e), video.notes());
            }
            None => return (frames, None, video.notes()),
        }
    }
}

fn ffmpeg(arguments: &[&str], path: &Path) {
    let mut command = Command::new("ffmpeg");
    command.args(["-nostdin", "-loglevel", "error", "-y"]).args(arguments).arg(path);
    assert!(command.status().expect("ffmpeg, which scripts/setup installs").success());
}

#[test]
fn every_image_of_a_video_comes_once_in_order_with_its_time() {
    let folder = Folder::new("video");
    let path = folder.path("clip.avi");
    write_video(&path, 40, (32, 24));
    let video = Video::open(&path, ReadOptions { size: Some((32, 24)), ..ReadOptions::default() }).unwrap();
    assert_eq!((video.size(), video.frames_left(), video.period()), ((32, 24), Some(40), Some(0.04)));
    let (frames, error, notes) = all(video);
    assert_eq!((frames.len(), error, notes), (40, None, vec![]));
    for (number, frame) in (0..).zip(&frames) {
        assert_eq!((frame.number, frame.time), (number, f64::from(number) / 25.0));
        // The codec is lossless, and the conversion from grey to colour is exact.
        assert_eq!(*frame.image, grey_image(10 + 2 * number as u8, (32, 24)), "{number}");
    }
}

#[test]
fn a_video_may_be_read_from_the_middle() {
    let folder = Folder::new("middle");
    let path = folder.path("clip.mkv");
    write_video(&path, 10, (16, 8));
    let times = Times::Listed(Arc::new(BTreeMap::from([(7, 1.0), (8, 1.5), (9, 2.5)])));
    let options = ReadOptions { first: 7, times: Some(times), ..ReadOptions::default() };
    let (frames, error, _) = all(Video::open(&path, options.clone()).unwrap());
    assert_eq!(error, None);
    assert_eq!(
        frames.iter().map(|frame| (frame.number, frame.time)).collect::<Vec<_>>(),
        [(7, 1.0), (8, 1.5), (9, 2.5)]
    );
    assert_eq!(*frames[0].image, grey_image(24, (16, 8)));
    let beyond = ReadOptions { first: 10, ..options };
    assert_says(Video::open(&path, beyond), &["clip.mkv", "frame 10", "found none"]);
}

#[test]
fn time_stamps_that_disagree_with_the_rate_drop_and_repeat_nothing() {
    // 20 images with irregular time stamps: ffmpeg's own clock would produce 58 images.
    let folder = Folder::new("stamps");
    let path = folder.path("clip.mkv");
    let source = "color=black:s=16x8:r=25,format=gray,geq=lum=10+2*N,setpts=PTS+floor(N/7)/TB";
    ffmpeg(&["-f", "lavfi", "-i", source, "-frames:v", "20", "-vsync", "vfr", "-c:v", "ffv1"], &path);
    let (frames, error, _) = all(Video::open(&path, ReadOptions::default()).unwrap());
    assert_eq!(error, None);
    let greys: Vec<_> = frames.iter().map(|frame| frame.image.get_pixel(3, 3).0[0]).collect();
    assert_eq!(greys, (0..20).map(|n| 10 + 2 * n).collect::<Vec<_>>());
}

#[test]
fn a_video_of_another_size_is_refused_with_both_sizes() {
    let folder = Folder::new("size");
    let path = folder.path("clip.avi");
    write_video(&path, 2, (32, 24));
    let options = ReadOptions { size: Some((64, 48)), ..ReadOptions::default() };
    assert_says(Video::open(&path, options), &["clip.avi", "64 x 48", "found 32 x 24", "calibrate"]);
}

#[test]
fn a_video_taken_upright_is_rotated() {
    let folder = Folder::new("portrait");
    let (landscape, portrait) = (folder.path("landscape.mp4"), folder.path("portrait.mp4"));
    ffmpeg(&["-f", "lavfi", "-i", "testsrc=s=32x24:r=25", "-frames:v", "2", "-c:v", "mpeg4"], &landscape);
    let source = landscape.to_str().unwrap();
    ffmpeg(&["-i", source, "-c", "copy", "-metadata:s:v:0", "rotate=90"], &portrait);
    assert_eq!(Video::open(&landscape, ReadOptions::default()).unwrap().size(), (32, 24));
    assert_eq!(Video::open(&portrait, ReadOptions::default()).unwrap().size(), (24, 32));
}

#[test]
fn a_truncated_video_yields_its_images_and_then_an_error() {
    let folder = Folder::new("cut");
    let path = folder.path("clip.avi");
    ffmpeg(&["-f", "lavfi", "-i", "testsrc2=s=160x120:r=25", "-frames:v", "40", "-c:v", "ffv1"], &path);
    let (whole, ..) = all(Video::open(&path, ReadOptions::default()).unwrap());

    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();

    let (frames, error, _) = all(Video::open(&path, ReadOptions::default()).unwrap());
    assert!((10..30).contains(&frames.len()), "{}", frames.len());
    assert_eq!(frames[..frames.len() - 1], whole[..frames.len() - 1]);
    let parts = ["clip.avi", "expected 40 images", &format!("after {}", frames.len()), "good"];
    assert_says::<()>(Err(error.unwrap()), &parts);
}

#[test]
fn a_video_with_a_damaged_middle_is_reported() {
    let folder = Folder::new("damaged");
    let path = folder.path("clip.avi");
    ffmpeg(&["-f", "lavfi", "-i", "testsrc=s=64x48:r=25", "-frames:v", "40", "-c:v", "mpeg4"], &path);

    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle..middle + 600].fill(0x5a);
    std::fs::write(&path, &bytes).unwrap();

    let (frames, error, notes) = all(Video::open(&path, ReadOptions::default()).unwrap());
    assert!(frames.len() > 15, "{}", frames.len());
    let reported = notes.into_iter().chain(error.map(|e| e.to_string())).collect::<Vec<_>>().join("\n");
    assert!(reported.contains("clip.avi") && reported.contains("ffmpeg said"), "{reported}");
}

#[test]
fn files_that_are_not_videos_are_refused_with_ffmpegs_message() {
    let folder = Folder::new("foreign");
    assert_says(
        Video::open(folder.path("none.mp4"), ReadOptions::default()),
        &["none.mp4", "found none", "path"],
    );

    let path = folder.path("notes: today.mp4");
    std::fs::write(&path, "not a video").unwrap();
    assert_says(Video::open(&path, ReadOptions::default()), &["notes: today.mp4", "Invalid data"]);
    std::fs::write(&path, "").unwrap();
    assert_says(
        Video::open(&path, ReadOptions::default()),
        &["notes: today.mp4", "a video that ffmpeg can read"],
    );

    let sound = folder.path("sound.wav");
    ffmpeg(&["-f", "lavfi", "-i", "sine=d=0.1"], &sound);
    assert_says(Video::open(&sound, ReadOptions::default()), &["sound.wav", "no stream of images"]);

    let (path, options) =
        (folder.path("clip.avi"), ReadOptions { times: Some(Times::Rate(-1.0)), ..ReadOptions::default() });
    write_video(&path, 1, (8, 8));
    assert_says(Video::open(&path, options), &["positive", "-1"]);
}
