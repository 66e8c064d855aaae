//! Images of one camera at the times of its masks, as backgrounds of pictures.

use image::{DynamicImage, RgbImage};
use ode_visual_hull::Result;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::source::{Frame, ReadAhead, WhenFull};

/// Number of images read ahead.
const DEPTH: usize = 3;

/// The images of one camera, from its folder or its video. Its masks stand in where it has no image.
#[derive(Debug)]
pub struct BackgroundImages {
    camera: usize,
    images: Option<Images>,
    /// Greatest difference in seconds between the time of an image and the requested one; beyond it the mask is used.
    within: f64,
}

/// A stream of images in the order of time, with a cursor at the latest one before the requested time.
#[derive(Debug)]
struct Images {
    stream: ReadAhead,
    now: Frame,
    /// The image after `now`, once it has been read.
    next: Option<Frame>,
}

/// Number and capture time, in seconds, of a frame that has masks.
pub type FrameTime = (u32, f64);

impl BackgroundImages {
    /// Opens the images of the camera at index `camera`, from the one nearest to frame `first` on.
    ///
    /// # Errors
    /// Images that cannot be opened.
    pub fn open(
        recording: &Recording,
        camera: usize,
        first: FrameTime,
        streaming: &StreamOptions,
        within: f64,
    ) -> Result<Self> {
        let (frame, time) = first;
        let from = |first| Images::open(recording, camera, &StreamOptions { first, ..*streaming });

        let images = match recording.has_images_of(camera) {
            false => None,
            true => match from(frame)? {
                Some(images) if images.now.time <= time => Some(images),
                // Numbers of images and masks may differ: where the stream starts too late, search from its start.
                _ => from(0)?,
            },
        };
        Ok(Self { camera, images, within })
    }

    /// The image nearest in time to the frame, or the frame's mask. Frames must be requested in the order of time.
    ///
    /// # Errors
    /// An image or a mask that cannot be read.
    pub fn at(&mut self, recording: &Recording, (frame, time): FrameTime) -> Result<RgbImage> {
        if let Some(images) = &mut self.images {
            let nearest = images.nearest(time)?;
            if (nearest.time - time).abs() <= self.within {
                return Ok((*nearest.image).clone());
            }
        }
        Ok(DynamicImage::from(recording.masks(frame)?.swap_remove(self.camera)).into_rgb8())
    }
}

impl Images {
    fn open(recording: &Recording, camera: usize, streaming: &StreamOptions) -> Result<Option<Self>> {
        let name = recording.rig().cameras()[camera].name();
        let source = recording.source(camera, streaming)?;
        let mut stream = ReadAhead::spawn(name, source, DEPTH, WhenFull::Wait)?;
        let first = stream.next().transpose()?;
        Ok(first.map(|now| Self { stream, now, next: None }))
    }

    /// Advances the cursor and returns the image nearest to `time`.
    fn nearest(&mut self, time: f64) -> Result<&Frame> {
        // Read no farther than needed: a video that is damaged at its end stays usable before that.
        while self.now.time < time {
            match self.next.take() {
                Some(next) if next.time <= time => self.now = next,
                Some(next) => {
                    self.next = Some(next);
                    break;
                }
                None => match self.stream.next().transpose()? {
                    next @ Some(_) => self.next = next,
                    None => break,
                },
            }
        }

        let nearest = self.next.as_ref().filter(|next| next.time - time < time - self.now.time);
        Ok(nearest.unwrap_or(&self.now))
    }
}
