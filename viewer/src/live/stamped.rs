//! Real cameras on the clock of a live system.

use ode_visual_hull::Result;
use ode_visual_hull::source::{CancelHandle, Clock, Frame, Source};

/// A live camera whose images carry the time of a clock at their arrival. While the clock is paused they are left out.
pub struct Stamped<S> {
    source: S,
    clock: Clock,
    last: f64,
}

impl<S: Source> Stamped<S> {
    /// The images of `source`, on `clock`.
    pub fn new(source: S, clock: &Clock) -> Self {
        Self { source, clock: clock.clone(), last: f64::NEG_INFINITY }
    }
}

impl<S: Source> Source for Stamped<S> {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        loop {
            let frame = match self.source.next_frame()? {
                Ok(frame) => frame,
                Err(error) => return Some(Err(error)),
            };
            let time = self.clock.now();
            if !self.clock.is_paused() && time > self.last {
                self.last = time;
                return Some(Ok(Frame { time, ..frame }));
            }
        }
    }

    fn period(&self) -> Option<f64> {
        self.source.period()
    }

    fn cancel_handle(&self) -> CancelHandle {
        self.source.cancel_handle()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::RgbImage;
    use ode_visual_hull::source::Images;

    #[test]
    fn images_get_the_time_of_the_clock_and_none_comes_while_it_is_paused() {
        let images = Images::new(vec![RgbImage::new(2, 1); 5], 30.0).unwrap();
        let clock = Clock::new();
        clock.pause();
        clock.advance(7.0);
        assert!(Stamped::new(images.clone(), &clock).next_frame().is_none(), "all were left out");
        clock.resume();
        let mut stamped = Stamped::new(images, &clock);
        let times = [(); 2].map(|()| stamped.next_frame().unwrap().unwrap().time);
        assert!(times[0] >= 7.0 && times[1] > times[0], "{times:?}");
    }
}
