//! A source that is read on a thread of its own.

use super::queue::{Queue, Taken, WhenFull};
use super::{CancelHandle, Frame, Source};
use crate::{Error, Result};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// Reads a source on a thread of its own, a bounded number of images ahead.
///
/// Errors name the view. Dropping it ends the thread and cancels a waiting source.
///
/// ```no_run
/// use ode_visual_hull::source::{ImageFolder, ReadAhead, ReadOptions, WhenFull};
///
/// let folder = ImageFolder::open("left/image", ReadOptions::default())?;
/// for frame in ReadAhead::spawn("left", folder, 4, WhenFull::Wait)? {
///     let frame = frame?;
///     println!("{} at {} s: {:?}", frame.number, frame.time, frame.image.dimensions());
/// }
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
pub struct ReadAhead {
    name: String,
    frames_left: Option<u32>,
    period: Option<f64>,
    queue: Arc<Queue>,
    cancel_handle: CancelHandle,
    thread: Option<JoinHandle<()>>,
}

impl ReadAhead {
    /// Starts to read `source` for the view `name`, at most `depth` images ahead.
    ///
    /// # Errors
    /// A depth of zero; a system that cannot start another thread.
    pub fn spawn(
        name: impl Into<String>,
        source: impl Source + 'static,
        depth: usize,
        when_full: WhenFull,
    ) -> Result<Self> {
        let name = name.into();
        if depth == 0 {
            return Err(Error::argument("expected to read at least one image ahead, found 0"));
        }

        let queue = Arc::new(Queue::new(depth, when_full));
        let (frames_left, period) = (source.frames_left(), source.period());
        let cancel_handle = source.cancel_handle();
        let reader = Reader { name: name.clone(), queue: Arc::clone(&queue), source };

        let thread = std::thread::Builder::new().name(format!("reads {name}")).spawn(move || reader.run());
        let thread =
            thread.map_err(|e| Error::view(&name, format!("expected to start a thread, found: {e}")))?;
        Ok(Self { name, frames_left, period, queue, cancel_handle, thread: Some(thread) })
    }

    /// The view's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How many images the source had when it was opened, if known.
    pub fn frames_expected(&self) -> Option<u32> {
        self.frames_left
    }

    /// The seconds from one image to the next, if known.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// How many images were dropped because the queue was full; always 0 for [`WhenFull::Wait`].
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }

    /// The source's remarks after its last image, see [`Source::notes`].
    pub fn notes(&self) -> Vec<String> {
        self.queue.notes()
    }

    /// The next frame, for which it waits until `deadline` at most.
    pub(super) fn take_until(&self, deadline: Option<Instant>) -> Taken {
        self.queue.pop(deadline)
    }
}

impl Iterator for ReadAhead {
    type Item = Result<Frame>;

    fn next(&mut self) -> Option<Result<Frame>> {
        match self.take_until(None) {
            Taken::Frame(frame) => Some(frame),
            Taken::Ended | Taken::Timeout => None,
        }
    }
}

/// Images that are read ahead of one who waits between them, as [`Paced`](super::Paced) does.
impl Source for ReadAhead {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        self.next()
    }

    fn period(&self) -> Option<f64> {
        self.period
    }

    fn notes(&self) -> Vec<String> {
        self.queue.notes()
    }

    fn cancel_handle(&self) -> CancelHandle {
        let (queue, source) = (Arc::clone(&self.queue), self.cancel_handle.clone());
        CancelHandle::new(move || {
            queue.disconnect();
            source.stop();
        })
    }
}

impl Drop for ReadAhead {
    fn drop(&mut self) {
        self.cancel_handle().stop();
        if let Some(thread) = self.thread.take() {
            // A panic has been reported as an error already.
            let _ = thread.join();
        }
    }
}

impl std::fmt::Debug for ReadAhead {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReadAhead").field("name", &self.name).field("dropped", &self.dropped()).finish()
    }
}

/// The state of the reading thread; dropping it ends the queue, after a panic too.
struct Reader<S: Source> {
    name: String,
    queue: Arc<Queue>,
    source: S,
}

