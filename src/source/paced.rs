//! A source that is played by a clock, again and again, as if it were live.

use super::{CancelHandle, Clock, Frame, Source};
use crate::{Error, Result};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

/// What is repeated: the part of a recording's time, and of its image numbers, that all of its cameras share.
#[derive(Debug, Clone, PartialEq)]
pub struct Round {
    numbers: Range<u32>,
    first_time: f64,
    length: f64,
}

impl Round {
    /// The images with `numbers`, the first of which is at `first_time` and the last at `last_time`, in seconds;
    /// `period` seconds after the last, the first follows again.
    ///
    /// # Errors
    /// No numbers; times that are not finite or decrease; a period that is not positive.
    pub fn new(numbers: Range<u32>, first_time: f64, last_time: f64, period: f64) -> Result<Self> {
        if numbers.is_empty() {
            return Err(Error::argument("expected at least one image to repeat, found none"));
        }
        let length = last_time - first_time + period;
        let is_valid = period > 0.0 && last_time >= first_time && length.is_finite();
        if !is_valid {
            return Err(Error::argument(format!(
                "expected images to repeat whose times grow, with a positive period, found {first_time} s to \
                 {last_time} s with a period of {period} s; check their times"
            )));
        }
        Ok(Self { numbers, first_time, length })
    }

    /// `count` images from number and time 0 on, at `rate` images per second.
    ///
    /// # Errors
    /// No images; a rate that is not positive.
    pub fn at_rate(count: u32, rate: f64) -> Result<Self> {
        Self::new(0..count, 0.0, f64::from(count.saturating_sub(1)) / rate, 1.0 / rate)
    }

    /// The seconds from one repetition to the next.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The numbers of the images.
    pub fn numbers(&self) -> Range<u32> {
        self.numbers.clone()
    }

    /// The frame as it is in repetition `index`, on a clock on which repetition 0 begins at `start`.
    fn place(&self, frame: Frame, index: u32, start: f64) -> Frame {
        let time = start + f64::from(index) * self.length + (frame.time - self.first_time);
        let count = self.numbers.end - self.numbers.start;
        // After 2^32 images, more than four years at 30 a second, the numbers begin again.
        let number = index.wrapping_mul(count).wrapping_add(frame.number - self.numbers.start);
        Frame { number, time, image: frame.image }
    }

    fn has(&self, frame: &Frame) -> bool {
        self.numbers.contains(&frame.number) && (0.0..self.length).contains(&(frame.time - self.first_time))
    }
}

/// When the first image of [`Paced`] sources is due, on their clock: at this time in seconds, or by default as soon as one of the
/// sources that share it is asked for an image, once all that takes time is prepared.
#[derive(Debug, Clone, Default)]
pub struct Start(Arc<OnceLock<f64>>);

impl From<f64> for Start {
    fn from(time: f64) -> Self {
        Self(Arc::new(time.into()))
    }
}

impl Start {
    fn time(&self, clock: &Clock) -> f64 {
        *self.0.get_or_init(|| clock.now())
    }
}

type Open = Box<dyn FnMut() -> Result<Box<dyn Source>> + Send>;

/// The source of the next repetition.
enum Next {
    /// Its time to be opened has not come.
    Closed(Open),
    /// A thread of its own opens it.
    Opening(JoinHandle<(Open, Result<Box<dyn Source>>)>),
    /// It could not be opened.
    Failed,
}

impl Next {
    fn start(mut open: Open) -> Result<Self> {
        let opens = move || {
            let source = open();
            (open, source)
        };
        let thread = std::thread::Builder::new().name("opens a source".into()).spawn(opens);
        thread
            .map(Self::Opening)
            .map_err(|e| Error::argument(format!("expected to start a thread, found: {e}")))
    }

    /// Has it opened, if that has not begun.
    fn begin(&mut self) -> Result<()> {
        match std::mem::replace(self, Self::Failed) {
            Self::Closed(open) => *self = Self::start(open)?,
            other => *self = other,
        }
        Ok(())
    }

    /// The source, once it is open; it becomes the one after it.
    fn take(&mut self) -> Result<Option<Box<dyn Source>>> {
        self.begin()?;
        let Self::Opening(thread) = std::mem::replace(self, Self::Failed) else { return Ok(None) };
        let Ok((open, source)) = thread.join() else {
            return Err(Error::argument("expected to open a source, found a panic of what opens it"));
        };
        let source = source?;
        *self = Self::Closed(open);
        Ok(Some(source))
    }
}

