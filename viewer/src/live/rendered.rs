//! Images of synthetic cameras.

use image::RgbImage;
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::synthetic::{Room, Scene, Subject, add_noise, clean_plate, render_over};
use rayon::prelude::*;

/// Noise of the sensors, in grey levels.
const NOISE: f64 = 2.0;

/// What synthetic cameras see.
pub struct Rendered {
    /// Images of each camera.
    pub images: Vec<Vec<RgbImage>>,
    /// The image of the empty room in each camera.
    pub empty_room: Vec<RgbImage>,
}

impl Rendered {
    /// The images of `cameras` in a room in which `subjects` are seen one after the other.
    ///
    /// # Errors
    /// A camera without a size.
    pub fn new(cameras: &[Camera], subjects: &[Subject]) -> Result<Self> {
        let room = Room::default();
        let of_camera = |(view, camera): (usize, &Camera)| -> Result<_> {
            let plate = clean_plate(camera, &room);
            let image = |(k, subject): (usize, &Subject)| {
                let scene = Scene { subject: subject.clone(), room: room.clone() };
                let mut image = render_over(camera, &scene, &plate)?;
                add_noise(&mut image, NOISE, (1000 * view + k) as u64)?;
                Ok(image)
            };
            let images = subjects.par_iter().enumerate().map(image).collect::<Result<Vec<_>>>()?;
            Ok((images, plate))
        };
        let rendered = cameras.par_iter().enumerate().map(of_camera).collect::<Result<Vec<_>>>()?;
        let (images, empty_room) = rendered.into_iter().unzip();
        Ok(Self { images, empty_room })
    }
}