impl<S: Source> Reader<S> {
    fn run(mut self) {
        while let Some(frame) = self.source.next_frame() {
            if !self.queue.put(frame.map_err(|e| self.named(e))) {
                break;
            }
        }
    }

    /// The error with the view's name, which the source may have given it.
    fn named(&self, error: Error) -> Error {
        match error {
            Error::View { view, problem } if view == self.name => Error::View { view, problem },
            other => Error::view(&self.name, other),
        }
    }
}

impl<S: Source> Drop for Reader<S> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.queue.put(Err(Error::view(&self.name, "expected an image, found that its source panicked")));
            self.queue.end(Vec::new());
        } else {
            self.queue.end(self.source.notes());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Fed, assert_says, frame};
    use super::*;

    fn numbers(ahead: ReadAhead) -> Vec<u32> {
        ahead.map(|frame| frame.unwrap().number).collect()
    }

    #[test]
    fn a_reader_that_waits_loses_nothing_and_keeps_the_order() {
        let fed = Fed::with((0..100).map(|n| Ok(frame(n, f64::from(n)))));
        let ahead = ReadAhead::spawn("left", fed, 3, WhenFull::Wait).unwrap();
        assert_eq!(numbers(ahead), (0..100).collect::<Vec<_>>());
    }

    #[test]
    fn a_reader_that_drops_keeps_the_newest_and_counts_the_rest() {
        let fed = Fed::default();
        let ahead = ReadAhead::spawn("left", fed.clone(), 3, WhenFull::DropOldest).unwrap();
        (0..10).for_each(|n| fed.send(Ok(frame(n, 0.0))));
        fed.wait_until_starved();
        assert_eq!(ahead.dropped(), 7);
        fed.end();
        assert_eq!(numbers(ahead), [7, 8, 9]);
    }

    #[test]
    fn errors_name_the_view_and_are_never_dropped() {
        let fed = Fed::default();
        let mut ahead = ReadAhead::spawn("left", fed.clone(), 2, WhenFull::DropOldest).unwrap();
        fed.send(Err(Error::argument("broken")));
        (0..5).for_each(|n| fed.send(Ok(frame(n, 0.0))));
        fed.wait_until_starved();
        fed.end();
        assert_says(ahead.next().unwrap(), &["view \"left\"", "broken"]);
        assert_eq!(ahead.dropped(), 4);
        assert_eq!(numbers(ahead), [4]);
    }

    #[test]
    fn a_reader_of_a_reader_names_the_view_once_and_is_cancelled_through_it() {
        let fed = Fed::default();
        let inner = ReadAhead::spawn("left", fed.clone(), 2, WhenFull::Wait).unwrap();
        let mut outer = ReadAhead::spawn("left", inner, 2, WhenFull::Wait).unwrap();
        fed.send(Ok(frame(0, 0.0)));
        fed.send(Err(Error::argument("broken")));
        assert_eq!(outer.next().unwrap().unwrap().number, 0);
        let told = outer.next().unwrap().unwrap_err().to_string();
        assert_eq!(told.matches("left").count(), 1, "{told}");
        drop(outer);
    }

    #[test]
    fn a_reader_that_is_dropped_ends_a_source_that_waits() {
        let fed = Fed::default();
        let ahead = ReadAhead::spawn("left", fed.clone(), 2, WhenFull::Wait).unwrap();
        fed.wait_until_starved();
        drop(ahead);
        // A reader whose thread waits because the queue is full ends as well.
        let full = Fed::with((0..9).map(|n| Ok(frame(n, 0.0))));
        drop(ReadAhead::spawn("left", full, 1, WhenFull::Wait).unwrap());
    }

    #[test]
    fn a_source_that_panics_is_an_error_and_the_end() {
        struct Panics;
        impl Source for Panics {
            fn next_frame(&mut self) -> Option<Result<Frame>> {
                std::panic::resume_unwind(Box::new("silent"))
            }
        }
        let mut ahead = ReadAhead::spawn("left", Panics, 1, WhenFull::Wait).unwrap();
        assert_says(ahead.next().unwrap(), &["view \"left\"", "panicked"]);
        assert!(ahead.next().is_none());
        assert_says(ReadAhead::spawn("left", Panics, 0, WhenFull::Wait), &["at least one"]);
    }
}
