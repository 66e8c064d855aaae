//! One camera's video, written by an `ffmpeg` process.

use crate::source::{cannot_start, enlarge, file_name, last_lines};
use crate::{Error, Result};
use image::RgbImage;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::thread::JoinHandle;

/// The options of the codec and its format.
///
/// Each image by itself, in Matroska, which needs no end: a killed process loses at most the last image. Colours keep
/// their full resolution, by which subjects are told from backgrounds. Measured for noisy images of 640 x 480 pixels on
/// one core with ffmpeg 5.1; the last column is how many of 60 images were readable after `kill -9`:
///
/// ```text
///                                     ms/image   PSNR/dB   kB/image
///   mjpeg q 3, fixed Huffman tables      6.4       36.3        87    59
///   mjpeg q 2, fixed Huffman tables      9.1       38.3       140    59
///   libx264 ultrafast crf 15, g 1        6.7       36.8        80    59
///   libx264 ultrafast crf 18             6         35.5        62     0: a whole group of images is written at once
///   ffv1                                26     lossless       484     -
/// ```
///
/// mjpeg is in every build of ffmpeg, libx264 is not.
const CODEC: [&str; 12] = [
    "-c:v",
    "mjpeg",
    "-pix_fmt",
    "yuvj444p",
    "-q:v",
    "3",
    "-huffman",
    "default",
    "-threads",
    "1",
    "-flush_packets",
    "1",
];

/// A video that is being written; dropping it completes the file.
#[derive(Debug)]
pub(super) struct VideoWriter {
    path: PathBuf,
    child: Child,
    /// `None` once all images are written.
    images: Option<ChildStdin>,
    /// The thread that drains ffmpeg's messages.
    messages: Option<JoinHandle<Vec<String>>>,
}

impl VideoWriter {
    /// Starts the video at `path`, with images of `size` in pixels at `rate` images per second.
    ///
    /// # Errors
    /// `ffmpeg` is not installed.
    pub(super) fn start(path: &Path, size: (u32, u32), rate: f64) -> Result<Self> {
        let (size, rate) = (format!("{}x{}", size.0, size.1), rate.to_string());
        let mut command = Command::new("ffmpeg");
        command
            .args(["-nostdin", "-hide_banner", "-loglevel", "error", "-y"])
            .args(["-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", &size, "-framerate", &rate])
            .args(["-i", "pipe:0"])
            .args(CODEC)
            .args(["-f", "matroska"])
            .arg(file_name(path))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());

        // Ctrl-C is for the program, which then completes the video.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);

        let mut child = command.spawn().map_err(|e| cannot_start("ffmpeg", path, &e))?;
        let (images, stderr) = (child.stdin.take(), child.stderr.take());
        if let Some(images) = &images {
            enlarge(images);
        }
        let mut writer = Self { path: path.to_owned(), child, images, messages: None };
        let Some(stderr) = stderr else { return Ok(writer) };
        let messages =
            std::thread::Builder::new().name("ffmpeg's stderr".into()).spawn(|| last_lines(stderr));
        writer.messages =
            Some(messages.map_err(|e| Error::file(path, format!("expected to start a thread, found: {e}")))?);
        Ok(writer)
    }

    /// Appends an image, which has the size of the video.
    ///
    /// # Errors
    /// ffmpeg has ended, with its messages.
    pub(super) fn write(&mut self, image: &RgbImage) -> Result<()> {
        let written = self.images.as_mut().map(|images| images.write_all(image.as_raw()));
        match written {
            Some(Ok(())) => Ok(()),
            Some(Err(e)) => {
                self.finish()?;
                Err(self.failed(&e.to_string()))
            }
            None => Err(self.failed("that it has ended before")),
        }
    }

    /// Completes the file.
    ///
    /// # Errors
    /// ffmpeg has failed, with its messages.
    pub(super) fn finish(&mut self) -> Result<()> {
        self.images = None;
        let status = self.child.wait().map_err(|e| self.failed(&e.to_string()))?;
        let messages = self.messages.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
        match messages.as_slice() {
            _ if status.success() => Ok(()),
            [] => Err(self.failed(&format!("that it ended with {status}"))),
            lines => Err(self.failed(&lines.join("; "))),
        }
    }

    fn failed(&self, found: &str) -> Error {
        let problem = format!(
            "expected ffmpeg to write this video, found: {found}; make room on the disk, or choose another folder"
        );
        Error::file(&self.path, problem)
    }

    #[cfg(test)]
    pub(super) fn kill(&mut self) {
        self.child.kill().unwrap();
    }
}

impl Drop for VideoWriter {
    fn drop(&mut self) {
        let _ = self.finish();
    }
}
