//! A synthetic subject at one moment: what the cameras around it see, and its hull.

use image::RgbImage;
use nalgebra::{Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, Hull, HullData};
use ode_visual_hull::segment::{CleanPlate, Segmenter, Thresholds};
use ode_visual_hull::synthetic::{
    Room, Scene, Subject, add_noise, clean_plate, coverage, layout, render_over,
};
use std::sync::Arc;

/// The work volume around the subject.
pub const BOUNDS: Aabb = Aabb { min: Point3::new(-1.0, -1.0, -0.1), max: Point3::new(1.0, 1.0, 2.1) };

/// A rendered moment.
#[derive(Debug)]
pub struct Rendered {
    /// The subject and the room.
    pub scene: Scene,
    /// The cameras.
    pub cameras: Vec<Camera>,
    /// The image of the empty room in each camera.
    pub plates: Vec<RgbImage>,
    /// The image of each camera, without noise.
    pub images: Vec<RgbImage>,
    /// The hull of exact silhouettes.
    pub hull: Arc<Hull>,
}

impl Rendered {
    /// `subject` in a room, seen by `count` cameras around it whose images have `size` pixels.
    ///
    /// # Errors
    /// No camera, or a size of zero.
    pub fn new(subject: Subject, count: usize, size: (u32, u32)) -> Result<Self> {
        let target = Point3::new(0.0, 0.0, 0.9);
        let cameras = layout::staggered(count, 3.2, &[1.1, 2.4, 0.6], target, size, 0.75)?;
        let room = Room::new(Vector3::new(9.0, 9.0, 4.0))?;
        let plates: Vec<_> = cameras.iter().map(|camera| clean_plate(camera, &room)).collect();
        let scene = Scene { subject, room };
        let images = cameras.iter().zip(&plates).map(|(camera, plate)| render_over(camera, &scene, plate));
        let images = images.collect::<Result<Vec<_>>>()?;
        let masks: Vec<_> = cameras.iter().map(|camera| coverage(camera, &scene.subject)).collect();
        let hull = hull_of(&cameras, &masks)?;
        Ok(Self { scene, cameras, plates, images, hull })
    }

    /// The images with sensor noise of a standard deviation of `sigma` grey levels, and the hull of their silhouettes by
    /// segmentation.
    ///
    /// # Errors
    /// A noise that is negative.
    pub fn exposed(&self, sigma: f64, seed: u64) -> Result<(Vec<RgbImage>, Arc<Hull>)> {
        let (mut images, mut masks) = (self.images.clone(), Vec::new());
        for (view, image) in images.iter_mut().enumerate() {
            add_noise(image, sigma, seed.wrapping_mul(1_000).wrapping_add(view as u64))?;
            let mut segmenter = CleanPlate::new(&self.plates[view], Thresholds::default())?;
            masks.push(segmenter.segment(image)?);
        }
        Ok((images, hull_of(&self.cameras, &masks)?))
    }
}

fn hull_of(cameras: &[Camera], masks: &[image::GrayImage]) -> Result<Arc<Hull>> {
    let data = HullData::new();
    data.add_views(cameras)?;
    data.set_bounds(BOUNDS)?;
    for (view, mask) in masks.iter().enumerate() {
        data.set_mask(view, mask)?;
    }
    data.update(0.0)
}
