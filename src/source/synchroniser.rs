//! Groups the images of several cameras by their times.

use super::queue::Taken;
use super::{Frame, ReadAhead};
use crate::{Error, Result};
use image::RgbImage;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The images of all cameras at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageSet {
    /// One image per camera, in the streams' order; `None` for a camera without one at this time.
    pub images: Vec<Option<Frame>>,
    /// The mean of the images' times, in seconds.
    pub time: f64,
    /// The time from the earliest image to the latest, in seconds; at most the synchroniser's bound.
    pub time_spread: f64,
}

impl ImageSet {
    /// A set of images taken at the same `time` in seconds: one per camera, in the cameras' order, all with the number
    /// `number`.
    pub fn simultaneous(number: u32, time: f64, images: impl IntoIterator<Item = RgbImage>) -> Self {
        let frame = |image| Some(Frame { number, time, image: Arc::new(image) });
        Self { images: images.into_iter().map(frame).collect(), time, time_spread: 0.0 }
    }

    /// Whether every camera has an image.
    pub fn is_complete(&self) -> bool {
        self.images.iter().all(Option::is_some)
    }

    /// The indices of the cameras without an image.
    pub fn missing(&self) -> impl Iterator<Item = usize> {
        (0..self.images.len()).filter(|&camera| self.images[camera].is_none())
    }

    /// The image number of the first camera that has an image; 0 for a set without images.
    pub fn number(&self) -> u32 {
        self.images.iter().flatten().next().map_or(0, |frame| frame.number)
    }
}

/// Groups the images of several streams into sets, in the order of time.
///
/// A set begins with the earliest remaining image, at time t, and takes the next image of every other stream if its
/// time is at most t + bound. With a bound of half a period no image can fit two sets. A set is returned even if
/// cameras are missing from it; only images that arrive [too late](Self::set_patience) are in no set.
///
/// An error of a stream is returned in place of a set; images already read from other streams are kept for the
/// following sets.
///
/// ```no_run
/// use ode_visual_hull::source::{ReadAhead, ReadOptions, Synchroniser, Video, WhenFull};
///
/// let streams = ["left", "right"].map(|name| {
///     let video = Video::open(format!("{name}.mp4"), ReadOptions::default())?;
///     ReadAhead::spawn(name, video, 4, WhenFull::Wait)
/// });
/// let streams = streams.into_iter().collect::<Result<Vec<_>, _>>()?;
/// for set in Synchroniser::new(streams, 0.5 / 30.0)? {
///     let set = set?;
///     println!("{} s, within {} s; without {:?}", set.time, set.time_spread, set.missing().collect::<Vec<_>>());
/// }
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
#[derive(Debug)]
pub struct Synchroniser {
    streams: Vec<Stream>,
    bound: f64,
    patience: Option<Duration>,
    /// The latest time that the last set covered; a stalled stream's images up to it are late.
    emitted_until: f64,
}

#[derive(Debug)]
/// One camera's stream and its next image.
struct Stream {
    reader: ReadAhead,
    head: Head,
    /// The time of the last image read from it.
    last: f64,
    /// The stream has missed a set within the allowed time, and is not waited for until it delivers again.
    stalled: bool,
    late: u64,
}

/// The next image of a stream.
#[derive(Debug)]
enum Head {
    Unread,
    Read(Frame),
    Ended,
}

impl Synchroniser {
    /// Groups images of `streams` whose times differ by at most `bound` seconds. Half a period suits cameras that are
    /// triggered together.
    ///
    /// # Errors
    /// No streams; a bound that is negative or not finite.
    pub fn new(streams: Vec<ReadAhead>, bound: f64) -> Result<Self> {
        if streams.is_empty() {
            return Err(Error::argument("expected at least one stream of images, found none"));
        }
        if !(bound.is_finite() && bound >= 0.0) {
            return Err(Error::argument(format!("expected a bound of 0 or more seconds, found {bound}")));
        }

        let stream = |ahead| Stream {
            reader: ahead,
            head: Head::Unread,
            last: f64::NEG_INFINITY,
            stalled: false,
            late: 0,
        };
        let streams = streams.into_iter().map(stream).collect();
        Ok(Self { streams, bound, patience: None, emitted_until: f64::NEG_INFINITY })
    }

