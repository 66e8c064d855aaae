//! Where colour images come from: folders, video files, live devices.
//!
//! ```text
//!   ImageFolder ─┐                             ┌► ImageSet: an image of each camera,
//!   Video ───────┼─ Source ─► ReadAhead ─┐     │  or the gap that says which is missing
//!   Device ──────┘            (a thread  ├─► Synchroniser
//!   your own                   each)     ┘
//! ```
//!
//! A [`Source`] gives one camera's images in order, each with its number and its time in seconds. [`ReadAhead`] reads
//! it on a thread of its own into a bounded queue; a slow reader makes it wait (recordings: nothing is lost) or makes
//! it drop the oldest image and count it (live: what is shown is fresh). [`Synchroniser`] puts the images of several
//! cameras together by their times.
//!
//! Videos and devices are read by the program `ffmpeg`, whose codecs are those that people have; it is started as a
//! process of its own and ended when its source is dropped. Folders need nothing.
//!
//! # Times
//!
//! An image's time is listed ([`Times::Listed`], [`frames_csv`]), or its number divided by a rate ([`Times::Rate`], a
//! video's own rate), or, of a live device, when it arrived. All cameras of a set need the same clock: the devices of
//! one program share the instant from which they count.

mod device;
mod ffmpeg;
mod folder;
pub mod frames_csv;
mod probe;
mod queue;
mod read_ahead;
mod synchroniser;
mod times;
mod video;

pub use device::{Device, DeviceOptions};
pub use folder::ImageFolder;
pub use queue::WhenFull;
pub use read_ahead::ReadAhead;
pub use synchroniser::{ImageSet, Synchroniser};
pub use times::Times;
pub use video::Video;

use crate::{Error, Result};
use image::RgbImage;
use std::path::Path;

/// An image of one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Its number in its source: that of the file name, or the position in the video from 0.
    pub number: u32,
    /// When it was taken, in seconds.
    pub time: f64,
    /// What the camera saw.
    pub image: RgbImage,
}

/// Images of one camera, in the order in which they were taken.
///
/// Implement it for a camera with a library of its own; everything else here then works with it.
pub trait Source: Send {
    /// The next image, `None` after the last. May wait for a camera.
    ///
    /// # Errors
    /// An image that cannot be read. Those before it are good, and reading may go on with the ones after it; `None`
    /// follows where it cannot.
    fn next_frame(&mut self) -> Option<Result<Frame>>;

    /// How many images are still to come, where that is known.
    fn frames_left(&self) -> Option<u32> {
        None
    }

    /// The seconds from one image to the next, where that is known.
    fn period(&self) -> Option<f64> {
        None
    }

    /// What somebody should know who has read all images without an error; a sentence each.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// What ends a [`next_frame`](Self::next_frame) that waits on another thread. Needed only where it may wait long.
    fn cancel_handle(&self) -> CancelHandle {
        CancelHandle::default()
    }
}

impl<S: Source + ?Sized> Source for Box<S> {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        (**self).next_frame()
    }

    fn frames_left(&self) -> Option<u32> {
        (**self).frames_left()
    }

    fn period(&self) -> Option<f64> {
        (**self).period()
    }

    fn notes(&self) -> Vec<String> {
        (**self).notes()
    }

    fn cancel_handle(&self) -> CancelHandle {
        (**self).cancel_handle()
    }
}

/// Ends what a [`Source`] waits for, from another thread.
#[derive(Default)]
pub struct CancelHandle(Option<Box<dyn Fn() + Send + Sync>>);

impl CancelHandle {
    /// Calls `stop`, which must not wait for the source.
    pub fn new(stop: impl Fn() + Send + Sync + 'static) -> Self {
        Self(Some(Box::new(stop)))
    }

    fn stop(&self) {
        if let Some(stop) = &self.0 {
            stop();
        }
    }
}

impl std::fmt::Debug for CancelHandle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("CancelHandle").field(&self.0.is_some()).finish()
    }
}

/// How to read a folder or a video.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Width and height that the images must have, in pixels: those at which the camera is calibrated.
    pub size: Option<(u32, u32)>,
    /// The number of the first image; earlier ones are passed over.
    pub first: u32,
    /// When the images were taken. Default: a video's own rate, 30 a second for folders.
    pub times: Option<Times>,
}

impl ReadOptions {
    fn check_size(&self, path: &Path, what: &str, found: (u32, u32)) -> Result<()> {
        match self.size {
            Some((w, h)) if (w, h) != found => Err(Error::file(
                path,
                format!(
                    "{what}expected {w} x {h} pixels, the size at which the camera is calibrated, found {} x {}; \
                     calibrate at the size of the pictures, or scale them",
                    found.0, found.1
                ),
            )),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod testing;
