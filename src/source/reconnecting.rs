//! A live source that is opened again when it is lost.

mod watch;

pub use watch::{StatusHandle, StreamStatus};

use super::{CancelHandle, Frame, Source};
use crate::{Error, Result};
use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;
use watch::Watch;

/// How many images the measured rate spans.
const RATE_SPAN: usize = 30;

/// When a [`Reconnecting`] source counts as lost, and how it is opened again.
#[derive(Debug, Clone, PartialEq)]
pub struct ReconnectOptions {
    /// Width and height that images must have, in pixels; others are left out. Default: any.
    pub size: Option<(u32, u32)>,
    /// A source that gives no image for so long is lost. Default: 3 s.
    pub patience: Duration,
    /// A source that gives no image for so long after it was opened is lost: a network stream begins late. Default: 10 s.
    pub first_patience: Duration,
    /// The wait before it is opened again; doubled after each failed try, up to ten times. Default: 0.5 s.
    pub retry: Duration,
}

impl Default for ReconnectOptions {
    fn default() -> Self {
        Self {
            size: None,
            patience: Duration::from_secs(3),
            first_patience: Duration::from_secs(10),
            retry: Duration::from_millis(500),
        }
    }
}

type Open = Box<dyn FnMut() -> Result<Box<dyn Source>> + Send>;

/// A live camera or stream that is opened again after an error, an end, or a time without images.
///
/// It ends only when it is [cancelled](Source::cancel_handle), and a loss is no error: its
/// [`status_handle`](Self::status_handle) tells. Images are numbered from 0, through all losses. Images whose time does
/// not increase are left out, as those of another size are.
///
/// ```no_run
/// use ode_visual_hull::source::{Device, DeviceOptions, ReadAhead, ReconnectOptions, Reconnecting, WhenFull};
/// use std::time::Instant;
///
/// let epoch = Instant::now();
/// let open = move || Ok(Box::new(Device::start("rtsp://camera/live", &DeviceOptions::stream(), epoch)?) as _);
/// let options = ReconnectOptions { size: Some((640, 480)), ..ReconnectOptions::default() };
/// let source = Reconnecting::new(options, open)?;
/// let status = source.status_handle();
/// for frame in ReadAhead::spawn("left", source, 2, WhenFull::DropOldest)? {
///     println!("{} s, {:?}", frame?.time, status.status());
/// }
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
pub struct Reconnecting {
    options: ReconnectOptions,
    open: Open,
    source: Option<Box<dyn Source>>,
    watch: Arc<Watch>,
    watchdog: Option<JoinHandle<()>>,
    /// The wait before the source is opened next; zero for the first time.
    wait: Duration,
    next: u32,
    last_time: f64,
    /// The times of the last images since the source was opened.
    times: VecDeque<f64>,
}

impl Reconnecting {
    /// A source that `open` opens, first in [`next_frame`](Source::next_frame).
    ///
    /// `open` must not wait for images, since nothing can end that wait: use
    /// [`Device::start`](super::Device::start), not `open`. The times of what it opens must go on, as those of a
    /// [`Device`](super::Device) with one epoch.
    ///
    /// # Errors
    /// A system that cannot start another thread.
    pub fn new(
        options: ReconnectOptions,
        open: impl FnMut() -> Result<Box<dyn Source>> + Send + 'static,
    ) -> Result<Self> {
        let watch = Arc::new(Watch::default());
        let watchdog = {
            let watch = Arc::clone(&watch);
            std::thread::Builder::new().name("watches a stream".into()).spawn(move || watch.run())
        };
        let watchdog =
            watchdog.map_err(|e| Error::argument(format!("expected to start a thread, found: {e}")))?;

        Ok(Self {
            options,
            open: Box::new(open),
            source: None,
            watch,
            watchdog: Some(watchdog),
            wait: Duration::ZERO,
            next: 0,
            last_time: f64::NEG_INFINITY,
            times: VecDeque::new(),
        })
    }

    /// A handle that tells from outside how the source is doing.
    pub fn status_handle(&self) -> StatusHandle {
        StatusHandle::new(Arc::clone(&self.watch))
    }

    /// Waits, and opens the source.
    fn connect(&mut self) {
        if !self.watch.sleep(self.wait) {
            return;
        }
        let longest = self.options.retry * 10;
        self.wait = if self.wait.is_zero() { self.options.retry } else { (self.wait * 2).min(longest) };

        match (self.open)() {
            Ok(source) => {
                self.watch.opened(source.cancel_handle());
                self.source = Some(source);
            }
            Err(e) => self.watch.lost(e.to_string()),
        }
    }

    /// The next image of the open source; `None` if that is lost or the image is left out.
    fn read(&mut self) -> Option<Frame> {
        let patience =
            if self.times.is_empty() { self.options.first_patience } else { self.options.patience };
        self.watch.begin_wait(patience);
        let next = self.source.as_mut()?.next_frame();
        let is_overdue = self.watch.end_wait();

        let problem = match next {
            // An image that came at the last moment is an image, although its source has been ended.
            Some(Ok(frame)) => return self.accept(frame),
            _ if is_overdue => format!("expected an image, found none for {:.1} s", patience.as_secs_f64()),
            Some(Err(e)) => e.to_string(),
            None => "expected an image, found the end of the stream".into(),
        };

        self.source = None;
        self.times.clear();
        self.watch.lost(problem);
        None
    }

    fn accept(&mut self, mut frame: Frame) -> Option<Frame> {
        let (w, h) = frame.image.dimensions();
        if let Some((width, height)) = self.options.size.filter(|size| *size != (w, h)) {
            self.watch.left_out(format!(
                "expected images of {width} x {height} pixels, found {w} x {h}; set the camera to the size at which \
                 it is calibrated"
            ));
            return None;
        }
        if !(frame.time.is_finite() && frame.time > self.last_time) {
            self.watch.left_out(format!(
                "expected a time after the last image's, {} s, found {} s; count all times from one epoch",
                self.last_time, frame.time
            ));
            return None;
        }

        self.last_time = frame.time;
        self.wait = self.options.retry;
        frame.number = self.next;
        self.next = self.next.wrapping_add(1);
        let rate = self.rate(frame.time);
        self.watch.delivered(rate);
        Some(frame)
    }

    /// The rate of the last images up to the one at `time`, in images per second.
    fn rate(&mut self, time: f64) -> Option<f64> {
        self.times.push_back(time);
        if self.times.len() > RATE_SPAN {
            self.times.pop_front();
        }
        let first = self.times.front().filter(|first| **first < time)?;
        Some((self.times.len() - 1) as f64 / (time - first))
    }
}

impl Source for Reconnecting {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        while !self.watch.is_cancelled() {
            if self.source.is_none() {
                self.connect();
            } else if let Some(frame) = self.read() {
                return Some(Ok(frame));
            }
        }
        None
    }

    fn cancel_handle(&self) -> CancelHandle {
        let watch = Arc::clone(&self.watch);
        CancelHandle::new(move || watch.cancel())
    }
}

impl Drop for Reconnecting {
    fn drop(&mut self) {
        self.watch.cancel();
        if let Some(watchdog) = self.watchdog.take() {
            let _ = watchdog.join();
        }
    }
}

impl std::fmt::Debug for Reconnecting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reconnecting")
            .field("options", &self.options)
            .field("next", &self.next)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
