//! `ffmpeg` as a child process: pictures from its standard output, messages from its standard error.

use super::CancelHandle;
use super::image_pool::ImagePool;
use crate::lock::lock;
use crate::{Error, Result};
use image::RgbImage;
use std::collections::VecDeque;
use std::ffi::{OsStr, OsString};
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// How many of ffmpeg's last messages are kept.
const LINES_KEPT: usize = 4;

/// A running ffmpeg process; dropping it ends the process.
#[derive(Debug)]
pub(super) struct Ffmpeg {
    /// The file or device that ffmpeg reads.
    path: PathBuf,
    child: Arc<Mutex<Child>>,
    pictures: BufReader<ChildStdout>,
    images: ImagePool,
    /// The thread that drains the pipe of messages; ffmpeg would block if the pipe were full.
    messages: Option<JoinHandle<Vec<String>>>,
}

/// How ffmpeg ended.
pub(super) struct End {
    pub(super) success: bool,
    /// The last lines of its standard error.
    pub(super) messages: Vec<String>,
}

impl Ffmpeg {
    /// Starts `ffmpeg` on `path`; `input` are the options before `-i`, and `filter` is applied before the pictures are
    /// renumbered.
    ///
    /// The pictures are renumbered at an arbitrary rate: ffmpeg's own clock would drop and repeat pictures where a
    /// file's rate and its time stamps disagree. Each picture is a ppm, whose header has its size: devices do not
    /// always deliver the requested size, and phones' videos are rotated. One thread decodes: there is a process for each
    /// camera, and several threads would keep back as many pictures of a stream.
    pub(super) fn start(path: &Path, input: &[&str], filter: &str, name: &OsStr) -> Result<Self> {
        let filter = format!("{filter}settb=1/25,setpts=N");
        let one_thread = ["-threads", "1"];
        let before = ["-nostdin", "-hide_banner", "-loglevel", "error", "-filter_threads", "1"];
        let after = ["-map", "0:v:0", "-vf", &filter, "-r", "25", "-f", "image2pipe", "-c:v", "ppm"];

        let mut command = Command::new("ffmpeg");
        command
            .args(before)
            .args(one_thread)
            .args(input)
            .arg("-i")
            .arg(name)
            .args(after)
            .args(one_thread)
            .args(["-pix_fmt", "rgb24", "pipe:1"]);
        Self::run(path, &mut command)
    }

    fn run(path: &Path, command: &mut Command) -> Result<Self> {
        let piped = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn().map_err(|e| cannot_start("ffmpeg", path, &e))?;
        let (Some(out), Some(stderr)) = (child.stdout.take(), child.stderr.take()) else {
            return Err(Error::file(path, "expected ffmpeg's output, found none"));
        };

        enlarge(&out);
        let child = Arc::new(Mutex::new(child));
        let messages =
            std::thread::Builder::new().name("ffmpeg's stderr".into()).spawn(|| last_lines(stderr));
        let pictures = BufReader::with_capacity(1 << 16, out);
        // Constructed before a failed thread returns, so that dropping it ends the process.
        let images = ImagePool::default();
        let mut ffmpeg = Self { path: path.to_owned(), child, pictures, images, messages: None };
        let messages =
            messages.map_err(|e| Error::file(path, format!("expected to start a thread, found: {e}")))?;
        ffmpeg.messages = Some(messages);
        Ok(ffmpeg)
    }

    /// The next picture; `None` when ffmpeg has ended or failed, which [`end`](Self::end) distinguishes.
    pub(super) fn next_picture(&mut self) -> Result<Option<Arc<RgbImage>>> {
        let Some(size) = self.header()? else { return Ok(None) };
        match self.images.image(size, |bytes| self.pictures.read_exact(bytes)) {
            Ok(picture) => Ok(Some(picture)),
            Err(e) if e.kind() == ErrorKind::UnexpectedEof => Ok(None),
            Err(e) => Err(self.unreadable(&e)),
        }
    }

