//! What a film is made from: the frames of a captured subject, and what to show of them.

use crate::playback_options::PlaybackOptions;
use crate::window::Window;
use image::RgbImage;
use nalgebra::Point3;
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{Hull, HullData};
use ode_visual_hull::synthetic::Hit;
use ode_visual_hull::{Error, Result};

/// Frames of a film a second.
pub const FRAME_RATE: f64 = 30.0;

/// Steps of a film's simulation a second.
pub const STEPS_PER_SECOND: f64 = 240.0;

/// Calibrated cameras and what they see at each time.
pub trait Frames: Sync {
    /// The cameras, in the order of the hull's views.
    fn cameras(&self) -> &[Camera];

    /// Makes sure that `data` has published the masks of `time`, in seconds. It is called before each step of the
    /// simulation, of which there are several in a frame of the film: cameras may be faster or slower than that.
    ///
    /// # Errors
    /// Masks that cannot be read or made, or that `data` refuses.
    fn publish(&mut self, time: f64, data: &HullData) -> Result<()>;

    /// The image of camera `view` that was taken nearest to `time`, in seconds: that of the hull in the simulation, which
    /// may lag behind the masks published last. Times never decrease.
    ///
    /// # Errors
    /// An image that cannot be read.
    fn picture(&mut self, view: usize, time: f64) -> Result<RgbImage>;

    /// Where `ray`, a viewing ray of camera `view`, first meets the subject at the time of `hull`, the hull in the
    /// simulation.
    fn hit(&self, ray: &Ray, view: usize, hull: &Hull) -> Option<Hit>;

    /// The height of the subject's top at the time of the masks published last, where it is known.
    fn real_top(&self) -> Option<f64>;
}

/// What happens to the captured subject, and how to show it.
pub trait Story {
    /// A word for the subject.
    fn subject(&self) -> &str;

    /// The number of frames of a film of it.
    fn frames(&self) -> usize;

    /// The time, in seconds, up to which the subject does not move.
    fn still_until(&self) -> f64;

    /// Three times that show what happens, in seconds.
    fn moments(&self) -> [f64; 3];

    /// The index of the camera that shows most.
    fn best_view(&self) -> usize;

    /// The part of camera `view`'s image to draw.
    fn window(&self, view: usize) -> Window;

    /// The position of the light, in the world.
    fn light(&self) -> Point3<f64>;

    /// How to play the recording of it so that the same happens at the same time; `None` where there is no recording.
    fn playback(&self) -> Option<PlaybackOptions>;
}

/// The index of the camera that is called `wanted` or has that number; without `wanted` the best one of the story.
///
/// # Errors
/// No such camera.
pub fn view_of(capture: &(impl Frames + Story), wanted: Option<&str>) -> Result<usize> {
    let Some(wanted) = wanted else { return Ok(capture.best_view()) };
    let cameras = capture.cameras();
    let by_name = cameras.iter().position(|camera| camera.name() == wanted);
    let by_number = || wanted.parse().ok().filter(|&view: &usize| view < cameras.len());
    by_name.or_else(by_number).ok_or_else(|| {
        let names: Vec<_> = cameras.iter().map(|camera| camera.name()).collect();
        let most = cameras.len() - 1;
        let names = names.join(", ");
        Error::argument(format!("--view: expected 0 to {most} or one of {names}, found {wanted}"))
    })
}
