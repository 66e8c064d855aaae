//! Images that are in memory already.

use super::{Frame, Source, Times};
use crate::{Error, Result};
use image::RgbImage;
use std::sync::Arc;

/// Images in memory as the images of a camera, for cameras that are rendered. Numbers and times count from 0.
///
/// Clones share the images, and so do those who use them.
#[derive(Debug, Clone)]
pub struct Images {
    images: Arc<[Arc<RgbImage>]>,
    rate: f64,
    next: u32,
}

impl Images {
    /// `images` at `rate` images per second.
    ///
    /// # Errors
    /// A rate that is not positive; no image, or more than [`u32`] counts.
    pub fn new(images: impl IntoIterator<Item = RgbImage>, rate: f64) -> Result<Self> {
        let images: Arc<[_]> = images.into_iter().map(Arc::new).collect();
        Times::Rate(rate).check()?;
        if images.is_empty() || u32::try_from(images.len()).is_err() {
            return Err(Error::argument(format!(
                "expected 1 to {} images, found {}",
                u32::MAX,
                images.len()
            )));
        }
        Ok(Self { images, rate, next: 0 })
    }
}

impl Source for Images {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        let image = self.images.get(self.next as usize)?.clone();
        let number = self.next;
        self.next += 1;
        Some(Ok(Frame { number, time: f64::from(number) / self.rate, image }))
    }

    fn frames_left(&self) -> Option<u32> {
        Some(self.images.len() as u32 - self.next)
    }

    fn period(&self) -> Option<f64> {
        Some(1.0 / self.rate)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_says, grey_image};
    use super::*;

    #[test]
    fn images_come_in_order_at_their_rate_and_clones_begin_where_they_were_made() {
        let grey = |value| grey_image(value, (2, 1));
        let mut source = Images::new([grey(3), grey(5)], 4.0).unwrap();
        let copy = source.clone();
        for (number, value) in [(0, 3), (1, 5)] {
            let time = f64::from(number) / 4.0;
            let expected = Frame { number, time, image: grey(value).into() };
            assert_eq!(source.next_frame(), Some(Ok(expected)));
        }
        assert_eq!((source.next_frame(), source.frames_left()), (None, Some(0)));
        assert_eq!((copy.frames_left(), copy.period()), (Some(2), Some(0.25)));
    }

    #[test]
    fn no_image_or_no_rate_is_an_error() {
        assert_says(Images::new([], 4.0), &["1 to", "found 0"]);
        assert_says(Images::new([grey_image(0, (1, 1))], 0.0), &["positive", "found 0"]);
    }
}
