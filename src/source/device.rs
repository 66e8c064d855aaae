//! Live cameras and network streams, read through `ffmpeg`.

use super::ffmpeg::Ffmpeg;
use super::{CancelHandle, Frame, ReadOptions, Source};
use crate::{Error, Result};
use image::RgbImage;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// The settings requested from a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceOptions {
    /// ffmpeg's name for the kind of device. Default: `v4l2`, Linux's cameras. `None` for a network stream or a pipe,
    /// whose format ffmpeg finds out; it is read without a buffer, for a small delay.
    pub format: Option<String>,
    /// Width and height in pixels: the size at which the camera is calibrated. Default: the camera's own. A device is
    /// asked for it; that of a stream is only checked.
    pub size: Option<(u32, u32)>,
    /// Images per second. Default: the camera's own.
    pub rate: Option<f64>,
    /// ffmpeg's name for the transfer format of images, such as `mjpeg`, which many cameras require for their full
    /// size. Default: the camera's own.
    pub pixels: Option<String>,
}

impl Default for DeviceOptions {
    fn default() -> Self {
        Self { format: Some("v4l2".into()), size: None, rate: None, pixels: None }
    }
}

/// ffmpeg's options for a stream without a device's format: it finds out the format within 1 s instead of 5, leaves out
/// the images of that time, which are old, and then hands out each image as soon as it can.
const LOW_DELAY: [&str; 6] = ["-fflags", "nobuffer", "-flags", "low_delay", "-analyzeduration", "1000000"];

impl DeviceOptions {
    /// The options of a network stream or a pipe: its own format, size and rate.
    pub fn stream() -> Self {
        Self { format: None, ..Self::default() }
    }

    /// The options before `-i` on ffmpeg's command line.
    fn input(&self) -> Vec<String> {
        // Only devices know these options; ffmpeg refuses them for a stream.
        if self.format.is_none() {
            return LOW_DELAY.map(str::to_owned).into();
        }
        let size = self.size.map(|(width, height)| format!("{width}x{height}"));
        let options = [
            ("-f", self.format.clone()),
            ("-input_format", self.pixels.clone()),
            ("-video_size", size),
            ("-framerate", self.rate.map(|rate| rate.to_string())),
        ];
        let given = options.into_iter().filter_map(|(name, value)| Some([name.to_owned(), value?]));
        given.flatten().collect()
    }
}

/// A live camera or a network stream. Its images are numbered from 0 and carry the time of their arrival in seconds.
///
/// It ends only with an error, that it is lost; a [`Reconnecting`](super::Reconnecting) source opens it again. An image that is delayed in transfer carries a late time; the time bound of a
/// [`Synchroniser`](super::Synchroniser) must allow for it.
#[derive(Debug)]
pub struct Device {
    path: PathBuf,
    read_options: ReadOptions,
    rate: Option<f64>,
    epoch: Instant,
    /// `None` after a failure.
    ffmpeg: Option<Ffmpeg>,
    first: Option<(Arc<RgbImage>, f64)>,
    next: u32,
}

impl Device {
    /// Opens the camera `device`, such as `/dev/video0`, and waits for its first image. Times count from `epoch`; use
    /// the same for all cameras of a rig.
    ///
    /// # Errors
    /// `ffmpeg` is not installed; a device that is missing, in use, or refuses the settings, with ffmpeg's messages; a
    /// camera that delivers another size than requested; a rate that is not positive.
    pub fn open(device: impl Into<PathBuf>, options: &DeviceOptions, epoch: Instant) -> Result<Self> {
        let mut device = Self::start(device, options, epoch)?;

        // A camera that opens may still deliver nothing, so wait for an image.
        let Some(ffmpeg) = &mut device.ffmpeg else { return Err(device.lost("it has failed before")) };
        let Some(image) = ffmpeg.next_picture()? else {
            let problem = format!(
                "expected a camera that gives images, found none; {}; check that it is connected, that no other \
                 program uses it, and that it has this size and rate",
                ffmpeg.end().quoted()
            );
            return Err(Error::file(device.path, problem));
        };

        device.check_size(&image)?;
        device.first = Some((image, epoch.elapsed().as_secs_f64()));
        Ok(device)
    }

