//! A mask of one view that is being prepared, without holding a lock.

use super::mask_filter::MaskFilter;
use super::moving_mask::{distances_of, motion_between};
use crate::camera::Camera;
use crate::silhouette::{
    Border, EdgeDistances, IncomingMask, MaskMotion, MaskScratch, PackedMask, Silhouette, Undistortion,
    WarpedMask,
};
use crate::{Error, Result};
use std::sync::Arc;

/// The immutable part of a view: its camera, and how its lens is undistorted.
#[derive(Debug)]
pub(super) struct ViewCalibration {
    /// The camera that was added, with its lens.
    pub(super) camera: Arc<Camera>,
    /// The camera of the undistorted image, in which the hull works; `camera` itself if it has no distortion.
    pub(super) pinhole: Arc<Camera>,
    pub(super) undistortion: Option<Undistortion>,
    /// The part of the undistorted image that the lens sees; `None` if that is all of it.
    pub(super) field_of_view: Option<Arc<Silhouette>>,
    /// The pixels of [`Self::field_of_view`].
    pub(super) visible: Option<PackedMask>,
}
/// A mask that is being prepared, without holding a lock.
#[derive(Debug)]
pub(super) struct Preparation {
    pub(super) calibration: Arc<ViewCalibration>,
    pub(super) silhouette: Arc<Silhouette>,
    pub(super) scratch: MaskScratch,
    /// The distances of the mask before this one, if its motion is wanted.
    pub(super) predecessor: Option<Arc<EdgeDistances>>,
    pub(super) distances: Option<Arc<EdgeDistances>>,
    pub(super) motion: Option<Arc<MaskMotion>>,
    /// Memory for these two, if the motion is wanted.
    pub(super) spare: Option<(Arc<EdgeDistances>, Arc<MaskMotion>)>,
    pub(super) filter: MaskFilter,
    /// Whether too much time has passed since the mask before this one to relate the two.
    pub(super) is_after_gap: bool,
}
impl Preparation {
    /// Forgets the motion, where the mask was prepared again.
    pub(super) fn forget_motion(&mut self) {
        (self.distances, self.motion) = (None, None);
    }

    /// Computes the motion of the prepared mask since the one before it, if it is wanted.
    pub(super) fn find_motion(&mut self) {
        let Some((distances, motion)) = self.spare.take() else { return };
        let distances = distances_of(&self.silhouette, distances);
        self.motion =
            self.predecessor.clone().map(|earlier| motion_between(earlier, distances.clone(), motion));
        self.distances = Some(distances);
        self.average();
    }

    /// Averages the prepared mask with the one before it, if that is wanted.
    fn average(&mut self) {
        let (Some(motion), false) = (self.motion.as_mut().and_then(Arc::get_mut), self.is_after_gap) else {
            return;
        };
        let Some(silhouette) = Arc::get_mut(&mut self.silhouette).filter(|_| self.filter.averages()) else {
            return;
        };

        let ViewCalibration { pinhole, visible, .. } = &*self.calibration;
        let border = silhouette.border();
        WarpedMask::with_scratch(|memory| {
            let mask = motion.average(self.filter.new_weight, pinhole.size(), memory);
            if let Some(visible) = visible {
                mask.hide(visible.subject(), border == Border::Unknown);
            }
            silhouette.refill_packed(mask, border);
        });

        // Motion and later averages refer to the averaged mask.
        let distances = distances_of(silhouette, Arc::default());
        motion.replace_later(distances.clone());
        self.distances = Some(distances);
    }

    /// Prepares `mask`. Pixels that the lens does not see become subject if the border is [`Border::Unknown`], so that
    /// they make no edge.
    ///
    /// # Errors
    /// As [`HullData::set_mask`](crate::hull::HullData::set_mask).
    pub(super) fn prepare(&mut self, mask: IncomingMask, border: Border) -> Result<()> {
        self.calibration.check_size(mask.size())?;

        // A silhouette with another owner stays as it is.
        if Arc::get_mut(&mut self.silhouette).is_none() {
            self.silhouette = Arc::new(Silhouette::blank(border));
        }
        let Some(silhouette) = Arc::get_mut(&mut self.silhouette) else {
            unreachable!("a new silhouette has one owner");
        };

        let MaskScratch { packed, bytes, tiles, holes } = &mut self.scratch;
        let smallest_hole_px = self.filter.smallest_hole_px;
        let mask = if smallest_hole_px > 1 {
            IncomingMask::Packed(holes.fill(mask, smallest_hole_px))
        } else {
            mask
        };
        let is_full = match &self.calibration.undistortion {
            Some(lens) => !silhouette.refill_undistorted(&mask.bytes(bytes), lens, border, tiles)?,
            None => {
                let packed = mask.packed(packed);
                let is_full = packed.is_full();
                if !is_full {
                    silhouette.refill_packed(packed, border);
                }
                is_full
            }
        };
        if is_full { Err(self.calibration.full_mask()) } else { Ok(()) }
    }
}

impl ViewCalibration {
    /// # Errors
    /// A lens that cannot be undistorted within the largest image.
    pub(super) fn new(camera: Camera) -> Result<Self> {
        let undistortion = Undistortion::new(&camera);
        if undistortion.is_none() && !camera.lens().is_none() {
            let (width, height) = camera.size();
            let problem = format!(
                "expected a lens that can be undistorted within the largest image, found {width} x {height} pixels \
                 and the lens {}; scale the images down or undistort them first",
                camera.lens()
            );
            return Err(Error::view(camera.name(), problem));
        }

        let visible = undistortion.as_ref().map(|lens| PackedMask::new(lens.field_of_view()));
        let field_of_view =
            undistortion.as_ref().map(|lens| Silhouette::new(lens.field_of_view(), Border::Background));
        let field_of_view = field_of_view.map(Arc::new);
        let camera = Arc::new(camera);
        let pinhole =
            undistortion.as_ref().map_or_else(|| camera.clone(), |lens| Arc::new(lens.pinhole().clone()));

        Ok(Self { camera, pinhole, undistortion, field_of_view, visible })
    }

    /// Refuses a mask whose size differs from the camera's image.
    fn check_size(&self, found: (u32, u32)) -> Result<()> {
        let (width, height) = self.camera.size();
        if found != (width, height) {
            let found = format!("found {} x {}", found.0, found.1);
            let problem = format!(
                "mask: expected {width} x {height} pixels as in the calibration, {found}; scale the mask or calibrate \
                 at its size"
            );
            return Err(Error::view(self.camera.name(), problem));
        }
        Ok(())
    }

    /// The error for a mask without background.
    fn full_mask(&self) -> Error {
        let problem = "mask: expected some background, found every pixel subject; \
                       it is inverted or the segmentation failed; the last good mask stays";
        Error::view(self.camera.name(), problem)
    }
}

/// The mask's value at pixels that a lens does not see.
pub(super) fn unseen_value(border: Border) -> u8 {
    if border == Border::Unknown { 255 } else { 0 }
}
