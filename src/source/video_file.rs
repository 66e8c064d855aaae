//! A video file and its header.

use super::probe::{self, Header};
use super::{ReadOptions, Video};
use crate::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A video file of any kind that the installed `ffmpeg` reads. Its header is read when it is first needed, and kept, so
/// that playing a video again and again reads it once.
#[derive(Debug, Clone)]
pub struct VideoFile {
    path: PathBuf,
    header: OnceLock<Header>,
}

impl VideoFile {
    /// The video at `path`; nothing is read yet.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), header: OnceLock::new() }
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The images per second, if the header has the rate.
    ///
    /// # Errors
    /// No such file; `ffprobe`, which comes with ffmpeg, is not installed; a file that it cannot read.
    pub fn rate(&self) -> Result<Option<f64>> {
        Ok(self.header()?.rate)
    }

    /// The number of images. A file whose header lacks it is read, without decoding.
    ///
    /// # Errors
    /// All errors of [`rate`](Self::rate).
    pub fn count(&self) -> Result<Option<u32>> {
        match self.header()?.frames {
            None => probe::packets(&self.path),
            known => Ok(known),
        }
    }

    /// Opens the video and decodes its first image.
    ///
    /// # Errors
    /// All errors of [`Video::open`].
    pub fn open(&self, options: ReadOptions) -> Result<Video> {
        // Also where the header is known: the file may have gone since.
        if !self.path.is_file() {
            return Err(Error::file(&self.path, "expected a video file, found none; check the path"));
        }
        Video::start(&self.path, self.header()?, options)
    }

    fn header(&self) -> Result<Header> {
        if let Some(header) = self.header.get() {
            return Ok(*header);
        }
        let header = probe::header(&self.path)?;
        Ok(*self.header.get_or_init(|| header))
    }
}
