//! Where silhouettes come from, frame by frame.

use image::RgbImage;
use nalgebra::Point3;
use ode_visual_hull::camera::{Camera, Pixel, Ray};
use ode_visual_hull::hull::{Hull, HullData};
use ode_visual_hull::synthetic::Hit;
use ode_visual_hull::{Error, Result};

/// Frames of a film a second.
pub const FRAME_RATE: f64 = 30.0;

/// Calibrated cameras and what they see in the course of time.
pub trait Capture: Sync {
    /// What is captured, in a word.
    fn subject(&self) -> &str;

    /// The cameras, in the order of the hull's views.
    fn cameras(&self) -> &[Camera];

    /// The camera that shows most.
    fn best_view(&self, data: &HullData) -> usize;

    /// The number of frames of a film of it.
    fn frames(&self) -> usize;

    /// Until when, in seconds, the subject does not move.
    fn still_until(&self) -> f64;

    /// Three moments that tell the story, in seconds.
    fn moments(&self) -> [f64; 3];

    /// Sees to it that `data` has published the masks of `time`, in seconds. It is called before each step of the
    /// simulation, of which there are several in a frame of the film: cameras may be faster or slower than that.
    ///
    /// # Errors
    /// Masks that cannot be had, or that `data` refuses.
    fn publish(&mut self, time: f64, data: &HullData) -> Result<()>;

    /// What camera `view` saw when the masks published last were taken.
    ///
    /// # Errors
    /// A picture that cannot be had.
    fn picture(&mut self, view: usize) -> Result<RgbImage>;

    /// The part of camera `view`'s image to draw.
    fn window(&self, view: usize, data: &HullData) -> Window;

    /// Where `ray`, a viewing ray of camera `view`, first meets the subject as it was published last; its hull is
    /// `hull`.
    fn hit(&self, ray: &Ray, view: usize, hull: &Hull) -> Option<Hit>;

    /// The height of the subject's top as it was published last, where it is known.
    fn real_top(&self) -> Option<f64>;

    /// Where the light comes from.
    fn light(&self) -> Point3<f64>;
}

/// A part of an image, in pixels.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    /// Columns left of it.
    pub left: u32,
    /// Rows above it.
    pub top: u32,
    /// Its columns.
    pub width: u32,
    /// Its rows.
    pub height: u32,
}

impl Window {
    /// All of a camera's image.
    pub fn full(camera: &Camera) -> Self {
        let (width, height) = camera.size();
        Self { left: 0, top: 0, width, height }
    }

    /// Around `points` of the world, as far as they are in the image; all of it where none is.
    pub fn around(camera: &Camera, points: &[Point3<f64>]) -> Self {
        let (width, height) = camera.size();
        let pixels: Vec<_> = points.iter().filter_map(|point| camera.project(point)).collect();
        let least = |x: f64, most: u32| x.clamp(0.0, f64::from(most)) as u32;
        let fold = |pick: fn(&Pixel) -> f64, first: f64, better: fn(f64, f64) -> f64, most: u32| {
            least(pixels.iter().map(pick).fold(first, better), most)
        };
        let left = fold(|p| p.u, f64::INFINITY, f64::min, width);
        let right = fold(|p| p.u, f64::NEG_INFINITY, f64::max, width);
        let top = fold(|p| p.v, f64::INFINITY, f64::min, height);
        let bottom = fold(|p| p.v, f64::NEG_INFINITY, f64::max, height);
        if right <= left || bottom <= top {
            return Self::full(camera);
        }
        Self { left, top, width: right - left, height: bottom - top }
    }
}

/// The index of the camera called `wanted`, or of that number; without a wish the one that shows most.
///
/// # Errors
/// No such camera.
pub fn view_of(capture: &dyn Capture, wanted: Option<&str>, data: &HullData) -> Result<usize> {
    let Some(wanted) = wanted else { return Ok(capture.best_view(data)) };
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
