//! Sources of colour images: folders, video files, live devices, network streams.
//!
//! ```text
//!   ImageFolder ─┐                               ┌► ImageSet: an image of each camera,
//!   Video        │                               │  or the gap that says which is missing
//!   Images       ├─ Source ─► ReadAhead ─┐       │
//!   Device       │            (a thread  ├─► Synchroniser
//!   your own    ─┘ │   ▲      each)      ┘
//!                  ▼   │
//!         Paced (played by a Clock), Reconnecting (opened again)
//! ```
//!
//! A [`Source`] yields one camera's images in order, each with its number and its time in seconds. [`ReadAhead`] reads
//! it on a thread of its own into a bounded queue. If the queue is full, it waits (for recordings, so that nothing is
//! lost) or drops and counts the oldest image (for live cameras, so that the images are fresh). [`Synchroniser`]
//! groups the images of several cameras by their times.
//!
//! [`Paced`] plays a source by a [`Clock`] as if it were live, again and again; [`Images`] are in memory already.
//!
//! A [`Reconnecting`] source opens a camera or a network stream again when it is lost, and tells its
//! [status](StreamStatus).
//!
//! Videos and devices are read by the program `ffmpeg`, which supports all common codecs; it runs as a child process
//! and ends when its source is dropped. Folders need no other program.
//!
//! # Times
//!
//! An image's time is listed ([`Times::Listed`], [`frames_csv`]), or its number divided by a rate ([`Times::Rate`], a
//! video's own rate), or, for a live device, the time of its arrival. All cameras of a set need the same clock: the
//! devices of one program share the instant from which they count. A live system that pauses and steps has a [`Clock`].

mod clock;
mod device;
mod ffmpeg;
mod folder;
pub mod frames_csv;
mod image_pool;
mod images;
mod paced;
mod probe;
mod queue;
mod read_ahead;
mod reconnecting;
mod synchroniser;
mod times;
mod video;
mod video_file;

pub use clock::Clock;
pub use device::{Device, DeviceOptions};
pub(crate) use ffmpeg::{cannot_start, enlarge, file_name, last_lines};
pub use folder::ImageFolder;
pub use images::Images;
pub use paced::{Paced, Round, Start};
pub use queue::WhenFull;
pub use read_ahead::ReadAhead;
pub use reconnecting::{ReconnectOptions, Reconnecting, StatusHandle, StreamStatus};
pub use synchroniser::{ImageSet, Synchroniser};
pub use times::Times;
pub use video::Video;
pub use video_file::VideoFile;

use crate::{Error, Result};
use image::RgbImage;
use std::path::Path;
use std::sync::Arc;

/// An image of one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The image's number in its source: the number in the file name, or the position in the video from 0.
    pub number: u32,
    /// The time of exposure, in seconds.
    pub time: f64,
    /// The pixels, shared by all who use them.
    pub image: Arc<RgbImage>,
}

/// Images of one camera, in the order in which they were taken.
///
/// Implement it for a camera with its own library; everything else in this module then works with it.
pub trait Source: Send {
    /// The next image; `None` after the last. It may wait for a camera.
    ///
    /// # Errors
    /// An image that cannot be read. Reading may continue with the images after it; if it cannot, `None` follows.
    fn next_frame(&mut self) -> Option<Result<Frame>>;

    /// How many images remain, if known.
    fn frames_left(&self) -> Option<u32> {
        None
    }

    /// The seconds from one image to the next, if known.
    fn period(&self) -> Option<f64> {
        None
    }

    /// Remarks after the last image, such as damaged images; one sentence each.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// A handle that ends a waiting [`next_frame`](Self::next_frame) from another thread; needed only where it may
    /// wait long.
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

/// Cancels a waiting [`Source`] from another thread.
#[derive(Clone, Default)]
pub struct CancelHandle(Option<Arc<dyn Fn() + Send + Sync>>);

impl CancelHandle {
    /// A handle that calls `stop`, which must not wait for the source.
    pub fn new(stop: impl Fn() + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(stop)))
    }

    /// Ends the source's wait for an image, and the source.
    pub fn stop(&self) {
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

/// Options for reading a folder or a video.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Width and height that the images must have, in pixels: the size at which the camera is calibrated.
    pub size: Option<(u32, u32)>,
    /// The number of the first image; earlier ones are skipped.
    pub first: u32,
    /// The images' times. Default: a video's own rate, 30 images per second for folders.
    pub times: Option<Times>,
}

impl ReadOptions {
    /// Compares an image's size with the expected one; `what` begins the error message.
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
