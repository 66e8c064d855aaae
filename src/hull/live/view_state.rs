//! One view of a data object: its camera, its latest silhouettes, and memory recycled from past ones.

use crate::camera::Camera;
use crate::hull::{Aabb, View};
use crate::silhouette::{
    Border, IncomingMask, MaskRing, MaskScratch, SUBJECT, Silhouette, Tables, TimedMask, Undistortion,
};
use crate::{Error, Result};
use std::sync::Arc;

/// As many silhouettes, and as many sets of tables, are kept for the next masks of a view.
const MAX_RECYCLED: usize = 3;

/// A view's camera and latest silhouettes.
#[derive(Debug)]
pub(super) struct ViewState {
    calibration: Arc<ViewCalibration>,
    masks: MaskRing,
    pub(super) enabled: bool,
    /// Whether the camera sees some of the work volume given beside.
    sees_volume: Option<(Aabb, bool)>,
    /// Silhouettes without another owner and without tables: memory for the bits of the next masks.
    recycled_silhouettes: Vec<Arc<Silhouette>>,
    /// Tables of past silhouettes: memory for those of the next masks, nine tenths of all.
    recycled_tables: Vec<Tables>,
    scratch: MaskScratch,
}

/// What never changes of a view.
#[derive(Debug)]
pub(super) struct ViewCalibration {
    camera: Arc<Camera>,
    pinhole: Arc<Camera>,
    undistortion: Option<Undistortion>,
    field_of_view: Option<Arc<Silhouette>>,
}

/// A mask's preparation, which needs no lock.
#[derive(Debug)]
pub(super) struct Preparation {
    lens: Arc<ViewCalibration>,
    silhouette: Arc<Silhouette>,
    scratch: MaskScratch,
}

