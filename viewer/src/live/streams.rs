//! How the real cameras are doing: what is lost and comes back is told, and what has another rate.

use super::messages::Messages;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::{StatusHandle, StreamStatus};

/// A rate that differs by more than this part from the expected one is another rate: images of a moment would be put together
/// with others.
const ANOTHER_RATE: f64 = 0.2;

/// Images for which a camera has another rate before that is told: they may come in bursts for a while.
const RATE_PATIENCE: u64 = 60;

/// The real cameras of a rig.
pub struct Streams {
    /// Images a second that each is expected to give.
    rate: f64,
    streams: Vec<Stream>,
}

struct Stream {
    name: String,
    handle: StatusHandle,
    /// As it was told last.
    is_connected: bool,
    last_error: Option<String>,
    /// The number of the image since which the camera has another rate, and whether that was told.
    off_since: Option<u64>,
    is_rate_told: bool,
}

impl Streams {
    /// The cameras of `rig`, whose sources have these `handles` and are expected to give an image in each `period` seconds.
    pub fn new(rig: &Rig, handles: Vec<StatusHandle>, period: f64) -> Self {
        let stream = |(camera, handle): (&ode_visual_hull::camera::Camera, _)| Stream {
            name: camera.name().to_owned(),
            handle,
            is_connected: false,
            last_error: None,
            off_since: None,
            is_rate_told: false,
        };
        let streams = rig.cameras().iter().zip(handles).map(stream).collect();
        Self { rate: 1.0 / period, streams }
    }

    /// Tells which cameras were lost, have come back, or have had another rate since the last call.
    pub fn tell_changes(&mut self, messages: &Messages) {
        for stream in &mut self.streams {
            let status = stream.handle.status();
            let is_new_error = status.last_error != stream.last_error;
            if status.is_connected && !stream.is_connected {
                messages.tell(&stream.name, "images arrive");
            }
            if let Some(error) = status.last_error.as_ref().filter(|_| is_new_error) {
                let next = if status.is_connected { "the image is left out" } else { "trying again" };
                messages.warn(&stream.name, format!("{error}; {next}"));
            }
            stream.tell_rate(&status, self.rate, messages);
            (stream.is_connected, stream.last_error) = (status.is_connected, status.last_error);
        }
    }
}

impl Stream {
    /// Tells once if images come at another rate than `expected` a second.
    fn tell_rate(&mut self, status: &StreamStatus, expected: f64, messages: &Messages) {
        let is_other = |rate: &f64| (rate / expected - 1.0).abs() > ANOTHER_RATE;
        let Some(rate) = status.measured_rate.filter(is_other).filter(|_| status.is_connected) else {
            (self.off_since, self.is_rate_told) = (None, false);
            return;
        };
        let since = *self.off_since.get_or_insert(status.frames);
        if status.frames - since >= RATE_PATIENCE && !self.is_rate_told {
            self.is_rate_told = true;
            messages.warn(
                &self.name,
                format!(
                    "expected {expected:.1} images a second, found {rate:.1}; set the camera to that rate, or start with the rate that \
                     all cameras have (--rate)"
                ),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::RgbImage;
    use nalgebra::{Point3, Vector3};
    use ode_visual_hull::camera::Camera;
    use ode_visual_hull::source::{Images, ReconnectOptions, Reconnecting, Source};

    #[test]
    fn a_camera_with_another_rate_is_told_once() {
        let eye = Point3::new(3.0, 0.0, 1.0);
        let camera = Camera::look_at("left", (4, 3), 0.8, eye, Point3::origin(), Vector3::z()).unwrap();
        let rig = Rig::new(vec![camera]).unwrap();
        for (expected, told) in [(100.0, false), (110.0, false), (30.0, true), (200.0, true)] {
            let images = Images::new(vec![RgbImage::new(4, 3); 200], 100.0).unwrap();
            let open = move || Ok(Box::new(images.clone()) as Box<dyn Source>);
            let mut source = Reconnecting::new(ReconnectOptions::default(), open).unwrap();
            let (messages, handle) = (Messages::default(), source.status_handle());
            let mut streams = Streams::new(&rig, vec![handle], 1.0 / expected);
            for _ in 0..150 {
                source.next_frame().unwrap().unwrap();
                streams.tell_changes(&messages);
            }
            let texts: Vec<_> = messages.take_new().into_iter().map(|message| message.text).collect();
            let rates: Vec<_> = texts.iter().filter(|text| text.contains("found 100.0")).collect();
            assert_eq!(rates.len(), usize::from(told), "{expected}: {texts:?}");
        }
    }
}
