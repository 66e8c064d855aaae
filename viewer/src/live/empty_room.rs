//! The empty room, which is learnt while the cameras run.

use image::RgbImage;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::segment::{CleanPlate, Segmenter, Thresholds};
use ode_visual_hull::source::ImageSet;
use ode_visual_hull::{Error, Result};

/// Images of each camera from which the room is learnt: enough for the mean and the noise of each pixel.
const IMAGES: usize = 24;

/// Images of the empty room that are being collected.
#[derive(Debug, Default)]
pub struct EmptyRoom {
    /// Those of each camera; `None` while none are collected.
    images: Option<Vec<Vec<RgbImage>>>,
}

impl EmptyRoom {
    /// Starts to collect.
    pub fn start(&mut self) {
        self.images = Some(Vec::new());
    }

    /// Whether images are being collected.
    pub fn is_learning(&self) -> bool {
        self.images.is_some()
    }

    /// Adds the images of a set, and returns those of each camera once there are enough of each.
    pub fn add(&mut self, set: &ImageSet) -> Option<Vec<Vec<RgbImage>>> {
        let images = self.images.as_mut()?;
        images.resize_with(set.images.len(), Vec::new);
        for (own, frame) in images.iter_mut().zip(&set.images) {
            own.extend(frame.as_ref().filter(|_| own.len() < IMAGES).map(|frame| (*frame.image).clone()));
        }
        images.iter().all(|own| own.len() == IMAGES).then(|| self.images.take())?
    }
}

/// A segmenter for each camera of `rig` against its images of the empty room.
///
/// # Errors
/// No images of a camera, or images of another size than the camera's.
pub fn segmenters(rig: &Rig, images: &[Vec<RgbImage>]) -> Result<Vec<Box<dyn Segmenter>>> {
    if images.len() != rig.len() {
        return Err(Error::argument(format!(
            "empty room: expected images of {} cameras, found those of {}",
            rig.len(),
            images.len()
        )));
    }
    let segmenter = |(camera, images): (&ode_visual_hull::camera::Camera, &Vec<RgbImage>)| {
        let plate = CleanPlate::from_empty(images, Thresholds::default());
        let plate = plate.map_err(|error| Error::view(camera.name(), format!("empty room: {error}")))?;
        Ok(Box::new(plate) as Box<dyn Segmenter>)
    };
    rig.cameras().iter().zip(images).map(segmenter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn set(number: u32) -> ImageSet {
        let image = |value: u8| RgbImage::from_pixel(8, 6, Rgb([value; 3]));
        ImageSet::simultaneous(number, f64::from(number), [image(number as u8), image(100)])
    }

    #[test]
    fn images_are_collected_until_each_camera_has_enough() {
        let mut room = EmptyRoom::default();
        assert!(room.add(&set(0)).is_none() && !room.is_learning());
        room.start();
        // The second camera misses the first set.
        let mut first = set(0);
        first.images[1] = None;
        assert!(room.add(&first).is_none());
        let last = IMAGES as u32;
        assert!((1..last).all(|number| room.add(&set(number)).is_none()));
        let images = room.add(&set(last)).unwrap();
        assert_eq!([images[0].len(), images[1].len()], [IMAGES; 2]);
        assert!(!room.is_learning());
    }
}
