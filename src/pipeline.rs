//! From the images of several cameras to masks and the hull.
//!
//! ```text
//!              ┌───────────────── Pipeline ─────────────────┐
//!   ImageSet ──┼─► Segmenters ─► PackedMask ─► HullData     ├─► Captured: images, masks and hull of one time
//!              │   (a thread     of each                    │
//!              │   per camera)   camera                     │
//!              └────────────────────────────────────────────┘
//! ```
//!
//! A [`Pipeline`] segments a set of images of one time, publishes the hull, and returns images, masks and hull
//! together. [`Segmenters`] produce masks without a hull. [`publish_masks`] publishes the hull of existing masks, such
//! as those of a [`recording`](crate::recording).

use crate::camera::Camera;
use crate::hull::{Hull, HullData};
use crate::segment::Segmenter;
use crate::side_by_side::side_by_side;
use crate::silhouette::{MaskView, PackedMask};
use crate::source::{Frame, ImageSet};
use crate::{Error, Result};
use std::fmt;
use std::sync::Arc;

/// Segments the images of several cameras and publishes the hull of their masks.
///
/// ```
/// use nalgebra::Point3;
/// use ode_visual_hull::Result;
/// use ode_visual_hull::hull::{Aabb, HullData};
/// use ode_visual_hull::pipeline::Pipeline;
/// use ode_visual_hull::segment::{CleanPlate, Segmenter, Thresholds};
/// use ode_visual_hull::source::ImageSet;
/// use ode_visual_hull::synthetic::{Scene, Subject, clean_plate, layout, render};
/// use std::sync::Arc;
///
/// # fn main() -> Result<()> {
/// let cameras = layout::ring(4, 3.5, 1.2, Point3::new(0.0, 0.0, 0.9), (160, 120), 0.9)?;
/// let data = Arc::new(HullData::new());
/// data.add_views(&cameras)?;
/// data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 2.2))?)?;
///
/// // Each camera has an image of the empty scene.
/// let segmenter = |camera| -> Result<Box<dyn Segmenter>> {
///     let empty = clean_plate(camera, &Scene::default().room);
///     Ok(Box::new(CleanPlate::new(&empty, Thresholds::default())?))
/// };
/// let segmenters = cameras.iter().map(segmenter).collect::<Result<Vec<_>>>()?;
/// let mut pipeline = Pipeline::new(segmenters, data)?;
///
/// // A person enters. Sets of a `source::Synchroniser` work in the same way.
/// let scene = Scene { subject: Subject::person_at(0.0), ..Scene::default() };
/// let images = ImageSet::simultaneous(0, 0.0, cameras.iter().map(|camera| render(camera, &scene)));
/// let captured = pipeline.publish(images)?;
/// assert!(captured.hull.inside(&Point3::new(0.0, 0.0, 1.2)));
/// assert_eq!(captured.masks.len(), 4);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Pipeline {
    segmenters: Segmenters,
    data: Arc<HullData>,
}

/// Images of one time, their masks, and the published hull.
#[derive(Debug, Clone)]
pub struct Captured {
    /// The images, in the order of the views.
    pub images: ImageSet,
    /// The masks of the images; `None` for a camera without an image, whose view keeps its last mask in the hull.
    pub masks: Vec<Option<PackedMask>>,
    /// The hull at the images' time.
    pub hull: Arc<Hull>,
}

impl Pipeline {
    /// A pipeline that writes to `data`, with one segmenter per view, in their order.
    ///
    /// # Errors
    /// Another number of segmenters than views.
    pub fn new(segmenters: Vec<Box<dyn Segmenter>>, data: Arc<HullData>) -> Result<Self> {
        let cameras = (0..data.view_count()).map(|view| data.camera(view)).collect::<Result<Vec<_>>>()?;
        let segmenters = Segmenters::new(cameras.iter().map(Arc::as_ref), segmenters)?;
        Ok(Self { segmenters, data })
    }

    /// The hull data that the pipeline writes to.
    pub fn data(&self) -> &Arc<HullData> {
        &self.data
    }

    /// Segments `images` and publishes the hull of the masks at the images' time. Cameras are processed side by side,
    /// on as many threads as there are processors; the result does not depend on their order of completion.
    ///
    /// A camera without an image keeps its last mask, as in [`HullData`].
    ///
    /// # Errors
    /// All errors of [`Segmenters::segment`]; a mask without background, which shows that the segmentation failed. In
    /// these cases no view takes a new mask. Also all errors of [`HullData::set_packed`] and [`HullData::update`],
    /// such as a time before the last frame's. The last frame stays current after any error. Messages name the time,
    /// and the view if the error is about one.
    pub fn publish(&mut self, images: ImageSet) -> Result<Captured> {
        let masks = self.segmenters.segment(&images)?;

        // Check before any view takes its mask, so that later frames do not mix masks of a refused set.
        self.segmenters.refuse_full_masks(&images, &masks)?;

        let set = |(view, (mask, frame)): (usize, (&Option<PackedMask>, &Option<Frame>))| match (mask, frame)
        {
            (Some(mask), Some(frame)) => self.data.set_packed_at(view, mask, frame.time),
            _ => Ok(()),
        };

        let hull = side_by_side(masks.iter().zip(&images.images).enumerate(), set)
            .and_then(|_| self.data.update(images.time))
            .map_err(|e| with_time(e, images.time))?;

        Ok(Captured { images, masks, hull })
    }
}

