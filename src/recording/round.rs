//! What of a recording is repeated when it is played again and again.

use super::{Recording, StreamOptions};
use crate::source::{Round, Times, frames_csv};
use crate::{Error, Result};

impl Recording {
    /// The images of all cameras as one [`Round`], so that [`Paced`](crate::source::Paced) sources of
    /// [`source`](Self::source) with these `options` stay together however often they are repeated: from the first
    /// image of any camera to the last of any, and the shortest period.
    ///
    /// # Errors
    /// A camera without images, or with fewer than are needed to know the period; all errors of
    /// [`source`](Self::source). The message names the view and what is missing.
    pub fn round(&self, options: &StreamOptions) -> Result<Round> {
        let (mut first_number, mut end, mut period) = (u32::MAX, 0, f64::INFINITY);
        let (mut first_time, mut last_time) = (f64::INFINITY, f64::NEG_INFINITY);

        for (camera, times) in self.times(options)?.into_iter().enumerate() {
            let named = |e| Error::view(self.name(camera), e);
            let times = self.times_or_rate(camera, times).map_err(named)?;
            let (first, last) = self.first_and_last(camera, &times, options.first).map_err(named)?;
            let time = |number| times.of(number).map_err(|problem| Error::view(self.name(camera), problem));

            (first_number, end) = (first_number.min(first), end.max(last.saturating_add(1)));
            (first_time, last_time) = (first_time.min(time(first)?), last_time.max(time(last)?));
            period = period.min(times.period().unwrap_or(f64::INFINITY));
        }

        if !period.is_finite() {
            let problem =
                "expected the times of two images at least, found one; give the rate in images per second";
            return Err(Error::file(self.dir.join(frames_csv::NAME), problem));
        }
        Round::new(first_number..end, first_time, last_time, period)
    }

    /// `times`, or those by the rate of the camera's own video; folders have 30 images per second.
    fn times_or_rate(&self, camera: usize, times: Option<Times>) -> Result<Times> {
        let times = match (times, &self.videos[camera]) {
            (Some(times), _) => times,
            (None, None) => Times::Rate(30.0),
            (None, Some(video)) => video.rate()?.map(Times::Rate).ok_or_else(|| {
                let problem = "expected a rate in the header, found none; give the rate or the times";
                Error::file(video.path(), problem)
            })?,
        };
        times.check()?;
        Ok(times)
    }

    /// The numbers of the first and last image of a camera from number `from` on.
    fn first_and_last(&self, camera: usize, times: &Times, from: u32) -> Result<(u32, u32)> {
        let numbers = match (times, &self.videos[camera]) {
            (Times::Listed(listed), _) => {
                let mut numbers = listed.range(from..).map(|(number, _)| *number);
                numbers.next().map(|first| (first, numbers.next_back().unwrap_or(first)))
            }
            (Times::Rate(_), Some(video)) => {
                let count = video.count()?.unwrap_or(0);
                (from < count).then(|| (from, count - 1))
            }
            (Times::Rate(_), None) => {
                let mut numbers = self.images.files[camera].range(from..).map(|(number, _)| *number);
                numbers.next().map(|first| (first, numbers.next_back().unwrap_or(first)))
            }
        };
        numbers.ok_or_else(|| {
            Error::file(
                &self.dir,
                format!("expected images from number {from} on, found none; start earlier"),
            )
        })
    }
}