    /// Opens the camera `device`, or the stream of a URL such as `rtsp://camera/live` with
    /// [`DeviceOptions::stream`], without waiting for its first image: what is wrong with it is the error of the first
    /// [`next_frame`](Source::next_frame), which another thread can [cancel](Source::cancel_handle). Otherwise as
    /// [`open`](Self::open).
    ///
    /// # Errors
    /// `ffmpeg` is not installed; a rate that is not positive.
    pub fn start(device: impl Into<PathBuf>, options: &DeviceOptions, epoch: Instant) -> Result<Self> {
        let path = device.into();
        if let Some(rate) = options.rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            return Err(Error::argument(format!(
                "expected a positive number of images per second, found {rate}"
            )));
        }

        let input = options.input();
        let input: Vec<_> = input.iter().map(String::as_str).collect();
        let ffmpeg = Some(Ffmpeg::start(&path, &input, "", path.as_os_str())?);

        let read_options = ReadOptions { size: options.size, ..ReadOptions::default() };
        Ok(Self { path, read_options, rate: options.rate, epoch, ffmpeg, first: None, next: 0 })
    }

    fn check_size(&self, image: &RgbImage) -> Result<()> {
        self.read_options.check_size(&self.path, "", image.dimensions())
    }

    fn picture(&mut self) -> Result<(Arc<RgbImage>, f64)> {
        if let Some(first) = self.first.take() {
            return Ok(first);
        }
        let Some(ffmpeg) = &mut self.ffmpeg else { return Err(self.lost("it has failed before")) };
        if let Some(image) = ffmpeg.next_picture()? {
            return Ok((image, self.epoch.elapsed().as_secs_f64()));
        }
        let said = ffmpeg.end().quoted();
        Err(self.lost(&said))
    }

    fn lost(&self, said: &str) -> Error {
        Error::file(
            &self.path,
            format!("expected image {}, found that the camera is disconnected; {said}", self.next),
        )
    }
}

