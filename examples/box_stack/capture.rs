//! Where silhouettes come from: the synthetic studio or a recording.

use image::RgbImage;
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::synthetic::Hit;

/// Frames a second.
pub const FRAME_RATE: f64 = 30.0;

/// Calibrated cameras and what they see, frame by frame.
pub trait Capture {
    /// What is captured, in a word.
    fn subject(&self) -> &str;

    /// The cameras, in the order of the hull's views.
    fn cameras(&self) -> &[Camera];

    /// The camera that shows most.
    fn best_view(&self) -> usize;

    /// The number of frames.
    fn frames(&self) -> usize;

    /// Until when, in seconds, the subject does not move.
    fn still_until(&self) -> f64;

    /// Gives the masks of `frame` to `data` and publishes them.
    fn publish(&mut self, frame: usize, data: &HullData) -> Result<()>;

    /// What camera `view` sees in `frame`.
    fn picture(&mut self, frame: usize, view: usize) -> Result<RgbImage>;

    /// Where `ray` first meets the subject in `frame`.
    fn hit(&self, frame: usize, ray: &Ray, data: &HullData) -> Option<Hit>;

    /// The height of the subject's top in `frame`, where it is known.
    fn real_top(&self, frame: usize) -> Option<f64>;

    /// Where the light comes from.
    fn lamp(&self) -> Point3<f64>;
}