/// One segmenter per camera, run side by side: colour images in, masks out.
pub struct Segmenters {
    cameras: Vec<CameraSegmenter>,
}

struct CameraSegmenter {
    name: String,
    size: (u32, u32),
    segmenter: Box<dyn Segmenter>,
}

impl Segmenters {
    /// One segmenter for each of `cameras`, in their order.
    ///
    /// # Errors
    /// Another number of segmenters than cameras.
    pub fn new<'a>(
        cameras: impl IntoIterator<Item = &'a Camera>,
        segmenters: Vec<Box<dyn Segmenter>>,
    ) -> Result<Self> {
        let cameras: Vec<_> = cameras.into_iter().collect();
        if cameras.len() != segmenters.len() {
            return Err(Error::argument(format!(
                "expected {} segmenters, one per camera, found {}; pass them in the order of the cameras",
                cameras.len(),
                segmenters.len()
            )));
        }

        let pair = |(camera, segmenter): (&Camera, Box<dyn Segmenter>)| CameraSegmenter {
            name: camera.name().to_owned(),
            size: camera.size(),
            segmenter,
        };
        Ok(Self { cameras: cameras.into_iter().zip(segmenters).map(pair).collect() })
    }

    /// The masks of `images`, in the order of the cameras; `None` for a camera without an image. Cameras are
    /// processed side by side, on as many threads as there are processors.
    ///
    /// # Errors
    /// A set of another number of cameras; an image or a mask of another size than its camera's; an error of a
    /// segmenter. If several cameras fail, the first camera's error is returned. Messages name the view, the image's
    /// number and its time.
    pub fn segment(&mut self, images: &ImageSet) -> Result<Vec<Option<PackedMask>>> {
        let (expected, found) = (self.cameras.len(), images.images.len());
        if expected != found {
            return Err(Error::argument(format!(
                "images of {:.3} s: expected a set of {expected} cameras, found {found}; synchronise the streams of \
                 all cameras, in their order",
                images.time
            )));
        }
        let pairs = self.cameras.iter_mut().zip(&images.images);
        side_by_side(pairs, |(camera, frame)| frame.as_ref().map(|frame| camera.segment(frame)).transpose())
    }

    /// Refuses a mask without any background.
    fn refuse_full_masks(&self, images: &ImageSet, masks: &[Option<PackedMask>]) -> Result<()> {
        for ((camera, frame), mask) in self.cameras.iter().zip(&images.images).zip(masks) {
            if let (Some(frame), Some(mask)) = (frame, mask)
                && mask.is_full()
            {
                return Err(camera.error(
                    frame,
                    "expected some background, found a mask that is all subject; check the light and the \
                     images of the empty scene",
                ));
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Segmenters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.cameras.iter().map(|camera| &camera.name)).finish()
    }
}

impl CameraSegmenter {
    fn segment(&mut self, frame: &Frame) -> Result<PackedMask> {
        self.check_size(frame, "image", frame.image.dimensions())?;
        let mut mask = PackedMask::default();
        self.segmenter.segment_packed(&frame.image, &mut mask).map_err(|e| self.error(frame, e))?;
        self.check_size(frame, "mask", mask.size())?;
        Ok(mask)
    }

    fn check_size(&self, frame: &Frame, what: &str, (w, h): (u32, u32)) -> Result<()> {
        let (width, height) = self.size;
        if (w, h) == (width, height) {
            return Ok(());
        }
        let problem = format!(
            "{what}: expected {width} x {height} pixels as in the calibration, found {w} x {h}; calibrate at the size \
             of the images, or scale them"
        );
        Err(self.error(frame, problem))
    }

    fn error(&self, frame: &Frame, problem: impl fmt::Display) -> Error {
        Error::view(&self.name, format!("image {} of {:.3} s: {problem}", frame.number, frame.time))
    }
}

/// Publishes the hull of `masks`, one per view of `data` in their order, as the frame at `time` seconds, and returns
/// it. Masks are prepared side by side, on as many threads as there are processors.
///
/// # Errors
/// Another number of masks than views; all errors of [`HullData::set_mask`] and [`HullData::update`]. The last frame
/// then stays current.
pub fn publish_masks<'a, M: Sync>(data: &HullData, masks: &'a [M], time: f64) -> Result<Arc<Hull>>
where
    &'a M: Into<MaskView<'a>>,
{
    let (expected, found) = (data.view_count(), masks.len());
    if expected != found {
        return Err(Error::argument(format!(
            "expected {expected} masks, one per view, found {found}; pass them in the order of the views"
        )));
    }
    side_by_side(masks.iter().enumerate(), |(view, mask)| data.set_mask(view, mask))?;
    data.update(time)
}

/// Adds the time of the frame in seconds to an error.
fn with_time(error: Error, time: f64) -> Error {
    match error {
        Error::View { view, problem } => Error::view(view, format!("frame of {time:.3} s: {problem}")),
        other => Error::argument(format!("frame of {time:.3} s: {other}")),
    }
}

#[cfg(test)]
mod tests;
