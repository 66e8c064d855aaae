//! Video files, read through `ffmpeg`.

use super::ffmpeg::{Ffmpeg, file_name};
use super::probe::{self, Header};
use super::{CancelHandle, Frame, ReadOptions, Source, Times, VideoFile};
use crate::{Error, Result};
use image::RgbImage;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The images of a video file of any kind that the installed `ffmpeg` reads.
///
/// They are numbered from 0 as they are decoded; none is dropped or repeated to match a clock. A video taken upright
/// is rotated as its header says. Times are listed, or follow from the number and the video's mean rate.
#[derive(Debug)]
pub struct Video {
    path: PathBuf,
    options: ReadOptions,
    times: Times,
    header: Header,
    /// `None` after the last image.
    ffmpeg: Option<Ffmpeg>,
    /// The first image, which is decoded on opening.
    first: Option<Arc<RgbImage>>,
    size: (u32, u32),
    next: u32,
    notes: Vec<String>,
}

impl Video {
    /// Opens the video at `path` and decodes its first image.
    ///
    /// # Errors
    /// `ffmpeg` is not installed; a file that is missing or unreadable, with ffmpeg's messages; a video of another
    /// size than in `options`, or without its first image; a rate that is not positive, or neither in the header nor
    /// in `options`.
    pub fn open(path: impl AsRef<Path>, options: ReadOptions) -> Result<Self> {
        VideoFile::new(path.as_ref()).open(options)
    }

    /// Opens the video at `path`, which has this header.
    pub(super) fn start(path: &Path, header: Header, options: ReadOptions) -> Result<Self> {
        let path = path.to_owned();
        let Some(times) = options.times.clone().or(header.rate.map(Times::Rate)) else {
            return Err(Error::file(
                path,
                "expected a rate in the header, found none; give the rate or the times",
            ));
        };
        times.check()?;

        let filter = match options.first {
            0 => String::new(),
            first => format!("select=gte(n\\,{first}),"),
        };

        let mut ffmpeg = Ffmpeg::start(&path, &[], &filter, &file_name(&path))?;
        let Some(first) = ffmpeg.next_picture()? else {
            let (end, number) = (ffmpeg.end(), options.first);
            let problem = format!("expected an image as frame {number}, found none; {}", end.quoted());
            return Err(Error::file(path, problem));
        };

        let size = first.dimensions();
        options.check_size(&path, "", size)?;
        let next = options.first;
        let (ffmpeg, first) = (Some(ffmpeg), Some(first));
        Ok(Self { path, options, times, header, ffmpeg, first, size, next, notes: Vec::new() })
    }

    /// Width and height of the images, in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    fn picture(&mut self) -> Result<Option<Arc<RgbImage>>> {
        match (self.first.take(), &mut self.ffmpeg) {
            (None, Some(ffmpeg)) => ffmpeg.next_picture(),
            (first, _) => Ok(first),
        }
    }

    /// Closes the video after the last image: notes about it, or an error if it ended too early.
    fn end(&mut self) -> Result<()> {
        let Some(mut ffmpeg) = self.ffmpeg.take() else { return Ok(()) };
        let (end, found, path) = (ffmpeg.end(), self.next, &self.path);
        let kept = "the images before are good";

        if !end.success {
            let problem = format!("expected frame {found}, found an end; {}; {kept}", end.quoted());
            return Err(Error::file(path, problem));
        }

        if let Some(promised) = self.header.frames.filter(|&promised| found < promised) {
            // Some encoders leave out images that repeat the last one but count them in the header.
            if probe::packets(path)?.is_some_and(|held| held < promised) {
                let problem = format!(
                    "expected {promised} images as its header says, found an end after {found}; {}; copy the file \
                     again if it was cut off; {kept}",
                    end.quoted()
                );
                return Err(Error::file(path, problem));
            }

            let left_out = promised - found;
            self.notes.push(format!(
                "{}: its header counts {promised} images, of which {left_out} only repeat others and are left out; the \
                 numbers are those of the other {found}",
                path.display()
            ));
        }

        if !end.messages.is_empty() {
            self.notes.push(format!("{}: some images may be damaged: {}", path.display(), end.quoted()));
        }
        Ok(())
    }

    fn frame(&mut self, image: Arc<RgbImage>) -> Result<Frame> {
        let number = self.next;
        self.next += 1;
        self.options.check_size(&self.path, &format!("frame {number}: "), image.dimensions())?;
        let time = self.times.of(number).map_err(|problem| Error::file(&self.path, problem))?;
        Ok(Frame { number, time, image })
    }
}

impl Source for Video {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        match self.picture() {
            Ok(Some(image)) => Some(self.frame(image)),
            Ok(None) => self.end().err().map(Err),
            Err(e) => {
                self.ffmpeg = None;
                Some(Err(e))
            }
        }
    }

    fn frames_left(&self) -> Option<u32> {
        Some(self.header.frames?.saturating_sub(self.next))
    }

    fn period(&self) -> Option<f64> {
        self.times.period()
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    fn cancel_handle(&self) -> CancelHandle {
        self.ffmpeg.as_ref().map(Ffmpeg::cancel_handle).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