    /// How long a set that has images waits for a camera that delivers none, for live cameras, which may stall.
    /// Default `None`: without limit, which suits recordings.
    ///
    /// A camera that misses a set is not waited for again until it delivers an image. Images of sets that have been
    /// returned already are [counted](Self::late) and dropped.
    pub fn set_patience(&mut self, patience: Option<Duration>) {
        self.patience = patience;
    }

    /// The streams, in the order of the sets' images.
    pub fn streams(&self) -> impl ExactSizeIterator<Item = &ReadAhead> {
        self.streams.iter().map(|stream| &stream.reader)
    }

    /// The largest time between the images of a set, in seconds.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// How many images of the stream at index `stream` arrived after their set was returned; 0 if there is no such
    /// stream.
    pub fn late(&self, stream: usize) -> u64 {
        self.streams.get(stream).map_or(0, |stream| stream.late)
    }

    /// How many images of the stream at index `stream` were dropped because its queue was full; 0 if there is no such
    /// stream.
    pub fn dropped(&self, stream: usize) -> u64 {
        self.streams.get(stream).map_or(0, |stream| stream.reader.dropped())
    }

    /// Waits until the next image of each stream is known, or until the patience ends while another stream has an
    /// image.
    fn fill_heads(&mut self) -> Result<()> {
        loop {
            let deadline = self.patience.map(|patience| Instant::now() + patience);

            let none_read = !self.streams.iter().any(|stream| matches!(stream.head, Head::Read(_)));
            for stream in &mut self.streams {
                let deadline = if stream.stalled && !none_read { Some(Instant::now()) } else { deadline };
                stream.read_head(deadline, self.emitted_until)?;
            }

            let has = |state: fn(&Head) -> bool| self.streams.iter().any(|stream| state(&stream.head));
            if has(|head| matches!(head, Head::Read(_))) || !has(|head| matches!(head, Head::Unread)) {
                return Ok(());
            }
        }
    }
}

impl Stream {
    /// Reads the next image; images up to the time `passed` of a stalled stream are counted as late.
    fn read_head(&mut self, deadline: Option<Instant>, passed: f64) -> Result<()> {
        while matches!(self.head, Head::Unread) {
            match self.reader.take_until(deadline) {
                Taken::Ended => self.head = Head::Ended,
                Taken::Timeout => {
                    self.stalled = true;
                    return Ok(());
                }

                Taken::Frame(frame) => {
                    let frame = self.check(frame?)?;
                    if self.stalled && frame.time <= passed {
                        self.late += 1;
                    } else {
                        self.head = Head::Read(frame);
                        self.stalled = false;
                    }
                }
            }
        }
        Ok(())
    }

    /// Refuses an image whose time does not increase.
    fn check(&mut self, frame: Frame) -> Result<Frame> {
        let (number, time, last) = (frame.number, frame.time, self.last);
        if time.is_finite() && time > last {
            self.last = time;
            return Ok(frame);
        }
        let problem = format!(
            "frame {number}: expected a time after the last image's, {last} s, found {time} s; check its times"
        );
        Err(Error::view(self.reader.name(), problem))
    }

    fn time(&self) -> Option<f64> {
        match &self.head {
            Head::Read(frame) => Some(frame.time),
            Head::Unread | Head::Ended => None,
        }
    }

    /// The stream's next image, if its time is at most `end`.
    fn take_until(&mut self, end: f64) -> Option<Frame> {
        if self.time().is_none_or(|time| time > end) {
            return None;
        }
        match std::mem::replace(&mut self.head, Head::Unread) {
            Head::Read(frame) => Some(frame),
            Head::Unread | Head::Ended => None,
        }
    }
}

impl Iterator for Synchroniser {
    type Item = Result<ImageSet>;

    fn next(&mut self) -> Option<Result<ImageSet>> {
        if let Err(e) = self.fill_heads() {
            return Some(Err(e));
        }

        let begin = self.streams.iter().filter_map(Stream::time).min_by(f64::total_cmp)?;
        let end = begin + self.bound;
        let images: Vec<_> = self.streams.iter_mut().map(|stream| stream.take_until(end)).collect();
        self.emitted_until = end;

        // images
        let times = || images.iter().flatten().map(|frame: &Frame| frame.time);
        let spread = times().fold(begin, f64::max) - begin;
        let time = times().map(|time| time - begin).sum::<f64>() / times().count() as f64 + begin;
        Some(Ok(ImageSet { images, time, time_spread: spread }))
    }
}

#[cfg(test)]
mod tests;
