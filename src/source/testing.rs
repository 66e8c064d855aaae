//! Folders, images and sources for the tests of this module.

use super::{CancelHandle, Frame, Source};
use crate::Result;
use image::{Rgb, RgbImage};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Condvar, Mutex};

/// A temporary folder for one test, removed when it is dropped.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("ode-visual-hull-source-{}-{test}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// An image of a uniform grey value.
pub fn grey_image(value: u8, (width, height): (u32, u32)) -> RgbImage {
    RgbImage::from_pixel(width, height, Rgb([value; 3]))
}

pub fn frame(number: u32, time: f64) -> Frame {
    Frame { number, time, image: grey_image(number as u8, (2, 1)).into() }
}

#[track_caller]
pub fn assert_says<T>(result: Result<T>, parts: &[&str]) {
    let message = result.err().expect("an error").to_string();
    parts.iter().for_each(|part| assert!(message.contains(part), "{message:?} lacks {part:?}"));
}

/// Writes a lossless video of `frames` uniform images with grey values 10, 12, 14, .., at 25 images per second.
pub fn write_video(path: &Path, frames: u32, (width, height): (u32, u32)) {
    let source = format!("color=black:s={width}x{height}:r=25,format=gray,geq=lum=10+2*N");
    let done = Command::new("ffmpeg")
        .args(["-nostdin", "-loglevel", "error", "-y", "-f", "lavfi", "-i", &source])
        .args(["-frames:v", &frames.to_string(), "-c:v", "ffv1"])
        .arg(path)
        .status()
        .expect("ffmpeg, which scripts/setup installs");
    assert!(done.success());
}

/// A source that yields the frames that the test sends, and waits for more until the test ends it.
#[derive(Clone, Default)]
pub struct Fed(Arc<(Mutex<Feed>, Condvar)>);

#[derive(Default)]
struct Feed {
    frames: VecDeque<Result<Frame>>,
    ended: bool,
    blocks: bool,
}

impl Fed {
    /// A source that yields `frames` and ends.
    pub fn with(frames: impl IntoIterator<Item = Result<Frame>>) -> Self {
        let fed = Self::default();
        frames.into_iter().for_each(|frame| fed.send(frame));
        fed.end();
        fed
    }

    pub fn send(&self, frame: Result<Frame>) {
        self.0.0.lock().unwrap().frames.push_back(frame);
        self.0.1.notify_all();
    }

    pub fn end(&self) {
        self.0.0.lock().unwrap().ended = true;
        self.0.1.notify_all();
    }

    /// Waits until all frames have been taken and a reader waits for more.
    pub fn wait_until_starved(&self) {
        let feed = self.0.0.lock().unwrap();
        let starved = |feed: &mut Feed| !(feed.frames.is_empty() && feed.blocks);
        drop(self.0.1.wait_while(feed, starved).unwrap());
    }
}

impl Source for Fed {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        let mut feed = self.0.0.lock().unwrap();
        while feed.frames.is_empty() && !feed.ended {
            feed.blocks = true;
            self.0.1.notify_all();
            feed = self.0.1.wait(feed).unwrap();
        }
        feed.blocks = false;
        feed.frames.pop_front()
    }

    fn cancel_handle(&self) -> CancelHandle {
        let fed = self.clone();
        CancelHandle::new(move || fed.end())
    }
}