    /// Width and height from the three lines `P6`, `640 480`, `255`; `None` at the end of the stream.
    fn header(&mut self) -> Result<Option<(u32, u32)>> {
        let mut lines = [const { String::new() }; 3];
        for line in &mut lines {
            let read = (&mut self.pictures).take(32).read_line(line).map_err(|e| self.unreadable(&e))?;
            if read == 0 {
                return Ok(None);
            }
        }

        let size = lines[1].trim().split_once(' ');
        let size = size.and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
        let is_valid = |size: &(u32, u32)| size.0 <= 65_535 && size.1 <= 65_535;
        match size.filter(is_valid) {
            Some(size) if lines[0].trim() == "P6" && lines[2].trim() == "255" => Ok(Some(size)),
            _ => Err(self.unreadable(&format!("a picture that begins {:?}", lines.concat()))),
        }
    }

    fn unreadable(&self, found: &dyn std::fmt::Display) -> Error {
        Error::file(&self.path, format!("expected pictures from ffmpeg, found: {found}"))
    }

    /// Waits for the process to end, after its last picture.
    pub(super) fn end(&mut self) -> End {
        // Without the lock between the looks, so that a cancel handle can end a process that has closed its output and
        // goes on.
        let success = loop {
            let status = lock(&self.child).try_wait();
            match status {
                Ok(None) => std::thread::sleep(Duration::from_millis(1)),
                ended => break ended.ok().flatten().is_some_and(|status| status.success()),
            }
        };
        let messages = self.messages.take().map(|thread| thread.join().unwrap_or_default());
        End { success, messages: messages.unwrap_or_default() }
    }

    /// A handle that ends ffmpeg, and with it a read that waits for a picture.
    pub(super) fn cancel_handle(&self) -> CancelHandle {
        let child = Arc::clone(&self.child);
        CancelHandle::new(move || {
            // Fails only if the process has ended already.
            let _ = lock(&child).kill();
        })
    }

    #[cfg(test)]
    pub(super) fn process_id(&self) -> u32 {
        lock(&self.child).id()
    }
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        let _ = lock(&self.child).kill();
        self.end();
    }
}

impl End {
    /// ffmpeg's messages, or that there were none.
    pub(super) fn quoted(&self) -> String {
        match self.messages.as_slice() {
            [] => "ffmpeg said nothing".into(),
            lines => format!("ffmpeg said: {}", lines.join("; ")),
        }
    }
}

/// The size of a pipe of pictures, in bytes: what Linux lets every user have. With its usual 64 KiB, the two programs would
/// wait for each other tens of times in each picture, which costs more than decoding it.
#[cfg(target_os = "linux")]
const PIPE_SIZE: usize = 1 << 20;

/// Lets more bytes wait in a pipe of pictures, where the system has room for them. Without it everything works, slower.
#[cfg(target_os = "linux")]
pub(crate) fn enlarge(pipe: &impl std::os::fd::AsFd) {
    let _ = rustix::pipe::fcntl_setpipe_size(pipe, PIPE_SIZE);
}

/// Only Linux lets a program choose how many bytes wait in a pipe.
#[cfg(not(target_os = "linux"))]
pub(crate) fn enlarge<T>(_: &T) {}

/// The error if `program` does not start.
pub(crate) fn cannot_start(program: &str, path: &Path, e: &std::io::Error) -> Error {
    let problem = match e.kind() {
        ErrorKind::NotFound => format!(
            "expected the program {program} for its images, found none; install ffmpeg (Debian, Ubuntu: apt-get \
             install ffmpeg) or put it on the PATH"
        ),
        _ => format!("expected to start {program}, found: {e}"),
    };
    Error::file(path, problem)
}

/// A path in the form that ffmpeg takes for a file: otherwise a colon would make it a protocol and a dash an option.
pub(crate) fn file_name(path: &Path) -> OsString {
    let mut name = OsString::from("file:");
    name.push(path);
    name
}