impl ViewState {
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
        let seen =
            undistortion.as_ref().map(|lens| Silhouette::new(lens.field_of_view(), Border::Background));
        let camera = Arc::new(camera);
        let pinhole =
            undistortion.as_ref().map_or_else(|| camera.clone(), |lens| Arc::new(lens.pinhole().clone()));
        let lens =
            Arc::new(ViewCalibration { camera, pinhole, undistortion, field_of_view: seen.map(Arc::new) });
        Ok(Self {
            calibration: lens,
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

    /// What the next mask's preparation needs, in recycled memory where there is any.
    pub(super) fn take_buffers(&mut self) -> Preparation {
        let blank = || Arc::new(Silhouette::blank(Border::Background));
        let mut silhouette = self.recycled_silhouettes.pop().unwrap_or_else(blank);
        if let Some(unshared) = Arc::get_mut(&mut silhouette)
            && let Some(tables) = self.recycled_tables.pop()
        {
            unshared.recycle_tables(tables);
        }
        Preparation { lens: self.calibration.clone(), silhouette, scratch: std::mem::take(&mut self.scratch) }
    }

    /// Refuses the time of a mask that cannot be the next one.
    ///
    /// # Errors
    /// A time that is not finite or lies before the last mask's.
    pub(super) fn check_time(&self, time: Option<f64>) -> Result<()> {
        self.masks.check_time(time).map_err(|e| Error::view(self.name(), e))
    }

    /// Takes a prepared silhouette of `time` into force, from the next frame on.
    ///
    /// # Errors
    /// As [`Self::check_time`].
    pub(super) fn commit(&mut self, preparation: Preparation, time: Option<f64>) -> Result<()> {
        let Preparation { silhouette, scratch, .. } = preparation;
        self.scratch = scratch;
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

    /// Takes note that the latest mask is in the frame of `time`.
    pub(super) fn publish(&mut self, time: f64) {
        self.masks.publish(time);
        self.recycle_old();
    }

    /// Recycles the masks that are too old.
    fn recycle_old(&mut self) {
        while let Some(old) = self.masks.pop_old() {
            self.recycle(old);
        }
    }

    /// Recycles the tables of past masks that no frame needs any more.
    pub(super) fn recycle_past_tables(&mut self) {
        // Of the last masks, which are still in the caches. Those that were held for longer stay.
        for silhouette in self.masks.past().take(2).filter_map(Arc::get_mut) {
            keep_tables(&mut self.recycled_tables, silhouette.take_tables());
        }
    }

    /// Keeps the memory of a silhouette that is no longer needed here, unless it has another owner.
    pub(super) fn recycle(&mut self, mut silhouette: Arc<Silhouette>) {
        let Some(unshared) = Arc::get_mut(&mut silhouette) else { return };
        keep_tables(&mut self.recycled_tables, unshared.take_tables());
        if self.recycled_silhouettes.len() < MAX_RECYCLED {
            self.recycled_silhouettes.push(silhouette);
        }
    }

    /// Prepares all silhouettes anew for another border: what the view does not see is then something else.
    pub(super) fn change_border(&mut self, border: Border) {
        for silhouette in self.masks.all() {
            let mut mask = silhouette.to_mask();
            if let Some(lens) = &self.calibration.undistortion {
                let unseen = unseen_value(border);
                let pixels = mask.iter_mut().zip(lens.field_of_view().iter());
                pixels.filter(|(_, seen)| **seen < SUBJECT).for_each(|(pixel, _)| *pixel = unseen);
            }
            *silhouette = Arc::new(Silhouette::new(&mask, border));
        }
    }

    /// The view of the next frame, of `time`.
    pub(super) fn next_view(&mut self, bounds: &Aabb, time: f64) -> Result<View> {
        let latest = self.masks.latest().map(|mask| mask.silhouette.clone());
        self.view(latest.zip(self.masks.time_in_frame(time)), bounds)
    }

    /// The view of what was to be seen at `time`.
    pub(super) fn view_at(&mut self, bounds: &Aabb, time: f64) -> Result<View> {
        let mask = self.masks.at(time).map(|mask| (mask.silhouette.clone(), mask.time.unwrap_or(time)));
        self.view(mask, bounds)
    }

    /// The view of a silhouette and its time.
    fn view(&mut self, mask: Option<(Arc<Silhouette>, f64)>, bounds: &Aabb) -> Result<View> {
        let (silhouette, time) = match mask {
            Some((silhouette, time)) => (silhouette, Some(time)),
            // A disabled view is never asked.
            None if !self.enabled => (Arc::new(Silhouette::blank(Border::Unknown)), None),
            None => {
                let problem =
                    "expected a mask before the first update, found none; set one, or disable the view";
                return Err(Error::view(self.name(), problem));
            }
        };
        let ViewCalibration { pinhole, field_of_view: seen, .. } = &*self.calibration;
        let view = View::new(pinhole.clone(), silhouette, seen.clone());
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

    /// Asked once a work volume.
    fn sees_some_of(&mut self, view: &View, bounds: &Aabb) -> bool {
        let (_, sees) = match self.sees_volume {
            Some(known) if known.0 == *bounds => known,
            _ => *self.sees_volume.insert((*bounds, view.sees_some_of(bounds))),
        };
        sees
    }
}

/// Keeps the memory of tables, unless there is enough.
fn keep_tables(recycled: &mut Vec<Tables>, tables: Option<Tables>) {
    if recycled.len() < MAX_RECYCLED {
        recycled.extend(tables);
    }
}

impl Preparation {
    /// Prepares `mask`; what the view does not see is subject where it abstains, so that it has no edge.
    ///
    /// # Errors
    /// As [`HullData::set_mask`](crate::hull::HullData::set_mask).
    pub(super) fn prepare(&mut self, mask: IncomingMask, border: Border) -> Result<()> {
        self.lens.check_size(mask.size())?;

        // A silhouette that has another owner too stays as it is.
        if Arc::get_mut(&mut self.silhouette).is_none() {
            self.silhouette = Arc::new(Silhouette::blank(border));
        }
        let Some(silhouette) = Arc::get_mut(&mut self.silhouette) else {
            unreachable!("a new silhouette has one owner");
        };

        let MaskScratch { packed, bytes, tiles } = &mut self.scratch;
        let is_full = match &self.lens.undistortion {
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
        if is_full { Err(self.lens.full_mask()) } else { Ok(()) }
    }
}

impl ViewCalibration {
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

    fn full_mask(&self) -> Error {
        let problem = "mask: expected some background, found every pixel subject; \
                       it is inverted or the segmentation failed; the last good mask stays";
        Error::view(self.camera.name(), problem)
    }
}

/// The mask's value where a lens did not see.
fn unseen_value(border: Border) -> u8 {
    if border == Border::Unknown { 255 } else { 0 }
}