impl Source for Device {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        self.ffmpeg.as_ref()?;
        let frame = self.picture().and_then(|(image, time)| {
            self.check_size(&image)?;
            Ok(Frame { number: self.next, time, image })
        });
        match frame {
            Ok(_) => self.next = self.next.wrapping_add(1),
            Err(_) => self.ffmpeg = None,
        }
        Some(frame)
    }

    fn period(&self) -> Option<f64> {
        self.rate.map(|rate| 1.0 / rate)
    }

    fn cancel_handle(&self) -> CancelHandle {
        self.ffmpeg.as_ref().map(Ffmpeg::cancel_handle).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Folder, assert_says, write_video};
    use super::super::{ReadAhead, WhenFull};
    use super::*;
    use std::process::Command;

    /// A test pattern from ffmpeg that never ends.
    fn endless() -> Device {
        let options = DeviceOptions { format: Some("lavfi".into()), ..DeviceOptions::default() };
        Device::open("testsrc=s=32x24", &options, Instant::now()).unwrap()
    }

    fn is_running(process: u32) -> bool {
        std::path::Path::new(&format!("/proc/{process}")).exists()
    }

    #[test]
    fn times_of_a_live_camera_grow_from_the_epoch() {
        let before = Instant::now();
        let mut device = endless();
        let frames = [(); 5].map(|()| device.next_frame().unwrap().unwrap());
        let times = frames.each_ref().map(|frame| frame.time);
        assert!(
            times.is_sorted() && times[0] > 0.0 && times[4] <= before.elapsed().as_secs_f64(),
            "{times:?}"
        );
        assert_eq!(frames.map(|frame| frame.number), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn a_dropped_camera_leaves_no_process_behind() {
        let mut device = endless();
        let process = device.ffmpeg.as_ref().unwrap().process_id();
        assert!(device.next_frame().unwrap().is_ok());

        assert!(is_running(process));
        drop(device);
        assert!(!is_running(process));
    }

    #[test]
    fn a_slow_reader_of_a_live_camera_loses_the_oldest_images_and_leaves_nothing_behind() {
        let device = endless();
        let process = device.ffmpeg.as_ref().unwrap().process_id();
        let mut ahead = ReadAhead::spawn("live", device, 2, WhenFull::DropOldest).unwrap();
        while ahead.dropped() < 3 {
            std::thread::yield_now();
        }
        assert!(ahead.next().unwrap().unwrap().number >= 3);
        drop(ahead);
        assert!(!is_running(process));
    }

    #[test]
    fn dropping_a_blocked_reader_ends_its_process() {
        let device = endless();
        let process = device.ffmpeg.as_ref().unwrap().process_id();
        drop(ReadAhead::spawn("live", device, 1, WhenFull::Wait).unwrap());
        assert!(!is_running(process));
    }

    #[test]
    fn a_camera_that_is_lost_is_an_error_and_then_the_end() {
        let mut device = endless();
        device.cancel_handle().stop();
        let lost = std::iter::from_fn(|| device.next_frame()).find(Result::is_err).unwrap();
        assert_says(lost, &["testsrc", "camera is disconnected", "ffmpeg said"]);
        assert!(device.next_frame().is_none());
    }

    #[test]
    fn a_missing_camera_and_an_invalid_rate_are_errors() {
        let open = |path: &str, options: &DeviceOptions| Device::open(path, options, Instant::now());
        let absent = open("/dev/video-none", &DeviceOptions::default());
        assert_says(absent, &["/dev/video-none", "found none", "ffmpeg said", "No such file", "connected"]);
        let rate = DeviceOptions { rate: Some(0.0), ..DeviceOptions::default() };
        assert_says(open("/dev/video-none", &rate), &["positive", "found 0"]);
    }

    #[test]
    fn a_stream_through_a_pipe_is_read_until_it_ends() {
        let folder = Folder::new("stream");
        let pipe = folder.path("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let mut writer = Command::new("ffmpeg")
            .args(["-nostdin", "-loglevel", "quiet", "-y", "-f", "lavfi", "-i", "testsrc=s=32x24"])
            .args(["-f", "mpegts"])
            .arg(&pipe)
            .spawn()
            .unwrap();
        let options = DeviceOptions { size: Some((32, 24)), ..DeviceOptions::stream() };
        let mut device = Device::start(&pipe, &options, Instant::now()).unwrap();
        let times = [(); 3].map(|()| device.next_frame().unwrap().unwrap().time);
        assert!(times.is_sorted(), "{times:?}");

        // Without a writer the pipe ends.
        writer.kill().unwrap();
        writer.wait().unwrap();
        let lost = std::iter::from_fn(|| device.next_frame()).find(Result::is_err).unwrap();
        assert_says(lost, &["pipe", "expected image", "disconnected"]);
        assert!(device.next_frame().is_none());
    }

    #[test]
    fn a_stream_of_another_size_is_an_error() {
        let folder = Folder::new("stream-size");
        write_video(&folder.path("clip.avi"), 100, (32, 24));
        let options = DeviceOptions { size: Some((16, 24)), ..DeviceOptions::stream() };
        let mut device = Device::start(folder.path("clip.avi"), &options, Instant::now()).unwrap();
        assert_says(device.next_frame().unwrap(), &["expected 16 x 24", "found 32 x 24"]);
        assert!(device.next_frame().is_none());
    }

    #[test]
    fn what_is_wrong_with_a_started_camera_is_the_error_of_its_first_image() {
        let mut device = Device::start("/dev/video-none", &DeviceOptions::default(), Instant::now()).unwrap();
        assert_says(device.next_frame().unwrap(), &["video-none", "expected image 0", "No such file"]);
        assert!(device.next_frame().is_none());
    }

    #[test]
    fn size_rate_and_format_are_passed_to_ffmpeg() {
        let options = DeviceOptions {
            size: Some((640, 480)),
            rate: Some(29.97),
            pixels: Some("mjpeg".into()),
            ..DeviceOptions::default()
        };
        let arguments = options.input().join(" ");
        assert_eq!(arguments, "-f v4l2 -input_format mjpeg -video_size 640x480 -framerate 29.97");
    }
}
