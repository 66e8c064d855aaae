//! Films as files: animated GIFs, and MP4 by ffmpeg.

use image::RgbImage;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::Film;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};

/// A film that is written frame by frame, in the format that its name ends with.
pub struct Movie {
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    /// A GIF has one palette for all frames, so that they are kept until the end.
    Gif(Film),
    Mp4(Encoder),
}

/// A running ffmpeg that takes raw frames.
struct Encoder {
    child: Child,
    /// Taken when the film ends.
    frames: Option<ChildStdin>,
    size: (u32, u32),
}

impl Movie {
    /// A film of `rate` frames a second with pictures of `size` pixels.
    ///
    /// # Errors
    /// A name that ends neither with .gif nor with .mp4; for .mp4, an ffmpeg that is missing.
    pub fn create(path: &Path, size: (u32, u32), rate: f64) -> Result<Self> {
        let sink = match path.extension().and_then(|extension| extension.to_str()) {
            Some("gif") => Sink::Gif(Film::new(rate)),
            Some("mp4") => Sink::Mp4(Encoder::start(path, size, rate)?),
            _ => {
                return Err(Error::file(
                    path,
                    "expected a film's name to end with .gif or .mp4, found another",
                ));
            }
        };
        Ok(Self { path: path.to_owned(), sink })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// An ffmpeg that has failed; a frame of another size.
    pub fn push(&mut self, frame: RgbImage) -> Result<()> {
        match &mut self.sink {
            Sink::Gif(film) => {
                film.push(frame);
                Ok(())
            }
            Sink::Mp4(encoder) => encoder.push(&frame).map_err(|problem| Error::file(&self.path, problem)),
        }
    }

    /// Completes the file.
    ///
    /// # Errors
    /// A file that cannot be written, as on a full disk.
    pub fn finish(self) -> Result<()> {
        match self.sink {
            Sink::Gif(film) => film.write(&self.path),
            Sink::Mp4(encoder) => encoder.finish().map_err(|problem| Error::file(&self.path, problem)),
        }
    }
}

impl Encoder {
    fn start(path: &Path, size: (u32, u32), rate: f64) -> Result<Self> {
        let mut command = Command::new("ffmpeg");
        command.args(["-nostdin", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"]);
        command.args(["-s", &format!("{}x{}", size.0, size.1), "-r", &rate.to_string(), "-i", "pipe:0"]);
        // Half of the colours' resolution needs even sizes. That players can start before the end needs the index first.
        command.args([
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2",
            "-pix_fmt",
            "yuv420p",
            "-movflags",
            "+faststart",
        ]);
        command.args(["-crf", "18", "-f", "mp4"]).arg(path);
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|e| {
            Error::file(
                path,
                format!("expected ffmpeg, which writes MP4, found: {e}; install ffmpeg, or give a name that ends with .gif"),
            )
        })?;
        let frames = child.stdin.take();
        Ok(Self { child, frames, size })
    }

    fn push(&mut self, frame: &RgbImage) -> std::result::Result<(), String> {
        if frame.dimensions() != self.size {
            let ((w, h), (width, height)) = (frame.dimensions(), self.size);
            return Err(format!("expected frames of {width} x {height} pixels, found one of {w} x {h}"));
        }
        let written = self.frames.as_mut().map_or(Ok(()), |frames| frames.write_all(frame));
        // A broken pipe says nothing; ffmpeg's last words do.
        written.map_err(|e| self.last_words().unwrap_or_else(|| e.to_string()))
    }

    fn finish(mut self) -> std::result::Result<(), String> {
        self.last_words().map_or(Ok(()), Err)
    }

    /// Ends ffmpeg's input and waits for it; what it says if it failed.
    fn last_words(&mut self) -> Option<String> {
        self.frames = None;
        let mut words = String::new();
        if let Some(mut errors) = self.child.stderr.take() {
            let _ = std::io::Read::read_to_string(&mut errors, &mut words);
        }
        let status = match self.child.wait() {
            Ok(status) if status.success() => return None,
            Ok(status) => status.to_string(),
            Err(e) => e.to_string(),
        };
        let words = words.lines().map(str::trim).collect::<Vec<_>>().join("; ");
        Some(format!(
            "expected ffmpeg to write the film, found that it failed ({status}): {words}; is the disk full?"
        ))
    }
}

impl Drop for Encoder {
    /// Without this, an ffmpeg whose film was not finished would be left as a zombie.
    fn drop(&mut self) {
        if self.frames.take().is_some() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}
