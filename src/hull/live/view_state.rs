//! One view of a [`HullData`](crate::hull::HullData): its camera, its latest silhouettes, and recycled memory.

use crate::camera::Camera;
use crate::hull::{Aabb, View};
use crate::silhouette::{
    Border, IncomingMask, MaskRing, MaskScratch, SUBJECT, Silhouette, Tables, TimedMask, Undistortion,
};
use crate::{Error, Result};
use std::sync::Arc;

/// The largest number of silhouettes, and of sets of tables, whose memory a view keeps for its next masks.
const MAX_RECYCLED: usize = 3;

/// A view's camera, its latest silhouettes, and recycled memory.
#[derive(Debug)]
pub(super) struct ViewState {
    calibration: Arc<ViewCalibration>,
    masks: MaskRing,
    pub(super) enabled: bool,
    /// The last work volume, and whether the camera sees some of it.
    sees_volume: Option<(Aabb, bool)>,
    /// Silhouettes without another owner and without tables, whose memory is reused for the bits of the next masks.
    recycled_silhouettes: Vec<Arc<Silhouette>>,
    /// Tables of past silhouettes, whose memory is reused for the next masks. They take nine tenths of the memory.
    recycled_tables: Vec<Tables>,
    scratch: MaskScratch,
}

/// The immutable part of a view: its camera, and how its lens is undistorted.
#[derive(Debug)]
pub(super) struct ViewCalibration {
    /// The camera that was added, with its lens.
    camera: Arc<Camera>,
    /// The camera of the undistorted image, in which the hull works; `camera` itself if it has no distortion.
    pinhole: Arc<Camera>,
    undistortion: Option<Undistortion>,
    /// The part of the undistorted image that the lens sees; `None` if that is all of it.
    field_of_view: Option<Arc<Silhouette>>,
}

/// A mask that is being prepared, without holding a lock.
#[derive(Debug)]
pub(super) struct Preparation {
    calibration: Arc<ViewCalibration>,
    silhouette: Arc<Silhouette>,
    scratch: MaskScratch,
}

impl ViewState {
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

        let field_of_view =
            undistortion.as_ref().map(|lens| Silhouette::new(lens.field_of_view(), Border::Background));
        let field_of_view = field_of_view.map(Arc::new);
        let camera = Arc::new(camera);
        let pinhole =
            undistortion.as_ref().map_or_else(|| camera.clone(), |lens| Arc::new(lens.pinhole().clone()));