/// The last lines of a program's messages, without ffmpeg's memory addresses, and repeated lines once.
pub(crate) fn last_lines(stderr: impl Read) -> Vec<String> {
    let mut kept = VecDeque::new();
    let mut stderr = BufReader::new(stderr);
    let mut line = Vec::new();
    while stderr.read_until(b'\n', &mut line).is_ok_and(|read| read > 0) {
        let text = String::from_utf8_lossy(&line);
        let text = without_address(text.trim());

        if !text.is_empty() && kept.back() != Some(&text) {
            kept.push_back(text);
            if kept.len() > LINES_KEPT {
                kept.pop_front();
            }
        }
        line.clear();
    }
    kept.into()
}

/// Turns `[h264 @ 0x55d0] error` into `h264: error`.
fn without_address(line: &str) -> String {
    let parts = line.strip_prefix('[').and_then(|rest| rest.split_once(" @ 0x"));
    match parts.and_then(|(component, rest)| Some((component, rest.split_once("] ")?.1))) {
        Some((component, message)) => format!("{component}: {message}"),
        None => line.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_says;
    use super::*;

    #[test]
    fn a_missing_program_says_what_to_install() {
        let started = Ffmpeg::run(Path::new("clip.mp4"), &mut Command::new("/nowhere/ffmpeg"));
        assert_says(started, &["clip.mp4", "program ffmpeg", "found none", "apt-get install ffmpeg", "PATH"]);
    }

    #[test]
    fn output_that_is_not_a_picture_is_an_error() {
        let read = |output: &str| {
            let mut command = Command::new("printf");
            Ffmpeg::run(Path::new("clip.mp4"), command.arg(output)).unwrap().next_picture()
        };
        assert_says(read("GIF89a\\n1 1\\n255\\nabc"), &["clip.mp4", "GIF89a"]);
        assert_says(read("P6\\n99999 1\\n255\\nabc"), &["99999"]);
        assert_says(read("P6\\n-1 1\\n255\\nabc"), &["-1"]);
        // The stream ends, between pictures or within one.
        for cut in ["", "P6\\n", "P6\\n2 2\\n255\\nabc"] {
            assert_eq!(read(cut).unwrap(), None, "{cut}");
        }
        assert_eq!(read("P6\\n1 1\\n255\\nabc").unwrap().unwrap().get_pixel(0, 0).0, *b"abc");
    }

    #[test]
    fn the_last_messages_are_kept_and_repeated_ones_once() {
        let text = "1\n2\n\n[h264 @ 0x55d0c] broken\n[h264 @ 0x55d0d] broken\n[AVIOContext] odd\n5\n";
        assert_eq!(last_lines(text.as_bytes()), ["2", "h264: broken", "[AVIOContext] odd", "5"]);
        assert_eq!(last_lines(&b"\xff"[..]), ["\u{fffd}"]);
    }

    #[test]
    fn a_program_that_closes_its_output_and_goes_on_can_be_ended() {
        let mut command = Command::new("sh");
        command.args(["-c", "exec >&- 2>&-; exec sleep 3600"]);
        let mut ffmpeg = Ffmpeg::run(Path::new("clip.mp4"), &mut command).unwrap();
        assert_eq!(ffmpeg.next_picture().unwrap(), None);
        let cancel_handle = ffmpeg.cancel_handle();
        let ends = std::thread::spawn(move || ffmpeg.end().success);
        cancel_handle.stop();
        assert!(!ends.join().unwrap());
    }

    #[test]
    fn a_program_with_more_messages_than_a_pipe_holds_does_not_hang() {
        let mut command = Command::new("sh");
        command.args(["-c", "seq 100000 >&2; exit 3"]);
        let mut ffmpeg = Ffmpeg::run(Path::new("clip.mp4"), &mut command).unwrap();
        assert_eq!(ffmpeg.next_picture().unwrap(), None);
        let end = ffmpeg.end();
        assert!(!end.success);
        assert_eq!(end.quoted(), "ffmpeg said: 99997; 99998; 99999; 100000");
    }
}