/// Plays a source by a [`Clock`] as if it were live, and from its start again after its end.
///
/// The source of the next repetition is opened while this one plays, so that a video has begun to be decoded when it is due,
/// [at a time of its own](Self::opening_after).
///
/// Each image is handed out when the clock reaches its time; a late one at once, with its true time. Times and numbers
/// grow over the repetitions, so that images of equal numbers, or times, of several cameras belong together in each of
/// them if all cameras have one [`Round`], start and clock. Images outside the round are left out. If reading is slower
/// than the clock, repetitions that have passed entirely are left out as well.
///
/// ```no_run
/// use ode_visual_hull::recording::{Recording, StreamOptions};
/// use ode_visual_hull::source::{Clock, Paced, ReadAhead, Start, Synchroniser, WhenFull};
/// use std::sync::Arc;
///
/// let recording = Arc::new(Recording::open("recording")?);
/// let (options, clock, start) = (StreamOptions::default(), Clock::new(), Start::default());
/// let round = recording.round(&options)?;
/// let streams = (0..recording.rig().len()).map(|camera| {
///     let recording_of = Arc::clone(&recording);
///     let open = move || recording_of.source(camera, &options);
///     let paced = Paced::looped(&clock, round.clone(), start.clone(), open)?;
///     ReadAhead::spawn(recording.rig().cameras()[camera].name(), paced, 2, WhenFull::DropOldest)
/// });
/// let streams = streams.collect::<Result<Vec<_>, _>>()?;
/// let live = Synchroniser::new(streams, 0.5 / 30.0)?;
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
pub struct Paced {
    clock: Clock,
    round: Round,
    start: Start,
    /// `None` after a failure.
    source: Option<Box<dyn Source>>,
    next: Next,
    /// The part of a repetition after which the source of the next one is opened.
    opened_after: f64,
    /// The index of the repetition.
    index: u32,
    /// Whether this repetition has given an image.
    has_image: bool,
    stop: Arc<AtomicBool>,
}

impl Paced {
    /// Plays what `open` opens, from its first image, without an end; the time `first_time` of `round` is at `start` of
    /// `clock`.
    ///
    /// # Errors
    /// All errors of `open`, which is called once here, and then for each repetition, always on a thread of its own; a start
    /// that is not finite.
    pub fn looped(
        clock: &Clock,
        round: Round,
        start: impl Into<Start>,
        open: impl FnMut() -> Result<Box<dyn Source>> + Send + 'static,
    ) -> Result<Self> {
        let start = start.into();
        if let Some(start) = start.0.get().filter(|time| !time.is_finite()) {
            return Err(Error::argument(format!("expected a start in seconds, found {start}")));
        }
        let mut paced = Self {
            clock: clock.clone(),
            round,
            start,
            source: None,
            next: Next::Closed(Box::new(open)),
            opened_after: 0.0,
            index: 0,
            has_image: false,
            stop: Arc::default(),
        };
        paced.source = paced.next.take()?;
        Ok(paced)
    }

    /// Has the source of the next repetition opened when this part of a repetition has passed, 0 to 1; otherwise it is opened
    /// at once. Videos of several cameras that begin to be decoded at the same time delay each other and all else.
    pub fn opening_after(mut self, part: f64) -> Self {
        self.opened_after = part;
        self
    }

    /// The next image of the round, in this repetition or a later one.
    fn read(&mut self) -> Result<Option<Frame>> {
        loop {
            // A source may be long without an image of the round.
            if self.stop.load(Ordering::Relaxed) || self.clock.is_closed() {
                return Ok(None);
            }

            let Some(source) = &mut self.source else { return Ok(None) };
            match source.next_frame().transpose()? {
                Some(frame) if self.round.has(&frame) => {
                    self.has_image = true;
                    if frame.time - self.round.first_time >= self.opened_after * self.round.length {
                        self.next.begin()?;
                    }
                    return Ok(Some(self.round.place(frame, self.index, self.start.time(&self.clock))));
                }
                Some(_) => {}
                None => self.repeat()?,
            }
        }
    }

    /// Begins the next repetition, or the one that is due if that is later.
    fn repeat(&mut self) -> Result<()> {
        self.source = None;
        if !std::mem::take(&mut self.has_image) {
            let Range { start, end } = self.round.numbers;
            return Err(Error::argument(format!(
                "expected images with numbers from {start} to {} to repeat, found none in this source; open the \
                 source that the round was made for",
                end - 1
            )));
        }

        let due = (self.clock.now() - self.start.time(&self.clock)) / self.round.length;
        self.index = self.index.saturating_add(1).max(due as u32);
        self.source = self.next.take()?;
        Ok(())
    }
}

impl Source for Paced {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        let frame = match self.read() {
            Ok(frame) => frame?,
            Err(e) => return Some(Err(e)),
        };
        self.clock.wait_until(frame.time, &self.stop).then_some(Ok(frame))
    }

    fn period(&self) -> Option<f64> {
        self.source.as_ref()?.period()
    }

    fn cancel_handle(&self) -> CancelHandle {
        let (clock, stop) = (self.clock.clone(), Arc::clone(&self.stop));
        CancelHandle::new(move || clock.stop(&stop))
    }
}

impl std::fmt::Debug for Paced {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Paced")
            .field("round", &self.round)
            .field("index", &self.index)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