        Ok(Self {
            calibration: Arc::new(ViewCalibration { camera, pinhole, undistortion, field_of_view }),
            masks: MaskRing::default(),
            enabled: true,
            sees_volume: None,
            recycled_silhouettes: Vec::new(),
            recycled_tables: Vec::new(),
            scratch: MaskScratch::default(),
        })
    }

    pub(super) fn name(&self) -> &str {
        self.calibration.camera.name()
    }

    pub(super) fn camera(&self) -> &Arc<Camera> {
        &self.calibration.camera
    }

    /// Takes the buffers in which the next mask is prepared: recycled ones if there are any.
    pub(super) fn take_buffers(&mut self) -> Preparation {
        let blank = || Arc::new(Silhouette::blank(Border::Background));
        let mut silhouette = self.recycled_silhouettes.pop().unwrap_or_else(blank);
        if let Some(unshared) = Arc::get_mut(&mut silhouette)
            && let Some(tables) = self.recycled_tables.pop()
        {
            unshared.recycle_tables(tables);
        }
        let scratch = std::mem::take(&mut self.scratch);
        Preparation { calibration: self.calibration.clone(), silhouette, scratch }
    }

    /// Refuses a time at which the next mask cannot have been taken.
    ///
    /// # Errors
    /// A time that is not finite or lies before the last mask's.
    pub(super) fn check_time(&self, time: Option<f64>) -> Result<()> {
        self.masks.check_time(time).map_err(|e| Error::view(self.name(), e))
    }

    /// Makes a prepared silhouette, taken at `time`, the view's latest one. The next frame shows it.
    ///
    /// # Errors
    /// As [`Self::check_time`].
    pub(super) fn commit(&mut self, preparation: Preparation, time: Option<f64>) -> Result<()> {
        let Preparation { silhouette, scratch, .. } = preparation;
        self.scratch = scratch;

        // Another thread may have committed a later mask meanwhile.
        if let Err(e) = self.check_time(time) {
            self.recycle(silhouette);
            return Err(e);
        }

        if let Some(replaced) = self.masks.push(TimedMask { silhouette, time }) {
            self.recycle(replaced);
        }
        self.recycle_old();
        Ok(())
    }

    /// Records that the latest mask is part of the frame at `time`.
    pub(super) fn publish(&mut self, time: f64) {
        self.masks.publish(time);
        self.recycle_old();
    }

    /// Recycles the masks that are too old to be kept.
    fn recycle_old(&mut self) {
        while let Some(old) = self.masks.pop_old() {
            self.recycle(old);
        }
    }

    /// Recycles the tables of past masks that no frame needs any more.
    pub(super) fn recycle_past_tables(&mut self) {
        // Only those of the last two masks: their memory is still in the processor's caches.
        for silhouette in self.masks.past().take(2).filter_map(Arc::get_mut) {
            keep_tables(&mut self.recycled_tables, silhouette.take_tables());
        }
    }

    /// Recycles the memory of a silhouette that is no longer needed here, unless it has another owner.
    pub(super) fn recycle(&mut self, mut silhouette: Arc<Silhouette>) {
        let Some(unshared) = Arc::get_mut(&mut silhouette) else { return };
        keep_tables(&mut self.recycled_tables, unshared.take_tables());
        if self.recycled_silhouettes.len() < MAX_RECYCLED {
            self.recycled_silhouettes.push(silhouette);
        }
    }

    /// Prepares all silhouettes again for another border, which changes what the unseen parts of their masks are.
    pub(super) fn change_border(&mut self, border: Border) {
        for silhouette in self.masks.all() {
            let mut mask = silhouette.to_mask();
            if let Some(lens) = &self.calibration.undistortion {
                let unseen = unseen_value(border);
                let pixels = mask.iter_mut().zip(lens.field_of_view().iter());
                pixels.filter(|(_, visible)| **visible < SUBJECT).for_each(|(pixel, _)| *pixel = unseen);
            }
            *silhouette = Arc::new(Silhouette::new(&mask, border));
        }
    }

    /// The view with its latest mask, for the frame at `time`.
    ///
    /// # Errors
    /// No mask, or a camera that sees nothing of `bounds`, unless the view is disabled.
    pub(super) fn next_view(&mut self, bounds: &Aabb, time: f64) -> Result<View> {
        let latest = self.masks.latest().map(|mask| mask.silhouette.clone());
        self.view(latest.zip(self.masks.time_in_frame(time)), bounds)
    }

    /// The view with the mask that it showed at `time`.
    ///
    /// # Errors
    /// As [`Self::next_view`].
    pub(super) fn view_at(&mut self, bounds: &Aabb, time: f64) -> Result<View> {
        let mask = self.masks.at(time).map(|mask| (mask.silhouette.clone(), mask.time.unwrap_or(time)));
        self.view(mask, bounds)
    }

    /// The view with a silhouette that was taken at a time.
    fn view(&mut self, mask: Option<(Arc<Silhouette>, f64)>, bounds: &Aabb) -> Result<View> {
        let (silhouette, time) = match mask {
            Some((silhouette, time)) => (silhouette, Some(time)),
            // A disabled view takes no part in queries.
            None if !self.enabled => (Arc::new(Silhouette::blank(Border::Unknown)), None),
            None => {
                let problem =
                    "expected a mask before the first update, found none; set one, or disable the view";
                return Err(Error::view(self.name(), problem));
            }
        };

        let ViewCalibration { pinhole, field_of_view, .. } = &*self.calibration;
        let view = View::new(pinhole.clone(), silhouette, field_of_view.clone());
        let view = view.with_enabled(self.enabled).with_time(time);

        if self.enabled && !self.sees_some_of(&view, bounds) {
            let (centre, forward) = (self.camera().centre(), self.camera().forward());
            return Err(Error::view(
                self.name(),
                format!(
                    "expected a camera that sees the work volume, found one at ({:.3}, {:.3}, {:.3}) m that looks \
                     along ({:.3}, {:.3}, {:.3}), away from it; check that the pose maps world to camera with z \
                     forward, y down, or disable the view",
                    centre.x, centre.y, centre.z, forward.x, forward.y, forward.z
                ),
            ));
        }
        Ok(view)
    }

    /// Whether the camera sees some of the work volume, computed once for each.
    fn sees_some_of(&mut self, view: &View, bounds: &Aabb) -> bool {
        let (_, sees) = match self.sees_volume {
            Some(known) if known.0 == *bounds => known,
            _ => *self.sees_volume.insert((*bounds, view.sees_some_of(bounds))),
        };
        sees
    }
}

/// Adds tables to the recycled ones, unless there are enough.
fn keep_tables(recycled: &mut Vec<Tables>, tables: Option<Tables>) {
    if recycled.len() < MAX_RECYCLED {
        recycled.extend(tables);
    }
}

impl Preparation {
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

        let MaskScratch { packed, bytes, tiles } = &mut self.scratch;
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
fn unseen_value(border: Border) -> u8 {
    if border == Border::Unknown { 255 } else { 0 }
}
